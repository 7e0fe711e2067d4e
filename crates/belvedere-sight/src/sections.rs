//! Styling sections on the image: which representation a sample shows.
//!
//! Every sample has a threshold. At each position along the deformation curve the representations own disjoint intervals of thresholds, as
//! long as their weights, so a sample shows exactly one of them: no layers, one depth buffer. Thresholds differ between pixels (an 8 x 8
//! ordered dither) and between the samples of a pixel, and the mean of the samples tends to the weighted composite.
//!
//! Layers that are one surface in different colours need no thresholds: the surface is drawn once, and its colours are mixed by weight.

use belvedere_core::map::spline::SplineBend;
use belvedere_core::map::straighten::{Dimension, Plan};
use belvedere_core::sections::{MOST_REPRESENTATIONS, StylingSections};
use belvedere_core::{Aabb, DVec3, SpaceMap, Strip, View};
use belvedere_scene::{Compositing, RenderJob, Scene};

/// Visibility of the layers along the deformation curve.
#[derive(Debug, Clone)]
pub struct Sections<'a> {
    /// `None`: one representation everywhere.
    bend: Option<&'a SplineBend>,
    strip: Option<&'a Strip>,
    styling: StylingSections,
    table: Table,
    /// For each layer the representations that show it, as bits.
    shown_by: Vec<u32>,
    /// For each layer the representations that draw its surface, as bits: none where an earlier layer is the same surface and is drawn for both.
    drawn_by: Vec<u32>,
    /// For the first of several layers that are one surface: all of these layers; for other layers empty.
    one_surface: Vec<Vec<usize>>,
    /// Number of the only representation that is drawn, if just one is.
    only: Option<usize>,
}

/// Visible share of a layer or a part of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// No part.
    Nothing,
    /// Decided sample by sample.
    Partly,
    /// The whole.
    Everything,
}

impl<'a> Sections<'a> {
    /// `None` for scenes without representations.
    pub fn new(job: &RenderJob<'a>) -> Option<Self> {
        let options = job.options;
        Self::of(job.scene, job.view, options.representation, options.compositing == Compositing::Single)
    }

    /// * `only`: see [`belvedere_scene::RenderOptions::representation`]; `single`: whether layers of one surface are drawn once.
    pub fn of(scene: &Scene, view: &'a View, only: Option<usize>, single: bool) -> Option<Self> {
        if scene.representations.is_empty() {
            return None;
        }
        let (bend, strip) = (view.spline_bend(), view.strip());
        let styling = bend.map_or_else(StylingSections::plain, |bend| bend.sections().clone());
        let shown_by = scene.shown_by(&styling.representations());
        let only = only.filter(|number| *number < styling.representations().len());
        let table = Table::new(&styling);
        let one_surface = match single && only.is_none() {
            true => one_surface(scene, &shown_by),
            false => vec![Vec::new(); shown_by.len()],
        };
        let mut drawn_by = shown_by.clone();
        for layers in one_surface.iter().filter(|layers| !layers.is_empty()) {
            layers[1..].iter().for_each(|layer| drawn_by[layers[0]] |= std::mem::take(&mut drawn_by[*layer]));
        }
        Some(Self { bend, strip, styling, table, shown_by, drawn_by, one_surface, only })
    }

    /// Whether any layer is drawn together with others of the same surface.
    pub fn has_one_surface(&self) -> bool {
        self.one_surface.iter().any(|layers| !layers.is_empty())
    }

    /// Layers whose colours are mixed on the surface of a layer, starting with itself; empty where only its own colour is shown.
    pub fn mixed_on(&self, layer: usize) -> &[usize] {
        &self.one_surface[layer]
    }

    /// Shares, 0..=1, of the colours of [`Self::mixed_on`] at a point; they sum to 1.
    pub fn mixture(&self, layer: usize, p: DVec3) -> impl Iterator<Item = f64> {
        let intervals = self.table.intervals(&self.styling, self.parameter(p));
        let of = move |bits: u32| intervals.length_of(bits);
        let all = of(self.drawn_by[layer]);
        self.mixed_on(layer).iter().enumerate().map(move |(k, other)| match all > 0.0 {
            true => of(self.shown_by[*other]) / all,
            false => f64::from(u8::from(k == 0)),
        })
    }

    /// Number of representations that the sections name.
    pub fn representations(&self) -> usize {
        self.styling.representations().len()
    }

    /// Weight of a representation at a position along the curve.
    pub fn weight(&self, number: usize, parameter: f64) -> f64 {
        self.table.intervals(&self.styling, parameter).length(number)
    }

    /// Visible share of a layer at most, anywhere along the curve.
    pub fn of_layer(&self, layer: usize) -> Shown {
        self.of_range(layer, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// Visible share of a part of a layer, by its undisplaced bounds.
    pub fn of_part(&self, layer: usize, bounds: &Aabb) -> Shown {
        let Some(bend) = self.bend else { return self.of_layer(layer) };
        let unrolled = match self.strip {
            Some(strip) => strip.displaced_bounds(bounds),
            None => Some(*bounds),
        };
        let Some(unrolled) = unrolled else { return self.of_layer(layer) };
        let places = unrolled.corners().map(|p| bend.section_parameter(p));
        let range = places.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], t| [lo.min(t), hi.max(t)]);
        // Widened for rounding: parts at the border are tested sample by sample.
        self.of_range(layer, [range[0] - 1e-9, range[1] + 1e-9])
    }

    /// Visible share of a part of a layer, by the positions along the curve of its corners, between which the position is linear.
    pub fn of_corners(&self, layer: usize, positions: [f64; 3]) -> Shown {
        let [from, to] = [
            positions.iter().fold(f64::INFINITY, |a, b| a.min(*b)),
            positions.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)),
        ];
        // Widened for the rounding of positions in single precision.
        let slack = |t: f64| 1e-3 * (1.0 + t.abs());
        self.of_range(layer, [from - slack(from), to + slack(to)])
    }

    fn of_range(&self, layer: usize, range: [f64; 2]) -> Shown {
        let supported = self.styling.supported(range);
        if let Some(number) = self.only {
            return match supported & self.drawn_by[layer] & 1 << number {
                0 => Shown::Nothing,
                bit if bit == supported => Shown::Everything,
                _ => Shown::Partly,
            };
        }
        match supported & self.drawn_by[layer] {
            0 => Shown::Nothing,
            bits if bits == supported => Shown::Everything,
            _ => Shown::Partly,
        }
    }

    /// Position along the curve as a share of its length.
    #[inline]
    pub fn parameter(&self, p: DVec3) -> f64 {
        self.bend.map_or(0.0, |bend| bend.section_parameter(self.strip.map_or(p, |strip| unrolled(strip, p))))
    }

    /// Whether a sample with a threshold shows the layer at a position along the curve.
    #[inline]
    pub fn shows(&self, layer: usize, parameter: f64, threshold: f64) -> bool {
        self.is_drawn_by(layer, self.intervals(parameter).holding(threshold))
    }

    /// Whether a representation draws the surface of a layer; a number out of range draws none.
    #[inline]
    pub fn is_drawn_by(&self, layer: usize, number: usize) -> bool {
        self.drawn_by[layer].checked_shr(number as u32).is_some_and(|bits| bits & 1 == 1)
    }

    /// Intervals of thresholds at a position along the curve.
    #[inline]
    pub fn intervals(&self, parameter: f64) -> Intervals<'_> {
        match self.only {
            None => self.table.intervals(&self.styling, parameter),
            Some(number) if self.weight(number, parameter) > 0.0 => Intervals::OfOne(number),
            Some(_) => Intervals::OfOne(MOST_REPRESENTATIONS),
        }
    }

    /// Weight of the representations that show both `layer` and `on`, as a share, 0..=1, of those that show `on`, at a point.
    pub fn share(&self, layer: usize, on: usize, p: DVec3) -> f64 {
        let (held, all) = (self.shown_by[layer] & self.shown_by[on], self.shown_by[on]);
        if held == all || held == 0 {
            return if held == 0 { 0.0 } else { 1.0 };
        }
        let intervals = self.table.intervals(&self.styling, self.parameter(p));
        let of = intervals.length_of(all);
        if of > 0.0 { (intervals.length_of(held) / of).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Whether a layer casts shadows on another at a point: it does if both are shown together there.
    pub fn throws(&self, layer: usize, onto: usize, p: DVec3) -> bool {
        let (thrown, seen) = (self.shown_by[layer], self.shown_by[onto]);
        thrown & seen != 0 && (thrown & seen == seen || self.prevails(layer, p))
    }

    /// Whether a layer casts shadows on any that is drawn: on those of the only representation, if just one is drawn.
    pub fn casts(&self, layer: usize) -> bool {
        let Some(number) = self.only else { return true };
        self.shown_by.iter().any(|seen| seen >> number & 1 == 1 && seen & self.shown_by[layer] != 0)
    }

    /// Whether a layer is shown at threshold 0.5 at a point, where its lines and points are then drawn.
    pub fn prevails(&self, layer: usize, p: DVec3) -> bool {
        self.shows(layer, self.parameter(p), 0.5)
    }
}

/// For the first of several layers that are one surface, each in representations of its own: all of these layers; for others empty.
fn one_surface(scene: &Scene, shown_by: &[u32]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new(); shown_by.len()];
    for i in 0..shown_by.len() {
        let is_same = |first: &usize| scene.layers[*first].kind.is_surface_of(&scene.layers[i].kind);
        let Some(first) = (0..i).find(is_same) else { continue };
        let together = all[first].iter().fold(shown_by[first], |bits, other| bits | shown_by[*other]);
        if together & shown_by[i] == 0 && shown_by[i] != 0 {
            if all[first].is_empty() {
                all[first].push(first);
            }
            all[first].push(i);
        }
    }
    all
}

/// Position to which a strip carries a point. A point beside the strip is carried with the nearest point of the route, so that corners of
/// triangles across the border have a position along the curve.
fn unrolled(strip: &Strip, p: DVec3) -> DVec3 {
    strip.apply(p).unwrap_or_else(|_| {
        let g = strip.line().nearest(p.truncate());
        let (from, to) = (strip.line().at(g), strip.unrolled().at(g));
        let (along, across) = Plan::parts(from.turn, p.truncate() - from.p);
        (to.p + Plan::vector(to.turn, along, across)).extend(p.z)
    })
}

/// Intervals of thresholds of the representations at one position along the curve.
#[derive(Debug)]
pub enum Intervals<'t> {
    /// A single representation, by its number, holds all thresholds.
    OfOne(usize),
    /// Ends at two positions, and the share of the way from the first to the second.
    Between([&'t [f64]; 2], f64),
    /// Ends at this position.
    Here(Box<[f64]>),
}

impl Intervals<'_> {
    #[inline]
    fn count(&self) -> usize {
        match self {
            Self::OfOne(_) => 1,
            Self::Between([here, _], _) => here.len(),
            Self::Here(ends) => ends.len(),
        }
    }

    #[inline]
    fn end(&self, number: usize) -> f64 {
        match self {
            Self::OfOne(_) => 1.0,
            Self::Between([here, next], share) => here[number] + share * (next[number] - here[number]),
            Self::Here(ends) => ends[number],
        }
    }

    /// Number of the representation that holds a threshold.
    #[inline]
    pub fn holding(&self, threshold: f64) -> usize {
        match self {
            Self::OfOne(number) => *number,
            _ => (0..self.count() - 1).take_while(|number| threshold >= self.end(*number)).count(),
        }
    }

    /// Length of the interval of a representation: its weight.
    #[inline]
    fn length(&self, number: usize) -> f64 {
        let from = if number == 0 { 0.0 } else { self.end(number - 1) };
        (self.end(number) - from).max(0.0)
    }

    /// Total length of the intervals of several representations, given as bits.
    fn length_of(&self, numbers: u32) -> f64 {
        (0..self.count()).filter(|number| numbers >> number & 1 == 1).map(|number| self.length(number)).sum()
    }
}

/// Ends of the intervals of all representations at many positions along the curve, linear between them except at knees.
#[derive(Debug, Clone)]
struct Table {
    from: f64,
    per_step: f64,
    representations: usize,
    /// Ends of the intervals, position after position.
    ends: Vec<f64>,
    /// Whether a knee lies between a position and the next.
    has_knee: Vec<bool>,
}

impl Table {
    const TABLE_STEPS: usize = 1024;

    fn new(styling: &StylingSections) -> Self {
        let knees = styling.knees();
        let (from, to) = (knees.first().copied().unwrap_or(0.0), knees.last().copied().unwrap_or(0.0));
        // Slack, so that rounding does not put a knee into the wrong step.
        let slack = 1e-9 + 1e-3 * (to - from);
        let (from, to) = (from - slack, to + slack);
        let per_step = (to - from) / Self::TABLE_STEPS as f64;
        let representations = styling.representations().len();
        let place = |i: usize| from + per_step * i as f64;
        let ends =
            (0..=Self::TABLE_STEPS).flat_map(|i| styling.interval_ends(place(i)).into_iter().take(representations));
        let near = |i: usize| {
            let (a, b) = (place(i) - 1e-6 * per_step, place(i + 1) + 1e-6 * per_step);
            knees.iter().any(|knee| a <= *knee && *knee <= b)
        };
        Self {
            from,
            per_step,
            representations,
            ends: ends.collect(),
            has_knee: (0..Self::TABLE_STEPS).map(near).collect(),
        }
    }

    #[inline]
    fn intervals(&self, styling: &StylingSections, parameter: f64) -> Intervals<'_> {
        let at = ((parameter - self.from) / self.per_step).clamp(0.0, Self::TABLE_STEPS as f64 - 1e-9);
        // NaN becomes 0.
        let (step, n) = (at as usize, self.representations);
        if self.has_knee[step] {
            return Intervals::Here(styling.interval_ends(parameter)[..n].into());
        }
        Intervals::Between([&self.ends[step * n..][..n], &self.ends[(step + 1) * n..][..n]], at - step as f64)
    }
}

/// Thresholds of the samples of a pixel.
#[derive(Debug, Clone)]
pub struct Exposure {
    /// Offset added to the dither for each sample, the centre first.
    phases: Vec<f64>,
    /// Number of distinct sample positions apart from the centre.
    places: usize,
    dithered: bool,
}

impl Exposure {
    /// Repeats every sample apart from the centre (or the centre, if there are no others) `count` times with other thresholds.
    /// * `samples`: number of samples of a pixel, the centre included.
    pub fn new(count: usize, samples: usize) -> Self {
        let others = if count > 1 || samples > 1 { count.max(1) * (samples.max(2) - 1) } else { 0 };
        // Middles of equal parts of 0..1, which are no wider than the steps of the dither.
        let part = |i: usize| i as f64 / others as f64 + 0.5 / others.max(64) as f64;
        let phases = std::iter::once(0.5 + 0.5 / 64.0).chain((0..others).map(part)).collect();
        Self { phases, places: samples.max(2) - 1, dithered: true }
    }

    /// Number of distinct sample positions apart from the centre.
    pub fn places(&self) -> usize {
        self.places
    }

    /// Offsets of all samples of all exposures.
    /// * `offsets`: offsets of the samples of one exposure.
    pub fn offsets(&self, offsets: &[[i32; 2]]) -> Vec<[i32; 2]> {
        let own = offsets.len();
        (0..self.phases.len())
            .map(|s| if s == 0 || own == 1 { offsets[0] } else { offsets[1 + (s - 1) % (own - 1)] })
            .collect()
    }

    /// The threshold 0.5 everywhere: the representation with the greater weight is shown.
    pub fn even() -> Self {
        Self { phases: vec![0.5], places: 1, dithered: false }
    }

    /// Threshold of a sample, 0..1.
    #[inline]
    pub fn threshold(&self, sample: usize, x: i32, y: i32) -> f64 {
        if self.dithered { (dither(x, y) + self.phases[sample]).fract() } else { self.phases[0] }
    }
}

/// Ordered dither of 8 x 8 pixels: each multiple of 1/64 once.
#[inline]
fn dither(x: i32, y: i32) -> f64 {
    let (a, b) = ((x ^ y) as u32, y as u32);
    // Interleaves the bits of both coordinates; the lowest bits weigh most.
    let bits = (0..3).fold(0, |sum, k| sum << 2 | (a >> k & 1) << 1 | b >> k & 1);
    f64::from(bits) / 64.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::sections::TagPoint;

    #[test]
    fn the_table_shows_what_the_sections_show() {
        let tags = [(0.2, 0.05), (0.3, 0.2), (0.7, 0.0)].map(|(u, delta)| TagPoint { u, delta });
        let ids = |ids: [&str; 4]| ids.map(str::to_owned).to_vec();
        let styling = StylingSections::new(tags.to_vec(), ids(["a", "b", "a", "c"]), ids(["b", "b", "d", "c"]), 0.4);
        let styling = styling.expect("well formed");
        let table = Table::new(&styling);
        let mut differ = 0;
        for i in 0..200_000 {
            let t = -0.2 + 1.4 * (f64::from(i) * 0.618_033_988_75).fract();
            let threshold = (f64::from(i) * 0.754_877_666).fract();
            differ += u32::from(table.intervals(&styling, t).holding(threshold) != styling.shown(t, threshold));
        }
        assert!(differ <= 2, "{differ}: rounding at the ends of intervals alone");
    }

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
