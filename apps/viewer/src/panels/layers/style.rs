//! Style of a layer.

use super::super::choice;
use super::fields::Reading;
use super::paint::{color, opacity, opacity_of_solid};
use super::{by_property, fields, marks};
use crate::language::{fill, heard, later, tr};
use crate::model::Model;
use belvedere::scene::Hidden;
use belvedere::scene::molecule::Representation;
use belvedere::scene_file::{ColorByDoc, LayerDoc, MoleculeStyleDoc, PaletteDoc, PaletteName};
use eframe::egui::{ComboBox, DragValue, TextWrapMode, Ui};

/// Shows the style of a layer.
pub(super) fn show(ui: &mut Ui, model: &mut Model, index: usize, layer: &LayerDoc) {
    let key = ui.scope_id().with(("style", index));
    let pending = ui.data(|data| data.get_temp::<Pending>(key));
    let mut next = pending.map_or_else(|| layer.clone(), |pending| pending.0);
    let id = layer.id().to_owned();
    // The words beside a field or a list go on below where the panel is narrow.
    ui.style_mut().wrap_mode = Some(TextWrapMode::Wrap);
    controls(ui, model, &id, layer, &mut next);
    if let Some(opacity) = next.opacity_mut() {
        opacity_of_solid(ui, &id, opacity);
    }
    // Changes are applied when the pointer is released, since a layer is read again for each new style.
    if next != *layer && ui.input(|input| input.pointer.any_down()) {
        ui.data_mut(|data| data.insert_temp(key, Pending(next)));
        return;
    }
    ui.data_mut(|data| data.remove::<Pending>(key));
    if next != *layer {
        // What is typed in a field is one gesture.
        let field = ui.memory(|memory| memory.focused()).filter(|_| ui.ctx().text_edit_focused());
        if field.is_none() {
            model.begin_gesture();
        }
        model.edit_on(field.unwrap_or(key), |document| document.layer[index] = next);
    }
}

/// The controls of a layer. Scopes stand around what appears once a file is read: the controls below keep their identities, and so
/// their clicks.
fn controls(ui: &mut Ui, model: &mut Model, id: &str, layer: &LayerDoc, next: &mut LayerDoc) {
    match next {
        LayerDoc::Terrain(l) => {
            palette(ui, id, &mut l.style.palette);
            ui.checkbox(&mut l.style.sea, fill(tr("sea of {0}"), &[&id]));
        }
        LayerDoc::Line(l) => {
            let reading = fields::of(ui, model, layer);
            colors(ui, id, &reading, (&mut l.style.color, &mut l.style.color_by));
            width(ui, &fill(tr("width of {0}, pixels"), &[&id]), &mut l.style.width_px);
            let words = [fill(tr("width of {0} by"), &[&id]), tr("nothing: one width").to_owned()];
            ui.scope(|ui| by_property::sizes(ui, words, &reading, &mut l.style.width_by));
            marks::casing(ui, id, &mut l.style.casing);
            marks::distances(ui, id, &mut l.style.distance_markers_m);
            names(ui, id, &reading, (&mut l.style.labels, &mut l.style.label_px, &mut l.name_field));
            hidden(ui, id, &mut l.style.hidden);
        }
        LayerDoc::Area(l) => {
            let mut text = l.style.color.clone().unwrap_or_else(|| "#8fb4cc".into());
            if color(ui, &fill(tr("colour of {0}"), &[&id]), &mut text) | opacity(ui, id, &mut text) {
                l.style.color = Some(text.clone());
            }
            let reading = fields::of(ui, model, layer);
            ui.scope(|ui| by_property::colors(ui, id, &reading, &mut l.style.color_by, &text));
            marks::outline(ui, id, &mut l.style.outline);
            width(ui, &fill(tr("outline of {0}, pixels"), &[&id]), &mut l.style.width_px);
            names(ui, id, &reading, (&mut l.style.labels, &mut l.style.label_px, &mut l.name_field));
        }
        LayerDoc::Point(l) => {
            let reading = fields::of(ui, model, layer);
            marks::symbol(ui, id, &mut l.style.symbol);
            colors(ui, id, &reading, (&mut l.style.color, &mut l.style.color_by));
            width(ui, &fill(tr("size of {0}, pixels"), &[&id]), &mut l.style.size_px);
            let words = [fill(tr("size of {0} by"), &[&id]), tr("nothing: one size").to_owned()];
            ui.scope(|ui| by_property::sizes(ui, words, &reading, &mut l.style.size_by));
            marks::casing(ui, id, &mut l.style.casing);
            names(ui, id, &reading, (&mut l.style.labels, &mut l.style.label_px, &mut l.name_field));
            hidden(ui, id, &mut l.style.hidden);
        }
        LayerDoc::Boxes(l) => {
            color(ui, &fill(tr("colour of {0}"), &[&id]), &mut l.style.color);
        }
        LayerDoc::Mesh(l) => {
            color(ui, &fill(tr("colour of {0}"), &[&id]), &mut l.style.color);
            occlusion(ui, id, &mut l.style.ambient_occlusion);
        }
        LayerDoc::City(l) => {
            color(ui, &fill(tr("roofs of {0}"), &[&id]), &mut l.style.roof);
            color(ui, &fill(tr("walls of {0}"), &[&id]), &mut l.style.wall);
            color(ui, &fill(tr("ground of {0}"), &[&id]), &mut l.style.ground);
            occlusion(ui, id, &mut l.style.ambient_occlusion);
        }
        LayerDoc::Molecule(l) => molecule(ui, id, &mut l.style),
        LayerDoc::Volume(l) => super::volume::show(ui, model, id, &mut l.transfer),
    }
}

/// The colour of a layer, or a property that gives it, and its opacity.
fn colors(ui: &mut Ui, id: &str, reading: &Reading, (text, by): (&mut String, &mut Option<ColorByDoc>)) {
    color(ui, &fill(tr("colour of {0}"), &[&id]), text);
    ui.scope(|ui| by_property::colors(ui, id, reading, by, text));
    opacity(ui, id, text);
}

/// A style that is applied when the pointer is released.
#[derive(Clone)]
struct Pending(LayerDoc);

fn width(ui: &mut Ui, name: &str, value: &mut f64) {
    ui.horizontal(|ui| {
        let label = ui.label(name);
        ui.add(DragValue::new(value).speed(0.05).range(0.2..=40.0).clamp_existing_to_range(false))
            .labelled_by(label.id);
    });
}

/// Initial reach of ambient occlusion when it is switched on, metres: that of a town.
const REACH: f64 = 40.0;

fn occlusion(ui: &mut Ui, id: &str, value: &mut Option<f64>) {
    let mut on = value.is_some();
    ui.horizontal_wrapped(|ui| {
        if ui.checkbox(&mut on, fill(tr("ambient occlusion of {0}"), &[&id])).changed() {
            *value = on.then_some(REACH);
        }
        if let Some(reach) = value {
            let label = ui.label(tr("within"));
            ui.add(DragValue::new(reach).speed(0.5).range(0.01..=1e4).clamp_existing_to_range(false))
                .labelled_by(label.id);
        }
    });
}

/// Whether names are written, how large, and from which property.
fn names(ui: &mut Ui, id: &str, reading: &Reading, (on, size, field): (&mut bool, &mut f64, &mut Option<String>)) {
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(on, fill(tr("names of {0}"), &[&id]));
        if *on {
            let label = ui.label(tr("letters, pixels"));
            ui.add(DragValue::new(size).speed(0.1).range(6.0..=60.0).clamp_existing_to_range(false))
                .labelled_by(label.id);
        }
    });
    ui.scope(|ui| on.then(|| by_property::names(ui, id, reading, field)));
}

fn molecule(ui: &mut Ui, id: &str, style: &mut MoleculeStyleDoc) {
    let all = [
        (Representation::BallAndStick, later("balls and sticks")),
        (Representation::SpaceFilling, later("space filling")),
        (Representation::Sticks, later("sticks")),
        (Representation::Ribbon, later("ribbons")),
        (Representation::Surface, later("smooth surface")),
        (Representation::Auto, later("auto")),
    ];
    choice(ui, &fill(tr("atoms of {0}"), &[&id]), &mut style.representation, &all);
    let is_own = style.color.starts_with('#');
    let shown = if is_own { tr("one colour").to_owned() } else { heard(&style.color) };
    ComboBox::from_label(fill(tr("coloured by, {0}"), &[&id])).selected_text(shown).show_ui(ui, |ui| {
        for one in [later("auto"), later("element"), later("chain"), later("residue"), later("structure")] {
            ui.selectable_value(&mut style.color, one.to_owned(), tr(one));
        }
        if ui.selectable_label(is_own, tr("one colour")).clicked() && !is_own {
            style.color = "#8090a0".into();
        }
    });
    if is_own {
        color(ui, &fill(tr("colour of {0}"), &[&id]), &mut style.color);
    }
}

fn hidden(ui: &mut Ui, id: &str, value: &mut Hidden) {
    let all = [
        (Hidden::Show, later("show")),
        (Hidden::Fade, later("fade")),
        (Hidden::Dash, later("dash")),
        (Hidden::Cut, later("cut")),
    ];
    choice(ui, &fill(tr("where {0} is hidden"), &[&id]), value, &all);
}

fn palette(ui: &mut Ui, id: &str, value: &mut PaletteDoc) {
    let shown = match &*value {
        PaletteDoc::Named(named) => {
            PaletteName::ALL.iter().find(|(_, p)| p == named).map_or("auto", |(name, _)| *name).to_owned()
        }
        PaletteDoc::File(file) => file.clone(),
    };
    ComboBox::from_label(fill(tr("tints of {0}"), &[&id])).selected_text(shown).show_ui(ui, |ui| {
        for (name, palette) in PaletteName::ALL {
            ui.selectable_value(value, PaletteDoc::Named(palette), name);
        }
    });
}
