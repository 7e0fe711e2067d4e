//! Styling sections of a preset: what each shows, their borders, levels of abstraction, styles of their own.

use crate::language::{fill, tr};
use crate::model::Model;
use crate::widgets::strip::{StripEdit, strip};
use belvedere::core::presets::PresetDocument;
use belvedere::core::presets::edit::PresetChange;
use belvedere::scene_file::{Document, LayerDoc};
use belvedere_studio::{with_levels, with_own_style};
use eframe::egui::{Color32, ComboBox, Id, RichText, Role, TextStyle, TextWrapMode, Ui, WidgetInfo, WidgetText};

/// Name of sections that name no representation.
const UNNAMED: &str = "all";

/// An edit of the user.
pub(super) enum SectionEdit {
    /// Changes of the preset, and whether they begin a step of undo.
    Preset(Vec<PresetChange>, bool),
    /// Another document, a step of undo.
    Document(Box<Document>),
}

/// Shows the sections of a preset.
pub(super) fn show(ui: &mut Ui, model: &mut Model, presets: &PresetDocument, chosen: usize) -> Option<SectionEdit> {
    let preset = presets.presets.get(chosen)?;
    ui.separator();
    ui.strong(tr("Sections, near to far"));
    ui.label(tr("Each stretch of the curve shows what you choose for it. Drag the borders."));
    let borders: Vec<f64> = preset.tags.iter().map(|tag| tag.u).collect();
    let mut edit = None;
    if let Some(StripEdit { change, begins }) =
        strip(ui, ui.scope_id().with(("strip", chosen)), &preset.sections, &borders, color_of)
    {
        edit = Some(SectionEdit::Preset(vec![change], begins));
    }
    let mut known: Vec<String> = vec![UNNAMED.into()];
    known.extend(model.document().representations.keys().cloned());
    known.extend(model.layer_ids(|_| true));
    let count = preset.sections.len();
    for (i, section) in preset.sections.iter().enumerate() {
        let made = row(ui, model, (presets, [chosen, i]), (section, &known), count);
        edit = made.or(edit);
    }
    edit = levels(ui, model, presets, chosen).or(edit);
    ui.weak(tr("Or drag one of these onto a section:"));
    chips(ui, &known);
    edit
}

/// One section: what it shows, and what is done with it.
fn row(
    ui: &mut Ui,
    model: &mut Model,
    (presets, [chosen, i]): (&PresetDocument, [usize; 2]),
    (section, known): (&String, &[String]),
    count: usize,
) -> Option<SectionEdit> {
    let mut edit = None;
    ui.horizontal_wrapped(|ui| {
        let mut to = section.clone();
        ComboBox::from_label(fill(tr("Section {0}"), &[&(i + 1)])).width(110.0).selected_text(&to).show_ui(ui, |ui| {
            for name in known {
                ui.selectable_value(&mut to, name.clone(), name);
            }
        });
        if to != *section {
            edit = Some(SectionEdit::Preset(vec![PresetChange::Section(i + 1, to)], true));
        }
        let button = |ui: &mut Ui, words: &str, name: String| {
            let response = ui.small_button(words);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            response.on_hover_text(name).clicked()
        };
        if button(ui, tr("Split in two"), fill(tr("Split section {0} in two"), &[&(i + 1)])) {
            edit = Some(SectionEdit::Preset(vec![PresetChange::Split(i + 1)], true));
        }
        if count > 1 && button(ui, tr("Remove"), fill(tr("Remove section {0}"), &[&(i + 1)])) {
            edit = Some(removed(i, &presets.presets[chosen].sections));
        }
        let style = ui.menu_button(tr("Own style"), |ui| {
            ui.label(tr("A copy of the layer is shown here alone. Change its style under Layers."));
            for id in shown_by(model, section) {
                if ui.button(fill(tr("Copy of {0}"), &[&id])).clicked() {
                    match with_own_style(model.document(), presets, [chosen, i], &id) {
                        Ok((next, copy)) => {
                            model.notices.tell(fill(tr("{0} is a layer of its own now."), &[&copy]));
                            edit = Some(SectionEdit::Document(Box::new(next)));
                        }
                        Err(reason) => model.notices.error(reason),
                    }
                    ui.close();
                }
            }
        });
        let name = fill(tr("Style of its own for section {0}"), &[&(i + 1)]);
        style.response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    });
    edit
}

/// The layers that a section shows.
fn shown_by(model: &Model, section: &str) -> Vec<String> {
    match model.document().representations.get(section) {
        Some(members) => model.layer_ids(|layer| members.iter().any(|member| member == layer.id())),
        None if section == UNNAMED => model.layer_ids(|_| true),
        None => model.layer_ids(|layer| layer.id() == section),
    }
}

/// The section goes, and its neighbour takes its place.
fn removed(i: usize, sections: &[String]) -> SectionEdit {
    // Joined sections show what the first of them showed.
    let changes = match (i, sections.get(1)) {
        (0, Some(next)) => vec![PresetChange::Section(1, next.clone()), PresetChange::Merge(1)],
        _ => vec![PresetChange::Merge(i)],
    };
    SectionEdit::Preset(changes, true)
}

/// Levels of abstraction of a city.
fn levels(ui: &mut Ui, model: &mut Model, presets: &PresetDocument, chosen: usize) -> Option<SectionEdit> {
    let city = model.layer_ids(|layer| matches!(layer, LayerDoc::City(city) if city.loa == 0)).into_iter().next()?;
    let words = fill(tr("Three sections of {0}: buildings, blocks, main blocks"), &[&city]);
    let help = tr("near the buildings, behind them blocks between streets, far away blocks between main streets");
    if !ui.button(words).on_hover_text(help).clicked() {
        return None;
    }
    match with_levels(model.document(), presets, chosen, &city) {
        Ok(next) => Some(SectionEdit::Document(Box::new(next))),
        Err(reason) => {
            model.notices.error(reason);
            None
        }
    }
}

/// What sections can show, to be dragged onto them.
fn chips(ui: &mut Ui, known: &[String]) {
    ui.horizontal_wrapped(|ui| {
        for name in known {
            let id = Id::unique(("representation", name));
            let galley = WidgetText::from(dark(name.clone())).into_galley(
                ui,
                Some(TextWrapMode::Extend),
                f32::INFINITY,
                TextStyle::Button,
            );
            // What is dragged does not go to the next row by itself.
            if ui.available_size_before_wrap().x < galley.size().x + 2.0 * ui.spacing().button_padding.x {
                ui.end_row();
            }
            let response = ui
                .dnd_drag_source(id, name.clone(), |ui| {
                    let button = eframe::egui::Button::new(dark(name.clone())).fill(color_of(name));
                    let shown = ui.add(button.wrap_mode(TextWrapMode::Extend));
                    // The control is what is dragged; this is its text.
                    shown.widget_info(|| WidgetInfo::labeled(Role::Label, true, name));
                })
                .response;
            let words = fill(tr("Representation {0}"), &[name]);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &words));
        }
    });
}

/// Text on a muted colour.
fn dark(text: String) -> RichText {
    RichText::new(text).color(Color32::from_rgb(30, 34, 44))
}

/// A muted colour derived from a name.
fn color_of(name: &str) -> Color32 {
    let hash = name.bytes().fold(7u32, |hash, byte| hash.wrapping_mul(31).wrapping_add(u32::from(byte)));
    let palette =
        [[205, 222, 240], [226, 216, 190], [210, 232, 206], [240, 212, 204], [224, 208, 236], [204, 232, 232]];
    let [r, g, b] = palette[hash as usize % palette.len()];
    Color32::from_rgb(r, g, b)
}
