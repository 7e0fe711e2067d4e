//! Terrain disocclusion: required features, limits of the displacement, what stays hidden; below it moves by hand.

use super::{choice, percent, set_stage, slider};
use crate::language::{fill, later, tr};
use crate::model::Model;
use belvedere::core::DVec3;
use belvedere::live::Judged;
use belvedere::scene_file::{LayerDoc, SolverMode, StageDoc, TerrainStageDoc};
use eframe::egui::{Id, Ui};
use std::ops::RangeInclusive;
use std::sync::Arc;

const KIND: &str = "terrain_disocclusion";

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    let stage = match model.stage(KIND) {
        Some(StageDoc::TerrainDisocclusion(stage)) => Some(stage.clone()),
        _ => None,
    };
    let mut moves = stage.is_some();
    if ui.checkbox(&mut moves, tr("The ground makes way")).changed() {
        model.edit(|document| match moves {
            true => set_stage(document, StageDoc::TerrainDisocclusion(TerrainStageDoc::default())),
            false => document.stage.retain(|stage| stage.kind() != KIND),
        });
    }
    ui.label(tr("for:"));
    let document = model.document().clone();
    for (index, layer) in document.layer.iter().enumerate() {
        if matches!(layer, LayerDoc::Line(_) | LayerDoc::Area(_) | LayerDoc::Point(_)) {
            let mut must_see = layer.must_see();
            if ui.checkbox(&mut must_see, layer.id()).changed() {
                model.edit(|d| d.layer[index] = d.layer[index].with_must_see(must_see));
            }
        }
    }
    if let Some(stage) = stage {
        ui.separator();
        settings(ui, model, &stage);
    }
    ui.separator();
    let of_picture =
        |judged: &Judged| model.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(&shown.document, &judged.document));
    let judged = model.judged.as_deref().is_some_and(of_picture);
    // The last known shares are shown in grey while new ones are measured.
    ui.scope(|ui| {
        if !judged {
            ui.set_opacity(0.5);
        }
        shares(ui, model);
    });
    ui.separator();
    super::moves::show(ui, model);
}

const MODES: [(SolverMode, &str); 3] = [
    (SolverMode::Qp, later("a quadratic program")),
    (SolverMode::PaperQp, later("as published, then a quadratic program")),
    (SolverMode::Paper, later("as published")),
];

/// A value of the stage that the document may leave out.
type ValueOf = fn(&mut TerrainStageDoc) -> &mut Option<f64>;

/// Changes the stage in one step of undo.
type Put<'a> = &'a dyn Fn(&mut Model, Id, &dyn Fn(&mut TerrainStageDoc));

/// Stretches whose price is listed.
const PRICES: usize = 6;

fn settings(ui: &mut Ui, model: &mut Model, stage: &TerrainStageDoc) {
    let put = |model: &mut Model, by: Id, change: &dyn Fn(&mut TerrainStageDoc)| {
        let mut next = stage.clone();
        change(&mut next);
        model.edit_on(by, |document| set_stage(document, StageDoc::TerrainDisocclusion(next)));
    };
    if stage.delta.is_some() {
        ui.label(tr("The ground was solved before and comes from a file; uncheck and check to solve it here."));
        return;
    }
    let mut mode = stage.mode.unwrap_or(SolverMode::Qp);
    choice(ui, tr("Solver"), &mut mode, &MODES);
    if mode != stage.mode.unwrap_or(SolverMode::Qp) {
        model.begin_gesture();
        put(model, Id::unique("solver"), &|stage| stage.mode = Some(mode));
    }
    // Values that the document does not give are those that the last picture was solved with.
    let resolved = model.shown.as_ref().and_then(|shown| shown.session.resolved()).and_then(|document| {
        document.stage.iter().find_map(|stage| match stage {
            StageDoc::TerrainDisocclusion(stage) => Some(stage.clone()),
            _ => None,
        })
    });
    let moved = stage.adjust_viewpoint.unwrap_or(1.0);
    let help = tr("left: the camera moves a little where that saves ground; right: only the ground moves");
    if let Some((by, value)) = slider(ui, model, tr("camera or ground"), moved, 0.0..=1.0, help) {
        put(model, by, &|stage| stage.adjust_viewpoint = (value < 1.0).then_some(value));
    }
    let rows: [(&str, RangeInclusive<f64>, &str, ValueOf); 4] = [
        (tr("smoothness w"), 0.02..=2.0, tr("smaller: wider and gentler"), |stage| &mut stage.w),
        (tr("weight eta"), 0.0..=1.0, tr("mountains that are kept, against those that are moved"), |stage| {
            &mut stage.eta
        }),
        (tr("rise at most, m"), 0.0..=2000.0, tr("most that the ground may rise"), |stage| &mut stage.rise_limit_m),
        (tr("clearance, m"), 0.0..=50.0, tr("of the lines of sight"), |stage| &mut stage.margin_m),
    ];
    let (mut stated, mut usual) = (stage.clone(), resolved.unwrap_or_default());
    for (name, range, help, of) in rows {
        let now = of(&mut stated).or(*of(&mut usual)).unwrap_or_default();
        if let Some((by, value)) = slider(ui, model, name, now, range, help) {
            put(model, by, &|stage| *of(stage) = Some(value));
        }
    }
    price(ui, model, stage, &put);
    if ui.button(tr("Usual values")).clicked() {
        model.begin_gesture();
        put(model, Id::unique("usual values"), &|stage| *stage = TerrainStageDoc::default());
    }
}

/// What may be paid for what is shown: a share to show, a largest displacement, and what the stretches of the picture at rest cost.
fn price(ui: &mut Ui, model: &mut Model, stage: &TerrainStageDoc, put: Put<'_>) {
    let help =
        tr("share that the ground makes way for whatever it costs; at 0 as much as leaves the landscape like itself");
    if let Some((by, value)) = slider(ui, model, tr("share to show"), stage.show.unwrap_or(0.0), 0.0..=1.0, help) {
        put(model, by, &|stage| stage.show = (value > 0.0).then_some(value));
    }
    let help = tr("the dearest stretches are given up until the ground moves no farther; at 0 without limit");
    let most = stage.move_at_most_m.unwrap_or(0.0);
    if let Some((by, value)) = slider(ui, model, tr("moves at most, m"), most, 0.0..=2000.0, help) {
        put(model, by, &|stage| stage.move_at_most_m = (value > 0.0).then_some(value));
    }
    let paid = model.shown.as_ref().and_then(|shown| shown.session.terrain_report()?.price.clone());
    let Some(paid) = paid else { return };
    let mut go_to = None;
    for (title, of) in [
        (fill(tr("Given up ({0}), and its share of the price then:"), &[&paid.given_up.len()]), &paid.given_up),
        (tr("Shown, and its share of the price:").to_owned(), &paid.dearest),
    ] {
        if of.is_empty() {
            continue;
        }
        ui.label(title);
        for (k, stretch) in of.iter().take(PRICES).enumerate() {
            let from = fill(tr(" from {0} km"), &[&format!("{:.1}", stretch.from_m / 1000.0)]);
            let name = model.shown.as_ref().and_then(|shown| {
                let layer = shown.session.scene().layers.get(stretch.layer)?;
                Some(layer.kind.feature_name(stretch.feature).unwrap_or(&layer.id).to_owned())
            });
            let from = if stretch.length_m > 0.0 { from } else { String::new() };
            let label = format!("{}{from}: {:.0} %", name.unwrap_or_default(), 100.0 * stretch.share);
            let button = ui.push_id((&label, k), |ui| ui.button(&label)).inner;
            if button.on_hover_text(tr("Look there")).clicked() {
                go_to = Some(stretch.at);
            }
        }
    }
    if let Some(at) = go_to {
        look_at(model, at);
    }
}

/// Before and after, and what stays hidden.
fn shares(ui: &mut Ui, model: &mut Model) {
    let Some(judged) = model.judged.as_ref().filter(|judged| !judged.measures.features.is_empty()) else {
        ui.label(tr("Visible shares appear when something must be seen and the view rests."));
        return;
    };
    // The buttons below keep their identities, whatever was measured.
    ui.scope(|ui| measured(ui, model, judged));
    if judged.hidden.is_empty() {
        ui.label(tr("Nothing in the picture that must be seen is hidden."));
        return;
    }
    ui.label(fill(tr("Still hidden ({0}):"), &[&judged.hidden.len()]));
    let mut go_to = None;
    for (i, run) in judged.hidden.iter().take(40).enumerate() {
        let name = if run.name.is_empty() { &run.layer_id } else { &run.name };
        let from =
            run.from_m.map_or_else(String::new, |from| fill(tr(" from {0} km"), &[&format!("{:.1}", from / 1000.0)]));
        let button = ui.push_id((&run.layer_id, name, &from), |ui| ui.button(format!("{}. {name}{from}", i + 1))).inner;
        if button.on_hover_text(tr("Look there")).clicked() {
            go_to = Some(run.at);
        }
    }
    if let Some(at) = go_to {
        look_at(model, at);
    }
}

/// Turns the camera to a place on the ground.
fn look_at(model: &mut Model, [x, y]: [f64; 2]) {
    let height = model.shown.as_ref().and_then(|shown| shown.session.scene().terrain()?.surface_at([x, y].into()));
    let point = DVec3::new(x, y, height.unwrap_or(0.0));
    model.begin_gesture();
    model.move_camera(Id::unique("hidden"), |camera| {
        let by = 0.5 * (point - camera.target);
        camera.moved(by.truncate().extend(0.0))?.zoomed(point, 1.6)
    });
}

/// Shares before and after, and how far the picture was moved.
fn measured(ui: &mut Ui, model: &Model, judged: &Judged) {
    let measures = &judged.measures;
    for (name, of) in [
        (tr("lines"), &measures.lines),
        (tr("areas"), &measures.areas),
        (tr("points"), &measures.points),
        (tr("surfaces"), &measures.surfaces),
    ] {
        if let Some(of) = of {
            let [before, after] = [&of.straight, &of.bent].map(|side| {
                fill(tr("{0} ({1} in the frame)"), &[&percent(side.visible_share), &percent(side.in_frame_share)])
            });
            ui.label(fill(tr("{0}: {1} visible straight, {2} bent"), &[&name, &before, &after]));
        }
    }
    if let Some((shown, moved)) = model.shown.as_ref().and_then(|shown| Some((shown, shown.displacement?))) {
        let most = moved.most(shown.session.scene().unit);
        ui.label(fill(tr("What is in the picture was moved by up to {0}."), &[&most]));
    }
}
