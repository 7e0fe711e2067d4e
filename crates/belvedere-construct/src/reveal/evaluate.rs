//! Evaluation of a candidate picture: the share of the features that it shows, and how well it fills the image.

use super::shape::BuiltBend;
use crate::measure::Shares;
use crate::measure::bend::{facing, nodes};
use crate::sample::{Sample, SampledFeature};
use belvedere_core::map::spline::{ReferencePlane, check_presets};
use belvedere_core::quantile::{Rank, quantile};
use belvedere_core::{DVec2, DVec3, Pinhole, View};
use belvedere_scene::{Heightfield, Scene};
use belvedere_sight::{Obstacles, SightOptions};
use serde::Serialize;

/// Figures of one candidate picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evaluation {
    /// Share of the features' amount inside the image, 0..=1.
    pub in_frame: f64,
    /// Share inside the image and at least 4 % of its width or height away from its border.
    pub in_margin: f64,
    /// Visible share of the whole features, 0..=`in_frame`.
    pub visible: f64,
    /// Visible share of what is inside the image, 0..=1; 0 if nothing is.
    pub visible_in_frame: f64,
    /// Angle under which flat ground would be seen if the features in the image filled four fifths of its height, from the nearest to
    /// the farthest, radians: the best that a bend can reach from this eye (a logarithmic spiral, ours).
    pub attainable: f64,
    /// Vertical extent of the middle nine tenths of the features in the image, share of the image height.
    pub spread: f64,
    /// Length in the image of everything inside it, in image widths.
    pub drawn: f64,
    /// Share of the image below the skyline that ground of the data covers, by a grid of rays.
    pub covered: f64,
    /// Mean position of the upper edge of the ground, share of the image height from the top; 1 = no ground in the image.
    pub skyline: f64,
    /// Row of the horizon of level ground, share of the image height from the top; < 0 above the picture. In a bent picture, whose ground goes on
    /// to a horizon of its own, the same as `skyline`.
    pub horizon: f64,
    /// Standard deviation of that edge over the columns of the image, share of its height: large where the data end aslant in the picture.
    pub slant: f64,
    /// Tilt of the line through that edge, degrees.
    pub tilt_deg: f64,
    /// Horizontal extent of the middle 98 % of the features in the image, share of the image width.
    pub width: f64,
    /// Mean size of a grid cell at the lower border of the image, pixels; 0 without ground there. Ground that is magnified much more than 8
    /// times looks smeared.
    pub coarse_px: f64,
    /// How much higher the farther half of the ground in the image lies than the nearer half, in units of the spread of all its heights,
    /// about -2..=2: > 0 if the ground faces the eye, < 0 if the eye looks over mountains down into what lies behind them. 0 on flat ground.
    pub rise: f64,
}

impl Evaluation {
    /// Shares of the whole features.
    pub fn shares(&self) -> Shares {
        Shares { visible: self.visible, in_frame: self.in_frame }
    }

    /// The same with the shares that the measure found, which has more samples.
    #[must_use]
    pub fn judged(self, Shares { visible, in_frame }: Shares) -> Self {
        let visible_in_frame = if in_frame > 0.0 { (visible / in_frame).min(1.0) } else { 0.0 };
        Self { visible, in_frame, visible_in_frame, ..self }
    }
}

/// Nodes of the whole ground, and again of that around the features, about.
const NODES: usize = 2_000;
/// How far ground around the features reaches, in extents of them and at least in cells.
const AROUND: (f64, f64) = (1.5, 60.0);

/// A scene prepared for evaluating many views.
pub(crate) struct Evaluator<'a> {
    pub(crate) obstacles: Obstacles<'a>,
    pub(crate) heightfield: &'a Heightfield,
    pub(crate) plane: ReferencePlane,
    pub(crate) samples: Vec<Sample>,
    pub(crate) ground: Vec<DVec3>,
    pub(crate) cell: f64,
}

impl<'a> Evaluator<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        heightfield: &'a Heightfield,
        features: &[SampledFeature],
        count: usize,
    ) -> Self {
        let samples = thin(features, count);
        let mut ground = nodes(heightfield, NODES);
        ground.extend(nodes_around(heightfield, &samples));
        Self {
            obstacles: Obstacles::new(scene),
            heightfield,
            plane: ReferencePlane::level(heightfield.median_height()),
            samples,
            ground,
            cell: heightfield.spacing().max_element(),
        }
    }

    /// Evaluates `view`; `stride` > 1 looks at every stride-th sample only.
    pub(crate) fn evaluate(&self, view: &View, stride: usize) -> Evaluation {
        self.evaluated(view, stride, true)
    }

    /// The same without lines of sight, which take most of the time: nothing counts as visible.
    pub(crate) fn composed(&self, view: &View, stride: usize) -> Evaluation {
        self.evaluated(view, stride, false)
    }

    fn evaluated(&self, view: &View, stride: usize, looks: bool) -> Evaluation {
        // Only whether a sample is seen counts, and a quarter of a cell is exact enough to choose by.
        let sight = SightOptions { chord_m: 0.05 * self.cell, cap_m: 0.0, guard_m: 1.5 * self.cell };
        let pinhole = view.pinhole();
        let (mut all, mut framed, mut inner, mut seen, mut drawn) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let centre = pinhole.center_px();
        let [mut rows, mut columns, mut distances]: [Vec<f64>; 3] = Default::default();
        for sample in self.samples.iter().step_by(stride.max(1)) {
            all += sample.amount;
            let Ok(image) = view.project(sample.p_world) else { continue };
            if image.depth < pinhole.near || !pinhole.contains(image.pixel) {
                continue;
            }
            framed += sample.amount;
            if ((image.pixel - centre) / centre).abs().max_element() < 0.92 {
                inner += sample.amount;
            }
            rows.push(image.pixel.y);
            columns.push(image.pixel.x);
            distances.push((sample.p_world - pinhole.eye).length());
            drawn += sample.amount / image.depth;
            let at = (image.pixel, image.depth);
            if looks
                && !image.folded
                && self.obstacles.clearance(view, (sample.p_world, sample.lift), at, &sight) >= 0.0
            {
                seen += sample.amount;
            }
        }
        let height_angle = 2.0 * (0.5 * f64::from(pinhole.image[1]) / pinhole.scale_px()).atan();
        let depth_ratio =
            quantile(&mut distances, 0.97, Rank::Nearest) / quantile(&mut distances, 0.03, Rank::Nearest).max(1e-9);
        let (skyline, [slant, tilt_deg], rise) = self.skyline(view);
        let (covered, coarse_px) = self.covered(view, skyline);
        let [width, height] = pinhole.image.map(f64::from);
        Evaluation {
            in_frame: if all > 0.0 { framed / all } else { 0.0 },
            in_margin: if all > 0.0 { inner / all } else { 0.0 },
            visible: if all > 0.0 { seen / all } else { 0.0 },
            visible_in_frame: if framed > 0.0 { seen / framed } else { 0.0 },
            attainable: (0.8 * height_angle).atan2(depth_ratio.ln().max(0.0)),
            spread: (quantile(&mut rows, 0.95, Rank::Nearest) - quantile(&mut rows, 0.05, Rank::Nearest)) / height,
            drawn: drawn * stride.max(1) as f64 * pinhole.scale_px() / width,
            covered,
            skyline,
            horizon: if view.is_bent() { skyline } else { horizon(pinhole) },
            slant,
            tilt_deg,
            width: (quantile(&mut columns, 0.99, Rank::Nearest) - quantile(&mut columns, 0.01, Rank::Nearest)) / width,
            coarse_px,
            rise,
        }
    }

    /// Mean over the columns of the image of the highest terrain node in each, share of the image height from the top; its standard deviation
    /// and its tilt, degrees; and the rise of the ground.
    fn skyline(&self, view: &View) -> (f64, [f64; 2], f64) {
        const COLUMNS: usize = 12;
        let [width, height] = view.pinhole().image.map(f64::from);
        let mut top = [height; COLUMNS];
        let mut framed: Vec<(f64, f64)> = Vec::new();
        for &p in &self.ground {
            let Ok(image) = view.project(p) else { continue };
            let column = image.pixel.x / width * COLUMNS as f64;
            if (0.0..COLUMNS as f64).contains(&column) {
                let highest = &mut top[column as usize];
                *highest = highest.min(image.pixel.y.max(0.0));
                if view.pinhole().contains(image.pixel) {
                    framed.push(((p - view.pinhole().eye).dot(view.pinhole().forward), p.z));
                }
            }
        }
        let mean = |of: &dyn Fn(f64) -> f64| top.iter().map(|t| of(t / height)).sum::<f64>() / COLUMNS as f64;
        let middle = mean(&|t| t);
        let slant = mean(&|t| (t - middle) * (t - middle)).sqrt();
        let across = |i: usize| i as f64 - 0.5 * (COLUMNS - 1) as f64;
        let (along, square) = top.iter().enumerate().fold((0.0, 0.0), |(along, square), (i, t)| {
            (along + across(i) * (t / height - middle), square + across(i) * across(i))
        });
        let per_column = along / square;
        let tilt = (per_column * height * COLUMNS as f64 / width).atan().to_degrees();
        (middle, [slant, tilt.abs()], rise(&framed))
    }

    /// Share of a grid of rays below the skyline that come down on the ground of the data from above, and the size of its cells in the lowest
    /// row, pixels.
    fn covered(&self, view: &View, skyline: f64) -> (f64, f64) {
        let [width, height] = view.pinhole().image.map(f64::from);
        let top = skyline.clamp(0.0, 0.9);
        let (mut hit, mut all) = (0.0, 0.0);
        let (mut lowest, mut cells_px) = (0.0f64, 0.0);
        // The lower the row, the nearer and the more conspicuous a missing corner of the ground.
        for (part, weight) in [(0.05, 0.3), (0.15, 0.5), (0.3, 1.0), (0.6, 2.0), (0.985, 3.0)] {
            for column in [0.005, 0.12, 0.24, 0.38, 0.5, 0.62, 0.76, 0.88, 0.995] {
                let pixel = DVec2::new(column * width, (top + (1.0 - top) * part) * height);
                all += weight;
                let Some(distance) = self.meets_data(view, pixel) else { continue };
                hit += weight;
                if part > 0.9 {
                    lowest += 1.0;
                    cells_px += view.pinhole().scale_px() * self.cell / distance.max(self.cell);
                }
            }
        }
        (hit / all, if lowest > 0.0 { cells_px / lowest } else { 0.0 })
    }

    /// Distance from the eye at which the ray comes down on the terrain; `None` if it does not: one that passes its rim below the ground shows
    /// the void under it.
    fn meets_data(&self, view: &View, pixel: DVec2) -> Option<f64> {
        let ray = view.ray(pixel);
        let bounds = self.heightfield.bounds();
        let reach = 4.0 * (bounds.max - bounds.min).length() + (view.pinhole().eye - bounds.center()).length();
        let (mut over_data, mut depth) = (false, 1e-3 * reach);
        while depth < reach {
            if let Ok(at) = ray.at(depth) {
                match self.heightfield.surface_at(at.point.truncate()) {
                    Some(ground) if at.point.z < ground => {
                        return over_data.then(|| at.point.distance(view.pinhole().eye));
                    }
                    ground => over_data = ground.is_some(),
                }
            }
            depth *= 1.08;
        }
        None
    }

    /// Mean distance of the features from the eye along the direction of view, and the width of a grid cell there, pixels; `None` unless
    /// they lie before the eye.
    pub(crate) fn cells_among_features(&self, view: &View) -> Option<(f64, f64)> {
        let pinhole = view.pinhole();
        let sum: f64 = self.samples.iter().map(|s| (s.p_world - pinhole.eye).dot(pinhole.forward)).sum();
        let distance = sum / self.samples.len().max(1) as f64;
        (distance > 0.0).then(|| (distance, pinhole.scale_px() * self.cell / distance))
    }

    /// Whether whoever opens a scene with the bend is warned that it folds the ground or turns it away.
    pub(crate) fn is_warned_of(&self, built: &BuiltBend) -> bool {
        let Some(bend) = built.view.spline_bend() else { return false };
        let heights = self.heightfield.z_range().map(|z| z - self.plane.height());
        !check_presets(&built.document, bend.resolved().distance, Some(heights)).is_empty()
    }

    /// Smallest factor by which the bend squeezes lengths over the terrain inside the image (0 = fold), and the
    /// smallest sine of the angle at which the ground plane is seen there.
    pub(crate) fn fold_and_facing(&self, view: &View) -> (f64, f64) {
        let Some(bend) = view.spline_bend() else { return (1.0, 1.0) };
        let pinhole = view.pinhole();
        let (mut squeeze, mut faced) = (f64::INFINITY, bend.facing());
        for &p in &self.ground {
            let Ok(image) = view.project(p) else { continue };
            // A margin around the image: what folds just outside it reaches in with its neighbours.
            let [w, h] = pinhole.image.map(f64::from);
            if image.pixel.x < -0.1 * w
                || image.pixel.x > 1.1 * w
                || image.pixel.y < -0.1 * h
                || image.pixel.y > 1.2 * h
            {
                continue;
            }
            squeeze = squeeze.min(bend.stretch(p));
            faced = faced.min(facing(view, DVec3::new(p.x, p.y, self.plane.height())));
        }
        (if squeeze.is_finite() { squeeze } else { 1.0 }, faced)
    }
}

/// Row of the horizon, share of the image height from the top.
fn horizon(pinhole: &Pinhole) -> f64 {
    let rise = -pinhole.forward.z / pinhole.forward.truncate().length().max(1e-9);
    0.5 - rise * pinhole.scale_px() / f64::from(pinhole.image[1])
}

/// Difference of the mean heights of the nodes (distance, height) beyond and before the mean distance, in units of the standard deviation of
/// the heights; less on ground whose relief is less than a hundredth of its depth.
fn rise(nodes: &[(f64, f64)]) -> f64 {
    let mean = |of: &dyn Fn(&(f64, f64)) -> Option<f64>| {
        let (sum, count) = nodes.iter().filter_map(of).fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    };
    let (at, height) = (mean(&|n| Some(n.0)), mean(&|n| Some(n.1)));
    let depth = 4.0 * mean(&|n| Some((n.0 - at).abs()));
    let spread = mean(&|n| Some((n.1 - height).powi(2))).sqrt();
    if !nodes.iter().any(|n| n.0 > at) {
        return 0.0;
    }
    let [near, far] = [false, true].map(|beyond| mean(&|n| ((n.0 > at) == beyond).then_some(n.1)));
    (far - near) / spread.max(0.01 * depth).max(1e-9)
}

/// Nodes of the ground around the features, which a near eye sees between the few of a large ground.
fn nodes_around(hf: &Heightfield, samples: &[Sample]) -> Vec<DVec3> {
    let places = samples.iter().map(|s| s.p_world.truncate());
    let (low, high) = places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let (extents, cells) = AROUND;
    let reach = (extents * (high - low).max_element()).max(cells * hf.spacing().max_element());
    let column = |x: f64| ((x - hf.north_west().x) / hf.spacing().x).clamp(0.0, (hf.cols() - 1) as f64) as usize;
    let row = |y: f64| ((hf.north_west().y - y) / hf.spacing().y).clamp(0.0, (hf.rows() - 1) as f64) as usize;
    let (columns, rows) = (column(low.x - reach)..=column(high.x + reach), row(high.y + reach)..=row(low.y - reach));
    let stride = ((columns.clone().count() * rows.clone().count()) as f64 / NODES as f64).sqrt().ceil().max(1.0);
    let columns = columns.step_by(stride as usize);
    rows.step_by(stride as usize).flat_map(|r| columns.clone().filter_map(move |c| hf.node(c, r))).collect()
}

/// About `count` samples that stand for all: runs of neighbours are merged into their middle one.
fn thin(features: &[SampledFeature], count: usize) -> Vec<Sample> {
    let total: f64 = features.iter().flat_map(|f| &f.samples).map(|s| s.amount).sum();
    let share = total / count as f64;
    let mut out = Vec::with_capacity(count + features.len());
    for f in features {
        let mut run: Vec<Sample> = Vec::new();
        let mut amount = 0.0;
        let mut close = |run: &mut Vec<Sample>, amount: &mut f64| {
            if let Some(middle) = run.get(run.len() / 2) {
                out.push(Sample { amount: *amount, ..*middle });
            }
            run.clear();
            *amount = 0.0;
        };
        for &s in &f.samples {
            run.push(s);
            amount += s.amount;
            if amount >= share {
                close(&mut run, &mut amount);
            }
        }
        close(&mut run, &mut amount);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_that_faces_the_eye_rises() {
        let slope = |of: fn(f64) -> f64| rise(&(0..100).map(|k| (f64::from(k), of(f64::from(k)))).collect::<Vec<_>>());
        assert!(slope(|d| 0.5 * d) > 1.0 && slope(|d| -0.5 * d) < -1.0);
        assert!(slope(|d| if d < 50.0 { 500.0 } else { 0.0 }) < -1.9, "mountains before a plain");
        assert_eq!((slope(|_| 7.0), rise(&[]), rise(&[(5.0, 3.0)])), (0.0, 0.0, 0.0));
        assert!(slope(|d| 0.0005 * d) < 0.1, "hardly any relief");
    }
}
