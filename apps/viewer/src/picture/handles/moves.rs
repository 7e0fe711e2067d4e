//! Handles of ground that is moved by hand: one at each place or line, dragged where the ground is to go.

use super::{Way, dragged, handle, place};
use crate::language::{fill, tr};
use crate::model::Model;
use crate::panels::moves::{name, put, stage};
use crate::widgets::nudged;
use belvedere::core::{DVec2, DVec3, Stage, View};
use belvedere::scene::Scene;
use belvedere::scene_file::{MoveDoc, MoveKindDoc};
use eframe::egui::{Color32, Id, Pos2, Rect, Ui, Vec2, vec2};

/// Values that are tried along the way of a handle.
const PLACES: i32 = 64;
/// Step of the arrow keys, as a share of the way, and for shifts in points.
const STEP: f64 = 0.01;
const NUDGE: f32 = 4.0;
const COLOR: Color32 = Color32::from_rgb(176, 92, 0);

/// Shows the handle of each move.
pub(super) fn show(ui: &mut Ui, (id, rect): (Id, Rect), view: &View, model: &mut Model) {
    let stage = stage(model);
    let Some(scene) = model.shown.as_ref().map(|shown| shown.session.scene()) else { return };
    let later = view.stages().iter().filter(|stage| !matches!(stage, Stage::GroundMoves(_))).cloned().collect();
    let Ok(later) = View::new(view.pinhole().clone(), later) else { return };
    let mut next = stage.clone();
    let mut begins = false;
    for (k, one) in stage.moves.iter().enumerate() {
        let words = fill(tr("Move {0} in the picture: {1}"), &[&(k + 1), &name(one.kind)]);
        let own = (id.with(("move", k)), rect);
        begins |= match one.kind {
            MoveKindDoc::Shift => shift(ui, own, (&later, scene), (one, &words), &mut next.moves[k]),
            _ => along(ui, own, (&later, scene), (one, &words), &mut next.moves[k]),
        };
    }
    if begins {
        model.begin_gesture();
    }
    if next != stage {
        put(model, Id::unique("moves in the picture"), next);
    }
}

/// A place on the ground as it lies before moves.
fn on_ground(scene: &Scene, xy: DVec2) -> DVec3 {
    let height = scene.terrain().and_then(|terrain| terrain.surface_at(xy));
    xy.extend(height.unwrap_or_else(|| scene.bounds().min.z))
}

/// The handle of a shift follows the pointer over the ground; whether a step of undo begins.
fn shift(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    (later, scene): (&View, &Scene),
    (one, words): (&MoveDoc, &str),
    next: &mut MoveDoc,
) -> bool {
    let Some(at) = one.at.map(DVec2::from_array) else { return false };
    let (ground, by) = (on_ground(scene, at), DVec2::from_array(one.shift_m.unwrap_or_default()));
    let seen = |by: DVec2| place(later, ground + by.extend(0.0), rect);
    let Some(here) = seen(by).filter(|at| rect.shrink(4.0).contains(*at)) else { return false };
    let response = handle(ui, (rect, id), here, (words, COLOR));
    let pressed = nudged(ui, &response).map(|[x, y]| NUDGE * vec2(x as f32, -y as f32));
    let moved = Some(response.drag_delta()).filter(|d| response.dragged() && *d != Vec2::ZERO).or(pressed);
    let Some(moved) = moved else { return response.drag_started() };
    // How the handle moves in the picture as it moves over the ground.
    let step = 0.01 * one.reach_m;
    let [Some(x), Some(y)] = [DVec2::X, DVec2::Y].map(|axis| seen(by + step * axis)) else { return false };
    let points = |d: Vec2| DVec2::new(f64::from(d.x), f64::from(d.y));
    let (x, y, d) = (points(x - here) / step, points(y - here) / step, points(moved));
    let area = x.perp_dot(y);
    if area.abs() > 1e-6 * x.length() * y.length() {
        let by = by + DVec2::new(d.perp_dot(y), x.perp_dot(d)) / area;
        next.shift_m = Some(by.clamp_length_max(0.5 * one.reach_m).to_array());
    }
    response.drag_started() || pressed.is_some()
}

/// A value of a move, the range of the handle, and where the handle stands for each value.
struct Lever<'a> {
    value: f64,
    range: [f64; 2],
    at: Box<dyn Fn(f64) -> DVec3 + 'a>,
}

/// The handle of a move that has one value; whether a step of undo begins.
fn along(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    (later, scene): (&View, &Scene),
    (one, words): (&MoveDoc, &str),
    next: &mut MoveDoc,
) -> bool {
    let Some(lever) = lever(scene, one) else { return false };
    let seen = |value: f64| -> Option<Pos2> { place(later, (lever.at)(value), rect) };
    let Some(here) = seen(lever.value).filter(|at| rect.shrink(4.0).contains(*at)) else { return false };
    let response = handle(ui, (rect, id), here, (words, COLOR));
    let [low, high] = lever.range;
    let way = || {
        let values = (0..=PLACES).map(|k| low + (high - low) * f64::from(k) / f64::from(PLACES));
        Way(values.filter_map(|value| Some((value, seen(value)?))).collect())
    };
    let wanted = dragged(ui, &response, here, way);
    let pressed = nudged(ui, &response).map(|[x, y]| lever.value + (x + y) * STEP * (high - low));
    let Some(value) = wanted.or(pressed) else { return response.drag_started() };
    let value = Some(value.clamp(low, high));
    match one.kind {
        MoveKindDoc::Turn => next.angle_deg = value,
        MoveKindDoc::Straighten => next.share = value,
        _ => next.by_m = value,
    }
    response.drag_started() || pressed.is_some()
}

fn lever<'a>(scene: &'a Scene, one: &MoveDoc) -> Option<Lever<'a>> {
    let reach = one.reach_m;
    let core = one.core_m.unwrap_or(0.25 * reach);
    Some(match one.kind {
        MoveKindDoc::Raise => {
            let ground = on_ground(scene, DVec2::from_array(one.at?));
            let at = move |by: f64| ground + by * DVec3::Z;
            Lever { value: one.by_m?, range: [-0.5 * reach, 0.5 * reach], at: Box::new(at) }
        }
        MoveKindDoc::Turn => {
            // A point of the rim, which starts in the east.
            let middle = on_ground(scene, DVec2::from_array(one.at?));
            let radius = core.max(0.1 * reach);
            let at = move |deg: f64| middle + radius * DVec2::from_angle(deg.to_radians()).extend(0.0);
            Lever { value: one.angle_deg?, range: [-90.0, 90.0], at: Box::new(at) }
        }
        MoveKindDoc::Widen => {
            let (middle, side, _) = of_line(scene, one)?;
            let edge = on_ground(scene, middle + core * side);
            let at = move |by: f64| edge + (by * side).extend(0.0);
            Lever { value: one.by_m?, range: [-0.25 * reach, 0.5 * reach], at: Box::new(at) }
        }
        MoveKindDoc::Straighten => {
            let (from, _, goal) = of_line(scene, one)?;
            let ground = on_ground(scene, from);
            let at = move |share: f64| ground + (share * (goal - from)).extend(0.0);
            Lever { value: one.share.unwrap_or(1.0), range: [0.0, 1.0], at: Box::new(at) }
        }
        MoveKindDoc::Shift => return None,
    })
}

/// The middle of a move's line, or where it is to be straightened the point that goes farthest; the direction to its left there, and
/// where straightening takes it.
fn of_line(scene: &Scene, one: &MoveDoc) -> Option<(DVec2, DVec2, DVec2)> {
    let line: Vec<DVec2> = match (&one.along, &one.path) {
        (Some(id), _) => {
            let lines = scene.layers.iter().find(|l| l.id == *id)?.kind.lines()?;
            let gap = scene.terrain().map_or(1.0, |t| 20.0 * t.spacing().max_element());
            lines.longest_chain(gap).iter().map(|p| p.truncate()).collect()
        }
        (None, path) => path.as_ref()?.iter().copied().map(DVec2::from_array).collect(),
    };
    let steps = line.windows(2).scan(0.0, |sum, pair| {
        *sum += pair[0].distance(pair[1]);
        Some(*sum)
    });
    let along: Vec<f64> = std::iter::once(0.0).chain(steps).collect();
    let (from, to) = (one.from_m.unwrap_or(0.0), one.to_m.unwrap_or(f64::INFINITY));
    let inside: Vec<usize> = (0..line.len()).filter(|k| (from..=to).contains(&along[*k])).collect();
    let (first, last) = (*inside.first()?, *inside.last()?);
    let length = (along[last] - along[first]).max(f64::MIN_POSITIVE);
    let goal = |k: usize| line[first].lerp(line[last], (along[k] - along[first]) / length);
    let off = |k: &usize| line[*k].distance(goal(*k));
    let k = match one.kind {
        MoveKindDoc::Straighten => inside.iter().copied().max_by(|a, b| off(a).total_cmp(&off(b)))?,
        _ => *inside.get(inside.len() / 2)?,
    };
    let ahead = line[(k + 1).min(line.len() - 1)] - line[k.saturating_sub(1)];
    Some((line[k], ahead.perp().try_normalize()?, goal(k)))
}
