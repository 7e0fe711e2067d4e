//! The smallest bend, in any direction, that shows a target.
//!
//! Ours, beyond the paper: its tracker steps aside to the left and right behind fixed planes; here all directions across the view
//! and all distances of the planes are tried, and what the bend does to the rest of the picture counts against it.

use super::{Shown, Sidestep, Target, TargetSight};
use crate::ConstructError;
use belvedere_core::{DVec3, Pinhole, View};
use belvedere_scene::{Progress, Scene, Unit};
use rayon::prelude::*;
use serde::Serialize;

/// Directions across the view, and steps of the second viewpoint's distance.
const DIRECTIONS: usize = 16;
const REACHES: [f64; 9] = [0.06, 0.12, 0.2, 0.3, 0.42, 0.56, 0.75, 1.0, 1.4];
/// Distance of t0 and width of the transition, shares of the distance to the target.
const STARTS: [f64; 8] = [0.05, 0.12, 0.22, 0.34, 0.46, 0.58, 0.7, 0.8];
const WIDTHS: [f64; 2] = [0.25, 0.12];
/// Share of the target that a mean motion of the picture by its own height must gain.
const PRICE_OF_MOTION: f64 = 0.25;

/// Options of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AroundOptions {
    /// Margin around the target that must be clear as well, pixels, >= 0.
    pub grow_px: f64,
    /// Whether the camera may turn so that the target stays in the middle of the picture.
    pub may_turn: bool,
}

impl Default for AroundOptions {
    fn default() -> Self {
        Self { grow_px: 4.0, may_turn: false }
    }
}

/// A view that shows a target, and what it costs.
#[derive(Debug, Clone)]
pub struct BendFound {
    /// The bent view; `None` where no bend shows more than straight rays.
    pub bent: Option<(View, Sidestep)>,
    /// Figures.
    pub report: BendReport,
}

/// Figures of a [`BendFound`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BendReport {
    /// Share of the whole target that straight rays show.
    pub visible_straight: f64,
    /// Share of the whole target that the bent view shows.
    pub visible: f64,
    /// Share of the target that lies in the straight picture, hidden or not.
    pub in_frame_straight: f64,
    /// Share of the target that lies in the bent picture.
    pub in_frame: f64,
    /// Light of the target that comes through volumes along straight rays, 0..=1; from 0.5 on it counts as seen.
    pub light_straight: f64,
    /// Most light that any bend that was tried lets through.
    pub light_best: f64,
    /// Mean motion of the scene in the picture, shares of its height.
    pub motion: f64,
    /// Bends that were tried.
    pub tried: usize,
}

/// One bend.
#[derive(Debug, Clone)]
struct Candidate {
    view: View,
    sidestep: Sidestep,
    share: f64,
    light: f64,
    motion: f64,
}

impl Candidate {
    fn score(&self) -> f64 {
        self.share - PRICE_OF_MOTION * self.motion
    }
}

/// The bend of `base` that shows most of `target` for the least motion of the rest. Deterministic.
///
/// # Errors
/// [`ConstructError::Cancelled`].
pub fn bend_around(
    scene: &Scene,
    base: &View,
    target: &Target,
    options: &AroundOptions,
    progress: &Progress,
) -> Result<BendFound, ConstructError> {
    bend_around_by(&TargetSight::new(scene, target), base, options, progress)
}

/// [`bend_around`] by lines of sight that are there already: for several bases, the tree over the scene is built once.
///
/// # Errors
/// [`ConstructError::Cancelled`].
pub fn bend_around_by(
    sight: &TargetSight<'_>,
    base: &View,
    options: &AroundOptions,
    progress: &Progress,
) -> Result<BendFound, ConstructError> {
    let (scene, target) = (sight.scene(), sight.target());
    let Shown { share: visible_straight, light: light_straight } = sight.shown(base, 0.0);
    let straight = sight.share(base, options.grow_px);
    let in_frame = sight.in_frame(base);
    let mut report = BendReport {
        visible_straight,
        visible: visible_straight,
        in_frame_straight: in_frame,
        in_frame,
        light_straight,
        light_best: light_straight,
        motion: 0.0,
        tried: 0,
    };
    let pinhole = base.pinhole();
    let center = base.displace(target.center()).map_or(target.center(), |d| d.point);
    let depth = (center - pinhole.eye).dot(pinhole.forward);
    if straight >= 1.0 || pinhole.is_orthographic() || !(depth > 2.0 * pinhole.near) {
        return Ok(BendFound { bent: None, report });
    }
    let last = depth - target.extent().min(0.2 * depth);
    let rest = surroundings(scene, target);
    // Towns and landscapes are not looked at from below.
    let floor = if scene.unit == Unit::Metre { scene.bounds().min.z.min(pinhole.eye.z) } else { f64::NEG_INFINITY };
    let mut best: Option<Candidate> = None;
    for (i, start) in STARTS.into_iter().enumerate() {
        progress.tick("bending rays around what hides the target", i as f64 / STARTS.len() as f64)?;
        let stands = |s: &Sidestep| (pinhole.eye + s.offset).z >= floor;
        let has_room = |s: &Sidestep| s.planes[2] <= last && s.planes[0] > 1.001 * pinhole.near;
        let possible: Vec<Sidestep> = sidesteps(pinhole, start, depth).filter(|s| has_room(s) && stands(s)).collect();
        report.tried += possible.len();
        // Those of one step are compared with the best of the steps before: the same on any number of threads.
        let least = best.as_ref().map_or(straight, |b| b.score().max(straight));
        let found =
            possible.into_par_iter().filter_map(|s| candidate((base, s), center, options, sight, (&rest, least)));
        let found: Vec<Candidate> = found.collect();
        for next in found {
            report.light_best = report.light_best.max(next.light);
            if best.as_ref().is_none_or(|b| next.score() > b.score()) {
                best = Some(next);
            }
        }
    }
    // The margin around the target decides among bends, but not whether the picture is worse than the straight one.
    let worth = |b: &Candidate| b.share > straight && b.score() > straight;
    let bent = best.filter(|b| worth(b) && sight.share(&b.view, 0.0) > visible_straight);
    if let Some(best) = &bent {
        (report.visible, report.motion) = (sight.share(&best.view, 0.0), best.motion);
        report.in_frame = sight.in_frame(&best.view);
    }
    Ok(BendFound { bent: bent.map(|b| (b.view, b.sidestep)), report })
}

/// The bends whose planes begin at a share of the depth of the target.
fn sidesteps(pinhole: &Pinhole, start: f64, depth: f64) -> impl Iterator<Item = Sidestep> {
    WIDTHS.into_iter().flat_map(move |width| {
        let end = (start + width) * depth;
        REACHES.into_iter().flat_map(move |reach| {
            (0..DIRECTIONS).map(move |k| {
                let angle = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
                let (sin, cos) = angle.sin_cos();
                let offset = reach * depth * (cos * pinhole.right + sin * pinhole.down);
                Sidestep { offset, planes: [start * depth, 0.5 * (start * depth + end), end] }
            })
        })
    })
}

/// A bend judged; `None` if it is not possible, or its score is not above `least`.
fn candidate(
    (base, sidestep): (&View, Sidestep),
    center: DVec3,
    options: &AroundOptions,
    sight: &TargetSight<'_>,
    (rest, least): (&[DVec3], f64),
) -> Option<Candidate> {
    let turned = if options.may_turn { turned(base, &sidestep, center)? } else { base.clone() };
    let view = sidestep.view(&turned).ok()?;
    let motion = motion(base, &view, rest);
    let Shown { share, light } = sight.shown_over(&view, options.grow_px, least + PRICE_OF_MOTION * motion)?;
    Some(Candidate { motion, view, sidestep, share, light })
}

/// `base` turned towards the point through which the ray to `center` leaves the bend.
fn turned(base: &View, sidestep: &Sidestep, center: DVec3) -> Option<View> {
    let root = base.pinhole();
    let viewpoint = root.eye + sidestep.offset;
    let way = center - viewpoint;
    let share = sidestep.planes[1] / way.dot(root.forward);
    let aim = viewpoint + share * way;
    let up = -root.down;
    let pinhole = Pinhole::look_at(root.eye, aim, up, root.projection, root.image, root.near, root.far);
    View::new(pinhole.ok()?, base.stages().to_vec()).ok()
}

/// Points on the bounds of every layer, and those of the target.
fn surroundings(scene: &Scene, target: &Target) -> Vec<DVec3> {
    let solid = scene.layers.iter().map(belvedere_scene::Layer::bounds).filter(|b| !b.is_empty());
    let mut points: Vec<DVec3> = solid.flat_map(|b| Target::around(b).points).collect();
    points.extend(&target.points);
    points
}

/// Mean motion of points in the picture, shares of its height, each of at most one height.
fn motion(before: &View, after: &View, points: &[DVec3]) -> f64 {
    let height = f64::from(before.pinhole().image[1]);
    let (mut sum, mut count) = (0.0, 0usize);
    for &p in points {
        let Ok(a) = before.project(p) else { continue };
        if !before.pinhole().contains(a.pixel) {
            continue;
        }
        let moved = after.project(p).map_or(height, |b| (b.pixel - a.pixel).length());
        sum += (moved / height).min(1.0);
        count += 1;
    }
    sum / count.max(1) as f64
}
