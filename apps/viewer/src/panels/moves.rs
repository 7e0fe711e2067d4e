//! Ground that is moved by hand: the list of moves, and how far each takes effect.

use super::{set_stage, slider};
use crate::handles::Handles;
use crate::language::{fill, later, tr};
use crate::model::{Model, Tool};
use crate::widgets::steady;
use belvedere::core::DVec3;
use belvedere::scene_file::{GroundMovesStageDoc, LayerDoc, MoveDoc, MoveKindDoc, StageDoc};
use eframe::egui::{Button, Id, Ui};
use std::ops::RangeInclusive;

const KIND: &str = "ground_moves";

/// Reach of a new move, as a share of the distance of its place from the eye, or of its line from end to end.
const REACH: f64 = 0.25;
/// Height of a new rise, and width of a new widening, as shares of the reach.
const RISE: f64 = 0.12;
const WIDENING: f64 = 0.1;
/// Angle of a new turn, degrees.
const TURN: f64 = 20.0;
/// Share of the reach up to which the ground moves in full.
const CORE: f64 = 0.25;
/// A move that is carried out by less than this says so.
const WHOLE: f64 = 0.98;

const PLACED: [(MoveKindDoc, &str); 3] =
    [(MoveKindDoc::Raise, later("Raise")), (MoveKindDoc::Shift, later("Shift")), (MoveKindDoc::Turn, later("Turn"))];
const ALONG: [(MoveKindDoc, &str); 2] =
    [(MoveKindDoc::Widen, later("Widen")), (MoveKindDoc::Straighten, later("Straighten"))];

/// The word of a kind.
pub(crate) fn name(kind: MoveKindDoc) -> &'static str {
    let known = PLACED.iter().chain(&ALONG).find(|(one, _)| *one == kind);
    known.map_or("", |(_, name)| tr(name))
}

/// The moves of the document.
pub(crate) fn stage(model: &Model) -> GroundMovesStageDoc {
    match model.stage(KIND) {
        Some(StageDoc::GroundMoves(stage)) => stage.clone(),
        _ => GroundMovesStageDoc::default(),
    }
}

/// Puts moves into the document; a stage without any goes.
pub(crate) fn put(model: &mut Model, by: Id, stage: GroundMovesStageDoc) {
    model.edit_on(by, |document| {
        if stage.moves.is_empty() {
            document.stage.retain(|stage| stage.kind() != KIND);
        } else {
            set_stage(document, StageDoc::GroundMoves(stage));
        }
    });
}

/// Shows the part of the panel.
pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    ui.strong(tr("Moved by hand"));
    ui.horizontal_wrapped(|ui| {
        for (kind, label) in PLACED {
            let is_chosen = model.look.tool == Tool::Move(kind);
            if ui.add(Button::new(tr(label)).selected(is_chosen)).clicked() {
                model.look.tool = if is_chosen { Tool::Map } else { Tool::Move(kind) };
            }
        }
        for (kind, label) in ALONG {
            ui.menu_button(tr(label), |ui| lines(ui, model, kind));
        }
    });
    if matches!(model.look.tool, Tool::Move(_)) {
        ui.weak(tr("Click the place in the picture."));
    }
    let stage = stage(model);
    for (index, one) in stage.moves.iter().enumerate() {
        steady(ui, ("move", index), |ui| row(ui, model, (&stage, index), one));
    }
    model.handles = Some(Handles::Moves);
}

/// The line layers along which the ground can be moved.
fn lines(ui: &mut Ui, model: &mut Model, kind: MoveKindDoc) {
    let document = model.document().clone();
    let ids: Vec<&str> = document.layer.iter().filter(|l| matches!(l, LayerDoc::Line(_))).map(LayerDoc::id).collect();
    if ids.is_empty() {
        ui.weak(tr("There is no layer of lines."));
    }
    for id in ids {
        if ui.button(id).clicked() {
            let Some(length) = from_end_to_end(model, id) else { return };
            let reach = round(REACH * length);
            let widens = (kind == MoveKindDoc::Widen).then(|| round(WIDENING * reach));
            let share = (kind == MoveKindDoc::Straighten).then_some(0.5);
            add(model, MoveDoc { along: Some(id.to_owned()), by_m: widens, share, ..MoveDoc::of(kind, reach) });
        }
    }
}

/// Greatest extent of a layer's lines, scene units.
fn from_end_to_end(model: &Model, id: &str) -> Option<f64> {
    let scene = model.shown.as_ref()?.session.scene();
    let points = scene.layers.iter().find(|l| l.id == id)?.kind.lines()?.longest_chain(f64::INFINITY);
    let bounds = belvedere::core::Aabb::of(points);
    (!bounds.is_empty()).then(|| (bounds.max - bounds.min).truncate().length())
}

/// A new move at a place that was clicked.
pub(crate) fn place(model: &mut Model, kind: MoveKindDoc, point: DVec3) {
    let Some(eye) = model.shown.as_ref().map(|shown| shown.session.view().pinhole().eye) else { return };
    let reach = round(REACH * eye.distance(point));
    let new = MoveDoc::of(kind, reach);
    let at = Some([point.x, point.y].map(|v| round_to(v, 0.01 * reach)));
    let new = match kind {
        MoveKindDoc::Raise => MoveDoc { at, by_m: Some(round(RISE * reach)), ..new },
        MoveKindDoc::Turn => MoveDoc { at, angle_deg: Some(TURN), ..new },
        _ => MoveDoc { at, shift_m: Some([0.0, 0.0]), ..new },
    };
    add(model, new);
}

fn add(model: &mut Model, new: MoveDoc) {
    let mut next = stage(model);
    next.moves.push(new);
    model.begin_gesture();
    put(model, Id::unique("a new move"), next);
}

/// A value with two digits.
fn round(value: f64) -> f64 {
    round_to(value, 10f64.powf(value.abs().max(1e-9).log10().floor() - 1.0))
}

/// A value to the power of ten below a step.
fn round_to(value: f64, step: f64) -> f64 {
    let digits = -step.max(1e-9).log10().floor();
    let scale = 10f64.powf(digits.abs()).round();
    if digits > 0.0 { (value * scale).round() / scale } else { (value / scale).round() * scale }
}

/// One move: its name, the values of its kind, how far it takes effect.
fn row(ui: &mut Ui, model: &mut Model, (stage, index): (&GroundMovesStageDoc, usize), one: &MoveDoc) {
    let place = one.along.as_ref().map_or_else(String::new, |id| format!("  {id}"));
    let mut changed = stage.clone();
    let mut gone = false;
    ui.horizontal(|ui| {
        ui.label(format!("{}. {}{place}", index + 1, name(one.kind)));
        gone = ui.button(fill(tr("Remove move {0}"), &[&(index + 1)])).clicked();
    });
    if gone {
        changed.moves.remove(index);
        model.begin_gesture();
        put(model, Id::unique("a move removed"), changed);
        return;
    }
    let mut next = one.clone();
    let mut by = None;
    for value in values(one) {
        if let Some((id, set)) = slider(ui, model, value.name, value.now, value.range, value.help) {
            by = Some(id);
            (value.set)(&mut next, set);
        }
    }
    let shown = model.shown.as_ref().and_then(|shown| shown.session.moves_report());
    if let Some(one) = shown.and_then(|report| report.moves.get(index)).filter(|one| one.carried_out < WHOLE) {
        ui.weak(fill(tr("carried out by {0}"), &[&super::percent(Some(one.carried_out))]));
    }
    if let Some(by) = by {
        changed.moves[index] = next;
        put(model, by, changed);
    }
}

/// A value of a move and its slider.
struct Value {
    name: &'static str,
    now: f64,
    range: RangeInclusive<f64>,
    help: &'static str,
    set: fn(&mut MoveDoc, f64),
}

/// The values of a move.
fn values(one: &MoveDoc) -> Vec<Value> {
    let reach = one.reach_m;
    let half = -0.5 * reach..=0.5 * reach;
    let value = |name, now, range, help, set| Value { name, now, range, help, set };
    let by = one.by_m.unwrap_or_default();
    let mut all = match one.kind {
        MoveKindDoc::Raise => {
            let help = tr("height that the ground rises; negative sinks it");
            vec![value(tr("height, m"), by, half, help, |doc, v| doc.by_m = Some(v))]
        }
        MoveKindDoc::Turn => {
            let (now, help) = (one.angle_deg.unwrap_or_default(), tr("counter-clockwise as seen from above"));
            vec![value(tr("angle, °"), now, -90.0..=90.0, help, |doc, v| doc.angle_deg = Some(v))]
        }
        MoveKindDoc::Shift => {
            let ([east, north], help) =
                (one.shift_m.unwrap_or_default(), tr("drag the handle in the picture, or set it here"));
            let set_east = |doc: &mut MoveDoc, v| doc.shift_m = Some([v, doc.shift_m.unwrap_or_default()[1]]);
            let set_north = |doc: &mut MoveDoc, v| doc.shift_m = Some([doc.shift_m.unwrap_or_default()[0], v]);
            vec![
                value(tr("east, m"), east, half.clone(), help, set_east),
                value(tr("north, m"), north, half, help, set_north),
            ]
        }
        MoveKindDoc::Widen => {
            let help = tr("how far each side goes away from the line");
            vec![value(tr("each side, m"), by, -0.25 * reach..=0.5 * reach, help, |doc, v| doc.by_m = Some(v))]
        }
        MoveKindDoc::Straighten => {
            let (now, help) = (one.share.unwrap_or(1.0), tr("share of the way to the straight line between the ends"));
            vec![value(tr("straighter"), now, 0.0..=1.0, help, |doc, v| doc.share = Some(v))]
        }
    };
    let help = tr("distance up to which the ground moves in full");
    let core = one.core_m.unwrap_or(CORE * reach);
    all.push(value(tr("core, m"), core, 0.0..=0.9 * reach, help, |doc, v| doc.core_m = Some(v)));
    let help = tr("distance beyond which nothing moves");
    let set_reach = |doc: &mut MoveDoc, v| {
        // The core keeps its share of the reach.
        doc.core_m = doc.core_m.map(|core| core * v / doc.reach_m);
        doc.reach_m = v;
    };
    all.push(value(tr("reach, m"), reach, 0.2 * reach..=3.0 * reach, help, set_reach));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn new_values_are_round() {
        assert_eq!([round(1234.0), round(0.037_8), round(98.7)], [1200.0, 0.038, 99.0]);
        assert_eq!([round_to(382_642.4, 12.0), round_to(-5.678, 0.02)], [382_640.0, -5.68]);
    }
}
