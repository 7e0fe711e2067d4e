//! Measures of the bends over the whole picture: displacement of the ground, anisotropy and folds.

use super::image::SampleImage;
use crate::sample::SampledFeature;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Heightfield, Scene};
use belvedere_sight::Obstacles;
use serde::Serialize;

/// Distortion of the bent picture, over the ground nodes that lie in it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BendMeasure {
    /// Terrain nodes that are tested (a regular subset, at most some ten thousand) and lie in the bent picture.
    pub nodes_in_frame: usize,
    /// Share of them at which the picture folds over (orientation reversed), 0..=1.
    pub folded_share: f64,
    /// Smallest sine of the angle at which the reference plane (median height) is seen inside the picture; > 0 = it
    /// turns its upper side to the eye everywhere. `None` if no node lies in the picture.
    pub facing_min: Option<f64>,
    /// The same for the straight picture.
    pub facing_min_straight: Option<f64>,
    /// Largest displacement of a node by the bends, scene units.
    pub displacement_max: f64,
    /// Root mean square of these displacements, scene units.
    pub displacement_rms: f64,
    /// Largest distance between the straight and the bent image of a node that is in both, pixels.
    pub displacement_max_px: f64,
    /// Mean ratio of the largest to the smallest scale at which horizontal and vertical extents at a node appear
    /// (singular values of the image's derivative, curved-rays section 8); 1 = undistorted.
    pub anisotropy_mean: f64,
    /// 95 % of the nodes lie below this ratio.
    pub anisotropy_p95: f64,
    /// The mean ratio in the straight picture.
    pub anisotropy_mean_straight: f64,
}

/// Displacement of samples by the bends: scene units, and pixels.
pub(super) struct Displacement {
    pub(super) max: f64,
    pub(super) rms: f64,
    pub(super) max_px: f64,
}

/// Displacement of the samples in either picture.
pub(super) fn displacement(straight: &[(f64, SampleImage)], bent: &[(f64, SampleImage)]) -> Displacement {
    let mut out = Displacement { max: 0.0, rms: 0.0, max_px: 0.0 };
    let mut weight = 0.0;
    for ((amount, s), (_, b)) in straight.iter().zip(bent).filter(|((_, s), (_, b))| s.in_frame || b.in_frame) {
        let (Some(from), Some(to)) = (s.displaced, b.displaced) else { continue };
        let distance = from.distance(to);
        out.max = out.max.max(distance);
        out.rms += amount * distance * distance;
        weight += amount;
        if s.in_frame && b.in_frame {
            out.max_px = out.max_px.max((s.pixel - b.pixel).length());
        }
    }
    out.rms = if weight > 0.0 { (out.rms / weight).sqrt() } else { 0.0 };
    out
}

/// A sparse, regular set of terrain nodes; without terrain the samples themselves.
fn ground_points(scene: &Scene, features: &[SampledFeature]) -> Vec<DVec3> {
    let Some(hf) = scene.terrain() else {
        return features.iter().flat_map(|f| f.samples.iter().map(|s| s.p_world)).collect();
    };
    nodes(hf, 20_000)
}

/// About `count` nodes of the terrain, evenly spread, without holes.
pub(crate) fn nodes(hf: &Heightfield, count: usize) -> Vec<DVec3> {
    let stride = ((hf.cols() * hf.rows()) as f64 / count as f64).sqrt().ceil().max(1.0) as usize;
    let rows = (0..hf.rows()).step_by(stride);
    rows.flat_map(|r| (0..hf.cols()).step_by(stride).filter_map(move |c| hf.node(c, r))).collect()
}

pub(super) fn measure_bend(
    obstacles: &Obstacles<'_>,
    scene: &Scene,
    view: &View,
    straight: &View,
    features: &[SampledFeature],
) -> BendMeasure {
    let plane = obstacles.grounds().first().map(|(_, g)| g.heightfield().median_height());
    let mut out = Sums::default();
    for p in ground_points(scene, features) {
        let image = straight.project(p).ok().filter(|i| in_frame(straight, i.pixel, i.depth));
        let flat = plane.map_or(p, |z| DVec3::new(p.x, p.y, z));
        if image.is_some() {
            out.facing_straight = out.facing_straight.min(facing(straight, flat));
        }
        let Some(bent) = view.project(p).ok().filter(|i| in_frame(view, i.pixel, i.depth)) else { continue };
        out.count += 1;
        out.folded += usize::from(bent.folded);
        out.facing = out.facing.min(facing(view, flat));
        out.anisotropy.extend(anisotropy(view, p));
        out.anisotropy_straight.extend(anisotropy(straight, p));
        if let (Ok(a), Ok(b)) = (straight.displace(p), view.displace(p)) {
            let squared = a.point.distance_squared(b.point);
            out.squares += squared;
            out.largest = out.largest.max(squared.sqrt());
        }
        if let Some(i) = image {
            out.largest_px = out.largest_px.max(i.pixel.distance(bent.pixel));
        }
    }
    out.finish()
}

struct Sums {
    count: usize,
    folded: usize,
    facing: f64,
    facing_straight: f64,
    squares: f64,
    largest: f64,
    largest_px: f64,
    anisotropy: Vec<f64>,
    anisotropy_straight: Vec<f64>,
}

impl Default for Sums {
    fn default() -> Self {
        Self {
            count: 0,
            folded: 0,
            facing: f64::INFINITY,
            facing_straight: f64::INFINITY,
            squares: 0.0,
            largest: 0.0,
            largest_px: 0.0,
            anisotropy: Vec::new(),
            anisotropy_straight: Vec::new(),
        }
    }
}

impl Sums {
    fn finish(mut self) -> BendMeasure {
        let n = self.count.max(1) as f64;
        let mean = |v: &[f64]| if v.is_empty() { 1.0 } else { v.iter().sum::<f64>() / v.len() as f64 };
        self.anisotropy.sort_by(f64::total_cmp);
        let p95 = self.anisotropy.get(self.anisotropy.len() * 19 / 20).copied().unwrap_or(1.0);
        BendMeasure {
            nodes_in_frame: self.count,
            folded_share: self.folded as f64 / n,
            facing_min: self.facing.is_finite().then_some(self.facing),
            facing_min_straight: self.facing_straight.is_finite().then_some(self.facing_straight),
            displacement_max: self.largest,
            displacement_rms: (self.squares / n).sqrt(),
            displacement_max_px: self.largest_px,
            anisotropy_mean: mean(&self.anisotropy),
            anisotropy_p95: p95,
            anisotropy_mean_straight: mean(&self.anisotropy_straight),
        }
    }
}

fn in_frame(view: &View, pixel: DVec2, depth: f64) -> bool {
    let pinhole = view.pinhole();
    depth >= pinhole.near && pinhole.far.is_none_or(|far| depth <= far) && pinhole.contains(pixel)
}

/// Sine of the angle at which `view` sees a horizontal plane at `p_world`; negative = from below. Infinite where unknown.
pub(crate) fn facing(view: &View, p_world: DVec3) -> f64 {
    let (mut p, mut east, mut north) = (p_world, DVec3::X, DVec3::Y);
    for stage in view.stages() {
        let (Ok(j), Ok(next)) = (stage.jacobian(p), stage.apply(p)) else { return f64::INFINITY };
        (p, east, north) = (next, j * east, j * north);
    }
    let pinhole = view.pinhole();
    let towards_eye = if pinhole.is_orthographic() { -pinhole.forward } else { (pinhole.eye - p).normalize_or_zero() };
    let sine = east.cross(north).normalize_or_zero().dot(towards_eye);
    if sine.is_finite() { sine } else { f64::INFINITY }
}

/// Ratio of the singular values of the 2 x 3 derivative of the pixel.
fn anisotropy(view: &View, p_world: DVec3) -> Option<f64> {
    let [a, b] = view.jacobian(p_world).ok()?;
    let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
    let (mean, spread) = (0.5 * (aa + bb), (0.25 * (aa - bb).powi(2) + ab * ab).sqrt());
    let ratio = ((mean + spread) / (mean - spread).max(1e-300)).sqrt();
    ratio.is_finite().then_some(ratio)
}
