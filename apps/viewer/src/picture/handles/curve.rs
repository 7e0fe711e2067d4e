//! Control points of the spline's curve, in the middle of the bent picture: up and down raises and lowers the curve.

use super::{Way, dragged, handle, place};
use crate::language::{fill, tr};
use crate::model::Model;
use crate::widgets::nudged;
use belvedere::core::map::spline::SplineBend;
use belvedere::core::presets::PresetDocument;
use belvedere::core::presets::edit::{PresetChange, PresetOperation};
use belvedere::core::{DVec2, DVec3, Stage, View};
use belvedere::scene_file::{PresetsDoc, StageDoc};
use eframe::egui::{Color32, Id, Rect, Shape, Stroke, Ui};

/// Heights of a control point that are tried, and how far from the present one, curve units.
const PLACES: i32 = 48;
const REACH: f64 = 1.2;
/// Step of the arrow keys, curve units.
const STEP: f64 = 0.01;
/// Points of the drawn curve.
const POINTS: usize = 64;

const INK: Color32 = Color32::from_rgb(190, 96, 10);

/// Shows the control points of a preset, if the picture shows it alone.
pub(super) fn show(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    view: &View,
    (presets, chosen): (&PresetDocument, usize),
    model: &mut Model,
) {
    let Some(preset) = presets.presets.get(chosen) else { return };
    let at = view.stages().iter().position(|stage| matches!(stage, Stage::SplineBend(_)));
    let Some((at, Stage::SplineBend(bend))) = at.and_then(|at| Some((at, view.stages().get(at)?))) else { return };
    let Ok(after) = View::new(view.pinhole().clone(), view.stages()[at + 1..].to_vec()) else { return };
    // Between two presets the picture shows a curve of neither. During a drag of a point it lags behind the document, and the handles stay.
    let control = |i: usize| id.with(("control", i));
    let lags = (0..preset.control.len()).any(|i| ui.ctx().is_being_dragged(control(i)));
    let stated = &bend.resolved().control;
    let same = |(a, b): (&[f64; 2], &[f64; 2])| DVec2::from(*a).distance(DVec2::from(*b)) < 1e-6;
    if stated.len() != preset.control.len() || !lags && !stated.iter().zip(&preset.control).all(same) {
        return;
    }
    let curve = bend.curve();
    let line = (0..=POINTS).map(|k| curve.at(k as f64 / POINTS as f64 * curve.length()).0);
    let line: Vec<_> = line.filter_map(|q| place(&after, world(bend, view, q), rect)).collect();
    let painter = ui.painter_at(rect);
    painter.add(Shape::line(line.clone(), Stroke::new(4.0, Color32::from_white_alpha(120))));
    painter.add(Shape::line(line, Stroke::new(1.8, INK)));
    let mut change = None;
    for (i, point) in bend.control().into_iter().enumerate() {
        let at_height = |v: f64| place(&after, world(bend, view, DVec2::new(point.x, v)), rect);
        let Some(at) = at_height(point.y).filter(|at| rect.shrink(4.0).contains(*at)) else { continue };
        let name = fill(tr("Control point {0} in the picture"), &[&(i + 1)]);
        let response = handle(ui, (rect, control(i)), at, (&name, INK));
        let [u, v] = stated[i];
        let one = |k: i32| {
            let by = REACH * f64::from(k) / f64::from(PLACES);
            Some((v + by, at_height(point.y + by)?))
        };
        let way = || Way((-PLACES..=PLACES).filter_map(one).collect());
        let wanted = dragged(ui, &response, at, way).map(|v| (v, response.drag_started()));
        let pressed = nudged(ui, &response).map(|[_, up]| (v + STEP * up, true));
        if let Some((to, begins)) = wanted.or(pressed) {
            change = Some((PresetChange::MovePoint(i + 1, [u, to]), begins));
        }
    }
    let Some((change, begins)) = change else { return };
    if begins {
        model.begin_gesture();
    }
    let preset = (chosen + 1).to_string();
    match presets.edited(&PresetOperation::Preset { preset, change }) {
        Ok(next) => model.edit_on(Id::unique("curve in the picture"), |document| {
            for stage in &mut document.stage {
                if let StageDoc::SplineBend(stage) = stage {
                    stage.presets = PresetsDoc::Inline(Box::new(next.clone()));
                }
            }
        }),
        Err(e) => model.violated = Some(e.to_string()),
    }
}

/// The point of the bent space at curve coordinates, straight ahead of the eye.
fn world(bend: &SplineBend, view: &View, q: DVec2) -> DVec3 {
    let eye = view.pinhole().eye;
    let by = bend.scale() * (q - bend.curve_position(eye));
    let [u, v] = bend.curve_axes();
    eye + by.x * u + by.y * v
}
