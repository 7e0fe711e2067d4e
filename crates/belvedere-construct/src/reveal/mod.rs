//! Chooses a view and a bend that show more of the features than a straight picture can.
//!
//! The view: eyes all around the features, evaluated by line of sight alone. The bend: a B-spline over the mean ground
//! that turns the ground with the features towards the eye and lets the background sink back to a horizon
//! (Pasewaldt et al. 2011; their presets are drawn by hand, the choice by visible length is ours).

mod evaluate;
mod eyes;
mod options;
mod search;
mod shape;

pub use evaluate::Evaluation;
pub use options::RevealOptions;
pub use shape::BendShape;

use crate::ConstructError;
use crate::measure::{Shares, percent};
use crate::sample::SampledFeature;
use crate::samples::{default_spacing, sample_features};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec3, EarthCurvature, Stage, View};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Progress, Scene};
use evaluate::Evaluator;
use eyes::Eye;
use rayon::prelude::*;
use search::{BendSearch, Candidate, stride_for};
use serde::Serialize;

/// Memory of an earlier call, from whose result the next search for the same scene starts. The same inputs and memory give the same result.
#[derive(Debug, Clone, Default)]
pub struct RevealMemory {
    start: Option<search::SearchStart>,
}

/// Whether the goals were reached. Missing one is a result, not an error.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "result", content = "reasons", rename_all = "snake_case")]
pub enum Goal {
    /// All of them.
    Reached,
    /// Not all; one sentence for each that was missed.
    Missed(Vec<String>),
}

impl Goal {
    /// Whether the shares of the whole features reach the goals.
    ///
    /// * `straight`, `bent`: shares in either picture. The gain is demanded only where the straight picture leaves room for it.
    pub fn of([straight, bent]: [Shares; 2], options: &RevealOptions) -> Self {
        let mut missed = Vec::new();
        if bent.visible < options.goal_share {
            missed.push(shortfall(bent, options.goal_share));
        }
        if let Some(gain) = gain([straight, bent])
            && gain < options.goal_gain
            && options.goal_gain * straight.visible <= 1.0
        {
            missed.push(format!(
                "{gain:.2} times the share of the straight picture is visible, {:.2} times were wanted",
                options.goal_gain
            ));
        }
        if bent.in_frame < KEPT_IN_FRAME * straight.in_frame {
            let kept = 100.0 * bent.in_frame / straight.in_frame;
            missed.push(format!("only {kept:.0} % of what the straight picture holds stays in it"));
        }
        if missed.is_empty() { Self::Reached } else { Self::Missed(missed) }
    }
}

/// Share of what the straight picture holds that the bent one must hold.
const KEPT_IN_FRAME: f64 = 0.9;

/// A sentence about a visible share of the whole features that is less than wanted.
pub fn shortfall(shares: Shares, wanted: f64) -> String {
    format!(
        "{} of all that must be seen is visible and {} lies in the frame, {:.0} % were wanted",
        percent(shares.visible),
        percent(shares.in_frame),
        100.0 * wanted
    )
}

/// Visible share bent over visible share straight; `None` if the straight picture shows nothing.
pub fn gain([straight, bent]: [Shares; 2]) -> Option<f64> {
    (straight.visible > 0.0).then(|| bent.visible / straight.visible)
}

/// A view and a bend, and what they achieve.
#[derive(Debug, Clone)]
pub struct Revealed {
    /// The bent view.
    pub view: View,
    /// The same camera without the bend.
    pub straight: View,
    /// The bend as a preset document, for scene files.
    pub document: PresetDocument,
    /// Pivot of the bend, scene coordinates, on the reference plane.
    pub pivot: DVec3,
    /// Height of the reference plane (median of the terrain), scene units.
    pub plane_height: f64,
    /// Figures.
    pub report: RevealReport,
}

/// Figures of a [`Revealed`], ready for JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RevealReport {
    /// Length (areas: area, points: count) of all features.
    pub total: f64,
    /// The picture without the bend.
    pub straight: Evaluation,
    /// The picture with it.
    pub bent: Evaluation,
    /// Visible share of the whole features bent over that straight; `None` if the straight picture shows nothing.
    pub gain: Option<f64>,
    /// Whether the goals were reached.
    pub goal: Goal,
    /// The bend, by its angles.
    pub shape: BendShape,
    /// Smallest sine of the angle at which the ground plane is seen; > 0 = from above everywhere.
    pub facing: f64,
    /// Smallest factor by which the bend squeezes lengths over the terrain in the picture; 0 = fold.
    pub squeeze: f64,
    /// Eyes evaluated; 0 if the view was given.
    pub eyes_tried: usize,
    /// Bends evaluated.
    pub bends_tried: usize,
    /// Oddities, one sentence each.
    pub warnings: Vec<Warning>,
}

/// Chooses a view (unless `base` gives one) and a spline bend that show more of the layers that must be seen.
///
/// * `base`: a camera, with earth curvature at most; its other stages are left out.
/// * `memory`: where the search of an earlier frame ended;
/// * `progress`: when its time is up, the best view so far is taken.
///
/// Everything is evaluated by line of sight along the rays, so no renderer is needed; [`crate::measure()`] with a renderer
/// is the independent check. Deterministic, whatever the number of threads.
///
/// # Errors
/// [`ConstructError::NoTerrain`], [`ConstructError::NothingToSee`], [`ConstructError::NoSamples`],
/// [`ConstructError::EyeUnderGround`], [`ConstructError::OutOfFrame`], [`ConstructError::NoView`], [`ConstructError::Cancelled`].
pub fn reveal(
    scene: &Scene,
    base: Option<&View>,
    options: &RevealOptions,
    memory: &mut RevealMemory,
    progress: &Progress,
) -> Result<Revealed, ConstructError> {
    let heightfield = scene.terrain().ok_or(ConstructError::NoTerrain)?;
    let features = usable_features(scene, heightfield)?;
    progress.tick("preparing lines of sight", 0.0)?;
    let evaluator = Evaluator::new(scene, heightfield, &features, 4 * options.samples_per_try);
    let mut eyes_tried = 0;
    let bases = match base {
        Some(view) => vec![given_view(&evaluator, view)?],
        None => {
            let eyes = eyes::candidates(&evaluator, options);
            eyes_tried = eyes.len();
            promising_views(&evaluator, eyes, options, progress)?
        }
    };
    let (chosen, mut bends_tried) = best_bend_of_all(&evaluator, &bases, options, memory, progress)?;
    progress.tick("refining the bend", 0.8)?;
    let (base_view, straight) = &bases[chosen.view];
    let mut search = BendSearch::new(&evaluator, base_view, *straight, stride_for(evaluator.samples.len(), options));
    let (start, best) =
        search.refine(&chosen.start, 8, progress).ok_or(ConstructError::NoView { tried: eyes_tried })?;
    bends_tried += search.tried;
    memory.start = Some(start);
    progress.tick("refining the bend", 1.0)?;
    let total = features.iter().flat_map(|f| &f.samples).map(|s| s.amount).sum();
    Ok(finish(&evaluator, base_view, best, options, Counts { total, eyes_tried, bends_tried }))
}

struct Counts {
    total: f64,
    eyes_tried: usize,
    bends_tried: usize,
}

fn usable_features(scene: &Scene, hf: &belvedere_scene::Heightfield) -> Result<Vec<SampledFeature>, ConstructError> {
    if scene.must_see().next().is_none() {
        return Err(ConstructError::NothingToSee { layers: scene.layers.len() });
    }
    let mut features = sample_features(scene, default_spacing(scene));
    for f in &mut features {
        f.samples.retain(|s| s.amount > 0.0 && hf.surface_at(s.p_world.truncate()).is_some());
    }
    // Lines, areas and points cannot be added up: the picture is made for the first kind that is there.
    let kinds = [crate::Amount::Length, crate::Amount::Area, crate::Amount::Count];
    let first = kinds.into_iter().find(|k| features.iter().any(|f| f.amount == *k && !f.samples.is_empty()));
    let Some(kind) = first else {
        let layers: Vec<&str> = scene.must_see().map(|(_, l)| l.id.as_str()).collect();
        return Err(ConstructError::NoSamples { layers: layers.join(", ") });
    };
    features.retain(|f| f.amount == kind);
    Ok(features)
}

fn given_view(evaluator: &Evaluator<'_>, view: &View) -> Result<(View, Evaluation), ConstructError> {
    let base = view.straightened();
    if let Some(height) = evaluator.obstacles.above_ground(base.pinhole().eye)
        && height <= 0.0
    {
        return Err(ConstructError::EyeUnderGround { below_m: -height, raise_m: 1.0 - height });
    }
    let straight = evaluator.evaluate(&base, 1);
    if straight.in_frame < 0.02 {
        return Err(ConstructError::OutOfFrame { in_frame_share: 100.0 * straight.in_frame, needed: 2.0 });
    }
    Ok((base, straight))
}

/// Views kept for the search of a bend.
const VIEWS_KEPT: usize = 10;
/// Views whose bend is improved before one is chosen.
const VIEWS_REFINED: usize = 3;

/// Eyes that are evaluated even where time is up.
const EYES_AT_LEAST: usize = 24;

/// Evaluates every eye by its straight picture and keeps the best, not two from nearly the same direction.
fn promising_views(
    evaluator: &Evaluator<'_>,
    eyes: Vec<Eye>,
    options: &RevealOptions,
    progress: &Progress,
) -> Result<Vec<(View, Evaluation)>, ConstructError> {
    progress.tick("looking from all around", 0.1)?;
    let tried = eyes.len();
    let stride = 2 * stride_for(evaluator.samples.len(), options);
    let mut evaluated: Vec<(f64, Eye, View, Evaluation)> = eyes
        .into_par_iter()
        .enumerate()
        .filter_map(|(i, eye)| {
            // When time is up, the other eyes are left out, but not the most promising ones.
            if i >= EYES_AT_LEAST && progress.should_end() {
                return None;
            }
            let stages = options.earth_radius.map(|radius| {
                let refraction = EarthCurvature::REFRACTION;
                Stage::EarthCurvature(EarthCurvature { eye: eye.pinhole.eye, radius, refraction })
            });
            let view = View::new(eye.pinhole.clone(), stages.into_iter().collect()).ok()?;
            let a = evaluator.evaluate(&view, stride);
            Some((straight_score(&a, eye.heading_deg, options), eye, view, a))
        })
        .collect();
    evaluated.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<(f64, View, Evaluation)> = Vec::new();
    for (_, eye, view, a) in evaluated {
        let crowd = kept.iter().filter(|k| (k.0 - eye.heading_deg).abs() < 20.0).count();
        if a.in_frame > 0.05 && crowd < 2 && kept.len() < VIEWS_KEPT {
            kept.push((eye.heading_deg, view, a));
        }
    }
    if kept.is_empty() {
        return Err(ConstructError::NoView { tried });
    }
    Ok(kept.into_iter().map(|(_, view, a)| (view, a)).collect())
}

/// Score of a straight picture: it should look natural, hold the features, and hide many of them.
fn straight_score(a: &Evaluation, heading_deg: f64, options: &RevealOptions) -> f64 {
    let most = 0.85 * (options.goal_share / options.goal_gain).min(0.6);
    let hidden = 3.0 * (a.visible_in_frame - most).max(0.0) + 1.5 * (0.25 - a.visible_in_frame).max(0.0);
    // Light comes from the north-west: looking north shows the shaded side of the relief as readers of maps know it.
    let north = 0.15 * heading_deg.to_radians().cos();
    let sky = (0.08 - a.skyline).max(0.0) + (a.skyline - 0.25).max(0.0);
    0.6 * a.in_frame + 0.4 * a.in_margin + 0.25 * (a.drawn / 0.8).min(1.0) - 3.0 * (1.0 - a.covered) - hidden + north
        - 1.5 * sky
        - 1.2 * (0.8 - a.attainable).max(0.0)
}

struct Best {
    view: usize,
    start: search::SearchStart,
    score: f64,
}

fn best_bend_of_all(
    evaluator: &Evaluator<'_>,
    bases: &[(View, Evaluation)],
    options: &RevealOptions,
    memory: &RevealMemory,
    progress: &Progress,
) -> Result<(Best, usize), ConstructError> {
    let stride = stride_for(evaluator.samples.len(), options);
    let (mut found, mut tried): (Vec<Best>, usize) = (Vec::new(), 0);
    for (view, (base, straight)) in bases.iter().enumerate() {
        progress.tick("bending the picture", 0.3 + 0.3 * view as f64 / bases.len() as f64)?;
        let mut search = BendSearch::new(evaluator, base, *straight, stride);
        let remembered = memory.start.as_ref().and_then(|start| search.refine(start, 0, progress));
        let view_score = straight_score(straight, 0.0, options);
        let best = search.coarse().into_iter().chain(remembered).max_by(|a, b| a.1.score.total_cmp(&b.1.score));
        found.extend(best.map(|(start, t)| Best { view, start, score: t.score + view_score }));
        tried += search.tried;
        if !found.is_empty() && progress.should_end() {
            break;
        }
    }
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    found.truncate(VIEWS_REFINED);
    for (i, chosen) in found.iter_mut().enumerate() {
        if progress.should_end() {
            break;
        }
        progress.tick("bending the picture", 0.6 + 0.2 * i as f64 / VIEWS_REFINED as f64)?;
        let (base, straight) = &bases[chosen.view];
        let mut search = BendSearch::new(evaluator, base, *straight, stride);
        if let Some((start, better)) = search.refine(&chosen.start, 3, progress) {
            *chosen = Best { start, score: better.score + straight_score(straight, 0.0, options), ..*chosen };
        }
        tried += search.tried;
    }
    let best = found.into_iter().reduce(|best, next| if next.score > best.score { next } else { best });
    best.map(|b| (b, tried)).ok_or(ConstructError::NoView { tried: bases.len() })
}

fn finish(
    evaluator: &Evaluator<'_>,
    base: &View,
    best: Candidate,
    options: &RevealOptions,
    counts: Counts,
) -> Revealed {
    let straight = evaluator.evaluate(base, 1);
    let bent = evaluator.evaluate(&best.built.view, 1);
    let mut warnings = Vec::new();
    if bent.covered < 0.8 {
        let text =
            format!("the ground of the data fills {:.0} % of the picture below the skyline", 100.0 * bent.covered);
        warnings.push(Warning::new(WarningKind::Suspect, text).with("share", bent.covered));
    }
    let report = RevealReport {
        total: counts.total,
        straight,
        bent,
        gain: gain([straight.shares(), bent.shares()]),
        goal: Goal::of([straight.shares(), bent.shares()], options),
        shape: best.shape,
        facing: best.facing,
        squeeze: best.squeeze,
        eyes_tried: counts.eyes_tried,
        bends_tried: counts.bends_tried,
        warnings,
    };
    Revealed {
        view: best.built.view,
        straight: base.clone(),
        document: best.built.document,
        pivot: best.built.pivot,
        plane_height: evaluator.plane.height(),
        report,
    }
}
