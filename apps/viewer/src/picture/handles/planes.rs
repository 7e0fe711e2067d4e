//! Planes of turns, drawn where they meet the ground and dragged along the view; viewpoints where they are in the picture.

use super::{Way, dragged, handle, place};
use crate::language::{fill, tr};
use crate::model::Model;
use crate::panels::set_stage;
use crate::widgets::nudged;
use belvedere::core::{DVec2, DVec3, View};
use belvedere::scene::Scene;
use belvedere::scene_file::{StageDoc, TurnDoc};
use eframe::egui::{Color32, Id, Pos2, Rect, Shape, Stroke, Ui, vec2};

/// Places of a plane along the view that are tried, and points of its line on the ground.
const PLACES: usize = 64;
const POINTS: i32 = 24;
/// Least distance between planes, in that of the first from the last.
const APART: f64 = 0.01;
/// Step of the arrow keys, in the range of the plane, and for viewpoints in points.
const STEP: f64 = 0.01;
const NUDGE: f32 = 4.0;
/// Longest piece of a drawn line, points; longer ones span a fold of the picture.
const LONGEST: f32 = 160.0;

const COLORS: [Color32; 3] =
    [Color32::from_rgb(0, 120, 96), Color32::from_rgb(200, 60, 130), Color32::from_rgb(0, 120, 96)];
const VIEWPOINT: Color32 = Color32::from_rgb(30, 96, 170);

/// Shows planes and viewpoints of all turns.
pub(super) fn show(ui: &mut Ui, (id, rect): (Id, Rect), view: &View, model: &mut Model) {
    let Some(StageDoc::CurvedRays(stage)) = model.stage("curved_rays").cloned() else { return };
    let Some(scene) = model.shown.as_ref().map(|shown| shown.session.scene()) else { return };
    let mut next = stage.clone();
    let mut begins = false;
    let mut eye = view.pinhole().eye;
    for (i, turn) in stage.turn.iter().enumerate() {
        for (part, color) in COLORS.into_iter().enumerate() {
            let own = id.with(("plane", i, part));
            begins |= plane(ui, (own, rect), view, (scene, eye), (turn, &mut next.turn[i]), (i + 1, part, color));
        }
        begins |= viewpoint(ui, (id.with(("viewpoint", i)), rect), view, (i + 1, turn), &mut next.turn[i]);
        eye = DVec3::from_array(turn.viewpoint);
    }
    if begins {
        model.begin_gesture();
    }
    if next != stage {
        model.edit_on(Id::unique("planes in the picture"), |document| set_stage(document, StageDoc::CurvedRays(next)));
    }
}

/// Points on the three planes of a turn.
fn points(turn: &TurnDoc) -> [DVec3; 3] {
    [turn.t0, turn.t1, turn.t2].map(DVec3::from_array)
}

/// The direction in which planes are moved: from the first to the last.
fn through(turn: &TurnDoc) -> DVec3 {
    let [first, _, last] = points(turn);
    turn.normal.map(DVec3::from_array).filter(|n| n.dot(last - first) > 0.0).unwrap_or(last - first).normalize_or_zero()
}

/// Normal of the plane through a point.
fn normal(turn: &TurnDoc, point: DVec3) -> DVec3 {
    match turn.line {
        Some(line) => {
            let across = DVec3::from_array(line.dir).cross(point - DVec3::from_array(line.point));
            across.normalize_or(through(turn))
        }
        None => through(turn),
    }
}

/// Distances between which a plane may stand, from its point on, along the direction of the turn.
///
/// * `eye`: viewpoint before the turn.
fn range(turn: &TurnDoc, part: usize, eye: DVec3) -> [f64; 2] {
    let along = through(turn);
    let at = points(turn).map(|p| p.dot(along));
    let (before, gap) = (eye.dot(along), APART * (at[2] - at[0]).abs());
    let [low, high] = match part {
        0 => [before + 0.05 * (at[1] - before), at[1] - gap],
        1 => [at[0] + gap, at[2] - gap],
        _ => [at[1] + gap, at[1] + 3.0 * (at[2] - before).abs()],
    };
    [(low - at[part]).min(0.0), (high - at[part]).max(0.0)]
}

/// Height of the ground.
fn ground(scene: &Scene, xy: DVec2) -> f64 {
    scene.terrain().and_then(|terrain| terrain.surface_at(xy)).unwrap_or_else(|| scene.bounds().min.z)
}

/// Where a plane meets the ground below or above a point of it, straight down within the plane; `None` for a level plane.
fn foot(scene: &Scene, point: DVec3, normal: DVec3) -> Option<DVec3> {
    let down = -(DVec3::Z - normal.z * normal).try_normalize()?;
    let over = |p: DVec3| p.z - ground(scene, p.truncate());
    let above = over(point);
    let down = if above >= 0.0 { down } else { -down };
    let step = 0.125 * above.abs().max(1e-3) / down.z.abs().max(0.05);
    let is_past = |p: DVec3| (over(p) >= 0.0) != (above >= 0.0);
    let to = (1..=200).map(|k| point + f64::from(k) * step * down).find(|p| is_past(*p))?;
    let (mut from, mut to) = (to - step * down, to);
    for _ in 0..24 {
        let middle = 0.5 * (from + to);
        if is_past(middle) { to = middle } else { from = middle }
    }
    Some(0.5 * (from + to))
}

/// The line in which a plane meets the ground.
fn line(scene: &Scene, point: DVec3, normal: DVec3, foot: DVec3, reach: f64) -> Vec<DVec3> {
    let Some(across) = normal.cross(DVec3::Z).try_normalize() else { return Vec::new() };
    let level = normal.truncate();
    let on_ground = |i: i32| {
        let mut p = foot + reach * f64::from(i) / f64::from(POINTS) * across;
        // A slanted plane meets high ground elsewhere.
        for _ in 0..3 {
            p.z = ground(scene, p.truncate());
            let off = (p - point).dot(normal) / level.length_squared().max(0.05);
            p -= (off * level).extend(0.0);
        }
        p.with_z(ground(scene, p.truncate()))
    };
    (-POINTS..=POINTS).map(on_ground).collect()
}

/// One plane; whether a step of undo begins.
fn plane(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    view: &View,
    (scene, eye): (&Scene, DVec3),
    (turn, next): (&TurnDoc, &mut TurnDoc),
    (n, part, color): (usize, usize, Color32),
) -> bool {
    let (point, along) = (points(turn)[part], through(turn));
    let at_distance = |d: f64| {
        let moved = point + d * along;
        foot(scene, moved, normal(turn, moved))
    };
    let Some(on_ground) = at_distance(0.0) else { return false };
    draw(ui, rect, view, &line(scene, point, normal(turn, point), on_ground, 0.6 * eye.distance(on_ground)), color);
    let Some(at) = place(view, on_ground, rect).filter(|at| rect.shrink(4.0).contains(*at)) else { return false };
    let name = match part {
        0 => fill(tr("First plane of turn {0} in the picture"), &[&n]),
        1 => fill(tr("Bend point of turn {0} in the picture"), &[&n]),
        _ => fill(tr("Last plane of turn {0} in the picture"), &[&n]),
    };
    let response = handle(ui, (rect, id), at, (&name, color));
    let [low, high] = range(turn, part, eye);
    let base = point.dot(along);
    let way = || {
        let one = |k: usize| {
            // Near places are closer together, as they are wider apart in the picture.
            let share = (k as f64 / PLACES as f64).powi(2);
            let d = low + share * (high - low);
            Some((base + d, place(view, at_distance(d)?, rect)?))
        };
        Way((0..=PLACES).filter_map(one).collect())
    };
    let wanted = dragged(ui, &response, at, way);
    let pressed = nudged(ui, &response).map(|[_, up]| base + up * STEP * (high - low).min(eye.distance(point)));
    let Some(to) = wanted.or(pressed) else { return response.drag_started() };
    let moved = (point + (to - base).clamp(low, high) * along).to_array();
    *[&mut next.t0, &mut next.t1, &mut next.t2][part] = moved;
    response.drag_started() || pressed.is_some()
}

/// A line over the picture.
fn draw(ui: &Ui, rect: Rect, view: &View, points: &[DVec3], color: Color32) {
    let places: Vec<Option<Pos2>> = points.iter().map(|p| place(view, *p, rect)).collect();
    let painter = ui.painter_at(rect);
    for pair in places.windows(2) {
        let [Some(a), Some(b)] = [pair[0], pair[1]] else { continue };
        if a.distance(b) < LONGEST {
            painter.line_segment([a, b], Stroke::new(3.0, Color32::from_white_alpha(130)));
            painter.extend(Shape::dashed_line(&[a, b], Stroke::new(1.5, color), 6.0, 3.0));
        }
    }
}

/// A viewpoint that is in the picture: it is moved beside the direction of view.
fn viewpoint(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    view: &View,
    (n, turn): (usize, &TurnDoc),
    next: &mut TurnDoc,
) -> bool {
    let point = DVec3::from_array(turn.viewpoint);
    let pinhole = view.pinhole();
    let depth = (point - pinhole.eye).dot(pinhole.forward);
    let straight = view.straightened();
    let inside = place(&straight, point, rect).filter(|at| depth > pinhole.near && rect.shrink(4.0).contains(*at));
    let Some(at) = inside else { return false };
    let name = fill(tr("Viewpoint of turn {0} in the picture"), &[&n]);
    let response = handle(ui, (rect, id), at, (&name, VIEWPOINT));
    let pressed = nudged(ui, &response).map(|[x, y]| NUDGE * vec2(x as f32, -y as f32));
    let by = Some(response.drag_delta()).filter(|by| response.dragged() && *by != vec2(0.0, 0.0)).or(pressed);
    let Some(by) = by else { return response.drag_started() };
    let [w, h] = pinhole.image.map(f64::from);
    let to = (at + by - rect.min) / rect.size();
    let (start, direction) = pinhole.line(DVec2::new(f64::from(to.x) * w, f64::from(to.y) * h));
    let reach = (depth - (start - pinhole.eye).dot(pinhole.forward)) / direction.dot(pinhole.forward);
    next.viewpoint = (start + reach * direction).to_array();
    response.drag_started() || pressed.is_some()
}

#[cfg(test)]
mod tests;
