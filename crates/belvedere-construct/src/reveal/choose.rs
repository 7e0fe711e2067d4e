//! Choice of a view: a picture is judged by what it shows and how, bent only where something is hidden.

use super::evaluate::{Evaluation, Evaluator};
use super::eyes::Eye;
use super::options::RevealOptions;
use super::score::{PER_SHARE, UNBENT, composition, frame, shown, unbent};
use super::search::{BENT, BendSearch, Candidate, SearchStart, coarse_stride, stride_for};
use super::thresholds::NOTHING_HIDDEN;
use crate::ConstructError;
use belvedere_core::{EarthCurvature, Projection, Stage, View};
use belvedere_scene::Progress;
use rayon::prelude::*;

/// Views kept for the search of a bend.
pub(super) const VIEWS_KEPT: usize = 14;
/// Views whose bend is improved before one is chosen.
const VIEWS_REFINED: usize = 3;
/// Eyes with the best compositions, from which lines of sight are looked along.
const LOOKED_FROM: usize = 1500;
/// Eyes that are evaluated even where time is up.
const EYES_AT_LEAST: usize = 24;
/// Views within this angle of each other are alike, degrees; so many of them are kept.
const ALIKE_DEG: f64 = 20.0;
const MOST_ALIKE: usize = 2;
/// The best straight pictures are kept in any case: where one shows all, no bend is needed.
const STRAIGHT_KEPT: usize = 2;

/// A camera whose straight picture was evaluated.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    pub(crate) view: View,
    pub(crate) straight: Evaluation,
    /// Heading in degrees clockwise from north.
    pub(crate) heading_deg: f64,
    /// Score of the camera, whatever its picture shows.
    pub(crate) taste: f64,
}

/// The chosen camera with its bend, if bending pays.
pub(crate) struct Choice {
    pub(crate) base: usize,
    /// The bend, and where its search begins again; `None` if the straight picture is the best.
    pub(crate) bend: Option<SearchStart>,
    pub(crate) score: f64,
}

/// Field of view from which on a lens is not narrow, radians.
const USUAL_FOV_Y: f64 = 0.78;

/// Score of a camera: light comes from the north-west, and looking north shows the shaded side of the relief as readers of maps know it; through
/// a narrow lens, from far away, relief looks flat.
fn taste(eye: &Eye, options: &RevealOptions) -> f64 {
    let lens = match eye.pinhole.projection {
        Projection::Perspective { fov_y } => (fov_y / options.fov_y.min(USUAL_FOV_Y)).min(1.0),
        Projection::Orthographic { .. } => 0.0,
    };
    0.15 * eye.heading_deg.to_radians().cos() - 0.2 * (1.0 - lens)
}

/// Score of a straight picture as a start: composition, what it shows already, and how far a bend can show the rest. Where something is hidden,
/// the bend also brings a horizon that is not there yet.
fn promise(a: &Evaluation, taste: f64) -> f64 {
    let hidden = 1.0 - a.visible_in_frame;
    let bent = if a.visible_in_frame < 1.0 - SURE_GAIN { frame(a) - BENT } else { f64::NEG_INFINITY };
    composition(a).max(bent) + taste + 0.8 * a.visible_in_frame - 2.0 * hidden * (0.8 - a.attainable).max(0.0)
}

/// Evaluates the eyes by their straight pictures and keeps the most promising, not many from nearly the same direction.
pub(super) fn promising(
    evaluator: &Evaluator<'_>,
    eyes: Vec<Eye>,
    options: &RevealOptions,
    most: usize,
    progress: &Progress,
) -> Result<Vec<Base>, ConstructError> {
    progress.tick("looking from all around", 0.1)?;
    let tried = eyes.len();
    let samples = evaluator.samples.len();
    let stride = coarse_stride(samples, stride_for(samples, options));
    let mut composed = best_first(eyes, progress, |eye: Eye| {
        let stages = options.earth_radius.map(|radius| {
            let refraction = EarthCurvature::REFRACTION;
            Stage::EarthCurvature(EarthCurvature { eye: eye.pinhole.eye, radius, refraction })
        });
        let view = View::new(eye.pinhole.clone(), stages.into_iter().collect()).ok()?;
        let (straight, taste) = (evaluator.composed(&view, stride), taste(&eye, options));
        let score = composition(&straight).max(frame(&straight) - BENT) + taste;
        Some((score, Base { view, straight, heading_deg: eye.heading_deg, taste }))
    });
    composed.truncate(LOOKED_FROM);
    let evaluated = best_first(composed, progress, |base: Base| {
        let straight = evaluator.evaluate(&base.view, stride);
        Some((promise(&straight, base.taste), Base { straight, ..base }))
    });
    let (mut kept, mut others): (Vec<Base>, Vec<Base>) = Default::default();
    for base in evaluated {
        let apart = |k: &&Base| {
            let turn = (k.heading_deg - base.heading_deg).rem_euclid(360.0);
            turn.min(360.0 - turn) < ALIKE_DEG
        };
        if base.straight.in_frame > 0.05 && kept.iter().filter(apart).count() < MOST_ALIKE && kept.len() < most {
            kept.push(base);
        } else {
            others.push(base);
        }
    }
    if kept.is_empty() {
        return Err(ConstructError::NoView { tried });
    }
    others.sort_by(|a, b| score_straight(b).total_cmp(&score_straight(a)));
    let least = kept.iter().map(score_straight).fold(f64::NEG_INFINITY, f64::max);
    kept.extend(others.into_iter().take(STRAIGHT_KEPT).filter(|base| score_straight(base) > least));
    Ok(kept)
}

/// Cameras with a score, the best first. When time is up, the rest are left out, but not the first ones, which are the most usual.
fn best_first<T: Send>(of: Vec<T>, progress: &Progress, scored: impl Fn(T) -> Option<(f64, Base)> + Sync) -> Vec<Base> {
    let in_time = |i: usize| i < EYES_AT_LEAST || !progress.should_end();
    let all = of.into_par_iter().enumerate().filter_map(|(i, one)| if in_time(i) { scored(one) } else { None });
    let mut all: Vec<(f64, Base)> = all.collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, base)| base).collect()
}

/// Score of the straight picture as the answer.
fn score_straight(base: &Base) -> f64 {
    composition(&base.straight) + shown(&base.straight) + unbent(&base.straight) + base.taste
}

/// The best of all pictures, straight and bent; with the number of bends tried.
pub(super) fn best_of_all(
    evaluator: &Evaluator<'_>,
    bases: &[Base],
    options: &RevealOptions,
    remembered: Option<&SearchStart>,
    progress: &Progress,
) -> Result<(Choice, usize), ConstructError> {
    let stride = stride_for(evaluator.samples.len(), options);
    let (mut bent, mut tried): (Vec<(Choice, SearchStart)>, usize) = (Vec::new(), 0);
    let straight = bases.iter().enumerate().map(|(i, base)| (i, score_straight(base)));
    let mut best = straight.fold(None, |best: Option<Choice>, (base, score)| match best {
        Some(best) if best.score >= score => Some(best),
        _ => Some(Choice { base, bend: None, score }),
    });
    for (index, base) in bases.iter().enumerate() {
        progress.tick("bending the picture", 0.3 + 0.3 * index as f64 / bases.len() as f64)?;
        // A bend of it is hardly worth more than all of the features under a horizon.
        let at_best = frame(&base.straight).max(composition(&base.straight)) + PER_SHARE + UNBENT + base.taste;
        let hides = base.straight.visible_in_frame < NOTHING_HIDDEN;
        let gains = |candidate: &Candidate| candidate.visible >= base.straight.visible + SURE_GAIN;
        if !hides || best.as_ref().is_some_and(|best| best.score >= at_best) {
            continue;
        }
        let mut search = BendSearch::new(evaluator, &base.view, base.straight, stride);
        let remembered = remembered.and_then(|start| search.refine(start, 0, progress));
        let found = search.coarse().into_iter().chain(remembered).filter(|(_, found)| gains(found));
        let found = found.max_by(|a, b| a.1.score.total_cmp(&b.1.score));
        bent.extend(
            found.map(|(start, t)| (Choice { base: index, bend: Some(start), score: t.score + base.taste }, start)),
        );
        tried += search.tried;
        if progress.should_end() {
            break;
        }
    }
    bent.sort_by(|a, b| b.0.score.total_cmp(&a.0.score));
    bent.truncate(VIEWS_REFINED);
    for (i, (mut chosen, start)) in bent.into_iter().enumerate() {
        if !progress.should_end() {
            progress.tick("bending the picture", 0.6 + 0.2 * i as f64 / VIEWS_REFINED as f64)?;
            let base = &bases[chosen.base];
            let mut search = BendSearch::new(evaluator, &base.view, base.straight, stride);
            if let Some((start, better)) = search.refine(&start, 3, progress) {
                let score = better.score + base.taste;
                chosen = Choice { bend: Some(start), score, ..chosen };
            }
            tried += search.tried;
        }
        if best.as_ref().is_none_or(|best| chosen.score > best.score) {
            best = Some(chosen);
        }
    }
    best.map(|b| (b, tried)).ok_or(ConstructError::NoView { tried: bases.len() })
}

/// Whether a bend shows so much more of the whole features than the straight picture that it is worth bending.
pub(super) fn pays(straight: &Evaluation, bent: &Evaluation) -> bool {
    bent.visible >= straight.visible + LEAST_GAIN
}

/// Share of the whole features that a bend must show in addition.
const LEAST_GAIN: f64 = 0.005;
/// The same by the few samples of the search, so that a view is not chosen for a bend that all samples then refuse it.
const SURE_GAIN: f64 = 0.012;

/// The candidate of a bend at its camera, evaluated.
pub(super) fn candidate(
    evaluator: &Evaluator<'_>,
    base: &Base,
    start: &SearchStart,
    rounds: usize,
    options: &RevealOptions,
    progress: &Progress,
) -> (Option<(SearchStart, Candidate)>, usize) {
    let stride = stride_for(evaluator.samples.len(), options);
    let mut search = BendSearch::new(evaluator, &base.view, base.straight, stride);
    let found = search.refine(start, rounds, progress);
    (found, search.tried)
}
