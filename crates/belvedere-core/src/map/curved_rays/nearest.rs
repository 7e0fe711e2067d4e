//! The nearest valid turn to one that is not.

use super::check::{TurnContext, UnscaledTurn, axis, corner_direction};
use super::spec::{Pencil, Sharpness, TurnSpec};
use glam::DVec3;

/// Least distance between the planes of a turn that is made anew, and of its viewpoint before t1, shares of the distance of t1.
const APART: f64 = 0.02;
const BEFORE_BEND: f64 = 0.1;
/// Shares of the distance of a viewpoint from the one before that are tried.
const SHARES: [f64; 5] = [1.0, 0.5, 0.25, 0.1, 0.03];
/// A point that is no number lies at this multiple of the near distance.
const AHEAD: f64 = 10.0;

/// A turn that is made anew ends for every ray of the picture within this multiple of its distance.
const LATEST_END: f64 = 8.0;

/// Whether a changed turn meets all conditions.
pub(super) fn heals(candidate: &TurnSpec, context: &TurnContext<'_>) -> bool {
    UnscaledTurn::new(candidate, context.turn, &context.part)
        .is_ok_and(|unscaled| unscaled.check(candidate, context).is_ok())
}

/// Whether it meets them, and ends in reasonable distance: one that is only just valid ends nowhere near, and no turn fits behind it.
pub(super) fn heals_well(candidate: &TurnSpec, context: &TurnContext<'_>) -> bool {
    let Ok(unscaled) = UnscaledTurn::new(candidate, context.turn, &context.part) else { return false };
    let Ok(forms) = unscaled.check(candidate, context) else { return false };
    let distance = [candidate.t1, candidate.t2].map(|p| p.distance(context.part.viewpoint));
    let latest = LATEST_END * distance[0].max(distance[1]);
    context.corners.iter().all(|px| {
        let direction = corner_direction(*px, context.root, &context.part);
        forms.end(direction) * direction.length() <= latest
    })
}

/// Share of the distance to the bend point to which remedies are rounded.
const GRAIN: f64 = 1e-6;

/// A point with as few decimals as the turn's size allows: what is printed is what was tried.
pub(super) fn rounded(p: DVec3, spec: &TurnSpec, context: &TurnContext<'_>) -> DVec3 {
    let size = (spec.t1 - context.part.viewpoint).length().max((spec.viewpoint - context.part.viewpoint).length());
    let decimals = (-(GRAIN * size).log10().floor()).clamp(0.0, 15.0) as usize;
    let one = |v: f64| format!("{v:.decimals$}").parse().unwrap_or(v) + 0.0;
    DVec3::new(one(p.x), one(p.y), one(p.z))
}

/// Smallest `t` in (0, `end`] with `valid(t)`, to about a millionth, assuming that `valid` stays once it holds.
pub(super) fn smallest(valid: impl Fn(f64) -> bool, end: f64) -> Option<f64> {
    let steps = (0..=120).map(|i| end * 1.2f64.powi(i - 120));
    let mut low = 0.0;
    for t in steps {
        if valid(t) {
            let mut high = t;
            for _ in 0..30 {
                let middle = 0.5 * (low + high);
                if valid(middle) { high = middle } else { low = middle }
            }
            return Some(high);
        }
        low = t;
    }
    None
}

/// The nearest valid turn on the way from a turn to one with parallel planes across the axis, in order and apart, and a viewpoint
/// before them; `None` if there is none.
pub(super) fn nearest_turn(spec: &TurnSpec, context: &TurnContext<'_>) -> Option<TurnSpec> {
    valid_turn(spec, context, Way::First)
}

/// Which valid turn on the way to one with parallel planes is meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// The nearest.
    First,
    /// The one with parallel planes.
    End,
}

/// A valid turn on that way.
pub(super) fn valid_turn(spec: &TurnSpec, context: &TurnContext<'_>, way: Way) -> Option<TurnSpec> {
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
