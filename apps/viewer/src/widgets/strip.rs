//! Styling sections from near to far as a strip whose borders are dragged.

use super::nudged;
use crate::language::{fill, tr};
use belvedere::core::presets::edit::PresetChange;
use eframe::egui::{Align2, Color32, CursorIcon, FontId, Id, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

const HEIGHT: f32 = 34.0;
/// Room for the bar of the panel, points.
const BAR: f32 = 10.0;
/// Width of the part of a border that takes the pointer, points.
const GRAB: f32 = 14.0;
/// Step of the arrow keys, share of the curve's length.
const NUDGE: f64 = 0.01;
const INK: Color32 = Color32::from_rgb(30, 34, 44);

/// An edit of the user.
pub(crate) struct StripEdit {
    pub(crate) change: PresetChange,
    /// Whether it begins a drag: the edits up to the next beginning are one step of undo.
    pub(crate) begins: bool,
}

/// Shows the sections; the name of a representation may be dropped on each.
///
/// * `borders`: shares of the curve's length, ascending, one fewer than sections. `color`: fill for a name.
pub(crate) fn strip(
    ui: &mut Ui,
    id: Id,
    sections: &[String],
    borders: &[f64],
    color: impl Fn(&str) -> Color32,
) -> Option<StripEdit> {
    let (rect, whole) =
        ui.allocate_exact_size(vec2((ui.available_width() - BAR).clamp(60.0, 520.0), HEIGHT), Sense::hover());
    whole.widget_info(|| WidgetInfo::labeled(Role::Group, true, tr("Sections, near to far")));
    let at = |u: f64| rect.left() + u.clamp(0.0, 1.0) as f32 * rect.width();
    let painter = ui.painter_at(rect.expand(2.0));
    let mut edit = None;
    for (i, section) in sections.iter().enumerate() {
        let from = i.checked_sub(1).and_then(|i| borders.get(i)).copied().unwrap_or(0.0);
        let to = borders.get(i).copied().unwrap_or(1.0);
        let part = Rect::from_min_max(pos2(at(from), rect.top()), pos2(at(to), rect.bottom()));
        let response = ui.interact(part, id.with(("section", i)), Sense::hover());
        painter.rect_filled(part, 0.0, color(section));
        let text = format!("{}. {section}", i + 1);
        let clipped = painter.with_clip_rect(part.shrink(3.0).intersect(ui.clip_rect()));
        clipped.text(part.center(), Align2::CENTER_CENTER, text, FontId::proportional(12.0), INK);
        if let Some(dropped) = response.dnd_release_payload::<String>() {
            edit = Some(StripEdit { change: PresetChange::Section(i + 1, (*dropped).clone()), begins: true });
        }
        if response.dnd_hover_payload::<String>().is_some() {
            painter.rect_stroke(part, 0.0, Stroke::new(2.0, INK), eframe::egui::StrokeKind::Inside);
        }
    }
    for (i, border) in borders.iter().enumerate() {
        let x = at(*border);
        let grip = Rect::from_center_size(pos2(x, rect.center().y), vec2(GRAB, rect.height()));
        let response = ui.interact(grip, id.with(("border", i)), Sense::click_and_drag());
        let name = fill(tr("Border {0} of the sections"), &[&(i + 1)]);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        let strong = response.hovered() || response.dragged() || response.has_focus();
        painter.vline(x, rect.y_range(), Stroke::new(if strong { 4.0 } else { 2.5 }, INK));
        let place = |u: f64| PresetChange::PlaceTag(i + 1, u.clamp(0.0, 1.0));
        if response.dragged()
            && response.drag_delta().x != 0.0
            && let Some(to) = response.interact_pointer_pos()
        {
            let u = f64::from((to.x - rect.left()) / rect.width());
            edit = Some(StripEdit { change: place(u), begins: response.drag_started() });
        } else if response.drag_started() {
            // The gesture begins here even where the pointer stands still or moves up.
            edit = Some(StripEdit { change: place(*border), begins: true });
        } else if let Some([step, _]) = nudged(ui, &response) {
            edit = Some(StripEdit { change: place(border + NUDGE * step), begins: true });
        }
        response.on_hover_cursor(CursorIcon::ResizeHorizontal).on_hover_text(name);
    }
    edit
}
