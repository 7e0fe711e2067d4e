//! Styling sections on the image: which representation a sample shows.
//!
//! Every sample has a threshold. At each place of the deformation curve the representations own intervals of all thresholds, as long as
//! their weights, so exactly one of them is shown by a sample: no layers, one depth buffer. Pixels have different thresholds (an 8 x 8
//! ordered dither), its samples again others, and their mean tends to the weighted composite.

use belvedere_core::map::spline::SplineBend;
use belvedere_core::sections::StylingSections;
use belvedere_core::{Aabb, DVec3, Stage, View};
use belvedere_scene::{RenderJob, Scene};

/// Which layers are shown where.
#[derive(Debug, Clone)]
pub(crate) struct Sections<'a> {
    /// `None` = one representation everywhere.
    bend: Option<&'a SplineBend>,
    styling: StylingSections,
    /// For each layer the representations that show it, as bits.
    shown_by: Vec<u32>,
    /// The only representation that is drawn.
    only: Option<usize>,
}

/// How much of something is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shown {
    Nothing,
    /// Sample by sample.
    Partly,
    Everything,
}

impl<'a> Sections<'a> {
    /// `None` for scenes without representations.
    pub(crate) fn new(job: &RenderJob<'a>) -> Option<Self> {
        Self::of(job.scene, job.view, job.options.representation)
    }

    /// * `only`: see [`belvedere_scene::RenderOptions::representation`].
    pub(crate) fn of(scene: &Scene, view: &'a View, only: Option<usize>) -> Option<Self> {
        if scene.representations.is_empty() {
            return None;
        }
        let bend = view.stages().iter().find_map(|s| if let Stage::SplineBend(bend) = s { Some(bend) } else { None });
        let styling = bend.map_or_else(StylingSections::plain, |bend| bend.sections().clone());
        let shown_by = scene.shown_by(&styling.representations());
        let only = only.filter(|number| *number < styling.representations().len());
        Some(Self { bend, styling, shown_by, only })
    }

    /// How many representations the sections name.
    pub(crate) fn representations(&self) -> usize {
        self.styling.representations().len()
    }

    /// Weight of a representation at a place along the curve.
    pub(crate) fn weight(&self, number: usize, parameter: f64) -> f64 {
        self.styling.representation_weight(self.styling.representations()[number], parameter)
    }

    /// How much of a layer the image shows at most.
    pub(crate) fn of_layer(&self, layer: usize) -> Shown {
        self.of_range(layer, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// How much of a part of a layer is shown, by its bounds before any displacement.
    pub(crate) fn of_part(&self, layer: usize, bounds: &Aabb) -> Shown {
        let Some(bend) = self.bend else { return self.of_layer(layer) };
        let places = bounds.corners().map(|p| bend.section_parameter(p));
        let range = places.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], t| [lo.min(t), hi.max(t)]);
        // What bounds hold by rounding alone is tested.
        self.of_range(layer, [range[0] - 1e-9, range[1] + 1e-9])
    }

    fn of_range(&self, layer: usize, range: [f64; 2]) -> Shown {
        let supported = self.styling.supported(range);
        if let Some(number) = self.only {
            return match supported & self.shown_by[layer] & 1 << number {
                0 => Shown::Nothing,
                bit if bit == supported => Shown::Everything,
                _ => Shown::Partly,
            };
        }
        match supported & self.shown_by[layer] {
            0 => Shown::Nothing,
            bits if bits == supported => Shown::Everything,
            _ => Shown::Partly,
        }
    }

    /// Place along the curve, as a share of its length.
    pub(crate) fn parameter(&self, p: DVec3) -> f64 {
        self.bend.map_or(0.0, |bend| bend.section_parameter(p))
    }

    /// Whether a sample with a threshold shows the layer at a place along the curve.
    pub(crate) fn shows(&self, layer: usize, parameter: f64, threshold: f64) -> bool {
        let shown = match self.only {
            Some(number) if self.weight(number, parameter) > 0.0 => number,
            Some(_) => return false,
            None => self.styling.shown(parameter, threshold),
        };
        self.shown_by[layer] >> shown & 1 == 1
    }

    /// Share, 0..=1, of the representations that show `layer` among those that show `on`, at a place.
    pub(crate) fn share(&self, layer: usize, on: usize, p: DVec3) -> f64 {
        let (held, all) = (self.shown_by[layer] & self.shown_by[on], self.shown_by[on]);
        if held == all || held == 0 {
            return if held == 0 { 0.0 } else { 1.0 };
        }
        let t = self.parameter(p);
        let ids = self.styling.representations();
        let sum = |bits: u32| {
            let members = ids.iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1);
            members.map(|(_, id)| self.styling.representation_weight(id, t)).sum::<f64>()
        };
        let of = sum(all);
        if of > 0.0 { (sum(held) / of).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Whether a layer throws shadows on a place of another: on what is shown together with it.
    pub(crate) fn throws(&self, layer: usize, onto: usize, p: DVec3) -> bool {
        let (thrown, seen) = (self.shown_by[layer], self.shown_by[onto]);
        thrown & seen != 0 && (thrown & seen == seen || self.prevails(layer, p))
    }

    /// Whether a layer has at least half of the weight at a place: where lines and points of it are drawn.
    pub(crate) fn prevails(&self, layer: usize, p: DVec3) -> bool {
        self.shows(layer, self.parameter(p), 0.5)
    }
}

/// The thresholds of the samples of a pixel.
#[derive(Debug, Clone)]
pub(crate) struct Exposure {
    /// Added to the dither, for each sample, the centre first.
    phases: Vec<f64>,
    dithered: bool,
}

impl Exposure {
    /// Every sample apart from the centre, or the centre where there are no others, `count` times with other thresholds.
    /// * `samples`: of a pixel, the centre among them.
    pub(crate) fn new(count: usize, samples: usize) -> Self {
        let others = if count > 1 || samples > 1 { count.max(1) * (samples.max(2) - 1) } else { 0 };
        // In the middles of equal parts of 0..1, which are no wider than those of the dither.
        let part = |i: usize| i as f64 / others as f64 + 0.5 / others.max(64) as f64;
        let phases = std::iter::once(0.5 + 0.5 / 64.0).chain((0..others).map(part)).collect();
        Self { phases, dithered: true }
    }

    /// Places of all samples.
    /// * `offsets`: of those of one exposure.
    pub(crate) fn offsets(&self, offsets: &[[i32; 2]]) -> Vec<[i32; 2]> {
        let own = offsets.len();
        (0..self.phases.len())
            .map(|s| if s == 0 || own == 1 { offsets[0] } else { offsets[1 + (s - 1) % (own - 1)] })
            .collect()
    }

    /// The same threshold everywhere: what has the greater part of the weight.
    pub(crate) fn even() -> Self {
        Self { phases: vec![0.5], dithered: false }
    }

    /// Threshold of a sample, 0..1.
    #[inline]
    pub(crate) fn threshold(&self, sample: usize, x: i32, y: i32) -> f64 {
        if self.dithered { (dither(x, y) + self.phases[sample]).fract() } else { self.phases[0] }
    }
}

/// Ordered dither of 8 x 8 pixels: each 64th once.
#[inline]
fn dither(x: i32, y: i32) -> f64 {
    let (a, b) = ((x ^ y) as u32, y as u32);
    // Bits of both in turn, the lowest of the pixel's place weighing most.
    let bits = (0..3).fold(0, |sum, k| sum << 2 | (a >> k & 1) << 1 | b >> k & 1);
    f64::from(bits) / 64.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_of_a_pixel_and_of_a_tile_are_spread_evenly() {
        let mut tile: Vec<f64> = (0..64).map(|i| dither(i % 8, i / 8)).collect();
        tile.sort_by(f64::total_cmp);
        assert!(tile.iter().enumerate().all(|(i, d)| (d - i as f64 / 64.0).abs() < 1e-12));
        for (count, samples) in [(1, 1), (64, 1), (16, 5), (4, 17)] {
            let exposure = Exposure::new(count, samples);
            let all = exposure.offsets(&vec![[0, 0]; samples]).len();
            assert_eq!(all, if samples * count == 1 { 1 } else { 1 + count * (samples.max(2) - 1) });
            let coverage = if all == 1 { 0..1 } else { 1..all };
            let mut all: Vec<f64> = coverage.map(|s| exposure.threshold(s, 13, 7)).collect();
            all.sort_by(f64::total_cmp);
            let step = 1.0 / all.len() as f64;
            assert!(all.windows(2).all(|w| (w[1] - w[0] - step).abs() < 1e-9), "{count} {samples}: {all:?}");
            assert!(all[0] >= 0.0 && all[all.len() - 1] < 1.0);
        }
    }
}
