//! Curved rays: turns by hand, constructors that find them.

use super::{choice, number, set_stage, slider};
use crate::handles::Handles;
use crate::language::{fill, later, tr};
use crate::model::{Model, Tool};
use belvedere::core::DVec3;
use belvedere::core::map::curved_rays::{Model as RayModel, Sharpness};
use belvedere::scene_file::{ConstructorDoc, ConstructorKind, LayerDoc, RaysStageDoc, StageDoc, TurnDoc};
use belvedere_studio::{next_turn, with_parallel_planes, with_pivot_line};
use eframe::egui::{CollapsingHeader, ComboBox, Context, Id, Ui};

const KIND: &str = "curved_rays";
/// Speed of a played preview, share of the previewed length per second.
const PLAY: f64 = 0.25;
/// Share of the previewed length that is still ahead when playing ends, since nothing is left to show at the end of a path.
const AHEAD: f64 = 0.25;

/// Size of the field of a coordinate, points; the same for any number of digits.
const COORDINATE: [f32; 2] = [92.0, 20.0];
/// Least width of that field in a narrow panel, points.
const LEAST_COORDINATE: f32 = 56.0;

/// Visible share from which on a target counts as in sight.
const WHOLE: f64 = 0.99;

/// State of the panel.
#[derive(Debug, Default)]
pub(crate) struct RaysPanel {
    playing: bool,
    played_at: f64,
}

impl RaysPanel {
    /// Shows the panel.
    pub(crate) fn show(&mut self, ui: &mut Ui, model: &mut Model) {
        // Scopes: what stands below keeps its identity when something above it comes or goes while a click is under way.
        ui.scope(|ui| constructors(ui, model));
        ui.scope(|ui| self.constructed(ui, model));
        ui.separator();
        turns(ui, model);
        // Below everything, so that nothing moves under a pointer that drags.
        if let Some(reason) = &model.violated {
            ui.separator();
            ui.strong(tr("Not possible like this"));
            ui.label(reason);
        }
        model.handles = Some(Handles::Turns);
    }

    /// What the constructor is about.
    fn constructed(&mut self, ui: &mut Ui, model: &mut Model) {
        match model.document().constructor.clone() {
            Some(constructor) if constructor.kind == ConstructorKind::PathPreview => {
                self.preview(ui, model, &constructor);
            }
            Some(constructor) if constructor.kind == ConstructorKind::TargetTracking => {
                let target = constructor.target.as_deref().unwrap_or(tr("nothing chosen"));
                let judged = model.judged.as_ref().filter(|_| model.is_judged());
                ui.label(in_sight(target, judged.and_then(|judged| judged.target_seen)));
            }
            _ => {}
        }
    }

    /// Position and length of a preview.
    fn preview(&mut self, ui: &mut Ui, model: &mut Model, constructor: &ConstructorDoc) {
        let length = path_length(model, constructor).unwrap_or(1000.0);
        let put = |model: &mut Model, by: Id, change: &dyn Fn(&mut ConstructorDoc)| {
            let mut next = constructor.clone();
            change(&mut next);
            model.edit_on(by, |document| document.constructor = Some(next));
        };
        paths(ui, model, constructor);
        let position = constructor.position_m.unwrap_or(0.0);
        if let Some((by, value)) = slider(ui, model, tr("position"), position, 0.0..=length, tr("along the path")) {
            put(model, by, &|doc| doc.position_m = Some(value));
        }
        let ahead = constructor.preview_m.unwrap_or(0.25 * length);
        if let Some((by, value)) = slider(
            ui,
            model,
            tr("preview"),
            ahead,
            0.01 * length..=length,
            tr("length of the path ahead that is shown"),
        ) {
            put(model, by, &|doc| doc.preview_m = Some(value));
        }
        let name = tr(if self.playing { "Pause preview" } else { "Play preview" });
        if ui.button(name).clicked() {
            self.playing = !self.playing;
            self.played_at = ui.input(|input| input.time);
            model.begin_gesture_of(playing());
            // At the end it begins again.
            if self.playing && position >= length - AHEAD * ahead.min(length) {
                put(model, playing(), &|doc| doc.position_m = Some(0.0));
            }
        }
        ui.weak(tr("The preview has a camera of its own."));
    }

    /// Advances the played preview along the path.
    pub(crate) fn play(&mut self, ctx: &Context, model: &mut Model) {
        let constructor = model.document().constructor.clone();
        // It ends where something else edits.
        self.playing &= model.was_edited_by(playing());
        let Some(mut doc) = constructor.filter(|doc| self.playing && doc.kind == ConstructorKind::PathPreview) else {
            self.playing = false;
            return;
        };
        let now = ctx.input(|input| input.time);
        let length = path_length(model, &doc).unwrap_or(1000.0);
        let ahead = doc.preview_m.unwrap_or(0.25 * length);
        let (speed, end) = (PLAY * ahead, length - AHEAD * ahead.min(length));
        let next = doc.position_m.unwrap_or(0.0) + speed * (now - self.played_at).clamp(0.0, 0.2);
        self.played_at = now;
        self.playing = next < end;
        doc.position_m = Some(next.min(end.max(doc.position_m.unwrap_or(0.0))));
        model.edit_on(playing(), |document| document.constructor = Some(doc));
        ctx.request_repaint();
    }
}

/// What edits while a preview is played.
fn playing() -> Id {
    Id::unique("played preview")
}

/// Text on the visibility of a target.
///
/// * `seen`: measured visible share, 0..=1.
fn in_sight(target: &str, seen: Option<f64>) -> String {
    match seen {
        Some(share) if share >= WHOLE => fill(tr("In sight: {0}"), &[&target]),
        Some(share) => fill(tr("{0}: {1} % of it is in sight"), &[&target, &format!("{:.1}", 100.0 * share)]),
        None => fill(tr("To be kept in sight: {0}"), &[&target]),
    }
}

/// Length of the path of a preview, scene units.
fn path_length(model: &Model, constructor: &ConstructorDoc) -> Option<f64> {
    let scene = model.shown.as_ref()?.session.scene();
    let layer = scene.layers.iter().find(|layer| Some(&layer.id) == constructor.path.as_ref())?;
    let line = layer.kind.lines()?;
    let length = |points: &[DVec3]| points.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
    line.features.iter().map(|feature| length(&feature.points)).reduce(f64::max)
}

/// The path of a preview, where there are several.
fn paths(ui: &mut Ui, model: &mut Model, constructor: &ConstructorDoc) {
    let lines = model.layer_ids(|layer| matches!(layer, LayerDoc::Line(_)));
    let Some(path) = constructor.path.as_ref().filter(|path| lines.len() > 1 && lines.contains(path)) else { return };
    let mut chosen = path.clone();
    ComboBox::from_label(tr("Path")).selected_text(&chosen).show_ui(ui, |ui| {
        for line in &lines {
            ui.selectable_value(&mut chosen, line.clone(), line);
        }
    });
    if chosen != *path {
        let next = ConstructorDoc { path: Some(chosen), position_m: None, preview_m: None, ..constructor.clone() };
        model.edit(|document| document.constructor = Some(next));
    }
}

/// Keeps something in sight: a layer, a part, a box.
pub(crate) fn track(model: &mut Model, target: &str) {
    let target = Some(target.to_owned());
    construct(model, ConstructorDoc { target, ..ConstructorDoc::of(ConstructorKind::TargetTracking) });
}

/// Whether a stage can stand beside a constructor, which builds turns of its own.
///
/// * `solves`: whether the ground is still to be solved.
fn goes_with(kind: ConstructorKind, stage: &StageDoc, solves: bool) -> bool {
    let moves = kind == ConstructorKind::PathPreview || kind == ConstructorKind::AutoProbe;
    match stage {
        StageDoc::CurvedRays(_) | StageDoc::Tube(_) | StageDoc::Unroll(_) => false,
        StageDoc::SplineBend(_) | StageDoc::GroundMoves(_) | StageDoc::Strip(_) | StageDoc::Relief(_) => !moves,
        StageDoc::TerrainDisocclusion(_) => !solves,
    }
}

/// Chooses a constructor in place of turns by hand and of other bends that it excludes; one step of undo.
fn construct(model: &mut Model, constructor: ConstructorDoc) {
    let (before, solves) = (model.document().stage.len(), model.document().solves_terrain());
    model.edit(|document| {
        document.stage.retain(|stage| goes_with(constructor.kind, stage, solves));
        document.constructor = Some(constructor);
    });
    if model.document().stage.len() < before {
        model.notices.tell(tr("Bends that do not go with it made way; undo brings them back."));
    }
}

/// Whether a layer has something that can be kept in sight: ground and what is painted on it has not.
fn is_target(layer: &LayerDoc) -> bool {
    !matches!(layer, LayerDoc::Terrain(_) | LayerDoc::Area(_))
}

/// Whether the layer of that id has something that can be kept in sight.
pub(crate) fn can_track(model: &Model, id: &str) -> bool {
    model.document().layer.iter().any(|layer| layer.id() == id && is_target(layer))
}

fn constructors(ui: &mut Ui, model: &mut Model) {
    let kind = model.document().constructor.as_ref().map_or(ConstructorKind::Manual, |constructor| constructor.kind);
    ui.label(tr("Rays are bent"));
    ui.horizontal_wrapped(|ui| {
        if ui.selectable_label(kind == ConstructorKind::Manual, tr("By hand")).clicked() {
            model.edit(|document| document.constructor = None);
        }
        let tracking = kind == ConstructorKind::TargetTracking;
        let has_targets = model.document().layer.iter().any(is_target);
        let track = ui
            .add_enabled(has_targets, eframe::egui::Button::selectable(tracking, tr("To keep something in sight")))
            .on_hover_text(tr("then click it in the picture"));
        let lacks = tr("needs a line, a point, a building or a model");
        if track.on_disabled_hover_text(lacks).clicked() {
            model.look.tool = Tool::Track;
        }
        let lines = model.layer_ids(|layer| matches!(layer, LayerDoc::Line(_)));
        let preview = ui.add_enabled(
            !lines.is_empty(),
            eframe::egui::Button::selectable(kind == ConstructorKind::PathPreview, tr("Along a path")),
        );
        if preview.on_disabled_hover_text(tr("needs a line layer")).clicked() {
            let path = lines.first().cloned();
            construct(model, ConstructorDoc { path, ..ConstructorDoc::of(ConstructorKind::PathPreview) });
        }
        let probing = kind == ConstructorKind::AutoProbe;
        if ui
            .selectable_label(probing, tr("Into what is hidden"))
            .on_hover_text(tr("turns are found that show most"))
            .clicked()
        {
            construct(model, ConstructorDoc::of(ConstructorKind::AutoProbe));
        }
    });
    if model.look.tool == Tool::Track {
        ui.label(tr("Click what has to stay in sight."));
    }
}

/// Turns by hand.
fn turns(ui: &mut Ui, model: &mut Model) {
    let stage = match model.stage(KIND) {
        Some(StageDoc::CurvedRays(stage)) => Some(stage.clone()),
        _ => None,
    };
    ui.horizontal(|ui| {
        let camera = model.camera();
        if ui.add_enabled(camera.is_some(), eframe::egui::Button::new(tr("Add a turn"))).clicked()
            && let Some(camera) = camera
        {
            let mut next =
                stage.clone().unwrap_or(RaysStageDoc { model: RayModel::default(), turn: Vec::new(), split: None });
            next.turn.push(next_turn(&camera, stage.as_ref()));
            model.edit(|document| {
                document.constructor.take_if(|doc| doc.kind != ConstructorKind::Manual);
                set_stage(document, StageDoc::CurvedRays(next));
            });
            model.look.overhead = true;
        }
        if stage.is_some() && ui.button(tr("Straight rays")).clicked() {
            model.edit(|document| document.stage.retain(|stage| stage.kind() != KIND));
        }
    });
    let Some(stage) = stage else { return };
    ray_model(ui, model, &stage);
    let mut next = stage.clone();
    let (mut removed, mut by) = (None, None);
    let eye = model.camera().map(|camera| camera.pinhole.eye);
    for (index, turn) in stage.turn.iter().enumerate() {
        let before = match index.checked_sub(1) {
            Some(last) => Some(DVec3::from_array(stage.turn[last].viewpoint)),
            None => eye,
        };
        CollapsingHeader::new(fill(tr("Turn {0}"), &[&(index + 1)])).default_open(index == 0).show(ui, |ui| {
            by = by.or(one(ui, model, index + 1, turn, &mut next.turn[index]));
            by = by.or(planes(ui, model, (index + 1, before), turn, &mut next.turn[index]));
            if ui.button(fill(tr("Remove turn {0}"), &[&(index + 1)])).clicked() {
                removed = Some(index);
            }
        });
    }
    if let Some(index) = removed {
        next.turn.remove(index);
        model.edit(|document| match next.turn.is_empty() && next.split.is_none() {
            true => document.stage.retain(|stage| stage.kind() != KIND),
            false => set_stage(document, StageDoc::CurvedRays(next)),
        });
    } else if let Some(by) = by {
        model.edit_on(by, |document| set_stage(document, StageDoc::CurvedRays(next)));
    }
}

fn ray_model(ui: &mut Ui, model: &mut Model, stage: &RaysStageDoc) {
    let all = [
        (RayModel::Modified, later("modified")),
        (RayModel::Original, later("original")),
        (RayModel::C0, "C0"),
        (RayModel::C2, "C2"),
        (RayModel::Circular, later("circular")),
    ];
    let mut chosen = stage.model;
    choice(ui, tr("Model of the transition"), &mut chosen, &all);
    if chosen != stage.model {
        let next = RaysStageDoc { model: chosen, ..stage.clone() };
        model.edit(|document| set_stage(document, StageDoc::CurvedRays(next)));
    }
}

/// The numbers of a turn. Returns the control that edits.
fn one(ui: &mut Ui, model: &mut Model, n: usize, turn: &TurnDoc, next: &mut TurnDoc) -> Option<Id> {
    let mut by = None;
    let reach = DVec3::from_array(turn.viewpoint).distance(DVec3::from_array(turn.t1));
    let speed = 0.004 * reach;
    type Part = fn(&mut TurnDoc) -> &mut [f64; 3];
    let rows: [(&str, &str, Part); 4] = [
        (tr("viewpoint"), tr("where the rays come from behind the turn"), |t| &mut t.viewpoint),
        (tr("first plane"), tr("a point of the plane where the rays begin to bend"), |t| &mut t.t0),
        (tr("bend point"), tr("where the rays bend most"), |t| &mut t.t1),
        (tr("last plane"), tr("a point of the plane from which they run straight again"), |t| &mut t.t2),
    ];
    for (name, help, part) in rows {
        let now = *part(&mut turn.clone());
        ui.label(name).on_hover_text(help);
        ui.horizontal(|ui| {
            let third = (ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0;
            let size = [third.floor().clamp(LEAST_COORDINATE, COORDINATE[0]), COORDINATE[1]];
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let mut value = now[axis];
                let field =
                    eframe::egui::DragValue::new(&mut value).speed(speed).max_decimals(2).prefix(format!("{letter} "));
                let whole = format!("{name} {n}, {letter}");
                let response = ui.add_sized(size, field).accessible_name(whole.as_str()).on_hover_text(whole);
                if let Some(field) = model.changed(&response) {
                    by = Some(field);
                    part(next)[axis] = value;
                }
            }
        });
    }
    by
}

/// Whether the planes of a turn share a line, and how sharp it is. Returns the control that edits.
///
/// * `before`: the viewpoint before it.
fn planes(
    ui: &mut Ui,
    model: &mut Model,
    (n, before): (usize, Option<DVec3>),
    turn: &TurnDoc,
    next: &mut TurnDoc,
) -> Option<Id> {
    let mut by = None;
    let mut pivots = turn.line.is_some();
    let help = tr("planes that share a line turn the picture about it; else they are parallel");
    let pivot = ui.checkbox(&mut pivots, fill(tr("pivot line of turn {0}"), &[&n])).on_hover_text(help);
    if pivot.changed() {
        model.begin_gesture();
        by = Some(pivot.id);
        let before = before.unwrap_or(DVec3::from_array(turn.viewpoint));
        *next = if pivots { with_pivot_line(next, before) } else { with_parallel_planes(next) };
        model.look.overhead |= pivots;
    }
    let value = match turn.m {
        Sharpness::Value(value) => value,
        _ => 1.0,
    };
    let mut own = !matches!(turn.m, Sharpness::Value(_));
    let bend = ui.checkbox(&mut own, fill(tr("sharpness of turn {0} by its bend point"), &[&n]));
    if bend.changed() {
        model.begin_gesture();
        by = Some(bend.id);
        next.m = if own { Sharpness::Bend } else { Sharpness::Value(value) };
    }
    if !own
        && let Some((field, value)) =
            number(ui, model, &fill(tr("sharpness {0}"), &[&n]), value, 0.02, tr("0.2 to 20; larger is sharper"))
    {
        by = Some(field);
        next.m = Sharpness::Value(value.clamp(0.2, 20.0));
    }
    by
}

#[cfg(test)]
mod tests {
    use super::in_sight;

    #[test]
    fn only_what_is_measured_is_said_to_be_in_sight() {
        assert_eq!(in_sight("church", Some(1.0)), "In sight: church");
        assert_eq!(in_sight("church", Some(0.124)), "church: 12.4 % of it is in sight");
        assert_eq!(in_sight("church", None), "To be kept in sight: church");
    }
}
