//! Positions of the samples of features in a picture, and their visibility by line of sight.

use super::displaced::DisplacedSight;
use crate::sample::{Sample, SampledFeature};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Scene;
use belvedere_sight::{Carried, DisplacedGround, Obstacles, SightOptions, TreeMemory};
use rayon::prelude::*;
use std::borrow::Cow;

/// Position of one sample in a picture, and its visibility.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SampleImage {
    pub(super) pixel: DVec2,
    pub(super) depth: f64,
    pub(super) in_frame: bool,
    pub(super) folded: bool,
    /// The sample after all stages, scene coordinates.
    pub(super) displaced: Option<DVec3>,
    /// For a piece of surface: whether it is seen so slantwise that rounding decides which side shows.
    pub(super) edge_on: Option<bool>,
    /// By line of sight; `None` outside the frame.
    pub(super) clearance: Option<f64>,
    /// By the depth buffer; `None` outside the frame or without a renderer.
    pub(super) in_buffer: Option<DepthTest>,
}

impl SampleImage {
    pub(super) const UNSEEN: Self = Self {
        pixel: DVec2::ZERO,
        depth: 0.0,
        in_frame: false,
        folded: false,
        displaced: None,
        edge_on: None,
        clearance: None,
        in_buffer: None,
    };

    /// Seen by line of sight.
    pub(super) fn visible(&self) -> bool {
        self.clearance.is_some_and(|c| c >= 0.0)
    }
}

/// Result of the depth test of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct DepthTest {
    /// Nothing was drawn in front of the sample's ground.
    pub(super) seen: bool,
    /// What was drawn lies behind the ground: a hole, or a wrong depth.
    pub(super) missed: bool,
}

/// A scene as the rays of a view see it.
pub(super) struct Sight<'a> {
    pub(super) obstacles: Obstacles<'a>,
    bodies: BodyViews,
    /// Displaced ground behind which rays are straight.
    displaced: Option<DisplacedSight>,
    /// Obstacles other than that ground.
    beside: Option<Obstacles<'a>>,
}

/// The displaced ground, ready for lines of sight.
type Displaced<'s> = (&'s DisplacedSight, DisplacedGround<'s>);

impl<'a> Sight<'a> {
    pub(super) fn new(scene: &'a Scene, view: &View) -> Self {
        let bodies = BodyViews::new(scene, view);
        let displaced = DisplacedSight::new(scene, view).filter(|_| bodies.0.is_none());
        let beside = displaced.as_ref().map(|d| Obstacles::without(scene, &[d.layer()], None, &TreeMemory::default()));
        Self { obstacles: Obstacles::seen_by(scene, view), bodies, displaced, beside }
    }
}

/// Views by which samples on rigid bodies are projected.
pub(super) struct BodyViews(Option<Carried>);

impl BodyViews {
    pub(super) fn new(scene: &Scene, view: &View) -> Self {
        Self(Carried::new(scene, view))
    }

    /// `view` itself where a sample is displaced by itself, that of the body where it is carried by one; `None` if that has no image.
    pub(super) fn of<'v>(&self, view: &'v View, layer: usize, sample: &Sample) -> Option<Cow<'v, View>> {
        let bodies = self.0.as_ref().and_then(|carried| carried.layer(layer));
        match (bodies, sample.triangle.map(|t| t as usize)) {
            (Some(bodies), Some(t)) if bodies.holds(t) => {
                bodies.body(t).map(|(_, motion)| Cow::Owned(view.of_body(*motion)))
            }
            _ => Some(Cow::Borrowed(view)),
        }
    }
}

/// The images of all samples, in parallel.
pub(super) fn all(
    sight: &Sight<'_>,
    view: &View,
    features: &[SampledFeature],
    options: &SightOptions,
) -> Vec<Vec<SampleImage>> {
    let displaced: Option<Displaced<'_>> = sight.displaced.as_ref().map(|d| (d, d.ground()));
    let judged = |layer: usize, s: &Sample| {
        let mut found = image(sight, view, (layer, s), options);
        if let (Some(displaced), Some(c)) =
            (&displaced, found.clearance.filter(|_| !found.folded && s.surface.is_none()))
        {
            found.clearance = Some(over_displaced(sight, displaced, view, (s, &found, c), options));
        }
        found
    };
    let of = |f: &SampledFeature| f.samples.par_iter().map(|s| judged(f.layer, s)).collect();
    features.iter().map(of).collect()
}

/// The clearance of a sample on displaced ground, `c` by chords, with the verdict of the judge.
fn over_displaced(
    of: &Sight<'_>,
    (displaced, ground): &Displaced<'_>,
    view: &View,
    (sample, image, c): (&Sample, &SampleImage, f64),
    options: &SightOptions,
) -> f64 {
    let Some(over) = displaced.over(ground, sample) else { return c };
    if over > 0.0 {
        return c.min(-over);
    }
    // If the chords found the sample hidden, something other than the ground may hide it.
    match &of.beside {
        Some(beside) if c < 0.0 => {
            beside.clearance(view, (sample.p_world, sample.lift), (image.pixel, image.depth), options)
        }
        _ => c,
    }
}

fn image(of: &Sight<'_>, view: &View, (layer, sample): (usize, &Sample), sight: &SightOptions) -> SampleImage {
    let obstacles = &of.obstacles;
    let (rays, Some(own)) = (view, of.bodies.of(view, layer, sample)) else { return SampleImage::UNSEEN };
    let view = own.as_ref();
    let Ok(at) = view.project(sample.p_world) else { return SampleImage::UNSEEN };
    let displaced = view.displace(sample.p_world).ok().map(|d| d.point);
    let pinhole = view.pinhole();
    let in_range = at.depth >= pinhole.near && pinhole.far.is_none_or(|far| at.depth <= far);
    let in_frame = in_range && pinhole.contains(at.pixel);
    // A surface lies nearer to its sample than chords may lie to the ray.
    let fine = SightOptions { chord_m: sight.chord_m.min(1e-6 * at.depth), ..*sight };
    let sight = if sample.surface.is_some() { &fine } else { sight };
    let clearance = in_frame.then(|| {
        if at.folded {
            // Orientation is reversed there: the picture shows the ground from below.
            -sight.cap_m.max(f64::MIN_POSITIVE)
        } else if matches!(own, Cow::Owned(_)) {
            obstacles.clearance_of_body(rays, (at.pixel, at.depth), sight)
        } else {
            obstacles.clearance(view, (sample.p_world, sample.lift), (at.pixel, at.depth), sight)
        }
    });
    let edge_on = sample.surface.map(|normal| facing(view, sample.p_world, normal).abs() < EDGE_ON);
    SampleImage {
        pixel: at.pixel,
        depth: at.depth,
        in_frame,
        folded: at.folded,
        displaced,
        edge_on,
        clearance,
        in_buffer: None,
    }
}

/// Cosine of the slant below which a surface is seen edge-on.
const EDGE_ON: f64 = 0.15;

/// Cosine between the normal of a surface and the direction against the ray that sees it; 0 where there is no such direction.
pub(super) fn facing(view: &View, p: DVec3, normal: DVec3) -> f64 {
    // Along the ray the pixel stays: across the changes of its x and its y.
    let along = view.jacobian(p).map_or(DVec3::ZERO, |[x, y]| x.cross(y).normalize_or_zero());
    -normal.dot(along)
}
