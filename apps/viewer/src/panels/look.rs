//! How the picture is drawn and compared: marks, stylisation, light, projection.

use super::slider;
use crate::language::tr;
use crate::model::{Compare, Model, Tool};
use belvedere::scene_file::{
    HighlightMark, Inset, LightDoc, OverlayDoc, StylisationDoc, SwitchOrLength, SwitchOrStrength, SwitchOrVisibility,
};
use eframe::egui::{ComboBox, Ui};

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, model: &mut Model) {
    let look = &mut model.look;
    ui.horizontal(|ui| {
        ui.label(tr("Pointer"));
        ui.selectable_value(&mut look.tool, Tool::Map, tr("Map"));
        ui.selectable_value(&mut look.tool, Tool::Orbit, tr("Orbit"));
        let help = tr("lengths along the ground, climb and area");
        ui.selectable_value(&mut look.tool, Tool::Measure, tr("Measure")).on_hover_text(help);
    });
    ui.checkbox(&mut look.bent, tr("Bent"));
    ui.horizontal_wrapped(|ui| {
        ui.label(tr("Compare"));
        ui.selectable_value(&mut look.compare, Compare::Off, tr("One picture"));
        ui.selectable_value(&mut look.compare, Compare::Split, tr("Split"));
        ui.selectable_value(&mut look.compare, Compare::Flicker, tr("Flicker"));
    });
    ui.checkbox(&mut look.inset, tr("True view in a corner"));
    ui.checkbox(&mut look.overhead, tr("Camera from above"));
    ui.checkbox(&mut look.statistics, tr("Renderer and times"));
    ui.separator();
    marks(ui, model);
    ui.separator();
    stylisation(ui, model);
    ui.separator();
    light(ui, model);
    ui.separator();
    let fov = model.document().camera.fov_y_deg;
    let words = [tr("field of view, degrees"), tr("from top to bottom")];
    if let Some((by, fov)) = slider(ui, model, words[0], fov, 5.0..=120.0, words[1]) {
        model.edit_on(by, |document| document.camera.fov_y_deg = fov);
    }
}

fn marks(ui: &mut Ui, model: &mut Model) {
    let before = model.document().overlay.clone().unwrap_or_default();
    let mut overlay = before.clone();
    let mut grid = !matches!(overlay.grid, None | Some(SwitchOrLength::Switch(false)));
    if ui.checkbox(&mut grid, tr("Grid on the ground")).changed() {
        overlay.grid = grid.then_some(SwitchOrLength::Switch(true));
    }
    ui.checkbox(&mut overlay.heatmap, tr("Heat map of what was moved"));
    ui.checkbox(&mut overlay.ghost, tr("Straight picture faintly over it"));
    ui.checkbox(&mut overlay.mark, tr("Mark on bent pictures"));
    let mut curve = overlay.inset.is_some();
    if ui.checkbox(&mut curve, tr("Curve in a corner")).on_hover_text(tr("where a spline bends the picture")).changed()
    {
        overlay.inset = curve.then_some(Inset::Curve);
    }
    for (mark, name) in [
        (HighlightMark::Shift, tr("How far it moved in the picture")),
        (HighlightMark::Stages, tr("Which stage moved it")),
        (HighlightMark::Revealed, tr("Outline of what is revealed")),
        (HighlightMark::GhostBox, tr("Box where it would be")),
    ] {
        let mut on = overlay.highlight.contains(&mark);
        if ui.checkbox(&mut on, name).changed() {
            overlay.highlight.retain(|other| *other != mark);
            if on {
                // The two colour ramps exclude each other.
                let ramps = [HighlightMark::Shift, HighlightMark::Stages];
                if ramps.contains(&mark) {
                    overlay.highlight.retain(|other| !ramps.contains(other));
                    overlay.heatmap = false;
                }
                overlay.highlight.push(mark);
            }
        }
    }
    if overlay.heatmap && !before.heatmap {
        overlay.highlight.retain(|mark| !matches!(mark, HighlightMark::Shift | HighlightMark::Stages));
    }
    if overlay != before {
        let stated = (overlay != OverlayDoc::default()).then_some(overlay);
        model.edit(|document| document.overlay = stated);
    }
}

fn stylisation(ui: &mut Ui, model: &mut Model) {
    let before = model.document().stylisation.unwrap_or_default();
    let mut style = before;
    let is_on = |value: Option<SwitchOrStrength>| !matches!(value, None | Some(SwitchOrStrength::Switch(false)));
    for (value, name) in [(&mut style.edges, tr("Edges")), (&mut style.unsharp, tr("Shade behind what stands out"))] {
        let mut on = is_on(*value);
        if ui.checkbox(&mut on, name).changed() {
            *value = on.then_some(SwitchOrStrength::Switch(true));
        }
    }
    if style != before {
        model.edit(|document| document.stylisation = (style != StylisationDoc::default()).then_some(style));
    }
}

fn sky_name(name: &str) -> &str {
    match name {
        "auto" => tr("by the sun"),
        "day" => tr("clear day"),
        "dusk" => tr("dusk"),
        "night" => tr("night"),
        "white" => tr("white"),
        color => color,
    }
}

fn light(ui: &mut Ui, model: &mut Model) {
    let light = model.document().light.clone().unwrap_or_default();
    let mut set = |ui: &mut Ui, name: &str, value: f64, range, help: &str, put: fn(&mut LightDoc, f64)| {
        if let Some((by, value)) = slider(ui, model, name, value, range, help) {
            let mut light = light.clone();
            light.time = None;
            put(&mut light, value);
            model.edit_on(by, |document| document.light = Some(light));
        }
    };
    let azimuth = light.azimuth_deg.unwrap_or(315.0);
    set(ui, tr("sun from, degrees"), azimuth, 0.0..=360.0, tr("clockwise from north"), |l, v| l.azimuth_deg = Some(v));
    let altitude = light.altitude_deg.unwrap_or(45.0);
    set(ui, tr("sun high, degrees"), altitude, 1.0..=90.0, tr("over the horizon"), |l, v| l.altitude_deg = Some(v));
    let mut shadows = light.shadows;
    if ui.checkbox(&mut shadows, tr("Shadows")).changed() {
        model.edit(|document| document.light = Some(LightDoc { shadows, ..light.clone() }));
    }
    let mut sky = light.sky.clone().unwrap_or_else(|| "auto".into());
    let before = sky.clone();
    ComboBox::from_label(tr("Sky")).selected_text(sky_name(&before)).show_ui(ui, |ui| {
        for name in LightDoc::SKIES {
            ui.selectable_value(&mut sky, name.to_owned(), sky_name(name));
        }
    });
    if sky != before {
        let sky = (sky != "auto").then_some(sky);
        model.edit(|document| document.light = Some(LightDoc { sky, ..light.clone() }));
    }
    let mut haze = light.haze != Some(SwitchOrVisibility::Switch(false));
    if ui.checkbox(&mut haze, tr("Haze")).changed() {
        let visibility = model.look.visibility;
        let before = light.haze.filter(|haze| matches!(haze, SwitchOrVisibility::Kilometres(_)));
        model.look.visibility = before.or(visibility);
        let haze = if haze { visibility } else { Some(SwitchOrVisibility::Switch(false)) };
        model.edit(|document| document.light = Some(LightDoc { haze, ..light }));
    }
}
