//! Errors of violated conditions, with the nearest valid value.

use super::check::{PreviousTurn, TurnContext, UnscaledTurn, Violation, axis, corner_direction, crossing};
use super::nearest::{heals, nearest_turn, rounded, smallest};
use super::spec::{CurvedRaysError, Pencil, Remedy, TurnSpec};
use glam::{DVec2, DVec3};

/// The error for a violated condition of a turn.
pub(super) fn report(violation: Violation, spec: &TurnSpec, context: &TurnContext<'_>) -> CurvedRaysError {
    let turn = context.turn;
    let viewpoint = turn - 1;
    let remedy = if context.advise { remedy(violation, spec, context) } else { Remedy::Rebuild };
    match violation {
        Violation::Order { depths: [t0, t1, t2] } => {
            CurvedRaysError::PlaneOrder { turn, viewpoint, t0, t1, t2, remedy }
        }
        Violation::PreviousPastBend { past } => CurvedRaysError::PreviousPastBend { turn, viewpoint, past, remedy },
        Violation::ViewpointPastBend { past } => CurvedRaysError::ViewpointPastBend { turn, past, remedy },
        Violation::PreviousPastStart { past } => CurvedRaysError::PreviousPastStart { turn, viewpoint, past, remedy },
        Violation::BendNotMet { pixel, slope } => CurvedRaysError::BendNotMet { turn, viewpoint, pixel, slope, remedy },
        Violation::LineInPicture { pixel, beyond } => CurvedRaysError::LineInPicture { turn, pixel, beyond, remedy },
        Violation::EndNotReached { pixel, sigma, limit } => {
            CurvedRaysError::EndNotReached { turn, pixel, sigma, limit, remedy }
        }
        Violation::TurnsOverlap { pixel, end, start } => {
            CurvedRaysError::TurnsOverlap { turn, pixel, end, start, remedy }
        }
        Violation::NearPastStart { pixel, start } => {
            CurvedRaysError::NearPastStart { pixel, near: context.root.near, start, remedy }
        }
    }
}

/// The error for rays of the original model that cross in the picture. Remedy: t2 nearer to the bend, or another model.
pub(super) fn rays_cross(pixel: DVec2, sigma: f64, spec: &TurnSpec, context: &TurnContext<'_>) -> CurvedRaysError {
    let parted = |candidate: &TurnSpec| {
        let forms = UnscaledTurn::new(candidate, context.turn, &context.part).ok()?.check(candidate, context).ok()?;
        crossing(&forms, context).1.is_none().then_some(())
    };
    let healed = |t: f64| parted(&end_at(spec, context, t)).is_some();
    let remedy = if context.advise { smallest(healed, 1.0) } else { None };
    let remedy =
        remedy.map_or(Remedy::OtherModel, |t| Remedy::MovePoint { name: "t2", to: end_at(spec, context, t).t2 });
    CurvedRaysError::RaysCross { turn: context.turn, pixel, sigma, remedy }
}

fn remedy(violation: Violation, spec: &TurnSpec, context: &TurnContext<'_>) -> Remedy {
    let healed = |candidate: &TurnSpec| heals(candidate, context);
    let found = match violation {
        Violation::Order { depths } => {
            let swapped = TurnSpec { t0: spec.t2, t2: spec.t0, ..*spec };
            if depths[0] > depths[2] && healed(&swapped) {
                Some(Remedy::SwapPlanes)
            } else {
                shifted_planes(spec, context, &healed)
            }
        }
        Violation::PreviousPastBend { .. } => shifted_planes(spec, context, &healed),
        Violation::ViewpointPastBend { past } => viewpoint_back(spec, context, past, &healed),
        Violation::PreviousPastStart { .. } => start_towards_bend(spec, context, &healed),
        Violation::BendNotMet { .. } => turned_planes(spec, context, &healed),
        Violation::LineInPicture { .. } => line_away(spec, context, &healed),
        Violation::EndNotReached { .. } => smallest(|t| healed(&end_at(spec, context, t)), 1.0)
            .map(|t| Remedy::MovePoint { name: "t2", to: end_at(spec, context, t).t2 }),
        Violation::TurnsOverlap { .. } => shrunk(spec, context),
        Violation::NearPastStart { .. } => {
            let start = UnscaledTurn::new(spec, context.turn, &context.part).map(|unscaled| {
                let forms = unscaled.forms(&context.part, spec.viewpoint);
                let start = |px: &DVec2| forms.start(corner_direction(*px, context.root, &context.part));
                context.corners.iter().map(start).fold(f64::INFINITY, f64::min)
            });
            let near = floor(start.unwrap_or(0.0) * (1.0 - 1e-6));
            if near > 0.0 { Some(Remedy::Near { near }) } else { start_towards_bend(spec, context, &healed) }
        }
    };
    // One value is easier to change than several, but not if it changes much more.
    let far = found.as_ref().map_or(f64::INFINITY, |remedy| distance(remedy, spec));
    let nearest = || nearest_turn(spec, context).filter(|turn| FARTHER * turn.distance(spec) < far);
    let several = if far == 0.0 { None } else { nearest().map(|turn| Remedy::Turn { turn: Box::new(turn) }) };
    several.or(found).unwrap_or(Remedy::Rebuild)
}

/// Factor by which the change of one value may be larger than that of several.
const FARTHER: f64 = 10.0;

/// How far a remedy moves points of a turn, scene units; 0 where it moves none.
fn distance(remedy: &Remedy, spec: &TurnSpec) -> f64 {
    match (remedy, spec.pencil) {
        (Remedy::MovePoint { name: "line.point", to }, Pencil::Line { point, .. }) => to.distance(point),
        (Remedy::MovePoint { name, to }, _) => match *name {
            "t0" => to.distance(spec.t0),
            "t2" => to.distance(spec.t2),
            _ => to.distance(spec.viewpoint),
        },
        (Remedy::MovePlanes { by }, _) => by.length(),
        _ => 0.0,
    }
}

/// At most `value`, with six digits.
fn floor(value: f64) -> f64 {
    if !(value > 0.0) {
        return 0.0;
    }
    let scale = 10f64.powi(5 - value.log10().floor() as i32);
    let down = (value * scale).floor() / scale;
    format!("{down:.5e}").parse().unwrap_or(down)
}

fn shifted_planes(spec: &TurnSpec, context: &TurnContext<'_>, healed: &dyn Fn(&TurnSpec) -> bool) -> Option<Remedy> {
    let axis = axis(context);
    let shift = |t: f64| rounded(t * axis, spec, context);
    let by = |t: f64| {
        let shift = shift(t);
        TurnSpec { t0: spec.t0 + shift, t1: spec.t1 + shift, t2: spec.t2 + shift, ..*spec }
    };
    let reach =
        100.0 * ((spec.t1 - context.part.viewpoint).length() + (spec.viewpoint - context.part.viewpoint).length());
    smallest(|t| healed(&by(t)), reach).map(|t| Remedy::MovePlanes { by: shift(t) })
}

fn viewpoint_back(
    spec: &TurnSpec,
    context: &TurnContext<'_>,
    past: f64,
    healed: &dyn Fn(&TurnSpec) -> bool,
) -> Option<Remedy> {
    let normal = match spec.pencil {
        Pencil::Parallel { normal } => normal.normalize(),
        Pencil::Line { point, dir } => (spec.t1 - point).cross(dir).normalize(),
    };
    let back = normal * (context.part.viewpoint - spec.t1).dot(normal).signum();
    let to = |t: f64| TurnSpec { viewpoint: rounded(spec.viewpoint + t * back, spec, context), ..*spec };
    let reach = 100.0 * (past + (spec.t1 - context.part.viewpoint).length());
    smallest(|t| healed(&to(t)), reach).map(|t| Remedy::MovePoint { name: "viewpoint", to: to(t).viewpoint })
}

fn start_towards_bend(
    spec: &TurnSpec,
    context: &TurnContext<'_>,
    healed: &dyn Fn(&TurnSpec) -> bool,
) -> Option<Remedy> {
    let to = |t: f64| TurnSpec { t0: rounded(spec.t0.lerp(spec.t1, t), spec, context), ..*spec };
    smallest(|t| healed(&to(t)), 1.0 - 1e-6).map(|t| Remedy::MovePoint { name: "t0", to: to(t).t0 })
}

fn end_at(spec: &TurnSpec, context: &TurnContext<'_>, t: f64) -> TurnSpec {
    TurnSpec { t2: rounded(spec.t2.lerp(spec.t1, t * (1.0 - 1e-6)), spec, context), ..*spec }
}

fn turned_planes(spec: &TurnSpec, context: &TurnContext<'_>, healed: &dyn Fn(&TurnSpec) -> bool) -> Option<Remedy> {
    let axis = axis(context);
    match spec.pencil {
        Pencil::Parallel { normal } => {
            let normal = normal.normalize();
            let ahead = if normal.dot(axis) < 0.0 { -normal } else { normal };
            let short = |v: f64| format!("{v:.6}").parse().unwrap_or(v) + 0.0;
            let turned = |t: f64| ahead.lerp(axis, t).normalize().to_array().map(short).into();
            let with = |t: f64| TurnSpec { pencil: Pencil::Parallel { normal: turned(t) }, ..*spec };
            smallest(|t| healed(&with(t)), 1.0).map(|t| Remedy::Normal { normal: turned(t) })
        }
        Pencil::Line { point, dir } => {
            let foot = point + (spec.t1 - point).project_onto(dir);
            let (arm, across) = (foot - spec.t1, (foot - spec.t1).reject_from(axis));
            let to = |t: f64| rounded(spec.t1 + arm.length() * arm.lerp(across, t).normalize_or_zero(), spec, context);
            let with = |t: f64| TurnSpec { pencil: Pencil::Line { point: to(t), dir }, ..*spec };
            smallest(|t| healed(&with(t)), 1.0).map(|t| Remedy::MovePoint { name: "line.point", to: to(t) })
        }
    }
}

/// The line moves within t1, away from the bend point.
fn line_away(spec: &TurnSpec, context: &TurnContext<'_>, healed: &dyn Fn(&TurnSpec) -> bool) -> Option<Remedy> {
    let Pencil::Line { point, dir } = spec.pencil else { return None };
    let away: DVec3 = (point - spec.t1).reject_from(dir);
    let to = |t: f64| rounded(point + t * away, spec, context);
    let with = |t: f64| TurnSpec { pencil: Pencil::Line { point: to(t), dir }, ..*spec };
    smallest(|t| healed(&with(t)), 1000.0).map(|t| Remedy::MovePoint { name: "line.point", to: to(t) })
}

/// Both turns get narrower by one factor; the straight parts do not depend on t0 and t2.
fn shrunk(spec: &TurnSpec, context: &TurnContext<'_>) -> Option<Remedy> {
    let previous = context.previous.as_ref()?;
    let narrower = |s: &TurnSpec, t: f64| TurnSpec { t0: s.t0.lerp(s.t1, t), t2: s.t2.lerp(s.t1, t), ..*s };
    let valid = |t: f64| {
        let before = narrower(&previous.spec, t);
        let Ok(unscaled) = UnscaledTurn::new(&before, context.turn - 1, &previous.part) else { return false };
        let forms = unscaled.forms(&previous.part, before.viewpoint);
        let end = |px: &DVec2| forms.end(corner_direction(*px, context.root, &previous.part));
        let ends = context.corners.iter().map(end).collect();
        let narrow = TurnContext { previous: Some(PreviousTurn { ends, ..previous.clone() }), ..context.clone() };
        heals(&narrower(spec, t), &narrow)
    };
    smallest(valid, 1.0).map(|t| Remedy::Shrink { factor: floor(1.0 - t) })
}
