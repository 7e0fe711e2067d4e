//! Colours and their opacity, as texts of the document.

use crate::language::{fill, tr};
use eframe::egui::{Color32, Slider, Ui};

/// A colour; whether it was changed.
pub(super) fn color(ui: &mut Ui, name: &str, text: &mut String) -> bool {
    let now = opaque(text);
    let mut rgb = [now.r(), now.g(), now.b()];
    let changed = ui
        .horizontal_wrapped(|ui| {
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
pub(super) fn opacity(ui: &mut Ui, id: &str, text: &mut String) -> bool {
    let now = opaque(text);
    let alpha = text.get(7..9).and_then(|digits| u8::from_str_radix(digits, 16).ok()).unwrap_or(255);
    let mut percent = (f64::from(alpha) / 2.55).round();
    let changed = percents(ui, id, &mut percent);
    if changed {
        let [r, g, b, _] = now.to_array();
        let alpha = (percent * 2.55).round().clamp(0.0, 255.0) as u8;
        *text = format!("#{r:02x}{g:02x}{b:02x}");
        if alpha < 255 {
            *text += &format!("{alpha:02x}");
        }
    }
    changed
}

/// Opacity of a solid, 0..=1, shown in percent.
pub(super) fn opacity_of_solid(ui: &mut Ui, id: &str, opacity: &mut f64) {
    let mut percent = (100.0 * *opacity).round();
    if percents(ui, id, &mut percent) {
        *opacity = (percent.round() / 100.0).clamp(0.0, 1.0);
    }
}

/// The slider; whether it was moved.
fn percents(ui: &mut Ui, id: &str, percent: &mut f64) -> bool {
    // In a narrow panel the words stand below.
    let slider = Slider::new(percent, 0.0..=100.0).suffix(" %");
    let row = ui.horizontal_wrapped(|ui| {
        let response = ui.add(slider);
        let label = ui.label(fill(tr("opacity of {0}"), &[&id]));
        response.labelled_by(label.id)
    });
    row.inner.changed()
}
