//! Moving the camera by pointer, wheel, touchpad and fingers.

use crate::model::{Model, Tool};
use belvedere::core::{DVec2, DVec3, Navigation, Pinhole, PinholeError};
use eframe::egui::{Id, MultiTouchInfo, PointerButton, Rect, Response, Ui};

/// Turn of the camera for a drag across the whole picture, radians.
const TURN: f64 = 3.0;
/// Wheel points that double or halve the distance.
const WHEEL: f64 = 260.0;
/// Wheel turns closer together than this are one gesture, seconds.
const ONE_GESTURE: f64 = 0.6;
/// Way of two fingers together, points, change of their distance, as a logarithm, and turn, radians, from which on it is known what they do.
const TOGETHER: f32 = 10.0;
const APART: f32 = 0.08;
const TURNED: f32 = 0.14;

/// A drag in the picture.
#[derive(Debug, Clone, Default)]
pub(crate) struct Hand {
    held: Option<Held>,
    wheeled_at: f64,
    fingers: Option<Fingers>,
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

/// Two fingers on the picture.
#[derive(Debug, Clone)]
struct Fingers {
    /// World point between them when they came down.
    about: DVec3,
    /// What they have done before it was known what they do: way upwards, logarithm of the change of their distance, turn.
    so_far: [f32; 3],
    does: Option<TwoFingers>,
}

/// What two fingers do until they are lifted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TwoFingers {
    /// Nearer, farther and round about the point between them.
    Grasp,
    /// Up and down over it.
    Tilt,
}

/// A position in the window as shares of the picture's width and height.
pub(crate) fn share(rect: Rect, at: eframe::egui::Pos2) -> DVec2 {
    let offset = at - rect.min;
    DVec2::new(f64::from(offset.x / rect.width()), f64::from(offset.y / rect.height()))
}

impl Hand {
    /// Moves the camera by drags, the wheel and two fingers.
    pub(crate) fn steer(&mut self, ui: &Ui, response: &Response, rect: Rect, model: &mut Model) {
        if let Some(touch) = ui.input(|input| input.multi_touch()) {
            // The first finger is a pointer, too; what it began ends here.
            self.held = None;
            self.touch(ui, response, (rect, touch), model);
            return;
        }
        self.fingers = None;
        self.drag(response, rect, model);
        // A drag places the camera by its beginning, so the wheel has no effect meanwhile.
        if self.held.is_none() {
            self.wheel(ui, response, rect, model);
        }
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
            model.move_camera(Id::unique("drag"), |_| {
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
        model.move_camera(Id::unique("wheel"), |camera| camera.zoomed(about.unwrap_or(camera.target), factor));
    }

    /// Two fingers: pinched they go nearer or farther, turned they turn, up or down together they tilt.
    fn touch(&mut self, ui: &Ui, response: &Response, (rect, touch): (Rect, MultiTouchInfo), model: &mut Model) {
        let middle = touch.center_pos;
        if self.fingers.is_none() {
            let is_here =
                rect.contains(middle) && ui.ctx().layer_id_at(middle).is_none_or(|id| id == response.layer_id);
            let Some(camera) = model.camera().filter(|_| is_here) else { return };
            let about = model.world_at(share(rect, middle)).unwrap_or(camera.target);
            self.fingers = Some(Fingers { about, so_far: [0.0; 3], does: None });
            model.begin_gesture();
        }
        let Some(fingers) = &mut self.fingers else { return };
        let now = [touch.translation_delta.y, touch.zoom_delta.max(1e-3).ln(), touch.rotation_delta];
        let mut by = now;
        if fingers.does.is_none() {
            for (sum, now) in fingers.so_far.iter_mut().zip(now) {
                *sum += now;
            }
            let [along, apart, turned] = fingers.so_far.map(f32::abs);
            fingers.does = match () {
                () if apart > APART || turned > TURNED => Some(TwoFingers::Grasp),
                () if along > TOGETHER => Some(TwoFingers::Tilt),
                () => None,
            };
            // Nothing of the motion is lost.
            by = fingers.so_far;
        }
        let [along, apart, turned] = by.map(f64::from);
        let (about, by) = (fingers.about, Id::unique("fingers"));
        match fingers.does {
            None => {}
            Some(TwoFingers::Tilt) => {
                let pitch = TURN * along / f64::from(rect.height());
                model.move_camera(by, |camera| camera.orbited(0.0, pitch));
            }
            Some(TwoFingers::Grasp) => {
                model.move_camera(by, |camera| turned_about(camera, about, turned)?.zoomed(about, apart.exp()));
            }
        }
    }
}

/// The camera turned about the vertical through a point, counter-clockwise seen from above, radians.
fn turned_about(camera: &Navigation, about: DVec3, angle: f64) -> Result<Navigation, PinholeError> {
    let turn = |p: DVec3| {
        let (sin, cos) = angle.sin_cos();
        let d = p - about;
        about + DVec3::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y, d.z)
    };
    let (p, target) = (&camera.pinhole, turn(camera.target));
    let pinhole = Pinhole::look_at(turn(p.eye), target, DVec3::Z, p.projection, p.image, p.near, p.far)?;
    Ok(Navigation { pinhole, target })
}
