//! Layers: what is there, what must be seen, how it is drawn.

use super::percent;
use crate::model::Model;
use belvedere::Warning;
use belvedere::scene::Hidden;
use belvedere::scene_file::{LayerDoc, PaletteDoc, PaletteName};
use eframe::egui::{CollapsingHeader, Color32, ComboBox, DragValue, Ui};

/// Shows the list.
pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    let document = model.document().clone();
    let mut title = document.title.clone();
    ui.horizontal(|ui| {
        let label = ui.label("Title");
        if ui.text_edit_singleline(&mut title).labelled_by(label.id).changed() {
            model.edit_on(|document| document.title = title);
        }
    });
    if document.layer.is_empty() {
        ui.label("There is no layer. Drop a GeoTIFF and a GPX on the window, or open a scene.");
    }
    for (index, layer) in document.layer.iter().enumerate() {
        ui.separator();
        one(ui, model, index, layer);
    }
    let mut warnings = model.shown.as_ref().map_or_else(Vec::new, |shown| shown.session.warnings());
    if !warnings.is_empty() {
        warnings.sort_by_key(Warning::kind);
        ui.separator();
        CollapsingHeader::new(format!("Warnings ({})", warnings.len())).show(ui, |ui| {
            for alike in warnings.chunk_by(|a, b| a.kind() == b.kind()) {
                ui.weak(alike[0].kind().name());
                alike.iter().for_each(|warning| drop(ui.label(warning.text())));
            }
        });
    }
}

fn one(ui: &mut Ui, model: &mut Model, index: usize, layer: &LayerDoc) {
    let id = layer.id();
    ui.horizontal(|ui| {
        ui.strong(id);
        ui.weak(layer.kind());
        if let Some([seen, in_frame]) = shares(model, id) {
            ui.label(format!("{} visible, {} in the frame", percent(Some(seen)), percent(Some(in_frame))));
        }
    });
    if !matches!(layer, LayerDoc::Terrain(_)) {
        let mut must_see = layer.must_see();
        if ui.checkbox(&mut must_see, format!("{id} must be seen")).changed() {
            model.edit(|d| d.layer[index] = d.layer[index].with_must_see(must_see));
        }
    }
    if let Some(mut rigid) = layer.rigid() {
        let words =
            "Each building, box or part keeps its shape where space bends: walls stay straight, nothing of it folds.";
        if ui.checkbox(&mut rigid, format!("{id} is rigid")).on_hover_text(words).changed() {
            model.edit(|d| d.layer[index] = d.layer[index].with_rigid(rigid));
        }
    }
    CollapsingHeader::new(format!("Style of {id}")).show(ui, |ui| style(ui, model, index, layer));
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

fn style(ui: &mut Ui, model: &mut Model, index: usize, layer: &LayerDoc) {
    let key = ui.scope_id().with(("style", index));
    let pending = ui.data(|data| data.get_temp::<Pending>(key));
    let mut next = pending.map_or_else(|| layer.clone(), |pending| pending.0);
    let id = layer.id().to_owned();
    match &mut next {
        LayerDoc::Terrain(l) => {
            palette(ui, &id, &mut l.style.palette);
            ui.checkbox(&mut l.style.sea, format!("sea of {id}"));
        }
        LayerDoc::Line(l) => {
            color(ui, &format!("colour of {id}"), &mut l.style.color);
            width(ui, &format!("width of {id}, pixels"), &mut l.style.width_px);
            hidden(ui, &id, &mut l.style.hidden);
        }
        LayerDoc::Area(l) => {
            let mut text = l.style.color.clone().unwrap_or_else(|| "#8fb4cc".into());
            if color(ui, &format!("colour of {id}"), &mut text) {
                l.style.color = Some(text);
            }
        }
        LayerDoc::Point(l) => {
            color(ui, &format!("colour of {id}"), &mut l.style.color);
            width(ui, &format!("size of {id}, pixels"), &mut l.style.size_px);
            hidden(ui, &id, &mut l.style.hidden);
        }
        LayerDoc::Boxes(l) => {
            color(ui, &format!("colour of {id}"), &mut l.style.color);
        }
        LayerDoc::Mesh(l) => {
            color(ui, &format!("colour of {id}"), &mut l.style.color);
            occlusion(ui, &id, &mut l.style.ambient_occlusion);
        }
        LayerDoc::City(l) => {
            color(ui, &format!("roofs of {id}"), &mut l.style.roof);
            color(ui, &format!("walls of {id}"), &mut l.style.wall);
            color(ui, &format!("ground of {id}"), &mut l.style.ground);
            occlusion(ui, &id, &mut l.style.ambient_occlusion);
        }
        LayerDoc::Molecule(_) => {
            ui.label("Atoms are drawn in the colours of their elements; see molecules in the guide.");
        }
        LayerDoc::Volume(l) => {
            ui.horizontal(|ui| {
                let label = ui.label(format!("transfer function of {id}"));
                ui.text_edit_singleline(&mut l.transfer).labelled_by(label.id);
            });
        }
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
        if ui.checkbox(&mut on, format!("ambient occlusion of {id}")).changed() {
            *value = on.then_some(REACH);
        }
        if let Some(reach) = value {
            let label = ui.label("within");
            ui.add(DragValue::new(reach).speed(0.5).range(0.01..=1e4)).labelled_by(label.id);
        }
    });
}

fn color(ui: &mut Ui, name: &str, text: &mut String) -> bool {
    let now = Color32::from_hex(text).unwrap_or(Color32::GRAY);
    let mut rgb = [now.r(), now.g(), now.b()];
    let changed = ui
        .horizontal(|ui| {
            let response = ui.color_edit_button_srgb(&mut rgb).on_hover_text(name);
            ui.label(name);
            response.changed()
        })
        .inner;
    if changed {
        *text = format!("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
    }
    changed
}

fn hidden(ui: &mut Ui, id: &str, value: &mut Hidden) {
    let name = |hidden: Hidden| match hidden {
        Hidden::Show => "show",
        Hidden::Fade => "fade",
        Hidden::Dash => "dash",
        Hidden::Cut => "cut",
    };
    ComboBox::from_label(format!("where {id} is hidden")).selected_text(name(*value)).show_ui(ui, |ui| {
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
    ComboBox::from_label(format!("tints of {id}")).selected_text(shown).show_ui(ui, |ui| {
        for (name, palette) in PaletteName::ALL {
            ui.selectable_value(value, PaletteDoc::Named(palette), name);
        }
    });
}
