//! Flights of the camera to what was found or bookmarked, and the ring that marks it.

use crate::flight::{Flying, Ring};
use crate::model::Model;
use belvedere::core::{Aabb, Navigation, Pinhole, Projection};
use belvedere::scene_file::camera::navigation;
use belvedere::scene_file::{CameraDoc, ConstructorKind};
use belvedere_studio::{Flight, shown_whole};
use eframe::egui::{Context, Event, Id, TouchPhase};

/// Duration of a flight, seconds.
const SECONDS: f64 = 0.8;
/// Time for which a ring is shown from the beginning of the flight, seconds.
const MARKED: f64 = 3.0;

impl Model {
    /// Moves the camera so that a box fills the document's frame.
    pub(crate) fn frame(&mut self, bounds: &Aabb) {
        let Some(camera) = self.frame_camera() else { return };
        self.begin_gesture();
        self.move_camera(Id::unique("framing"), |_| camera.framing(bounds));
    }

    /// Flies to where a thing is seen whole, in the middle of the picture and from the present direction, and marks it.
    pub(crate) fn visit(&mut self, bounds: &Aabb, ctx: &Context) {
        let Some(camera) = self.frame_camera() else { return };
        let Some(shown) = &self.shown else { return };
        let scene = shown.session.scene();
        let Some(to) = shown_whole(&camera, bounds, scene) else { return };
        let middle = bounds.center();
        let ground = scene.terrain().and_then(|ground| ground.surface_at(middle.truncate()));
        self.ring = Some(Ring { point: middle.with_z(ground.map_or(middle.z, |z| z.max(middle.z))), began: None });
        self.fly(to, None, ctx);
    }

    /// Flies to the camera of a bookmark.
    pub(crate) fn return_to(&mut self, camera: &CameraDoc, ctx: &Context) {
        let image = self.document().camera.image;
        let camera = CameraDoc { image, ..camera.clone() };
        let to = self.shown.as_ref().map(|shown| {
            let (session, size) = (&shown.session, (image, 1.0));
            navigation(&camera, &camera, session.view(), session.scene(), size)
        });
        match to {
            Some(to) if !self.has_own_camera() => self.fly(to, Some(camera), ctx),
            _ => self.edit(|document| document.camera = camera),
        }
    }

    /// The camera with the document's frame instead of the picture on the screen.
    fn frame_camera(&self) -> Option<Navigation> {
        let camera = self.camera()?;
        let document = &self.document().camera;
        let projection = match document.ortho_height_m {
            Some(height) => Projection::Orthographic { height },
            None => Projection::Perspective { fov_y: document.fov_y_deg.to_radians() },
        };
        let pinhole = Pinhole { image: document.image, projection, ..camera.pinhole };
        Some(Navigation { pinhole, target: camera.target })
    }

    /// Whether a constructor places the camera.
    pub(crate) fn has_own_camera(&self) -> bool {
        self.document().constructor.as_ref().is_some_and(|doc| doc.kind == ConstructorKind::PathPreview)
    }

    fn fly(&mut self, to: Navigation, end: Option<CameraDoc>, ctx: &Context) {
        let (Some(from), Some(shown)) = (self.frame_camera(), &self.shown) else { return };
        let flight = Flight::new(from, to, shown.session.scene());
        self.begin_gesture();
        self.flying = Some(Flying { flight, began: None, end: end.map(Box::new) });
        // Where the user wants nothing to move, or no camera may, there is one step.
        if ctx.global_style().animation_time <= 0.0 || self.has_own_camera() {
            self.step_flight(1.0);
        }
        ctx.request_repaint();
    }

    /// Advances the flight; any input ends it where it is.
    pub(crate) fn fly_on(&mut self, ctx: &Context) {
        let now = ctx.input(|input| input.time);
        if let Some(ring) = &mut self.ring {
            let began = *ring.began.get_or_insert(now);
            if now - began > MARKED {
                self.ring = None;
            }
            ctx.request_repaint();
        }
        let Some(flying) = &mut self.flying else { return };
        let began = *flying.began.get_or_insert(now);
        if began < now && has_input(ctx) {
            self.flying = None;
            return;
        }
        self.step_flight((now - began) / SECONDS);
        ctx.request_repaint();
    }

    fn step_flight(&mut self, share: f64) {
        let Some(flying) = self.flying.take() else { return };
        let camera = flying.flight.at(share);
        let by = Id::unique("flight");
        self.move_camera(by, |_| Ok::<_, ()>(camera));
        if share < 1.0 {
            self.flying = Some(flying);
        } else if let Some(end) = flying.end {
            self.edit_on(by, |document| document.camera = *end);
        }
    }

    /// Share of the time of the ring that is over, 0..=1.
    pub(crate) fn ring_share(&self, ctx: &Context) -> f32 {
        let now = ctx.input(|input| input.time);
        let began = self.ring.as_ref().and_then(|ring| ring.began);
        began.map_or(0.0, |began| ((now - began) / MARKED).clamp(0.0, 1.0) as f32)
    }
}

/// Whether the user does anything.
fn has_input(ctx: &Context) -> bool {
    ctx.input(|input| {
        input.events.iter().any(|event| {
            matches!(
                event,
                Event::Key { pressed: true, .. }
                    | Event::PointerButton { pressed: true, .. }
                    | Event::MouseWheel { .. }
                    | Event::Zoom(_)
                    | Event::Text(_)
                    | Event::Touch { phase: TouchPhase::Start, .. }
            )
        })
    })
}
