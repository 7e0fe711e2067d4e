//! From a broken row to a message with the nearest valid value.

use super::check::{Broken, Earlier, Raw, Surroundings, axis, corner_direction, corner_pixels};
use super::spec::{CurvedRaysError, Pencil, Remedy, TurnSpec};
use glam::DVec3;

/// The message for a broken row of a turn.
pub(super) fn report(broken: Broken, spec: &TurnSpec, around: &Surroundings<'_>) -> CurvedRaysError {
    let turn = around.turn;
    let viewpoint = turn - 1;
    let remedy = remedy(broken, spec, around);
    match broken {
        Broken::Order { depths: [t0, t1, t2] } => CurvedRaysError::PlaneOrder { turn, viewpoint, t0, t1, t2, remedy },
        Broken::PreviousPastBend { past } => CurvedRaysError::PreviousPastBend { turn, viewpoint, past, remedy },
        Broken::ViewpointPastBend { past } => CurvedRaysError::ViewpointPastBend { turn, past, remedy },
        Broken::PreviousPastStart { past } => CurvedRaysError::PreviousPastStart { turn, viewpoint, past, remedy },
        Broken::BendNotMet { pixel, slope } => CurvedRaysError::BendNotMet { turn, viewpoint, pixel, slope, remedy },
        Broken::LineInPicture { pixel, beyond } => CurvedRaysError::LineInPicture { turn, pixel, beyond, remedy },
        Broken::EndNotReached { pixel, sigma, limit } => {
            CurvedRaysError::EndNotReached { turn, pixel, sigma, limit, remedy }
        }
        Broken::TurnsOverlap { pixel, end, start } => CurvedRaysError::TurnsOverlap { turn, pixel, end, start, remedy },
        Broken::NearPastStart { pixel, start } => {
            CurvedRaysError::NearPastStart { pixel, near: around.root.near, start, remedy }
        }
    }
}

fn remedy(broken: Broken, spec: &TurnSpec, around: &Surroundings<'_>) -> Remedy {
    let healed = |candidate: &TurnSpec| heals(broken, candidate, around);
    let found = match broken {
        Broken::Order { depths } => {
            let swapped = TurnSpec { t0: spec.t2, t2: spec.t0, ..*spec };
            if depths[0] > depths[2] && healed(&swapped) {
                Some(Remedy::SwapPlanes)
            } else {
                shifted_planes(spec, around, &healed)
            }
        }
        Broken::PreviousPastBend { .. } => shifted_planes(spec, around, &healed),
        Broken::ViewpointPastBend { past } => viewpoint_back(spec, around, past, &healed),
        Broken::PreviousPastStart { .. } => start_towards_bend(spec, &healed),
        Broken::BendNotMet { .. } => turned_planes(spec, around, &healed),
        Broken::LineInPicture { .. } => line_away(spec, &healed),
        Broken::EndNotReached { .. } => smallest(|t| healed(&end_at(spec, t)), 1.0)
            .map(|t| Remedy::MovePoint { name: "t2", to: end_at(spec, t).t2 }),
        Broken::TurnsOverlap { .. } => shrunk(broken, spec, around),
        Broken::NearPastStart { .. } => {
            let raw = Raw::new(spec, around.turn, &around.part).ok().map(|raw| raw.forms(&around.part, spec.viewpoint));
            let start = raw.map(|forms| {
                corner_pixels(around.root).map(|px| forms.start(corner_direction(px, around.root, &around.part)))
            });
            let near = start.map_or(0.0, |s| s.into_iter().fold(f64::INFINITY, f64::min)) * (1.0 - 1e-9);
            if near > 0.0 { Some(Remedy::Near { near }) } else { start_towards_bend(spec, &healed) }
        }
    };
    found.unwrap_or(Remedy::Rebuild)
}

/// Whether a changed turn passes the broken row and all before it.
fn heals(broken: Broken, candidate: &TurnSpec, around: &Surroundings<'_>) -> bool {
    Raw::new(candidate, around.turn, &around.part)
        .is_ok_and(|raw| raw.rows(candidate, around).err().is_none_or(|now| now.row() > broken.row()))
}

/// Smallest `t` in (0, `end`] with `valid(t)`, to about a millionth, assuming that `valid` stays once it holds.
fn smallest(valid: impl Fn(f64) -> bool, end: f64) -> Option<f64> {
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

fn shifted_planes(spec: &TurnSpec, around: &Surroundings<'_>, healed: &dyn Fn(&TurnSpec) -> bool) -> Option<Remedy> {
    let axis = axis(around);
    let by = |t: f64| TurnSpec { t0: spec.t0 + t * axis, t1: spec.t1 + t * axis, t2: spec.t2 + t * axis, ..*spec };
    let reach =
        100.0 * ((spec.t1 - around.part.viewpoint).length() + (spec.viewpoint - around.part.viewpoint).length());
    smallest(|t| healed(&by(t)), reach).map(|t| Remedy::MovePlanes { by: t * axis })
}

fn viewpoint_back(
    spec: &TurnSpec,
    around: &Surroundings<'_>,
    past: f64,
    healed: &dyn Fn(&TurnSpec) -> bool,
) -> Option<Remedy> {
    let normal = match spec.pencil {
        Pencil::Parallel { normal } => normal.normalize(),
        Pencil::Line { point, dir } => (spec.t1 - point).cross(dir).normalize(),
    };
    let back = normal * (around.part.viewpoint - spec.t1).dot(normal).signum();
    let to = |t: f64| TurnSpec { viewpoint: spec.viewpoint + t * back, ..*spec };
    let reach = 100.0 * (past + (spec.t1 - around.part.viewpoint).length());
    smallest(|t| healed(&to(t)), reach).map(|t| Remedy::MovePoint { name: "viewpoint", to: to(t).viewpoint })
}

fn start_towards_bend(spec: &TurnSpec, healed: &dyn Fn(&TurnSpec) -> bool) -> Option<Remedy> {
    let to = |t: f64| TurnSpec { t0: spec.t0.lerp(spec.t1, t), ..*spec };
    smallest(|t| healed(&to(t)), 1.0 - 1e-6).map(|t| Remedy::MovePoint { name: "t0", to: to(t).t0 })
}

fn end_at(spec: &TurnSpec, t: f64) -> TurnSpec {
    TurnSpec { t2: spec.t2.lerp(spec.t1, t * (1.0 - 1e-6)), ..*spec }
}

fn turned_planes(spec: &TurnSpec, around: &Surroundings<'_>, healed: &dyn Fn(&TurnSpec) -> bool) -> Option<Remedy> {
    let axis = axis(around);
    match spec.pencil {
        Pencil::Parallel { normal } => {
            let normal = normal.normalize();
            let ahead = if normal.dot(axis) < 0.0 { -normal } else { normal };
            let turned = |t: f64| ahead.lerp(axis, t).normalize();
            let with = |t: f64| TurnSpec { pencil: Pencil::Parallel { normal: turned(t) }, ..*spec };
            smallest(|t| healed(&with(t)), 1.0).map(|t| Remedy::Normal { normal: turned(t) })
        }
        Pencil::Line { point, dir } => {
            let foot = point + (spec.t1 - point).project_onto(dir);
            let (arm, across) = (foot - spec.t1, (foot - spec.t1).reject_from(axis));
            let to = |t: f64| spec.t1 + arm.length() * arm.lerp(across, t).normalize_or_zero();
            let with = |t: f64| TurnSpec { pencil: Pencil::Line { point: to(t), dir }, ..*spec };
            smallest(|t| healed(&with(t)), 1.0).map(|t| Remedy::MovePoint { name: "line.point", to: to(t) })
        }
    }
}

/// The line moves within t1, away from the bend point.
fn line_away(spec: &TurnSpec, healed: &dyn Fn(&TurnSpec) -> bool) -> Option<Remedy> {
    let Pencil::Line { point, dir } = spec.pencil else { return None };
    let away: DVec3 = (point - spec.t1).reject_from(dir);
    let to = |t: f64| point + t * away;
    let with = |t: f64| TurnSpec { pencil: Pencil::Line { point: to(t), dir }, ..*spec };
    smallest(|t| healed(&with(t)), 1000.0).map(|t| Remedy::MovePoint { name: "line.point", to: to(t) })
}

/// Both turns get narrower by one factor; the straight parts do not depend on t0 and t2.
fn shrunk(broken: Broken, spec: &TurnSpec, around: &Surroundings<'_>) -> Option<Remedy> {
    let earlier = around.earlier?;
    let narrower = |s: &TurnSpec, t: f64| TurnSpec { t0: s.t0.lerp(s.t1, t), t2: s.t2.lerp(s.t1, t), ..*s };
    let valid = |t: f64| {
        let before = narrower(earlier.spec, t);
        let Ok(raw) = Raw::new(&before, around.turn - 1, &earlier.part) else { return false };
        let forms = raw.forms(&earlier.part, before.viewpoint);
        let ends = corner_pixels(around.root).map(|px| forms.end(corner_direction(px, around.root, &earlier.part)));
        let narrow = Surroundings { earlier: Some(Earlier { ends, ..earlier }), ..*around };
        heals(broken, &narrower(spec, t), &narrow)
    };
    smallest(valid, 1.0).map(|t| Remedy::Shrink { factor: 1.0 - t })
}
