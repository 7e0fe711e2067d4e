//! Moving the camera by pointer, wheel and touchpad.

use crate::model::{Model, Tool};
use belvedere::core::{DVec2, DVec3, Navigation};
use eframe::egui::{PointerButton, Rect, Response, Ui};

/// Turn of the camera for a drag across the whole picture, radians.
const TURN: f64 = 3.0;
/// Wheel points that double or halve the distance.
const WHEEL: f64 = 260.0;
/// Wheel turns closer together than this are one gesture, seconds.
const ONE_GESTURE: f64 = 0.6;

/// A drag in the picture.
#[derive(Debug, Clone, Default)]
pub(crate) struct Hand {
    held: Option<Held>,
    wheeled_at: f64,
}

#[derive(Debug, Clone)]
struct Held {
    /// The camera when the drag began.
    camera: Navigation,
    /// Start of the drag, as shares of the picture's width and height, and the world point there.
    from: DVec2,
    point: DVec3,
    turns: bool,
}

/// A position in the window as shares of the picture's width and height.
pub(crate) fn share(rect: Rect, at: eframe::egui::Pos2) -> DVec2 {
    let offset = at - rect.min;
    DVec2::new(f64::from(offset.x / rect.width()), f64::from(offset.y / rect.height()))
}

impl Hand {
    /// Moves the camera by drags and the wheel.
    pub(crate) fn steer(&mut self, ui: &Ui, response: &Response, rect: Rect, model: &mut Model) {
        self.drag(response, rect, model);
        self.wheel(ui, response, rect, model);
    }

    fn drag(&mut self, response: &Response, rect: Rect, model: &mut Model) {
        let secondary = response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle);
        if response.drag_started() {
            let at = response.interact_pointer_pos();
            self.held = at.zip(model.camera()).map(|(at, camera)| {
                let from = share(rect, at);
                let point = model.world_at(from).unwrap_or(camera.target);
                let turns = secondary != (model.look.tool == Tool::Orbit);
                Held { camera, from, point, turns }
            });
            model.begin_gesture();
        }
        if let (Some(held), Some(at)) = (self.held.as_ref(), response.interact_pointer_pos())
            && response.dragged()
        {
            let to = share(rect, at);
            let held = held.clone();
            model.move_camera(|_| {
                if held.turns {
                    let by = TURN * (to - held.from);
                    return held.camera.orbited(-by.x, by.y);
                }
                let [w, h] = held.camera.pinhole.image.map(f64::from);
                held.camera.dragged(held.point, held.from * DVec2::new(w, h), to * DVec2::new(w, h))
            });
        }
        if response.drag_stopped() {
            self.held = None;
        }
    }

    fn wheel(&mut self, ui: &Ui, response: &Response, rect: Rect, model: &mut Model) {
        let Some(at) = response.hover_pos() else { return };
        let (scroll, pinch, now) =
            ui.input(|i| (f64::from(i.smooth_scroll_delta.y), f64::from(i.zoom_delta()), i.time));
        let factor = (scroll / WHEEL).exp2() * pinch;
        if (factor - 1.0).abs() < 1e-4 {
            return;
        }
        if now - self.wheeled_at > ONE_GESTURE {
            model.begin_gesture();
        }
        self.wheeled_at = now;
        let about = model.world_at(share(rect, at));
        model.move_camera(|camera| camera.zoomed(about.unwrap_or(camera.target), factor));
    }
}
