//! Transfer function of a volume: its curve of opacity over the histogram of the voxels.

use crate::language::{fill, tr};
use crate::model::Model;
use belvedere::scene::volume::TRANSFER_NAMES;
use belvedere::scene::{TransferPoint, VolumeLayer};
use eframe::egui::{
    Color32, ComboBox, CursorIcon, Id, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use std::sync::Arc;

const HEIGHT: f32 = 110.0;
/// Number of bars of the histogram.
const BARS: usize = 64;
/// Voxels that are counted, at most.
const COUNTED: usize = 400_000;

/// Shows names to choose and the curve; `transfer` is the text of the document.
pub(super) fn show(ui: &mut Ui, model: &Model, id: &str, transfer: &mut String) {
    let shown = if transfer.starts_with("points ") { tr("own curve") } else { transfer.as_str() }.to_owned();
    ComboBox::from_label(fill(tr("colours of {0}"), &[&id])).selected_text(shown).show_ui(ui, |ui| {
        for name in TRANSFER_NAMES {
            ui.selectable_value(transfer, (*name).to_owned(), *name);
        }
    });
    let scene = model.shown.as_ref().map(|shown| shown.session.scene());
    let layer = scene.and_then(|scene| scene.layers.iter().find(|layer| layer.id == id));
    let Some(volume) = layer.and_then(|layer| layer.kind.volume()) else { return };
    let points = stated(transfer).unwrap_or_else(|| volume.transfer.points().to_vec());
    if let Some(points) = curve(ui, ui.scope_id().with(("transfer", id)), volume, &points) {
        *transfer = text(&points);
    }
    ui.weak(tr("Drag a point up or down, left or right. Double click: a new point, or one less."));
}

/// The points of a text that states them.
fn stated(transfer: &str) -> Option<Vec<TransferPoint>> {
    let one = |text: &str| {
        let [value, color, opacity] = text.split(':').collect::<Vec<_>>()[..] else { return None };
        let [r, g, b, _] = Color32::from_hex(color).ok()?.to_array();
        let color = belvedere::scene::Color::rgb(r, g, b);
        Some(TransferPoint { value: value.parse().ok()?, color, opacity: opacity.parse().ok()? })
    };
    transfer.strip_prefix("points ")?.split_whitespace().map(one).collect()
}

/// The text of points, as the document states them.
fn text(points: &[TransferPoint]) -> String {
    let one = |p: &TransferPoint| {
        let [r, g, b] = [p.color.r, p.color.g, p.color.b];
        format!(" {}:#{r:02x}{g:02x}{b:02x}:{:.3}", (1e4 * p.value).round() / 1e4, p.opacity)
    };
    format!("points{}", points.iter().map(one).collect::<String>())
}

/// Draws histogram and curve and lets the points be dragged. Returns the changed points.
fn curve(ui: &mut Ui, id: Id, volume: &VolumeLayer, points: &[TransferPoint]) -> Option<Vec<TransferPoint>> {
    let (rect, whole) = ui.allocate_exact_size(vec2(ui.available_width().min(420.0), HEIGHT), Sense::click());
    whole.widget_info(|| WidgetInfo::labeled(Role::Group, true, tr("Histogram and opacity")));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, Color32::from_rgb(250, 250, 248));
    let room = rect.shrink2(vec2(8.0, 8.0));
    let [low, high] = volume.volume.range().map(f64::from);
    let span = (high - low).max(1e-12);
    let at = |p: &TransferPoint| {
        let x = ((p.value - low) / span).clamp(0.0, 1.0) as f32;
        pos2(room.left() + x * room.width(), room.bottom() - p.opacity as f32 * room.height())
    };
    let back = |p: Pos2| {
        let share = f64::from((p.x - room.left()) / room.width()).clamp(0.0, 1.0);
        (low + share * span, f64::from((room.bottom() - p.y) / room.height()).clamp(0.0, 1.0))
    };
    let bars = histogram(ui, id, volume, [low, span]);
    let width = room.width() / BARS as f32;
    for (i, share) in bars.iter().enumerate() {
        let [left, top] = [room.left() + i as f32 * width, room.bottom() - share * room.height()];
        let bar = Rect::from_min_max(pos2(left, top), pos2(left + width, room.bottom()));
        painter.rect_filled(bar, 0.0, Color32::from_rgb(196, 202, 210));
    }
    let line: Vec<Pos2> = points.iter().map(at).collect();
    painter.add(Shape::line(line.clone(), Stroke::new(1.5, Color32::from_rgb(60, 70, 90))));
    let mut next = None;
    for (i, spot) in line.iter().enumerate() {
        let own = ui.interact(Rect::from_center_size(*spot, vec2(16.0, 16.0)), id.with(i), Sense::click_and_drag());
        own.widget_info(|| WidgetInfo::labeled(Role::Button, true, fill(tr("Opacity point {0}"), &[&(i + 1)])));
        let color = points[i].color;
        let fill = Color32::from_rgb(color.r, color.g, color.b);
        painter.circle(*spot, if own.hovered() { 6.5 } else { 5.0 }, fill, Stroke::new(1.2, Color32::from_gray(30)));
        if own.double_clicked() && points.len() > 2 {
            next = Some([&points[..i], &points[i + 1..]].concat());
        } else if own.dragged()
            && let Some(to) = own.interact_pointer_pos()
        {
            let mut moved = points.to_vec();
            let (value, opacity) = back(to);
            // Points keep their order.
            let least = if i > 0 { points[i - 1].value + 1e-3 * span } else { low };
            let most = points.get(i + 1).map_or(high, |p| p.value - 1e-3 * span);
            moved[i].value = if least < most { value.clamp(least, most) } else { points[i].value };
            moved[i].opacity = opacity;
            next = Some(moved);
        }
        own.on_hover_cursor(CursorIcon::Move);
    }
    if next.is_none()
        && whole.double_clicked()
        && let Some(to) = whole.interact_pointer_pos()
    {
        let (value, opacity) = back(to);
        let [r, g, b, _] = volume.transfer.at(value).map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
        let new = TransferPoint { value, color: belvedere::scene::Color::rgb(r, g, b), opacity };
        let (before, after) = points.split_at(points.partition_point(|p| p.value < value));
        next = Some([before, &[new], after].concat());
    }
    next
}

/// Bars of the histogram, 0..=1, by the logarithm of the number of voxels; counted once for each volume.
fn histogram(ui: &Ui, id: Id, volume: &VolumeLayer, [low, span]: [f64; 2]) -> Arc<Vec<f32>> {
    let key = id.with(("histogram", Arc::as_ptr(&volume.volume) as usize));
    if let Some(bars) = ui.data(|data| data.get_temp::<Arc<Vec<f32>>>(key)) {
        return bars;
    }
    let values = volume.volume.values();
    let step = values.len().div_ceil(COUNTED).max(1);
    let mut counts = [0u32; BARS];
    for i in (0..values.len()).step_by(step) {
        let share = (f64::from(values.at(i)) - low) / span;
        if share.is_finite() {
            counts[((share * BARS as f64) as usize).min(BARS - 1)] += 1;
        }
    }
    let height = |n: u32| f64::from(n + 1).ln();
    let most = counts.iter().copied().map(height).fold(1e-9, f64::max);
    let bars = Arc::new(counts.iter().map(|n| (height(*n) / most) as f32).collect::<Vec<f32>>());
    ui.data_mut(|data| data.insert_temp(key, bars.clone()));
    bars
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_read_as_they_are_written() {
        let point = |value, opacity| TransferPoint { value, color: belvedere::scene::Color::rgb(1, 200, 30), opacity };
        let points = vec![point(-3.5, 0.0), point(120.0, 0.4)];
        assert_eq!(text(&points), "points -3.5:#01c81e:0.000 120:#01c81e:0.400");
        assert_eq!(stated(&text(&points)), Some(points));
        assert_eq!(stated("engine"), None);
    }

    #[test]
    fn bars_are_higher_where_more_voxels_are() {
        use belvedere::core::{DMat3, DVec3};
        use belvedere::scene::volume::{TransferFunction, Volume, VoxelValues};
        // Of eight voxels five are 0, two 100 and one 50.
        let values = VoxelValues::U8(vec![0, 100, 0, 0, 50, 0, 100, 0]);
        let volume = Volume::new([2, 2, 2], DMat3::IDENTITY, DVec3::ZERO, values).expect("volume");
        let point = TransferPoint { value: 50.0, color: belvedere::scene::Color::rgb(1, 200, 30), opacity: 0.5 };
        let transfer = TransferFunction::new("own", vec![point], 1.0).expect("transfer");
        let layer = VolumeLayer::new(volume, transfer);
        eframe::egui::__run_test_ui(|ui| {
            let bars = histogram(ui, Id::NULL, &layer, [0.0, 100.0]);
            let [low, middle, high] = [0, BARS / 2, BARS - 1].map(|i| bars[i]);
            assert!(low == 1.0 && low > high && high > middle && middle > 0.0, "{bars:?}");
            assert_eq!(bars.iter().filter(|bar| **bar > 0.0).count(), 3);
        });
    }
}
