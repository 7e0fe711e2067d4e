//! Colours, widths and sizes by a property of the file, and the property that holds the names.

use super::fields::{self, Reading};
use super::paint::color;
use crate::language::{fill, tr};
use belvedere::by_property::{CATEGORIES, Class, Coloring, Field, SCALES};
use belvedere::scene::Color;
use belvedere::scene_file::{ColorByDoc, ScaleName, SizeByDoc, StepsDoc};
use eframe::egui::{Color32, ComboBox, DragValue, Id, Sense, Slider, Ui, pos2, vec2};
use std::sync::Arc;

/// Values that are offered for a colour of their own.
const OFFERED: usize = 200;
/// Most colours of single values.
const MOST_COLORS: usize = 40;

fn hex(Color { r, g, b, .. }: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The property that gives the colour, and what it does with its values.
///
/// * `usual`: colour of the layer.
pub(super) fn colors(ui: &mut Ui, id: &str, reading: &Reading, by: &mut Option<ColorByDoc>, usual: &str) {
    let Some(known) = known(ui, reading) else { return };
    let shown = by.as_ref().map_or(tr("nothing: one colour"), |by| by.property.as_str()).to_owned();
    ComboBox::from_label(fill(tr("{0} coloured by"), &[&id])).selected_text(shown).show_ui(ui, |ui| {
        if ui.selectable_label(by.is_none(), tr("nothing: one colour")).clicked() {
            *by = None;
        }
        for field in known {
            let is_it = by.as_ref().is_some_and(|by| by.property == field.name);
            if ui.selectable_label(is_it, fields::described(field)).clicked() && !is_it {
                *by = Some(ColorByDoc::of(&field.name));
            }
        }
    });
    let Some(doc) = by else { return };
    let same = |field: &&Field| field.name.to_lowercase() == doc.property.to_lowercase();
    let Some(field) = known.iter().find(same) else {
        ui.colored_label(ui.visuals().warn_fg_color, tr("The file has no such property."));
        return;
    };
    let classed = classed(ui, id, reading, doc, field);
    match &*classed {
        Ok(coloring) if coloring.is_of_numbers() => {
            numbers(ui, id, doc);
            let is_smooth = doc.steps == Some(StepsDoc::Smooth);
            coloring.classes.iter().for_each(|class| swatch(ui, class, is_smooth));
            if !is_smooth && field.values.len() <= MOST_COLORS {
                let each = ui.button(tr("A colour for each number"));
                if each.on_hover_text(tr("each number becomes a category with a colour of its own")).clicked() {
                    let values = field.values.iter().zip(CATEGORIES.into_iter().cycle());
                    let values = values.map(|((value, _), color)| (value.clone(), hex(color))).collect();
                    *doc = ColorByDoc { values, others: doc.others.take(), ..ColorByDoc::of(&doc.property) };
                }
            }
            others(ui, id, doc, coloring.others, usual);
        }
        Ok(coloring) => {
            texts(ui, id, (doc, field), coloring);
            others(ui, id, doc, coloring.others, usual);
        }
        Err((_, reason)) => drop(ui.colored_label(ui.visuals().warn_fg_color, reason)),
    }
}

/// The classes of a property, or what is wrong with their style.
type Classed = Arc<Result<Coloring, (&'static str, String)>>;

/// The classes, made anew when their style or the file changes.
fn classed(ui: &Ui, id: &str, reading: &Reading, doc: &ColorByDoc, field: &Field) -> Classed {
    #[derive(Clone)]
    struct Kept(Reading, ColorByDoc, Classed);
    let key = Id::unique(("classes", id));
    if let Some(Kept(of, by, classed)) = ui.data(|data| data.get_temp::<Kept>(key))
        && Arc::ptr_eq(&of, reading)
        && by == *doc
    {
        return classed;
    }
    let classed = Classed::new(Coloring::new(doc, &field.values));
    ui.data_mut(|data| data.insert_temp(key, Kept(reading.clone(), doc.clone(), classed.clone())));
    classed
}

/// The properties; words while there are none.
fn known<'r>(ui: &mut Ui, reading: &'r Reading) -> Option<&'r [Field]> {
    match reading.get() {
        None => drop(ui.weak(tr("reading the properties of the file"))),
        Some(Err(reason)) => drop(ui.colored_label(ui.visuals().warn_fg_color, reason)),
        Some(Ok(fields)) => return Some(fields).filter(|fields| !fields.is_empty()).map(Vec::as_slice),
    }
    None
}

/// Scale and classes of numbers.
fn numbers(ui: &mut Ui, id: &str, doc: &mut ColorByDoc) {
    let scale = doc.scale.unwrap_or_default();
    let named = SCALES.iter().find(|(_, s)| *s == scale).map_or("", |(name, _)| *name);
    ComboBox::from_label(fill(tr("scale of {0}"), &[&id])).selected_text(named).show_ui(ui, |ui| {
        for (name, one) in SCALES {
            ui.horizontal(|ui| {
                ramp(ui, one);
                if ui.selectable_label(one == scale, name).clicked() {
                    doc.scale = Some(one);
                }
            });
        }
    });
    let words = |steps: StepsDoc| match steps {
        StepsDoc::Quantiles => tr("classes with as many features each"),
        StepsDoc::Equal => tr("classes of equal width"),
        StepsDoc::Smooth => tr("a smooth ramp"),
    };
    let mut steps = doc.steps.unwrap_or_default();
    let shown = if doc.breaks.is_some() { tr("the limits of the scene file") } else { words(steps) };
    let before = steps;
    ComboBox::from_label(fill(tr("steps of {0}"), &[&id])).selected_text(shown).show_ui(ui, |ui| {
        for one in [StepsDoc::Quantiles, StepsDoc::Equal, StepsDoc::Smooth] {
            if ui.selectable_value(&mut steps, one, words(one)).clicked() {
                doc.breaks = None;
            }
        }
    });
    if steps != before {
        doc.steps = Some(steps);
    }
    if steps != StepsDoc::Smooth && doc.breaks.is_none() {
        let mut count = doc.classes.unwrap_or(5);
        let row = ui.horizontal_wrapped(|ui| {
            let response = ui.add(Slider::new(&mut count, 3..=7));
            let label = ui.label(fill(tr("classes of {0}"), &[&id]));
            response.labelled_by(label.id)
        });
        if row.inner.changed() {
            doc.classes = Some(count);
        }
    }
}

/// A small picture of a scale.
fn ramp(ui: &mut Ui, scale: ScaleName) {
    const PIECES: usize = 12;
    let (rect, _) = ui.allocate_exact_size(vec2(60.0, 12.0), Sense::hover());
    let width = rect.width() / PIECES as f32;
    for i in 0..PIECES {
        let piece = eframe::egui::Rect::from_min_size(
            pos2(rect.left() + i as f32 * width, rect.top()),
            vec2(width + 0.5, rect.height()),
        );
        let Color { r, g, b, .. } = scale.color_at(i as f64 / (PIECES - 1) as f64);
        ui.painter().rect_filled(piece, 0.0, Color32::from_rgb(r, g, b));
    }
}

/// The colour of a class of numbers, and its range.
/// A colour and what has it; places on a smooth ramp have no number of features.
fn swatch(ui: &mut Ui, class: &Class, is_place: bool) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(22.0, 12.0), Sense::hover());
        let Color { r, g, b, .. } = class.color;
        ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
        let words = if is_place { class.name.clone() } else { fill(tr("{0} ({1})"), &[&class.name, &class.count]) };
        ui.label(words);
    });
}

/// A colour for each text.
fn texts(ui: &mut Ui, id: &str, (doc, field): (&mut ColorByDoc, &Field), coloring: &Coloring) {
    // A changed colour states all of them, so that none changes when the file does.
    let stated = || coloring.classes.iter().map(|class| (class.name.clone(), hex(class.color)));
    let mut next = None;
    for class in &coloring.classes {
        let mut text = doc.values.get(&class.name).cloned().unwrap_or_else(|| hex(class.color));
        ui.horizontal(|ui| {
            let name = fill(tr("{0} ({1})"), &[&class.name, &class.count]);
            if color(ui, &name, &mut text) {
                next = Some(stated().chain([(class.name.clone(), text.clone())]).collect());
            }
            let remove = ui.small_button(tr("Others"));
            if remove.on_hover_text(fill(tr("{0} has the colour of the others"), &[&class.name])).clicked() {
                next = Some(stated().filter(|(name, _)| *name != class.name).collect());
            }
        });
    }
    let is_new = |value: &&str| !coloring.classes.iter().any(|class| class.name == *value);
    let more: Vec<&str> = field.values.iter().map(|(v, _)| v.trim()).filter(is_new).take(OFFERED).collect();
    if !more.is_empty() && coloring.classes.len() < MOST_COLORS {
        let label = fill(tr("one more value of {0}"), &[&id]);
        ComboBox::from_label(label).selected_text(tr("choose")).show_ui(ui, |ui| {
            for value in more {
                if ui.selectable_label(false, value).clicked() {
                    let color = CATEGORIES[coloring.classes.len() % CATEGORIES.len()];
                    next = Some(stated().chain([(value.to_owned(), hex(color))]).collect());
                }
            }
        });
    }
    if let Some(next) = next {
        doc.values = next;
    }
}

/// The colour of what belongs to no class.
fn others(ui: &mut Ui, id: &str, doc: &mut ColorByDoc, count: usize, usual: &str) {
    let mut text = doc.others.clone().unwrap_or_else(|| usual.to_owned());
    if color(ui, &fill(tr("others of {0} ({1})"), &[&id, &count]), &mut text) {
        doc.others = Some(text);
    }
}

/// The property that gives the width or the size, and its range in pixels.
///
/// * `words`: the name of the choice, and of the size without one.
pub(super) fn sizes(ui: &mut Ui, words: [String; 2], reading: &Reading, by: &mut Option<SizeByDoc>) {
    let known = reading.get().and_then(|known| known.as_ref().ok()).map_or(&[][..], Vec::as_slice);
    let numbers: Vec<&Field> = known.iter().filter(|field| field.range.is_some()).collect();
    if numbers.is_empty() && by.is_none() {
        return;
    }
    let [name, none] = words;
    let shown = by.as_ref().map_or(none.as_str(), |by| by.property.as_str()).to_owned();
    ComboBox::from_label(&name).selected_text(shown).show_ui(ui, |ui| {
        if ui.selectable_label(by.is_none(), &none).clicked() {
            *by = None;
        }
        for field in numbers {
            let is_it = by.as_ref().is_some_and(|by| by.property == field.name);
            if ui.selectable_label(is_it, fields::described(field)).clicked() && !is_it {
                *by = Some(SizeByDoc::of(&field.name));
            }
        }
    });
    if let Some(doc) = by {
        ui.horizontal_wrapped(|ui| {
            let ends = [tr("pixels of the lowest number"), tr("of the highest")];
            for (px, words) in doc.px.iter_mut().zip(ends) {
                let label = ui.label(words);
                ui.add(DragValue::new(px).speed(0.05).range(0.2..=100.0).clamp_existing_to_range(false))
                    .labelled_by(label.id);
            }
        });
    }
}

/// The property that holds the names.
pub(super) fn names(ui: &mut Ui, id: &str, reading: &Reading, field: &mut Option<String>) {
    let Some(Ok(known)) = reading.get() else { return };
    let usual = known.iter().find(|f| f.is_name).map(|f| f.name.as_str());
    let Some(shown) = field.as_deref().or(usual).or(known.first().map(|_| tr("nothing"))) else { return };
    let shown = shown.to_owned();
    ComboBox::from_label(fill(tr("names of {0} from"), &[&id])).selected_text(&shown).show_ui(ui, |ui| {
        for one in known {
            let is_it = one.name == shown;
            if ui.selectable_label(is_it, fields::described(one)).clicked() && !is_it {
                *field = Some(one.name.clone());
            }
        }
    });
}
