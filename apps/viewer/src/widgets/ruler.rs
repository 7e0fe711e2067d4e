//! The angle ruler: presets over the range of viewing angles, and the viewing angle of the camera.

use crate::language::{fill, tr};
use crate::theme;
use eframe::egui::{Align2, FontId, Id, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

const HEIGHT: f32 = 52.0;
/// Range of angles, degrees.
pub(crate) const RANGE: [f64; 2] = [0.0, 90.0];

/// An edit of the user.
pub(crate) enum RulerEdit {
    /// Chose the preset of that number.
    Choose(usize),
    /// Drags that preset to an angle, degrees, possibly outside [`RANGE`]; whether the drag begins.
    Move(usize, f64, bool),
}

/// Draws the ruler.
///
/// * `presets`: name and angle of each. `chosen`: the one that is edited. `phi`: viewing angle of the camera, degrees.
pub(crate) fn ruler(
    ui: &mut Ui,
    id: Id,
    presets: &[(String, f64)],
    chosen: usize,
    phi: Option<f64>,
) -> Option<RulerEdit> {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Group, true, tr("Viewing angles")));
    let inner = rect.shrink2(vec2(12.0, 0.0));
    let x_of = |phi: f64| inner.left() + ((phi - RANGE[0]) / (RANGE[1] - RANGE[0])) as f32 * inner.width();
    let painter = ui.painter_at(rect);
    let (ink, is_dark) = (ui.visuals().text_color(), ui.visuals().dark_mode);
    let y = rect.center().y;
    painter.hline(inner.x_range(), y, Stroke::new(1.5, ink));
    for degrees in (0..=90).step_by(15) {
        let x = x_of(f64::from(degrees));
        painter.vline(x, y..=y + 5.0, Stroke::new(1.0, ink));
        painter.text(pos2(x, y + 6.0), Align2::CENTER_TOP, format!("{degrees}°"), FontId::proportional(10.0), ink);
    }
    if let Some(phi) = phi {
        painter.vline(
            x_of(phi.clamp(RANGE[0], RANGE[1])),
            y - 18.0..=y + 8.0,
            Stroke::new(2.0, theme::readable(theme::CAMERA, is_dark)),
        );
    }
    let mut edit = None;
    for (i, (name, phi)) in presets.iter().enumerate() {
        let at = pos2(x_of(phi.clamp(RANGE[0], RANGE[1])), y - 9.0);
        let target = eframe::egui::Rect::from_center_size(at, vec2(16.0, 18.0));
        let response = ui.interact(target, id.with(("preset", i)), Sense::click_and_drag());
        let label = if name.is_empty() {
            fill(tr("Preset {0} at {1}°"), &[&(i + 1), &format!("{phi:.0}")])
        } else {
            fill(tr("Preset {0} at {1}°"), &[name, &format!("{phi:.0}")])
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
        let color = if i == chosen { theme::readable(theme::CHOSEN, is_dark) } else { ink };
        painter.circle_filled(at, if response.hovered() || i == chosen { 6.5 } else { 5.0 }, color);
        if response.clicked() {
            edit = Some(RulerEdit::Choose(i));
        }
        if response.dragged()
            && let Some(to) = response.interact_pointer_pos()
        {
            let share = f64::from((to.x - inner.left()) / inner.width());
            let to = RANGE[0] + share * (RANGE[1] - RANGE[0]);
            edit = Some(RulerEdit::Move(i, (2.0 * to).round() / 2.0, response.drag_started()));
        }
        if let Some([step, _]) = super::nudged(ui, &response) {
            edit = Some(RulerEdit::Move(i, phi + 0.5 * step, true));
        }
        response.on_hover_text(label);
    }
    edit
}
