//! The camera from above: its picture, and handles on viewpoints, planes and bend points.

use super::nudged;
use crate::language::{fill, later, tr};
use belvedere::core::map::curved_rays::Sharpness;
use belvedere::core::{DVec2, DVec3, View};
use belvedere::scene_file::TurnDoc;
use belvedere_studio::{sharpness_at, sharpness_knob};
use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Id, Pos2, Rect, Role, Sense, Stroke, TextureId, Ui, WidgetInfo, pos2, vec2,
};

/// A part of a turn that can be dragged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Viewpoint,
    First,
    Bend,
    Last,
    /// The direction of the planes' normal.
    Normal,
    /// The line that the planes share.
    Line,
    /// Direction of that line.
    LineDirection,
    /// Sharpness of the turn.
    Sharpness,
}

/// An edit of the user: number of the turn, part, new position, whether a drag begins.
pub(crate) struct OverheadEdit {
    pub(crate) turn: usize,
    pub(crate) part: Part,
    pub(crate) to: DVec3,
    pub(crate) begins: bool,
}

const COLORS: [Color32; 8] = [
    Color32::from_rgb(30, 96, 170),
    Color32::from_rgb(0, 120, 96),
    Color32::from_rgb(200, 60, 130),
    Color32::from_rgb(0, 120, 96),
    Color32::from_rgb(120, 120, 120),
    Color32::from_rgb(150, 90, 20),
    Color32::from_rgb(120, 120, 120),
    Color32::from_rgb(120, 60, 170),
];
/// Handles closer than this, points, are drawn as one, such as those of a vertical line.
const APART: f32 = 14.0;
/// Step of the arrow keys, points.
const NUDGE: f32 = 4.0;

/// The picture on the screen.
struct Picture<'a> {
    view: &'a View,
    rect: Rect,
}

impl Picture<'_> {
    fn at(&self, p: DVec3) -> Option<Pos2> {
        let (pixel, [w, h]) = (self.view.project(p).ok()?.pixel, self.view.pinhole().image.map(|n| n as f32));
        Some(self.rect.min + vec2((pixel.x as f32) / w * self.rect.width(), (pixel.y as f32) / h * self.rect.height()))
    }

    /// The point at height `z`: points keep their height, which cannot be seen from above.
    fn back(&self, p: Pos2, z: f64) -> DVec3 {
        let (rect, [w, h]) = (self.rect, self.view.pinhole().image.map(|n| n as f32));
        let pixel = [(p.x - rect.left()) / rect.width() * w, (p.y - rect.top()) / rect.height() * h];
        let (start, direction) = self.view.pinhole().line(DVec2::from(pixel.map(f64::from)));
        let along = (z - start.z) / direction.z;
        start + along * direction
    }

    /// The parts of a turn, in the order of their colours, with names and places.
    fn parts(&self, turn: &TurnDoc) -> [(Part, &'static str, Option<DVec3>); COLORS.len()] {
        let [viewpoint, t0, t1, t2] = [turn.viewpoint, turn.t0, turn.t1, turn.t2].map(DVec3::from_array);
        let reach = 0.25 * t0.distance(t2).max(1e-6);
        let towards = |from: DVec3, dir: [f64; 3]| from + 4.0 * reach * DVec3::from_array(dir).normalize_or_zero();
        let apart = |a: DVec3, b: DVec3| self.at(a).zip(self.at(b)).is_some_and(|(a, b)| a.distance(b) > APART);
        let line = turn.line.map(|line| DVec3::from_array(line.point));
        let along = turn.line.zip(line).map(|(doc, line)| (line, towards(line, doc.dir)));
        let along = along.filter(|(line, along)| apart(*line, *along)).map(|(_, along)| along);
        let sharpness = match turn.m {
            Sharpness::Value(value) => value,
            _ => 1.0,
        };
        [
            (Part::Viewpoint, later("Viewpoint of turn {0}"), Some(viewpoint)),
            (Part::First, later("First plane of turn {0}"), Some(t0)),
            (Part::Bend, later("Bend point of turn {0}"), Some(t1)),
            (Part::Last, later("Last plane of turn {0}"), Some(t2)),
            (Part::Normal, later("Bend direction of turn {0}"), turn.normal.map(|normal| towards(t1, normal))),
            (Part::Line, later("Pivot line of turn {0}"), line),
            (Part::LineDirection, later("Direction of the pivot line of turn {0}"), along),
            (Part::Sharpness, later("Sharpness of turn {0}"), Some(sharpness_knob(turn, sharpness))),
        ]
    }
}

/// Shows the picture with handles.
///
/// * `view`: view of the picture, from above and in parallel projection.
pub(crate) fn overhead(
    ui: &mut Ui,
    id: Id,
    texture: TextureId,
    view: &View,
    turns: &[TurnDoc],
) -> Option<OverheadEdit> {
    let [w, h] = view.pinhole().image.map(|n| n as f32);
    let width = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(vec2(width, width * h / w), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, tr("Camera from above")));
    let painter = ui.painter_at(rect);
    painter.image(texture, rect, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
    let picture = Picture { view, rect };
    let mut edit = None;
    for (i, turn) in turns.iter().enumerate() {
        let parts = picture.parts(turn).map(|(part, name, p)| (part, name, p.and_then(|p| Some((p, picture.at(p)?)))));
        let spot = |part: Part| parts[part as usize].2.map(|(_, spot)| spot);
        for (from, to, width, of) in
            [(Part::Line, Part::LineDirection, 1.5, Part::Line), (Part::Bend, Part::Sharpness, 1.0, Part::Sharpness)]
        {
            if let (Some(a), Some(b)) = (spot(from), spot(to)) {
                painter.line_segment([a, b], Stroke::new(width, COLORS[of as usize]));
            }
        }
        for ((part, name, place), color) in parts.into_iter().zip(COLORS) {
            let Some((place, spot)) = place else { continue };
            let label = fill(tr(name), &[&(i + 1)]);
            // A part outside the picture has its handle at the edge.
            let handle = rect.shrink(8.0).clamp(spot);
            let own = id.with((i, name));
            let response = ui.interact(Rect::from_center_size(handle, vec2(18.0, 18.0)), own, Sense::click_and_drag());
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
            painter.circle(handle, if response.hovered() { 7.0 } else { 5.5 }, color, Stroke::new(1.5, Color32::WHITE));
            if part == Part::Viewpoint {
                let (at, font) = (handle + vec2(9.0, 0.0), FontId::proportional(12.0));
                painter.text(at, Align2::LEFT_CENTER, format!("V{}", i + 1), font, color);
            }
            let pressed = nudged(ui, &response).map(|[x, y]| (NUDGE * vec2(x as f32, -y as f32), true));
            let dragged = response.dragged().then(|| (response.drag_delta(), response.drag_started()));
            if let Some((by, begins)) = pressed.or(dragged) {
                edit = Some(OverheadEdit { turn: i, part, to: picture.back(spot + by, place.z), begins });
            }
            response.on_hover_cursor(CursorIcon::Move).on_hover_text(label);
        }
    }
    edit
}

impl OverheadEdit {
    /// The turn with its part where it was dragged.
    pub(crate) fn apply(&self, turn: &mut TurnDoc) {
        let to = self.to.to_array();
        match self.part {
            Part::Viewpoint => turn.viewpoint = to,
            Part::First => turn.t0 = to,
            Part::Last => turn.t2 = to,
            // The planes move with the bend point.
            Part::Bend => {
                let by = self.to - DVec3::from_array(turn.t1);
                for point in [&mut turn.t0, &mut turn.t1, &mut turn.t2] {
                    *point = (DVec3::from_array(*point) + by).to_array();
                }
                if let Some(line) = &mut turn.line {
                    line.point = (DVec3::from_array(line.point) + by).to_array();
                }
            }
            Part::Sharpness => turn.m = Sharpness::Value((100.0 * sharpness_at(turn, self.to)).round() / 100.0),
            Part::Line => {
                if let Some(line) = &mut turn.line {
                    line.point = to;
                }
            }
            Part::LineDirection => {
                if let Some(line) = &mut turn.line
                    && let Some(dir) = (self.to - DVec3::from_array(line.point)).try_normalize()
                {
                    line.dir = dir.to_array();
                }
            }
            Part::Normal => {
                let bend = DVec3::from_array(turn.t1);
                let Some(normal) = (self.to - bend).try_normalize() else { return };
                let half = |p: [f64; 3]| DVec3::from_array(p).distance(bend);
                (turn.t0, turn.t2) =
                    ((bend - half(turn.t0) * normal).to_array(), (bend + half(turn.t2) * normal).to_array());
                turn.normal = Some(normal.to_array());
            }
        }
    }
}
