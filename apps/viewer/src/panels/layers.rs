//! Layers: what is there, in which order, what must be seen, how it is drawn.

mod by_property;
mod fields;
mod marks;
mod paint;
mod residues;
mod style;
mod volume;

use super::percent;
use crate::language::{fill, heard, tr};
use crate::model::Model;
use crate::widgets::steady;
use belvedere::Warning;
use belvedere::scene_file::LayerDoc;
use belvedere_studio::{with_layer_renamed, without_layer};
use eframe::egui::{Button, CollapsingHeader, Role, Ui, WidgetInfo};

pub(crate) use residues::choose_clicked;

/// Shows the list.
pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    let document = model.document().clone();
    let mut title = document.title.clone();
    ui.horizontal(|ui| {
        let label = ui.label(tr("Title"));
        let field = ui.text_edit_singleline(&mut title).labelled_by(label.id);
        if let Some(by) = model.changed(&field) {
            model.edit_on(by, |document| document.title = title);
        }
    });
    if document.layer.is_empty() {
        ui.label(tr("There is no layer. Drop a GeoTIFF and a GPX on the window, or open a scene."));
    }
    for (index, layer) in document.layer.iter().enumerate() {
        ui.separator();
        steady(ui, layer.id(), |ui| one(ui, model, index, layer));
    }
    let mut warnings = model.shown.as_ref().map_or_else(Vec::new, |shown| shown.session.warnings());
    if !warnings.is_empty() {
        warnings.sort_by_key(Warning::kind);
        ui.separator();
        CollapsingHeader::new(fill(tr("Warnings ({0})"), &[&warnings.len()])).show(ui, |ui| {
            for alike in warnings.chunk_by(|a, b| a.kind() == b.kind()) {
                ui.weak(heard(alike[0].kind().name()));
                alike.iter().for_each(|warning| drop(ui.label(warning.text())));
            }
        });
    }
}

fn one(ui: &mut Ui, model: &mut Model, index: usize, layer: &LayerDoc) {
    let id = layer.id();
    let is_hidden = model.document().hidden.iter().any(|other| other == id);
    ui.horizontal(|ui| {
        if is_hidden {
            ui.weak(id);
        } else {
            ui.strong(id);
        }
        ui.weak(heard(layer.kind()));
    });
    // What is measured beside the window has its line from the start: nothing below moves under a click when it comes.
    match shares(model, id).filter(|_| !is_hidden) {
        Some([seen, in_frame]) => {
            ui.label(fill(tr("{0} visible, {1} in the frame"), &[&percent(Some(seen)), &percent(Some(in_frame))]));
        }
        None if layer.must_see() && !is_hidden => drop(ui.weak(tr("visible share: being measured"))),
        None => {}
    }
    steady(ui, "controls", |ui| controls(ui, model, (index, layer), is_hidden));
}

/// What is done with a layer.
fn controls(ui: &mut Ui, model: &mut Model, (index, layer): (usize, &LayerDoc), is_hidden: bool) {
    let id = layer.id();
    handling(ui, model, (index, id), is_hidden);
    if !matches!(layer, LayerDoc::Terrain(_)) {
        let mut must_see = layer.must_see();
        if ui.checkbox(&mut must_see, fill(tr("{0} must be seen"), &[&id])).changed() {
            model.edit(|d| d.layer[index] = d.layer[index].with_must_see(must_see));
        }
    }
    if let LayerDoc::Molecule(molecule) = layer {
        residues::show(ui, model, index, molecule);
    }
    if let Some(mut rigid) = layer.rigid() {
        let words = tr(
            "Each building, box or part keeps its shape where space bends: walls stay straight, nothing of it folds.",
        );
        if ui.checkbox(&mut rigid, fill(tr("{0} is rigid"), &[&id])).on_hover_text(words).changed() {
            model.edit(|d| d.layer[index] = d.layer[index].with_rigid(rigid));
        }
    }
    CollapsingHeader::new(fill(tr("Style of {0}"), &[&id])).show(ui, |ui| {
        name_field(ui, model, id);
        style::show(ui, model, index, layer);
    });
}

/// Buttons: seen or hidden, order, removal.
fn handling(ui: &mut Ui, model: &mut Model, (index, id): (usize, &str), is_hidden: bool) {
    let last = model.document().layer.len() - 1;
    let button = |ui: &mut Ui, enabled: bool, sign: &str, name: String| {
        let response = ui.add_enabled(enabled, Button::new(sign).small());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, &name));
        response.on_hover_text(name).clicked()
    };
    ui.horizontal_wrapped(|ui| {
        let (sign, name) = if is_hidden { (tr("Show"), tr("Show {0}")) } else { (tr("Hide"), tr("Hide {0}")) };
        if button(ui, true, sign, fill(name, &[&id])) {
            model.edit(|document| match is_hidden {
                true => document.hidden.retain(|other| other != id),
                false => document.hidden.push(id.to_owned()),
            });
        }
        if button(ui, index > 0, tr("Up"), fill(tr("Move {0} up"), &[&id])) {
            model.edit(|document| document.layer.swap(index, index - 1));
        }
        if button(ui, index < last, tr("Down"), fill(tr("Move {0} down"), &[&id])) {
            model.edit(|document| document.layer.swap(index, index + 1));
        }
        if button(ui, true, tr("Remove"), fill(tr("Remove {0}"), &[&id])) {
            model.edit(|document| *document = without_layer(document, id));
        }
    });
}

/// A field for the name of a layer; the name is taken when the field is left.
fn name_field(ui: &mut Ui, model: &mut Model, id: &str) {
    let key = ui.scope_id().with(("name", id));
    let mut name = ui.data(|data| data.get_temp::<String>(key)).unwrap_or_else(|| id.to_owned());
    ui.horizontal(|ui| {
        let label = ui.label(fill(tr("name of {0}"), &[&id]));
        let field = ui.text_edit_singleline(&mut name).labelled_by(label.id);
        if !field.lost_focus() {
            ui.data_mut(|data| data.insert_temp(key, name));
            return;
        }
        ui.data_mut(|data| data.remove::<String>(key));
        if name.trim() == id {
            return;
        }
        match with_layer_renamed(model.document(), id, &name) {
            Ok(next) => model.edit(|document| *document = next),
            Err(reason) => model.notices.error(reason),
        }
    });
}

/// Shares of a layer's whole features that the picture shows, and that it holds.
fn shares(model: &Model, id: &str) -> Option<[f64; 2]> {
    let judged = model.judged.as_ref()?;
    let of_layer = || judged.measures.features.iter().filter(|f| f.layer == id);
    let total: f64 = of_layer().map(|f| f.total).sum();
    let seen: f64 = of_layer().map(|f| f.bent.sight.visible).sum();
    let in_frame: f64 = of_layer().map(|f| f.bent.in_frame).sum();
    (total > 0.0).then(|| [seen, in_frame].map(|amount| amount / total))
}
