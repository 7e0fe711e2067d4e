//! The curve of a preset: control points, tags and transition widths to drag, the eye and what it sees.

use super::nudged;
use crate::language::{fill, tr};
use belvedere::core::DVec2;
use belvedere::core::presets::edit::PresetChange;
use belvedere::verbs::preset::{Sketch, SketchTag};
use eframe::egui::{
    Align, Color32, CursorIcon, FontId, Id, Label, Layout, Painter, Pos2, Rect, Response, RichText, Role, Sense, Shape,
    Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

const HEIGHT: f32 = 250.0;
const GRAB: f32 = 9.0;
const INK: Color32 = Color32::from_rgb(38, 44, 54);
const FAINT: Color32 = Color32::from_rgb(150, 156, 168);
const EYE: Color32 = Color32::from_rgb(30, 96, 170);
const TAG: Color32 = Color32::from_rgb(190, 96, 10);
const FOLD: Color32 = Color32::from_rgb(170, 50, 40);
/// Facing that is coloured as good: sine of 20 degrees.
const WELL_SEEN: f64 = 0.34;

/// An edit of the user.
pub(crate) struct CurveEdit {
    pub(crate) change: PresetChange,
    /// Whether it begins a drag: the edits up to the next beginning are one step of undo.
    pub(crate) begins: bool,
}

/// Maps curve units to the window.
struct Scale {
    rect: Rect,
    low: DVec2,
    per_unit: f64,
}

impl Scale {
    /// Fits curve, control points and eye; an eye that a dolly has moved far away is left out.
    fn of(sketch: &Sketch, rect: Rect) -> Self {
        let near = Some(sketch.eye).filter(|eye| eye.length() < 4.0);
        let all = sketch.curve.iter().map(|p| p.at).chain(sketch.control.iter().copied()).chain(near);
        let [lo, hi] = all.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)]);
        let (lo, hi) = (lo - 0.06, hi + 0.06);
        let room = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let per_unit = (room / (hi - lo)).min_element();
        Self { rect, low: 0.5 * (lo + hi) - 0.5 * room / per_unit, per_unit }
    }

    fn at(&self, p: DVec2) -> Pos2 {
        let q = (p - self.low) * self.per_unit;
        pos2(self.rect.left() + q.x as f32, self.rect.bottom() - q.y as f32)
    }

    fn back(&self, p: Pos2) -> DVec2 {
        let q = DVec2::new(f64::from(p.x - self.rect.left()), f64::from(self.rect.bottom() - p.y));
        self.low + q / self.per_unit
    }
}

/// Draws the curve and lets it be dragged.
///
/// * `said`: a sentence on the last edit, written into the plot, so that the rows below it keep their place.
pub(crate) fn curve(ui: &mut Ui, id: Id, sketch: &Sketch, said: Option<&str>) -> Option<CurveEdit> {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Group, true, tr("Curve of the preset")));
    // The scale is kept during a drag, or the curve would move away from the pointer.
    let key = id.with("scale");
    let dragging = ui.input(|input| input.pointer.any_down());
    let kept = ui.data(|data| data.get_temp::<(DVec2, f64)>(key)).filter(|_| dragging);
    let fitted = Scale::of(sketch, rect.shrink(6.0));
    let scale = kept.map_or(fitted, |(low, per_unit)| Scale { rect: rect.shrink(6.0), low, per_unit });
    ui.data_mut(|data| data.insert_temp(key, (scale.low, scale.per_unit)));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, Color32::from_rgb(252, 252, 250));
    draw(&painter, &scale, sketch);
    if let Some(said) = said {
        let row = rect.shrink(6.0).with_min_y(rect.bottom() - 40.0);
        let mut note = ui.new_child(UiBuilder::new().max_rect(row).layout(Layout::bottom_up(Align::Min)));
        note.add(Label::new(RichText::new(said).color(FOLD)).selectable(false));
    }
    let mut edit = None;
    for (i, point) in sketch.control.iter().enumerate() {
        let response = handle(ui, id.with(("point", i)), scale.at(*point), &fill(tr("Control point {0}"), &[&(i + 1)]));
        painter.circle_filled(scale.at(*point), if response.hovered() { 6.0 } else { 4.5 }, INK);
        if let Some(to) = dragged_to(&response) {
            let to = scale.back(to) - sketch.pinned_by;
            edit = Some(CurveEdit {
                change: PresetChange::MovePoint(i + 1, to.to_array()),
                begins: response.drag_started(),
            });
        }
        if let Some([x, y]) = nudged(ui, &response) {
            let to = *point - sketch.pinned_by + 0.01 * DVec2::new(x, y);
            edit = Some(CurveEdit { change: PresetChange::MovePoint(i + 1, to.to_array()), begins: true });
        }
    }
    for (i, tag) in sketch.tags.iter().enumerate() {
        edit = tag_handles(ui, id, &scale, sketch, i, tag, &painter).or(edit);
    }
    edit
}

/// A tag and the end of its transition.
fn tag_handles(
    ui: &Ui,
    id: Id,
    scale: &Scale,
    sketch: &Sketch,
    i: usize,
    tag: &SketchTag,
    painter: &Painter,
) -> Option<CurveEdit> {
    let at = scale.at(tag.at);
    let response = handle(ui, id.with(("tag", i)), at, &fill(tr("Tag {0}"), &[&(i + 1)]));
    let r = if response.hovered() { 7.0 } else { 5.5 };
    let diamond = [vec2(0.0, -r), vec2(r, 0.0), vec2(0.0, r), vec2(-r, 0.0)].map(|d| at + d);
    painter.add(Shape::convex_polygon(diamond.to_vec(), TAG, Stroke::new(1.0, Color32::WHITE)));
    if let Some(to) = dragged_to(&response) {
        let to = scale.back(to) - sketch.pinned_by;
        return Some(CurveEdit {
            change: PresetChange::MoveTag(i + 1, to.to_array()),
            begins: response.drag_started(),
        });
    }
    if let Some([x, _]) = nudged(ui, &response) {
        let change = PresetChange::PlaceTag(i + 1, (tag.share + 0.01 * x).clamp(0.0, 1.0));
        return Some(CurveEdit { change, begins: true });
    }
    let end = nearest(sketch, tag.share + tag.half_width);
    let knob = scale.at(end.at + 0.05 * end.normal);
    let response = handle(ui, id.with(("width", i)), knob, &fill(tr("Transition width of tag {0}"), &[&(i + 1)]));
    painter.line_segment([scale.at(end.at), knob], Stroke::new(1.0, TAG));
    painter.circle_filled(knob, if response.hovered() { 5.0 } else { 3.5 }, TAG);
    let width = |share: f64| PresetChange::TagWidth(i + 1, (share - tag.share).abs().clamp(0.0, 1.0));
    if let Some(to) = dragged_to(&response) {
        let to = scale.back(to);
        let near = sketch.curve.iter().min_by(|a, b| a.at.distance(to).total_cmp(&b.at.distance(to)))?;
        return Some(CurveEdit { change: width(near.share), begins: response.drag_started() });
    }
    let [x, _] = nudged(ui, &response)?;
    Some(CurveEdit { change: width(tag.share + (tag.half_width + 0.01 * x).max(0.0)), begins: true })
}

/// The sampled point nearest to a share of the length.
fn nearest(sketch: &Sketch, share: f64) -> belvedere::verbs::preset::SketchPoint {
    let by = |p: &&belvedere::verbs::preset::SketchPoint| (p.share - share).abs();
    *sketch.curve.iter().min_by(|a, b| by(a).total_cmp(&by(b))).unwrap_or(&sketch.curve[0])
}

fn handle(ui: &Ui, id: Id, at: Pos2, name: &str) -> Response {
    let response = ui.interact(Rect::from_center_size(at, vec2(2.0 * GRAB, 2.0 * GRAB)), id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response.on_hover_cursor(CursorIcon::Move).on_hover_text(name)
}

fn dragged_to(response: &Response) -> Option<Pos2> {
    (response.dragged() && response.drag_delta() != vec2(0.0, 0.0)).then(|| response.interact_pointer_pos()).flatten()
}

fn draw(painter: &Painter, scale: &Scale, sketch: &Sketch) {
    let level = [sketch.curve[0].at.x.min(-0.2), sketch.curve.last().map_or(1.2, |p| p.at.x)];
    let ground = level.map(|x| scale.at(DVec2::new(x, 0.0)));
    painter.line_segment(ground, Stroke::new(1.0, Color32::from_rgb(226, 228, 232)));
    if sketch.eye.length() < 4.0 {
        let reach = 8.0;
        let [low, high] = sketch.wedge.map(|d| scale.at(sketch.eye + reach * d));
        let eye = scale.at(sketch.eye);
        painter.add(Shape::convex_polygon(vec![eye, low, high], EYE.gamma_multiply(0.1), Stroke::NONE));
        painter.circle_filled(eye, 5.0, EYE);
        painter.text(
            eye + vec2(8.0, 0.0),
            eframe::egui::Align2::LEFT_CENTER,
            tr("eye"),
            FontId::proportional(12.0),
            EYE,
        );
    }
    for pair in sketch.control.windows(2) {
        painter.line_segment([scale.at(pair[0]), scale.at(pair[1])], Stroke::new(1.0, FAINT));
    }
    for tag in &sketch.tags {
        let inside = sketch.curve.iter().filter(|p| (p.share - tag.share).abs() <= tag.half_width);
        let band: Vec<Pos2> = inside.map(|p| scale.at(p.at)).collect();
        painter.add(Shape::line(band, Stroke::new(11.0, Color32::from_rgba_unmultiplied(240, 160, 40, 90))));
    }
    for (fold, side) in sketch.fold_heights.into_iter().zip([-1.0, 1.0]) {
        if fold.abs() < 1.5 {
            let line: Vec<Pos2> = sketch
                .curve
                .iter()
                .filter(|p| (0.0..=1.0).contains(&p.share))
                .map(|p| scale.at(p.at + side * fold.abs() * p.normal))
                .collect();
            painter.extend(Shape::dashed_line(&line, Stroke::new(1.0, FOLD), 5.0, 4.0));
        }
    }
    for pair in sketch.curve.windows(2) {
        let inside = (0.0..=1.0).contains(&pair[1].share);
        let stroke = Stroke::new(if inside { 3.5 } else { 1.8 }, seen(pair[1].facing));
        painter.line_segment([scale.at(pair[0].at), scale.at(pair[1].at)], stroke);
    }
}

/// Green where the ground is seen well, amber at grazing angles, red from below.
fn seen(facing: f64) -> Color32 {
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| {
        let t = t.clamp(0.0, 1.0);
        let [r, g, b] = [0, 1, 2].map(|i| (a[i] + t * (b[i] - a[i])) as u8);
        Color32::from_rgb(r, g, b)
    };
    if facing <= 0.0 {
        Color32::from_rgb(200, 50, 40)
    } else {
        mix([236.0, 176.0, 30.0], [40.0, 140.0, 80.0], facing / WELL_SEEN)
    }
}
