//! Panels: each shows one part of the document and edits it. No algorithm lives here.

mod gallery;
pub(crate) mod layers;
pub(crate) mod look;
pub(crate) mod moves;
pub(crate) mod rays;
mod sections;
pub(crate) mod spline;
pub(crate) mod terrain;

use crate::export::Exporter;
use crate::language::{later, tr};
use crate::menu::Bookmark;
use crate::model::Model;
use belvedere::scene_file::{Document, StageDoc};
use eframe::egui::{ComboBox, DragValue, Id, ScrollArea, Slider, Ui};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// The side panel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Tab {
    #[default]
    Layers,
    Look,
    Rays,
    Terrain,
    Spline,
    Export,
}

impl Tab {
    const ALL: [(Self, &'static str); 6] = [
        (Self::Layers, later("Layers")),
        (Self::Look, later("Look")),
        (Self::Rays, later("Curved rays")),
        (Self::Terrain, later("Terrain")),
        (Self::Spline, later("Spline")),
        (Self::Export, later("Export")),
    ];
}

/// All panels and what they remember.
#[derive(Default)]
pub(crate) struct Panels {
    pub(crate) tab: Tab,
    rays: rays::RaysPanel,
    spline: spline::SplinePanel,
    pub(crate) exporter: Exporter,
}

impl Panels {
    /// Shows the chosen one.
    pub(crate) fn show(&mut self, ui: &mut Ui, model: &mut Model, bookmarks: &[Bookmark]) {
        ui.horizontal_wrapped(|ui| {
            for (tab, name) in Tab::ALL {
                ui.selectable_value(&mut self.tab, tab, tr(name));
            }
        });
        ui.separator();
        if model.is_opening() {
            ui.weak(tr("opening"));
            return;
        }
        // The width that the user gave the panel is kept, whatever its content.
        ScrollArea::both().auto_shrink(false).show(ui, |ui| match self.tab {
            Tab::Layers => layers::show(ui, model),
            Tab::Look => look::show(ui, model),
            Tab::Rays => self.rays.show(ui, model),
            Tab::Terrain => terrain::show(ui, model),
            Tab::Spline => self.spline.show(ui, model),
            Tab::Export => self.exporter.show(ui, model, bookmarks),
        });
    }

    /// Whether pictures of presets are still to be drawn.
    pub(crate) fn is_drawing(&self) -> bool {
        self.spline.is_drawing()
    }

    /// Advances playing previews and sweeps, and the export.
    pub(crate) fn play(&mut self, ctx: &eframe::egui::Context, model: &mut Model, bookmarks: &[Bookmark]) {
        self.rays.play(ctx, model);
        self.spline.play(ctx, model);
        self.exporter.poll(ctx, model, bookmarks);
    }
}

/// Inserts a stage at its position in the chain, in place of another of its kind.
pub(crate) fn set_stage(document: &mut Document, stage: StageDoc) {
    const ORDER: [&str; 8] =
        ["terrain_disocclusion", "ground_moves", "strip", "tube", "unroll", "relief", "spline_bend", "curved_rays"];
    let rank = |stage: &StageDoc| ORDER.iter().position(|kind| *kind == stage.kind());
    document.stage.retain(|other| other.kind() != stage.kind());
    let at = document.stage.iter().take_while(|other| rank(other) < rank(&stage)).count();
    document.stage.insert(at, stage);
}

/// A list of values with their names, of which one is chosen.
pub(crate) fn choice<T: PartialEq + Copy>(ui: &mut Ui, label: &str, chosen: &mut T, all: &[(T, &'static str)]) {
    let shown = all.iter().find(|(one, _)| one == chosen).map_or("", |(_, name)| tr(name));
    ComboBox::from_label(label).selected_text(shown).show_ui(ui, |ui| {
        for (one, name) in all {
            ui.selectable_value(chosen, *one, tr(name));
        }
    });
}

/// Width of the number and the name beside a slider, points.
const BESIDE_SLIDER: f32 = 190.0;

/// Least width of the value of a slider, points.
const VALUE: f32 = 54.0;

/// A slider with its name after it; its drag is one step of undo. Returns the new value, and the control that edits.
pub(crate) fn slider(
    ui: &mut Ui,
    model: &mut Model,
    name: &str,
    value: f64,
    range: RangeInclusive<f64>,
    help: &str,
) -> Option<(Id, f64)> {
    let mut now = value;
    let slider = ui.scope(|ui| {
        // The name stays where it is whatever number of digits the value has.
        ui.spacing_mut().interact_size.x = VALUE;
        // In a narrow panel the slider leaves its name the room.
        let rest = ui.available_width() - BESIDE_SLIDER;
        ui.spacing_mut().slider_width = rest.clamp(0.6 * ui.spacing().slider_width, ui.spacing().slider_width);
        ui.add(Slider::new(&mut now, range).text(name))
    });
    let response = slider.inner.on_hover_text(help);
    model.changed(&response).map(|by| (by, now))
}

/// A number with its name before it; its drag is one step of undo. Returns the new value, and the control that edits.
pub(crate) fn number(
    ui: &mut Ui,
    model: &mut Model,
    name: &str,
    value: f64,
    speed: f64,
    help: &str,
) -> Option<(Id, f64)> {
    let mut now = value;
    let response = ui
        .horizontal(|ui| {
            let label = ui.label(name);
            ui.add(DragValue::new(&mut now).speed(speed).max_decimals(3)).labelled_by(label.id)
        })
        .inner
        .on_hover_text(help);
    model.changed(&response).map(|by| (by, now))
}

/// A share in percent, or a dash.
pub(crate) fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".into(), |share| format!("{:.1} %", 100.0 * share))
}
