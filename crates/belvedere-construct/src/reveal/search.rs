//! Search for the bend that shows most of the features in a natural picture: a coarse lattice, then ever smaller steps.

use super::evaluate::{Evaluation, Evaluator};
use super::options::RevealOptions;
use super::score::{composition, shown};
use super::shape::{BendShape, BuiltBend};
use belvedere_core::quantile::{Rank, quantile};
use belvedere_core::{Projection, View};
use belvedere_scene::Progress;
use rayon::prelude::*;

/// A bend that was evaluated.
pub(crate) struct Candidate {
    pub(crate) shape: BendShape,
    pub(crate) built: BuiltBend,
    pub(crate) squeeze: f64,
    pub(crate) facing: f64,
    pub(crate) score: f64,
    /// Visible share of the whole features, by the samples of the search.
    pub(crate) visible: f64,
}

/// Score that any bend costs: a straight picture that shows as much is better.
pub(super) const BENT: f64 = 0.05;

/// Distances and angles that the free parameters of a shape are multiples of.
struct Scales {
    /// Distances along the heading of the near end, the middle and the far end of the features in the picture.
    features: [f64; 3],
    half_fov: f64,
    pitch: f64,
    straight_in_frame: f64,
}

/// The free parameters of a shape, each about 0..=1.
#[derive(Debug, Clone, Copy)]
struct ShapeParameters {
    middle: f64,
    far: f64,
    near: f64,
    pivot: f64,
    fall_from: f64,
    fall_length: f64,
}

impl ShapeParameters {
    const fn get(&self) -> [f64; 6] {
        [self.middle, self.far, self.near, self.pivot, self.fall_from, self.fall_length]
    }

    const fn of([middle, far, near, pivot, fall_from, fall_length]: [f64; 6]) -> Self {
        Self { middle, far, near, pivot, fall_from, fall_length }
    }

    fn shape(&self, scales: &Scales) -> BendShape {
        let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let [first, middle, last] = scales.features;
        let depth = (last - first).max(0.1 * middle);
        // Equal steps are equal factors: 6 to 75 degrees.
        let angle = 6f64.to_radians() * (75f64 / 6.0).powf(self.middle.clamp(0.0, 1.0));
        let far = lerp(0.02, 0.25, self.far.clamp(0.0, 1.0)).min(angle);
        let straight = (scales.pitch + scales.half_fov).clamp(0.1, 1.0);
        let start = lerp(first - 0.2 * depth, last + 0.3 * depth, self.fall_from).max(0.3 * middle);
        let length = (lerp(0.25, 2.0, self.fall_length) * depth).max(0.2 * depth);
        let nearest = (first - 0.9 * depth).max(0.12 * middle).min(0.8 * first);
        BendShape {
            near: lerp(angle, straight, self.near.clamp(0.0, 1.0)),
            middle: angle,
            far,
            pivot: lerp(first, last, self.pivot).max(nearest),
            rise: [nearest, (first + 0.1 * depth).min(start).max(1.05 * nearest)],
            fall: [start, start + length],
        }
    }
}

/// The search for one camera.
pub(crate) struct BendSearch<'a, 'b> {
    evaluator: &'b Evaluator<'a>,
    base: &'b View,
    scales: Scales,
    straight: Evaluation,
    stride: usize,
    /// Bends evaluated so far.
    pub(crate) tried: usize,
}

impl<'a, 'b> BendSearch<'a, 'b> {
    pub(crate) fn new(evaluator: &'b Evaluator<'a>, base: &'b View, straight: Evaluation, stride: usize) -> Self {
        let pinhole = base.pinhole();
        let heading = super::shape::heading(pinhole, &evaluator.plane);
        let mut along: Vec<f64> = evaluator
            .samples
            .iter()
            .filter(|s| base.pinhole().project(s.p_world).is_ok_and(|(px, _)| pinhole.contains(px)))
            .map(|s| (s.p_world - pinhole.eye).dot(heading))
            .collect();
        let mut at = |share: f64| quantile(&mut along, share, Rank::Nearest).max(1.0);
        let half_fov = match pinhole.projection {
            Projection::Perspective { fov_y } => 0.5 * fov_y,
            Projection::Orthographic { .. } => 0.4,
        };
        let pitch = (-pinhole.forward.z).asin();
        let features = [at(0.03), at(0.5), at(0.97)];
        let scales = Scales { features, half_fov, pitch, straight_in_frame: straight.in_frame };
        Self { evaluator, base, scales, straight, stride, tried: 0 }
    }

    fn evaluate(&self, parameters: &ShapeParameters, stride: usize) -> Option<Candidate> {
        let shape = parameters.shape(&self.scales);
        let built = shape.build(self.base, &self.evaluator.plane).ok()?;
        let (squeeze, facing) = self.evaluator.fold_and_facing(&built.view);
        if squeeze < 0.25 || facing < 0.004 || self.evaluator.is_warned_of(&built) {
            return None;
        }
        let evaluation = self.evaluator.evaluate(&built.view, stride);
        let score = self.score(&shape, &evaluation, squeeze, facing);
        Some(Candidate { shape, built, squeeze, facing, score, visible: evaluation.visible })
    }

    fn score(&self, shape: &BendShape, a: &Evaluation, squeeze: f64, facing: f64) -> f64 {
        let lost =
            (self.scales.straight_in_frame * 0.97 - a.in_frame).max(0.0) / self.scales.straight_in_frame.max(1e-9);
        let bend = (shape.middle - self.scales.pitch).abs() + 0.3 * (shape.middle - shape.near).abs();
        // Turning per distance: ground that tips over a kink looks broken.
        let kink = (shape.middle - shape.far).abs() * self.scales.features[1] / (shape.fall[1] - shape.fall[0]);
        let more = a.visible - self.straight.visible;
        shown(a) + composition(a)
            - 6.0 * lost
            - 30.0 * (lost - 0.04).max(0.0)
            - BENT
            - 0.2 * bend
            - 2.0 * (0.05 - more).max(0.0)
            - 0.06 * (kink - 1.0).max(0.0)
            - 0.6 * (0.6 - squeeze).max(0.0)
            - 4.0 * (0.03 - facing).max(0.0)
    }

    fn best_of(&mut self, all: &[ShapeParameters], stride: usize) -> Option<(ShapeParameters, Candidate)> {
        self.tried += all.len();
        let evaluated: Vec<Option<Candidate>> = all.par_iter().map(|k| self.evaluate(k, stride)).collect();
        let pairs = all.iter().copied().zip(evaluated).filter_map(|(k, t)| Some((k, t?)));
        // The first of equals, so that the answer does not depend on threads.
        pairs.reduce(|best, next| if next.1.score > best.1.score { next } else { best })
    }

    /// The best of a coarse lattice over the whole range of bends.
    pub(crate) fn coarse(&mut self) -> Option<(SearchStart, Candidate)> {
        let mut grid = Vec::new();
        for middle in [0.4, 0.6, 0.75, 0.9] {
            for (pivot, fall_from) in [(0.35, 0.35), (0.55, 0.6), (0.7, 0.85)] {
                for fall_length in [0.25, 0.7] {
                    grid.push(ShapeParameters { middle, far: 0.2, near: 0.2, pivot, fall_from, fall_length });
                }
            }
        }
        let stride = coarse_stride(self.evaluator.samples.len(), self.stride);
        self.best_of(&grid, stride).map(|(k, t)| (SearchStart(k), t))
    }

    /// Improves a start by ever smaller steps of one or two parameters, as long as there is time.
    pub(crate) fn refine(
        &mut self,
        start: &SearchStart,
        rounds: usize,
        progress: &Progress,
    ) -> Option<(SearchStart, Candidate)> {
        let stride = self.stride;
        let mut best = self.best_of(&[start.0], stride)?;
        let mut step = 0.2;
        for _ in 0..rounds {
            if progress.should_end() {
                break;
            }
            let at = best.0.get();
            let mut around = Vec::with_capacity(16);
            for i in 0..at.len() {
                for sign in [-1.0, 1.0] {
                    let mut next = at;
                    next[i] = (next[i] + sign * step).clamp(-0.2, 1.2);
                    around.push(ShapeParameters::of(next));
                }
            }
            // Steeper ground needs an earlier fall to keep the horizon, and the other way round.
            for sign in [-1.0, 1.0] {
                let mut next = at;
                next[0] += sign * step;
                next[4] -= sign * step;
                around.push(ShapeParameters::of(next));
            }
            match self.best_of(&around, stride) {
                Some(found) if found.1.score > best.1.score + 1e-6 => best = found,
                _ => step *= 0.5,
            }
        }
        Some((SearchStart(best.0), best.1))
    }
}

/// Where a search begins; opaque to its callers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SearchStart(ShapeParameters);

/// Samples that a first look needs at least.
const LEAST_SAMPLES: usize = 60;

/// Every how many-th sample a first look takes: half of those of `stride`, unless that leaves too few.
pub(crate) fn coarse_stride(samples: usize, stride: usize) -> usize {
    if samples / (2 * stride) >= LEAST_SAMPLES { 2 * stride } else { stride }
}

/// Every how many-th sample is judged.
pub(crate) fn stride_for(samples: usize, options: &RevealOptions) -> usize {
    (samples / options.samples_per_try.max(1)).max(1)
}
