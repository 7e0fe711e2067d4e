//! Moves the frame of a chosen picture: what a bend carries up or aside is brought back to the middle of the picture, as large as it may be.

use super::choose::{Base, candidate};
use super::evaluate::Evaluator;
use super::options::RevealOptions;
use super::score::{composition, shown, unbent};
use super::search::{Candidate, SearchStart, stride_for};
use belvedere_core::{Pinhole, Projection, View};
use belvedere_scene::Progress;

/// Steps in which the camera is turned up and sideways, and its field of view changed, shares of the field of view.
const TURNS: [f64; 3] = [0.06, 0.06, 0.03];
const ZOOM: f64 = 0.06;
/// Score that a moved frame must gain.
const WORTH: f64 = 0.01;

/// A camera, its bend if it has one, and the score of the picture.
pub(super) struct Framed {
    pub(super) base: Base,
    pub(super) bend: Option<(SearchStart, Candidate)>,
    pub(super) score: f64,
    pub(super) tried: usize,
}

/// The best of the frames around that of `base`.
pub(super) fn polished(
    evaluator: &Evaluator<'_>,
    base: &Base,
    bend: Option<&SearchStart>,
    options: &RevealOptions,
    progress: &Progress,
) -> Option<Framed> {
    let mut best = framed(evaluator, base.clone(), bend, options, progress)?;
    for turn in TURNS {
        let around = [
            [0.0, turn, 0.0],
            [0.0, -turn, 0.0],
            [turn, 0.0, 0.0],
            [-turn, 0.0, 0.0],
            [0.0, 0.0, ZOOM],
            [0.0, 0.0, -ZOOM],
        ];
        for step in around {
            if progress.should_end() {
                return Some(best);
            }
            let stride = stride_for(evaluator.samples.len(), options);
            let Some(view) = moved(&best.base.view, step, options.fov_y) else { continue };
            let straight = evaluator.evaluate(&view, stride);
            let base = Base { view, straight, ..best.base.clone() };
            let start = best.bend.as_ref().map(|(start, _)| *start);
            let Some(next) = framed(evaluator, base, start.as_ref(), options, progress) else { continue };
            let tried = best.tried + next.tried;
            if next.score > best.score + WORTH {
                best = next;
            }
            best.tried = tried;
        }
    }
    Some(best)
}

/// Shares by which the field of view of a found picture is widened to hold what lies just outside it, and the part of the features in the picture
/// from which on all of them are.
const WIDER: [f64; 4] = [0.01, 0.025, 0.05, 0.08];
const WHOLE: f64 = 0.9995;
/// Visible share that a wider picture must gain.
const GAINED: f64 = 0.0005;

/// A found picture, judged by all samples, or one a little wider that shows more because more of the features lie in it.
///
/// * `bend`: the bend, and where its search ended; `None` if the picture is straight.
pub(super) fn widened(
    evaluator: &Evaluator<'_>,
    base: Base,
    bend: Option<(SearchStart, Candidate)>,
    options: &RevealOptions,
    progress: &Progress,
) -> (Base, Option<(SearchStart, Candidate)>) {
    let judged = |base: &Base, bend: &Option<(SearchStart, Candidate)>| {
        evaluator.evaluate(bend.as_ref().map_or(&base.view, |(_, found)| &found.built.view), 1)
    };
    let mut seen = judged(&base, &bend);
    let (first, start) = (base.clone(), bend.as_ref().map(|(start, _)| *start));
    let mut best = (base, bend);
    for zoom in WIDER {
        if seen.in_frame >= WHOLE || progress.should_end() {
            break;
        }
        let Some(view) = moved(&first.view, [0.0, 0.0, zoom], options.fov_y) else { break };
        let straight = evaluator.evaluate(&view, stride_for(evaluator.samples.len(), options));
        let base = Base { view, straight, ..first.clone() };
        let bend = match &start {
            None => None,
            Some(start) => match candidate(evaluator, &base, start, 0, options, progress).0 {
                Some(found) => Some(found),
                None => continue,
            },
        };
        let next = judged(&base, &bend);
        if next.visible >= seen.visible + GAINED {
            (best, seen) = ((base, bend), next);
        }
    }
    best
}

fn framed(
    evaluator: &Evaluator<'_>,
    base: Base,
    bend: Option<&SearchStart>,
    options: &RevealOptions,
    progress: &Progress,
) -> Option<Framed> {
    let Some(start) = bend else {
        let score = composition(&base.straight) + shown(&base.straight) + unbent(&base.straight);
        return Some(Framed { base, bend: None, score, tried: 0 });
    };
    let (found, tried) = candidate(evaluator, &base, start, 0, options, progress);
    let found = found?;
    Some(Framed { score: found.1.score, base, bend: Some(found), tried })
}

/// The camera turned aside and up, with another field of view, by shares of its field of view.
fn moved(view: &View, [aside, up, zoom]: [f64; 3], widest: f64) -> Option<View> {
    let old = view.pinhole();
    let Projection::Perspective { fov_y } = old.projection else { return None };
    let wide = (fov_y * (1.0 + zoom)).min(widest);
    let forward = old.forward - (up * fov_y).tan() * old.down + (aside * fov_y).tan() * old.right;
    let lens = Projection::Perspective { fov_y: wide };
    let pinhole =
        Pinhole::look_at(old.eye, old.eye + forward, belvedere_core::DVec3::Z, lens, old.image, old.near, old.far)
            .ok()?;
    View::new(pinhole, view.stages().to_vec()).ok()
}
