//! Casings, distance marks, symbols and outlines.

use super::paint::{color, opacity};
use crate::language::{fill, tr};
use belvedere::scene::Symbol;
use belvedere::scene_file::SymbolDoc;
use belvedere::scene_file::{AutoOrLength, AutoWord};
use eframe::egui::{ComboBox, DragValue, Ui};

/// Distance between marks that is offered first, metres.
const EVERY: f64 = 1000.0;

/// A colour that may be none.
pub(super) fn casing(ui: &mut Ui, id: &str, text: &mut String) {
    let mut on = !text.eq_ignore_ascii_case("none");
    ui.horizontal_wrapped(|ui| {
        if ui.checkbox(&mut on, fill(tr("rim of {0}"), &[&id])).changed() {
            *text = if on { "#ffffff" } else { "none" }.to_owned();
        }
    });
    if on {
        color(ui, &fill(tr("colour of the rim of {0}"), &[&id]), text);
    }
}

/// Marks at equal distances along lines.
pub(super) fn distances(ui: &mut Ui, id: &str, marks: &mut Option<AutoOrLength>) {
    let words = |marks: Option<AutoOrLength>| match marks {
        None => tr("none"),
        Some(AutoOrLength::Auto(_)) => tr("about ten on a line"),
        Some(AutoOrLength::Length(_)) => tr("at a distance of"),
    };
    let choices = [None, Some(AutoOrLength::Auto(AutoWord::Auto)), Some(AutoOrLength::Length(EVERY))];
    ui.horizontal(|ui| {
        let label = fill(tr("distance marks of {0}"), &[&id]);
        ComboBox::from_label(label).selected_text(words(*marks)).show_ui(ui, |ui| {
            for one in choices {
                if ui.selectable_label(words(one) == words(*marks), words(one)).clicked() {
                    *marks = one;
                }
            }
        });
        if let Some(AutoOrLength::Length(every)) = marks {
            let label = ui.label(tr("metres"));
            ui.add(DragValue::new(every).speed(10.0).range(1.0..=1e6).clamp_existing_to_range(false))
                .labelled_by(label.id);
        }
    });
}

/// The shape of points.
pub(super) fn symbol(ui: &mut Ui, id: &str, symbol: &mut SymbolDoc) {
    let words = |symbol: &SymbolDoc| match symbol {
        SymbolDoc::Auto => tr("as its points say"),
        SymbolDoc::File(_) => tr("a drawing of its own"),
        SymbolDoc::Named(symbol) => match symbol {
            Symbol::Dot | Symbol::Own(_) => tr("dot"),
            Symbol::Triangle => tr("triangle"),
            Symbol::Square => tr("square"),
            Symbol::Pin => tr("pin"),
            Symbol::Cross => tr("cross"),
            Symbol::Hut => tr("hut"),
            Symbol::Pass => tr("pass"),
            Symbol::Lift => tr("lift"),
            Symbol::Viewpoint => tr("viewpoint"),
            Symbol::Parking => tr("car park"),
            Symbol::Ring => tr("ring"),
            Symbol::Target => tr("ring and dot"),
        },
    };
    ComboBox::from_label(fill(tr("symbol of {0}"), &[&id])).selected_text(words(symbol)).show_ui(ui, |ui| {
        let named = Symbol::NAMED.map(|(_, symbol)| SymbolDoc::Named(symbol));
        for one in std::iter::once(SymbolDoc::Auto).chain(named) {
            let word = words(&one);
            ui.selectable_value(symbol, one, word);
        }
    });
}

/// The outline of areas: that of their surface, none, or one of its own.
pub(super) fn outline(ui: &mut Ui, id: &str, outline: &mut Option<String>) {
    let words = |outline: Option<&str>| match outline {
        None => tr("as the surface has it"),
        Some("none") => tr("none"),
        Some(_) => tr("a colour of its own"),
    };
    ComboBox::from_label(fill(tr("line round {0}"), &[&id])).selected_text(words(outline.as_deref())).show_ui(
        ui,
        |ui| {
            for one in [None, Some("none"), Some("#404040")] {
                let is_it = words(one) == words(outline.as_deref());
                if ui.selectable_label(is_it, words(one)).clicked() && !is_it {
                    *outline = one.map(str::to_owned);
                }
            }
        },
    );
    if let Some(text) = outline.as_mut().filter(|text| text.as_str() != "none") {
        color(ui, &fill(tr("colour of the line round {0}"), &[&id]), text);
        opacity(ui, &fill(tr("the line round {0}"), &[&id]), text);
    }
}
