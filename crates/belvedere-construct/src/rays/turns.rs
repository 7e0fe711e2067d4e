//! Turns that lead the rays of a picture round the corners of a polyline.

use belvedere_core::map::curved_rays::{Pencil, Sharpness, TurnSpec};
use belvedere_core::{DVec2, DVec3, Pinhole};

/// Turns of less than this count as straight, radians.
pub(super) const STRAIGHT: f64 = 0.035;
/// Turns beyond this are made in two, radians.
pub(super) const HAIRPIN: f64 = 1.6;
/// Half length of a transition, shares of the shorter leg beside it.
pub(super) const TRANSITION: f64 = 0.3;
/// Distance of the common line from the corner, half widths of the picture there.
const LINE_AT: f64 = 1.3;

/// A corner that rays are led round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    /// Arc length of the polyline there, scene units.
    pub(super) s: f64,
    pub(super) at: DVec3,
    /// Unit directions of the legs.
    pub(super) before: DVec3,
    pub(super) after: DVec3,
    /// Lengths of the legs.
    pub(super) edges: [f64; 2],
    /// Half length of the transition, at most.
    pub(super) half_length: f64,
    /// Share to which the turn has come in, 0..=1: at 0 it changes nothing.
    pub(super) entered: f64,
}

/// Parameters that all corners share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TurnShape {
    /// Distance of every viewpoint behind its corner, scene units, > 0.
    pub(super) behind: f64,
    /// Length of transitions, shares of the usual.
    pub(super) length: f64,
    pub(super) m: Sharpness,
}

/// The turns of `corners`; `None` if rays of the picture do not come to one of them.
///
/// * `from`: where the leg to the first corner begins.
pub(super) fn turns(root: &Pinhole, from: DVec3, corners: &[Corner], shape: &TurnShape) -> Option<Vec<TurnSpec>> {
    let mut viewpoint = root.eye;
    // Points on the last plane t1 of the rays through the corners of the picture.
    let mut rim = rim_rays(root).map(|ray| root.eye + ray);
    let mut specs = Vec::with_capacity(corners.len());
    for (i, turn) in corners.iter().enumerate() {
        let inside = (turn.after - turn.before).normalize_or(DVec3::X);
        let axis = turn.before.cross(turn.after).normalize_or(DVec3::Z);
        // Plane t1 halves the angle of the legs, wherever in it the common line is.
        let across = inside.cross(axis);
        let mut reach = 0.0f64;
        for point in &mut rim {
            let ray = *point - viewpoint;
            let share = (turn.at - viewpoint).dot(across) / ray.dot(across);
            if !(share > 0.0 && share.is_finite()) {
                return None;
            }
            *point = viewpoint + share * ray;
            reach = reach.max((*point - turn.at).dot(inside));
        }
        let before = if i == 0 { (turn.at - from).dot(turn.before).max(0.0) } else { turn.edges[0] };
        let length = shape.length * turn.half_length.min(TRANSITION * before);
        viewpoint += turn.entered * (turn.at - shape.behind * turn.after - viewpoint);
        specs.push(TurnSpec {
            viewpoint,
            t0: turn.at - length * turn.before,
            t1: turn.at,
            t2: turn.at + length * turn.after,
            pencil: Pencil::Line { point: turn.at + LINE_AT * reach * inside, dir: axis },
            m: shape.m,
        });
    }
    Some(specs)
}

/// Result of `make` for the largest number of a range for which it gives one; changes smoothly with what `make` depends on.
pub(super) fn largest<T>([least, most]: [f64; 2], make: impl Fn(f64) -> Option<T>) -> Option<T> {
    const HALVINGS: usize = 12;
    if let Some(made) = make(most) {
        return Some(made);
    }
    let mut best = make(least)?;
    let (mut low, mut high) = (least, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match make(middle) {
            Some(made) => (low, best) = (middle, made),
            None => high = middle,
        }
    }
    Some(best)
}

/// Smooth step (C1): 0 for `x` <= 0, 1 for `x` >= 1.
pub(super) fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Directions of the rays through the corners of the picture.
fn rim_rays(root: &Pinhole) -> [DVec3; 4] {
    let [w, h] = root.image.map(f64::from);
    [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)].map(|(x, y)| root.line(DVec2::new(x, y)).1)
}
