//! The camera of a picture, turned and zoomed where it stands, so that what a bend moved lies inside with an even margin.
//!
//! A bend displaces space in the same way wherever the camera at its eye looks. It is therefore kept as it is: nothing comes to stand in
//! front of anything else, and the frame alone changes.

use crate::rays::{Sidestep, TargetSight};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use serde::Serialize;

/// Share of the picture's width or height that the content takes up.
const FITTED: f64 = 0.92;
/// Factors by which the picture may show more or less than before, and the largest tangent of half its angle.
const ZOOM: [f64; 2] = [0.5, 3.0];
const WIDEST: f64 = 1.03;
/// Times that the middle of the content is sought: its extent on the picture plane depends on where the camera looks.
const ROUNDS: usize = 12;
/// Tangent of the angle from the direction of view beyond which content is not framed.
const FARTHEST: f64 = 4.0;
/// Visible share that another frame may cost: rounding.
const MAY_COST: f64 = 0.005;

/// What another frame changed; in each pair before and after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RefitRecord {
    /// Angle by which the camera was turned, degrees.
    pub turned_deg: f64,
    /// Full vertical field of view, degrees.
    pub fov_y_deg: [f64; 2],
    /// Share of the content that lies outside the bent picture.
    pub outside: [f64; 2],
}

/// A camera in another frame.
#[derive(Debug, Clone)]
pub struct Refit {
    /// The view without its bend.
    pub straight: View,
    /// What changed.
    pub record: RefitRecord,
}

/// What a frame is fitted to.
pub struct Content<'a> {
    /// Points of all that the picture is to hold.
    pub points: &'a [DVec3],
    /// Direction that is up in the picture.
    pub up: DVec3,
    /// Whether the field of view may change.
    pub may_zoom: bool,
}

/// The view `base` in another frame, with its bend if there is one; `None` where that would show less of the target, straight or bent.
pub fn refit(
    sight: &TargetSight<'_>,
    base: &View,
    sidestep: Option<&Sidestep>,
    content: &Content<'_>,
) -> Option<Refit> {
    let old = base.pinhole();
    let bent = |view: &View| sidestep.map_or_else(|| Some(view.clone()), |s| s.seen_by(old, view).ok());
    let before = bent(base)?;
    let direction = |view: &View, p: &DVec3| view.displace(*p).ok().map(|d| d.point - old.eye);
    let moved: Vec<DVec3> = content.points.iter().filter_map(|p| direction(&before, p)).collect();
    let shown = [base, &before].map(|view| (sight.share(view, 0.0), sight.in_frame(view)));
    let tried = |directions: &[DVec3]| {
        let straight = View::new(framed(old, content, directions)?, base.stages().to_vec()).ok()?;
        let after = bent(&straight)?;
        // The straight picture beside the bent one keeps the target, too, so that the two can be compared.
        let is_as_good = |view: &View, (share, in_frame): (f64, f64)| {
            sight.share(view, 0.0) + MAY_COST >= share && sight.in_frame(view) + MAY_COST >= in_frame
        };
        (is_as_good(&straight, shown[0]) && is_as_good(&after, shown[1])).then_some((straight, after))
    };
    let (straight, after) = tried(&moved).or_else(|| {
        let target = sight.target().points.iter().filter_map(|p| direction(base, p));
        tried(&moved.iter().copied().chain(target).collect::<Vec<_>>())
    })?;
    let record = RefitRecord {
        turned_deg: old.forward.angle_between(straight.pinhole().forward).to_degrees(),
        fov_y_deg: [old, straight.pinhole()].map(|p| 2.0 * half_tangent(p).atan().to_degrees()),
        outside: [&before, &after].map(|view| outside(view, content.points)),
    };
    Some(Refit { straight, record })
}

/// Share of points that lie outside the picture.
fn outside(view: &View, points: &[DVec3]) -> f64 {
    let is_inside = |p: &&DVec3| view.project(**p).is_ok_and(|image| view.pinhole().contains(image.pixel));
    1.0 - points.iter().filter(is_inside).count() as f64 / points.len().max(1) as f64
}

fn half_tangent(pinhole: &Pinhole) -> f64 {
    0.5 * f64::from(pinhole.image[1]) / pinhole.scale_px()
}

/// The camera at the same eye in whose picture the directions lie in the middle, and fill it if that may zoom. `None` without directions in
/// front of it.
fn framed(old: &Pinhole, content: &Content<'_>, directions: &[DVec3]) -> Option<Pinhole> {
    let Projection::Perspective { .. } = old.projection else { return None };
    let looking = |forward: DVec3, projection: Projection| {
        Pinhole::look_at(old.eye, old.eye + forward, content.up, projection, old.image, old.near, old.far).ok()
    };
    let mut pinhole = looking(old.forward, old.projection)?;
    let mut half = DVec2::ZERO;
    for _ in 0..ROUNDS {
        let (low, high) = extent(&pinhole, directions)?;
        let middle = 0.5 * (low + high);
        half = 0.5 * (high - low);
        let forward = (pinhole.forward + middle.x * pinhole.right + middle.y * pinhole.down).normalize();
        pinhole = looking(forward, old.projection)?;
    }
    if !content.may_zoom {
        return Some(pinhole);
    }
    let [width, height] = old.image.map(f64::from);
    let own = half_tangent(old);
    let wanted = half.y.max(half.x * height / width) / FITTED;
    let tangent = wanted.clamp(ZOOM[0] * own, ZOOM[1] * own).min(WIDEST.max(own));
    looking(pinhole.forward, Projection::Perspective { fov_y: 2.0 * tangent.atan() })
}

/// The box around directions on the picture plane, as tangents to the right and down.
fn extent(pinhole: &Pinhole, directions: &[DVec3]) -> Option<(DVec2, DVec2)> {
    let tangents = directions.iter().filter_map(|d| {
        let ahead = d.dot(pinhole.forward);
        let t = DVec2::new(d.dot(pinhole.right), d.dot(pinhole.down)) / ahead;
        (ahead > 0.0 && t.abs().max_element() < FARTHEST).then_some(t)
    });
    let empty = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = tangents.fold(empty, |(low, high), t| (low.min(t), high.max(t)));
    (low.cmple(high).all()).then_some((low, high))
}

#[cfg(test)]
mod tests;
