//! Handles in the picture: planes and viewpoints of turns while the panel of curved rays is open, moves of the ground while that of the terrain
//! is, the curve while that of the spline is.

mod curve;
mod moves;
mod planes;

use crate::handles::Handles;
use crate::model::Model;
use belvedere::core::{DVec3, View};
use eframe::egui::{Color32, CursorIcon, Id, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};

/// Half width of the part of a handle that takes the pointer, points.
const GRAB: f32 = 9.0;

/// Shows the handles of the open panel over the picture.
///
/// * `rect`: the picture in the window.
pub(super) fn show(ui: &mut Ui, rect: Rect, model: &mut Model) {
    let Some(handles) = model.handles.take().filter(|_| !model.is_easing()) else { return };
    let Some(shown) = &model.shown else { return };
    let view = if model.look.bent { shown.session.view().clone() } else { shown.session.view().straightened() };
    let id = ui.scope_id().with("handles");
    match handles {
        Handles::Moves if model.look.bent => moves::show(ui, (id, rect), &view, model),
        Handles::Turns => planes::show(ui, (id, rect), &view, model),
        Handles::Preset(presets, chosen) if model.look.bent => {
            curve::show(ui, (id, rect), &view, (&presets, chosen), model);
        }
        Handles::Moves | Handles::Preset(..) => {}
    }
}

/// Position in the window of a point that a view shows, wherever it lies; `None` behind the eye.
fn place(view: &View, point: DVec3, rect: Rect) -> Option<Pos2> {
    let at = view.project(point).ok()?.pixel;
    let [w, h] = view.pinhole().image.map(f64::from);
    let share = Vec2::new((at.x / w) as f32, (at.y / h) as f32);
    Some(rect.min + share * rect.size()).filter(|at| at.is_finite())
}

/// A handle of the picture; it takes the pointer only where it is drawn.
fn handle(ui: &Ui, (rect, id): (Rect, Id), at: Pos2, (name, color): (&str, Color32)) -> Response {
    let spot = Rect::from_center_size(at, vec2(2.0 * GRAB, 2.0 * GRAB));
    let response = ui.interact(spot, id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    let radius = if response.hovered() || response.dragged() || response.has_focus() { 7.5 } else { 6.0 };
    ui.painter_at(rect).circle(at, radius, color, Stroke::new(1.8, Color32::WHITE));
    response.on_hover_cursor(CursorIcon::Move).on_hover_text(name)
}

/// Places of a handle in the window for values of its parameter, ascending.
#[derive(Debug, Clone, Default)]
struct Way(Vec<(f64, Pos2)>);

impl Way {
    /// The value whose place is nearest to a position, between the known ones linear.
    fn value_at(&self, to: Pos2) -> Option<f64> {
        let on = |pair: &[(f64, Pos2)]| {
            let [(v0, a), (v1, b)] = [pair[0], pair[1]];
            let along = b - a;
            let t = ((to - a).dot(along) / along.length_sq().max(1e-9)).clamp(0.0, 1.0);
            ((a + t * along).distance_sq(to), v0 + f64::from(t) * (v1 - v0))
        };
        self.0.windows(2).map(on).min_by(|a, b| a.0.total_cmp(&b.0)).map(|nearest| nearest.1)
    }
}

/// A drag: the way at its beginning, and where the pointer took hold, from the middle of the handle.
#[derive(Debug, Clone)]
struct Held {
    way: Way,
    offset: Vec2,
}

/// The value to which a handle is dragged. The way is that of the beginning, since the picture changes with the value.
fn dragged(ui: &Ui, response: &Response, at: Pos2, way: impl FnOnce() -> Way) -> Option<f64> {
    let key = response.id.with("held");
    let pointer = response.interact_pointer_pos();
    if response.drag_started()
        && let Some(pointer) = pointer
    {
        let began = ui.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
        ui.data_mut(|data| data.insert_temp(key, Held { way: way(), offset: began - at }));
    }
    if response.drag_stopped() {
        ui.data_mut(|data| data.remove::<Held>(key));
    }
    if !response.dragged() {
        return None;
    }
    let held = ui.data(|data| data.get_temp::<Held>(key))?;
    held.way.value_at(pointer? - held.offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn the_value_follows_the_pointer_along_the_way_and_stops_at_its_ends() {
        let way = Way(vec![(0.0, pos2(100.0, 400.0)), (10.0, pos2(100.0, 300.0)), (30.0, pos2(110.0, 250.0))]);
        let at = |x: f32, y: f32| way.value_at(pos2(x, y)).expect("a value");
        assert_eq!((at(100.0, 350.0), at(160.0, 350.0)), (5.0, 5.0), "sideways nothing changes");
        assert_eq!((at(100.0, 600.0), at(110.0, 10.0)), (0.0, 30.0));
        let values: Vec<f64> = (0..40).map(|i| at(103.0, 410.0 - 5.0 * i as f32)).collect();
        assert!(values.windows(2).all(|pair| pair[0] <= pair[1]), "{values:?}");
        assert_eq!(Way::default().value_at(pos2(0.0, 0.0)), None);
    }
}
