//! The nearest valid camera to one that is not.

use super::CurvedRays;
use super::build::Chain;
use super::check::{TurnContext, axis, corner_direction, corner_pixels};
use super::remedy::{heals_well, rounded, smallest};
use super::spec::{CurvedRaysError, Model, Pencil, Remedy, Sharpness, TurnSpec};
use crate::Pinhole;
use glam::DVec3;

/// Changes of a camera per turn, at most.
const MOST_CHANGES: usize = 24;
/// Least distance between the planes of a turn that is made anew, and of its viewpoint before t1, shares of the distance of t1.
const APART: f64 = 0.02;
const BEFORE_BEND: f64 = 0.1;
/// Share of a viewpoint's distance from the eye at which it stands after turns were made gentler once.
const GENTLER: f64 = 0.8;
/// Shares of the distance of a viewpoint from the one before that are tried.
const SHARES: [f64; 5] = [1.0, 0.5, 0.25, 0.1, 0.03];
/// A point that is no number lies at this multiple of the near distance.
const AHEAD: f64 = 10.0;

/// A camera that was made valid.
#[derive(Debug, Clone)]
pub struct Mended {
    /// The valid camera.
    pub rays: CurvedRays,
    /// What was wrong, and what was done, in order; empty for a camera that was valid.
    pub changes: Vec<CurvedRaysError>,
}

impl CurvedRays {
    /// The camera of [`CurvedRays::new`], or a valid one near it: as long as something is wrong, what its error names as the nearest valid
    /// value is set; where that does not help, the turn becomes the nearest valid one on the way to a turn with parallel planes across the
    /// axis of the rays. `None` for an orthographic root, and where no such camera is valid.
    pub fn mended(root: &Pinhole, model: Model, turns: &[TurnSpec]) -> Option<Mended> {
        let (mut root, mut model, mut turns) = (root.clone(), model, turns.to_vec());
        let corners = corner_pixels(&root);
        let (mut changes, mut last) = (Vec::new(), None);
        loop {
            let mut chain = Chain::new(&root, model, &corners, true).ok()?;
            let wrong = turns.iter().enumerate().find_map(|(k, turn)| chain.add(turn).err().map(|e| (k, e)));
            let Some((k, error)) = wrong else { return Some(Mended { rays: chain.finish(), changes }) };
            let context = chain.context();
            let again = last.replace(k) == Some(k) && changes.len() > 2;
            let (near, other) = match error.remedy() {
                // The same turn may need several values; if it needs many it is made anew.
                _ if changes.last() == Some(&error) => (None, valid_turn(&turns[k], &context, Way::End)),
                _ if again && changes.len() % 4 == 3 => (None, nearest_turn(&turns[k], &context)),
                Some(Remedy::Near { near }) => (Some(*near), None),
                Some(Remedy::Shrink { factor }) if k > 0 => {
                    turns[k - 1] = narrower(&turns[k - 1], *factor);
                    (None, Some(narrower(&turns[k], *factor)))
                }
                Some(Remedy::OtherModel) => {
                    model = Model::Modified;
                    (None, Some(turns[k]))
                }
                Some(remedy) => {
                    // A value that makes the turn only just valid leaves no room for the turns behind it.
                    let one = applied(remedy, &turns[k]);
                    let is_last = k + 1 == turns.len();
                    let good = one.filter(|turn| is_last || heals_well(turn, &context));
                    (None, good.or_else(|| nearest_turn(&turns[k], &context)).or(one))
                }
                None => (None, nearest_turn(&turns[k], &context)),
            };
            match (near, other) {
                (Some(near), _) => root.near = near,
                (None, Some(turn)) => turns[k] = turn,
                // The rays that come to the turn go too far apart: the turns before it become gentler.
                (None, None) if k > 0 => gentler(&mut turns[..k], root.eye),
                (None, None) => return None,
            }
            changes.push(error);
            if changes.len() > MOST_CHANGES * turns.len() {
                return None;
            }
        }
    }
}

/// A turn with the value that a remedy names.
fn applied(remedy: &Remedy, spec: &TurnSpec) -> Option<TurnSpec> {
    let mut turn = *spec;
    match (*remedy, &mut turn.pencil) {
        (Remedy::MovePoint { name: "line.point", to }, Pencil::Line { point, .. }) => *point = to,
        (Remedy::MovePoint { name, to }, _) => match name {
            "t0" => turn.t0 = to,
            "t2" => turn.t2 = to,
            "viewpoint" => turn.viewpoint = to,
            _ => return None,
        },
        (Remedy::MovePlanes { by }, _) => [&mut turn.t0, &mut turn.t1, &mut turn.t2].into_iter().for_each(|t| *t += by),
        (Remedy::Normal { normal }, _) => turn.pencil = Pencil::Parallel { normal },
        (Remedy::SwapPlanes, _) => std::mem::swap(&mut turn.t0, &mut turn.t2),
        (Remedy::BendInPicture, _) => turn.m = Sharpness::Value(1.0),
        (Remedy::Turn { turn: other }, _) => turn = other,
        _ => return None,
    }
    Some(turn)
}

/// A turn whose t0 and t2 are nearer to its t1.
fn narrower(spec: &TurnSpec, factor: f64) -> TurnSpec {
    TurnSpec { t0: spec.t1.lerp(spec.t0, factor), t2: spec.t1.lerp(spec.t2, factor), ..*spec }
}

/// Brings viewpoints nearer to the eye.
fn gentler(turns: &mut [TurnSpec], eye: DVec3) {
    turns.iter_mut().for_each(|turn| *turn = turn.eased(eye, GENTLER));
}

/// The nearest valid turn on the way from a turn to one with parallel planes across the axis, in order and apart, and a viewpoint
/// before them; `None` if there is none.
pub(super) fn nearest_turn(spec: &TurnSpec, context: &TurnContext<'_>) -> Option<TurnSpec> {
    valid_turn(spec, context, Way::First)
}

/// Which valid turn on the way is meant.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    First,
    End,
}

fn valid_turn(spec: &TurnSpec, context: &TurnContext<'_>, way: Way) -> Option<TurnSpec> {
    let (eye, axis) = (context.part.viewpoint, middle(context));
    let start = start(context, axis);
    let ahead = |p: DVec3| (p - eye).dot(axis);
    let given = sane(spec, eye + AHEAD * start * axis);
    let reach = ahead(given.t1).max(1.5 * start);
    let mut depths = [given.t0, given.t1, given.t2].map(ahead);
    depths.sort_by(f64::total_cmp);
    let mut least = start + APART * reach;
    for depth in &mut depths {
        *depth = depth.max(least);
        least = *depth + APART * reach;
    }
    let at = |p: DVec3, depth: f64| p + (depth - ahead(p)) * axis;
    let latest = depths[1] - BEFORE_BEND * reach;
    let upright = TurnSpec {
        viewpoint: at(given.viewpoint, ahead(given.viewpoint).min(latest)),
        t0: at(given.t0, depths[0]),
        t1: at(given.t1, depths[1]),
        t2: at(given.t2, depths[2]),
        pencil: Pencil::Parallel { normal: axis },
        m: given.m,
    };
    // A viewpoint that stands far aside is brought nearer to the one before.
    SHARES.into_iter().find_map(|share| {
        let goal = TurnSpec { viewpoint: eye.lerp(upright.viewpoint, share), ..upright };
        between(&given, &goal, (axis, context), way)
    })
}

/// A valid turn on the way from one to another.
fn between(
    given: &TurnSpec,
    goal: &TurnSpec,
    (axis, context): (DVec3, &TurnContext<'_>),
    way: Way,
) -> Option<TurnSpec> {
    let at = |t: f64| {
        let point = |a: DVec3, b: DVec3| rounded(a.lerp(b, t), goal, context);
        let t1 = point(given.t1, goal.t1);
        TurnSpec {
            viewpoint: point(given.viewpoint, goal.viewpoint),
            t0: point(given.t0, goal.t0),
            t1,
            t2: point(given.t2, goal.t2),
            pencil: pencil_between(given.pencil, (axis, t1), t),
            m: given.m,
        }
    };
    match way {
        Way::First => smallest(|t| heals_well(&at(t), context), 1.0).map(at),
        Way::End => Some(at(1.0)).filter(|turn| heals_well(turn, context)),
    }
}

/// The planes on the way to parallel ones across the axis: a common line turns across the axis and moves away from the bend point.
fn pencil_between(pencil: Pencil, (axis, bend): (DVec3, DVec3), t: f64) -> Pencil {
    match pencil {
        Pencil::Line { point, dir } if t < 1.0 => {
            let across = dir.reject_from(axis).normalize_or(axis.any_orthonormal_vector());
            let away = (point - bend).reject_from(axis);
            let away = if away.length() > 0.0 { away } else { (point - bend).length() * axis.cross(across) };
            let dir = dir.normalize_or(across).lerp(across, t).normalize_or(across);
            Pencil::Line { point: bend + (point - bend).lerp(away, t) / (1.0 - t), dir }
        }
        Pencil::Parallel { normal } if t < 1.0 => {
            let normal = normal.normalize_or(axis);
            let ahead = if normal.dot(axis) < 0.0 { -normal } else { normal };
            Pencil::Parallel { normal: ahead.lerp(axis, t).normalize_or(axis) }
        }
        _ => Pencil::Parallel { normal: axis },
    }
}

/// Unit direction in the middle of the rays of the corners.
fn middle(context: &TurnContext<'_>) -> DVec3 {
    let corners = context.corners.iter().map(|px| corner_direction(*px, context.root, &context.part).normalize());
    corners.sum::<DVec3>().normalize_or(axis(context))
}

/// Distance along the axis from which on a turn may begin: beyond the near plane, and the end of the turn before.
fn start(context: &TurnContext<'_>, axis: DVec3) -> f64 {
    let of_turn = context.previous.iter().flat_map(|turn| turn.ends.iter().zip(context.corners));
    let ends = of_turn.map(|(end, px)| end * corner_direction(*px, context.root, &context.part).dot(axis));
    ends.fold(context.root.near, f64::max)
}

/// A turn of finite numbers, in range.
fn sane(spec: &TurnSpec, instead: DVec3) -> TurnSpec {
    let point = |p: DVec3| if p.is_finite() && p.abs().max_element() < 1e12 { p } else { instead };
    let direction = |d: DVec3| if d.is_finite() { d } else { DVec3::ZERO };
    let pencil = match spec.pencil {
        Pencil::Line { point: at, dir } => Pencil::Line { point: point(at), dir: direction(dir) },
        Pencil::Parallel { normal } => Pencil::Parallel { normal: direction(normal) },
    };
    let m = match spec.m {
        Sharpness::Value(m) if m.is_nan() => Sharpness::Bend,
        Sharpness::Value(m) => Sharpness::Value(m.clamp(0.2, 20.0)),
        rule => rule,
    };
    TurnSpec { viewpoint: point(spec.viewpoint), t0: point(spec.t0), t1: point(spec.t1), t2: point(spec.t2), pencil, m }
}
