//! Flights of the camera: from one view to another, above the ground.

use super::camera::above_ground;
use belvedere::core::{Aabb, DVec2, DVec3, Navigation, Pinhole, Projection};
use belvedere::scene::{Heightfield, Scene};
use std::f64::consts::{PI, TAU};

/// Half the width of what is shown around a single point, as a share of the diagonal of the scene.
const AROUND: f64 = 0.012;
/// Room around a thing, as a factor of its size.
const ROOM: f64 = 1.25;
/// Steps by which the camera is raised until nothing stands before a thing, degrees, and their number.
const RAISE_DEG: f64 = 4.0;
const RAISES: usize = 20;
/// Places of a path at which the ground is looked at.
const SAMPLES: usize = 96;
/// Height of the middle of a flight as a share of its length, where that is more than the distance at its ends.
const ARCH: f64 = 0.3;
/// Height over the ground in the middle of a flight, as a share of the distance to the point looked at.
const CLEAR: f64 = 0.03;
/// Least height over the ground, metres.
const LEAST_M: f64 = 3.0;

/// A camera that shows a whole box in the middle of its picture from the present direction, raised as far as the ground would hide its
/// middle; `None` for an empty box. A single point is shown with its surroundings.
pub fn shown_whole(camera: &Navigation, bounds: &Aabb, scene: &Scene) -> Option<Navigation> {
    if bounds.is_empty() {
        return None;
    }
    let all = scene.bounds();
    let diagonal = if all.is_empty() { 0.0 } else { (all.max - all.min).length() };
    let (middle, half) = (bounds.center(), 0.5 * (bounds.max - bounds.min));
    let half = if half.length() > 1e-6 * diagonal { ROOM * half } else { DVec3::splat((AROUND * diagonal).max(1e-3)) };
    let wide = Aabb { min: middle - half, max: middle + half };
    let raised = |k: usize| camera.orbited(0.0, (RAISE_DEG * k as f64).to_radians())?.framing(&wide);
    let found = (0..=RAISES).filter_map(|k| raised(k).ok()).find(|next| is_clear(next, middle, scene));
    found.or_else(|| raised(0).ok().map(|next| above_ground(next, scene)))
}

/// Whether the eye lies above the ground and the ground leaves the line to a point free.
fn is_clear(camera: &Navigation, point: DVec3, scene: &Scene) -> bool {
    let Some(ground) = scene.terrain() else { return true };
    let eye = camera.pinhole.eye;
    let height = |xy: DVec2| ground.surface_at(xy);
    if height(eye.truncate()).is_some_and(|z| eye.z < z + LEAST_M) {
        return false;
    }
    let point = point.with_z(height(point.truncate()).map_or(point.z, |z| z.max(point.z)));
    // The last part of the way lies on the slope of the thing itself.
    (0..4 * SAMPLES).map(|k| k as f64 / (4 * SAMPLES) as f64 * 0.97).all(|t| {
        let at = eye.lerp(point, t);
        height(at.truncate()).is_none_or(|z| at.z >= z)
    })
}

/// A path of the camera from one view to another.
#[derive(Debug, Clone)]
pub struct Flight {
    from: Navigation,
    to: Navigation,
    /// Height of the eye in the middle over that without the arch, scene units.
    lift: f64,
}

impl Flight {
    /// The flight between two cameras over the ground of a scene.
    pub fn new(from: Navigation, to: Navigation, scene: &Scene) -> Self {
        let flat = Self { from, to, lift: 0.0 };
        let way = flat.from.target.distance(flat.to.target);
        let reach = [&flat.from, &flat.to].map(|end| end.target.distance(end.pinhole.eye));
        let arch = (ARCH * way - 0.5 * (reach[0] + reach[1])).max(0.0);
        let lift = scene.terrain().map_or(arch, |ground| flat.over(ground).max(arch));
        Self { lift: lift.min(2.0 * (way + reach[0] + reach[1])), ..flat }
    }

    /// The lift that keeps the path above the ground.
    fn over(&self, ground: &Heightfield) -> f64 {
        let needed = (1..SAMPLES).map(|k| {
            let s = k as f64 / SAMPLES as f64;
            let (eye, target) = self.unlifted(s);
            let room = bump(s);
            let above = LEAST_M + CLEAR * room * eye.distance(target);
            ground.surface_at(eye.truncate()).map_or(0.0, |z| (z + above - eye.z) / room)
        });
        needed.fold(0.0, f64::max)
    }

    /// Eye and target at a share of the way without the arch.
    fn unlifted(&self, s: f64) -> (DVec3, DVec3) {
        let away = |end: &Navigation| end.pinhole.eye - end.target;
        let (a, b) = (away(&self.from), away(&self.to));
        let (length_a, length_b) = (a.length().max(1e-12), b.length().max(1e-12));
        let length = length_a * (length_b / length_a).powf(s);
        let heading = |v: DVec3| v.y.atan2(v.x);
        let steep = |v: DVec3, length: f64| (v.z / length).clamp(-1.0, 1.0).asin();
        let turn = (heading(b) - heading(a) + PI).rem_euclid(TAU) - PI;
        let (around, up) = (heading(a) + s * turn, steep(a, length_a).lerp_to(steep(b, length_b), s));
        let direction = DVec3::new(up.cos() * around.cos(), up.cos() * around.sin(), up.sin());
        let target = self.from.target.lerp(self.to.target, s);
        (target + length * direction, target)
    }

    /// The camera at a share of the time, 0..=1: it starts and ends gently, at 0 and 1 with the two cameras themselves.
    pub fn at(&self, share: f64) -> Navigation {
        let t = share.clamp(0.0, 1.0);
        if t <= 0.0 {
            return self.from.clone();
        }
        let s = t * t * (3.0 - 2.0 * t);
        let (eye, target) = self.unlifted(s);
        let eye = eye + self.lift * bump(s) * DVec3::Z;
        let (a, b) = (&self.from.pinhole, &self.to.pinhole);
        let projection = match (a.projection, b.projection) {
            (Projection::Perspective { fov_y: a }, Projection::Perspective { fov_y: b }) => {
                Projection::Perspective { fov_y: a.lerp_to(b, s) }
            }
            (Projection::Orthographic { height: a }, Projection::Orthographic { height: b }) => {
                Projection::Orthographic { height: a * (b / a).powf(s) }
            }
            (_, last) => last,
        };
        let pinhole = Pinhole::look_at(eye, target, DVec3::Z, projection, b.image, a.near.min(b.near), b.far);
        match pinhole {
            Ok(pinhole) if t < 1.0 => Navigation { pinhole, target },
            _ => self.to.clone(),
        }
    }
}

/// 0 at both ends and 1 in the middle.
fn bump(s: f64) -> f64 {
    4.0 * s * (1.0 - s)
}

trait Lerp {
    fn lerp_to(self, to: Self, s: f64) -> Self;
}

impl Lerp for f64 {
    fn lerp_to(self, to: Self, s: f64) -> Self {
        self + s * (to - self)
    }
}

#[cfg(test)]
mod tests;
