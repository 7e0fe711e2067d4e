//! Style of a layer.

use crate::language::{fill, heard, later, tr};
use crate::model::Model;
use belvedere::scene::Hidden;
use belvedere::scene::molecule::Representation;
use belvedere::scene_file::{LayerDoc, MoleculeStyleDoc, PaletteDoc, PaletteName};
use eframe::egui::{Color32, ComboBox, DragValue, Slider, Ui};

/// Shows the style of a layer.
pub(super) fn show(ui: &mut Ui, model: &mut Model, index: usize, layer: &LayerDoc) {
    let key = ui.scope_id().with(("style", index));
    let pending = ui.data(|data| data.get_temp::<Pending>(key));
    let mut next = pending.map_or_else(|| layer.clone(), |pending| pending.0);
    let id = layer.id().to_owned();
    match &mut next {
        LayerDoc::Terrain(l) => {
            palette(ui, &id, &mut l.style.palette);
            ui.checkbox(&mut l.style.sea, fill(tr("sea of {0}"), &[&id]));
        }
        LayerDoc::Line(l) => {
            color(ui, &fill(tr("colour of {0}"), &[&id]), &mut l.style.color);
            opacity(ui, &id, &mut l.style.color);
            width(ui, &fill(tr("width of {0}, pixels"), &[&id]), &mut l.style.width_px);
            labels(ui, &id, (&mut l.style.labels, &mut l.style.label_px));
            hidden(ui, &id, &mut l.style.hidden);
        }
        LayerDoc::Area(l) => {
            let mut text = l.style.color.clone().unwrap_or_else(|| "#8fb4cc".into());
            if color(ui, &fill(tr("colour of {0}"), &[&id]), &mut text) | opacity(ui, &id, &mut text) {
                l.style.color = Some(text);
            }
            width(ui, &fill(tr("outline of {0}, pixels"), &[&id]), &mut l.style.width_px);
        }
        LayerDoc::Point(l) => {
            color(ui, &fill(tr("colour of {0}"), &[&id]), &mut l.style.color);
            opacity(ui, &id, &mut l.style.color);
            width(ui, &fill(tr("size of {0}, pixels"), &[&id]), &mut l.style.size_px);
            labels(ui, &id, (&mut l.style.labels, &mut l.style.label_px));
            hidden(ui, &id, &mut l.style.hidden);
        }
        LayerDoc::Boxes(l) => {
            color(ui, &fill(tr("colour of {0}"), &[&id]), &mut l.style.color);
        }
        LayerDoc::Mesh(l) => {
            color(ui, &fill(tr("colour of {0}"), &[&id]), &mut l.style.color);
            occlusion(ui, &id, &mut l.style.ambient_occlusion);
        }
        LayerDoc::City(l) => {
            color(ui, &fill(tr("roofs of {0}"), &[&id]), &mut l.style.roof);
            color(ui, &fill(tr("walls of {0}"), &[&id]), &mut l.style.wall);
            color(ui, &fill(tr("ground of {0}"), &[&id]), &mut l.style.ground);
            occlusion(ui, &id, &mut l.style.ambient_occlusion);
        }
        LayerDoc::Molecule(l) => molecule(ui, &id, &mut l.style),
        LayerDoc::Volume(l) => super::volume::show(ui, model, &id, &mut l.transfer),
    }
    // Changes are applied when the pointer is released, since a layer is read again for each new style.
    if next == *layer {
        ui.data_mut(|data| data.remove::<Pending>(key));
    } else if ui.input(|input| input.pointer.any_down()) {
        ui.data_mut(|data| data.insert_temp(key, Pending(next)));
    } else {
        ui.data_mut(|data| data.remove::<Pending>(key));
        model.edit(|document| document.layer[index] = next);
    }
}

/// A style that is applied when the pointer is released.
#[derive(Clone)]
struct Pending(LayerDoc);

fn width(ui: &mut Ui, name: &str, value: &mut f64) {
    ui.horizontal(|ui| {
        let label = ui.label(name);
        ui.add(DragValue::new(value).speed(0.05).range(0.2..=40.0)).labelled_by(label.id);
    });
}

/// Initial reach of ambient occlusion when it is switched on, metres: that of a town.
const REACH: f64 = 40.0;

fn occlusion(ui: &mut Ui, id: &str, value: &mut Option<f64>) {
    let mut on = value.is_some();
    ui.horizontal(|ui| {
        if ui.checkbox(&mut on, fill(tr("ambient occlusion of {0}"), &[&id])).changed() {
            *value = on.then_some(REACH);
        }
        if let Some(reach) = value {
            let label = ui.label(tr("within"));
            ui.add(DragValue::new(reach).speed(0.5).range(0.01..=1e4)).labelled_by(label.id);
        }
    });
}

fn color(ui: &mut Ui, name: &str, text: &mut String) -> bool {
    let now = opaque(text);
    let mut rgb = [now.r(), now.g(), now.b()];
    let changed = ui
        .horizontal(|ui| {
            let response = ui.color_edit_button_srgb(&mut rgb).on_hover_text(name);
            let label = ui.label(name);
            response.labelled_by(label.id).changed()
        })
        .inner;
    if changed {
        let alpha = text.get(7..9).unwrap_or_default().to_owned();
        *text = format!("#{:02x}{:02x}{:02x}{alpha}", rgb[0], rgb[1], rgb[2]);
    }
    changed
}

/// A colour without its opacity.
fn opaque(text: &str) -> Color32 {
    text.get(..7).and_then(|text| Color32::from_hex(text).ok()).unwrap_or(Color32::GRAY)
}

/// Opacity of a colour, percent.
fn opacity(ui: &mut Ui, id: &str, text: &mut String) -> bool {
    let now = opaque(text);
    let alpha = text.get(7..9).and_then(|digits| u8::from_str_radix(digits, 16).ok()).unwrap_or(255);
    let mut percent = (f64::from(alpha) / 2.55).round();
    let response = ui.add(Slider::new(&mut percent, 0.0..=100.0).suffix(" %").text(fill(tr("opacity of {0}"), &[&id])));
    if response.changed() {
        let [r, g, b, _] = now.to_array();
        let alpha = (percent * 2.55).round().clamp(0.0, 255.0) as u8;
        *text = format!("#{r:02x}{g:02x}{b:02x}");
        if alpha < 255 {
            *text += &format!("{alpha:02x}");
        }
    }
    response.changed()
}

/// Whether names are written, and how large.
fn labels(ui: &mut Ui, id: &str, (on, size): (&mut bool, &mut f64)) {
    ui.horizontal(|ui| {
        ui.checkbox(on, fill(tr("names of {0}"), &[&id]));
        if *on {
            let label = ui.label(tr("letters, pixels"));
            ui.add(DragValue::new(size).speed(0.1).range(6.0..=60.0)).labelled_by(label.id);
        }
    });
}

fn molecule(ui: &mut Ui, id: &str, style: &mut MoleculeStyleDoc) {
    let name = |one: Representation| match one {
        Representation::BallAndStick => tr("balls and sticks"),
        Representation::SpaceFilling => tr("space filling"),
    };
    ComboBox::from_label(fill(tr("atoms of {0}"), &[&id])).selected_text(name(style.representation)).show_ui(
        ui,
        |ui| {
            for one in [Representation::BallAndStick, Representation::SpaceFilling] {
                ui.selectable_value(&mut style.representation, one, name(one));
            }
        },
    );
    let is_own = style.color.starts_with('#');
    let shown = if is_own { tr("one colour").to_owned() } else { heard(&style.color) };
    ComboBox::from_label(fill(tr("coloured by, {0}"), &[&id])).selected_text(shown).show_ui(ui, |ui| {
        for one in [later("element"), later("chain"), later("residue")] {
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
    let name = |hidden: Hidden| match hidden {
        Hidden::Show => tr("show"),
        Hidden::Fade => tr("fade"),
        Hidden::Dash => tr("dash"),
        Hidden::Cut => tr("cut"),
    };
    ComboBox::from_label(fill(tr("where {0} is hidden"), &[&id])).selected_text(name(*value)).show_ui(ui, |ui| {
        for one in [Hidden::Show, Hidden::Fade, Hidden::Dash, Hidden::Cut] {
            ui.selectable_value(value, one, name(one));
        }
    });
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
