//! Navigation of a camera: orbit, look around, pan, zoom and frame.

use super::{Pinhole, PinholeError, Projection};
use crate::Aabb;
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Least angle between the direction of view and the vertical, radians.
const LEAST_TILT: f64 = 1e-3;

/// Margin around a framed box, as a factor of the eye's distance or of the picture's height.
const ROOM: f64 = 1.06;
/// Halvings of the range of offsets of an eye.
const HALVINGS: usize = 40;

/// A camera and the point that it looks at. No operation rolls the camera; zooming an orthographic camera changes the height of its
/// picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Navigation {
    /// The camera.
    pub pinhole: Pinhole,
    /// Point on its optical axis, scene coordinates.
    pub target: DVec3,
}

impl Navigation {
    /// Turns the eye about the target by `yaw` (counter-clockwise seen from above) and up over it by `pitch`, radians; the eye stays between
    /// straight above and straight below.
    ///
    /// # Errors
    /// [`PinholeError`] only if the camera was invalid before.
    pub fn orbited(&self, yaw: f64, pitch: f64) -> Result<Self, PinholeError> {
        let away = self.pinhole.eye - self.target;
        self.placed(self.target + turned(away, yaw, pitch), self.target)
    }

    /// Turns the camera about its eye, to the left by `yaw` and up by `pitch`, radians.
    ///
    /// # Errors
    /// As [`Self::orbited`].
    pub fn looked(&self, yaw: f64, pitch: f64) -> Result<Self, PinholeError> {
        let ahead = self.target - self.pinhole.eye;
        self.placed(self.pinhole.eye, self.pinhole.eye + turned(ahead, yaw, pitch))
    }

    /// Moves eye and target by the same vector, scene units.
    ///
    /// # Errors
    /// As [`Self::orbited`].
    pub fn moved(&self, by: DVec3) -> Result<Self, PinholeError> {
        self.placed(self.pinhole.eye + by, self.target + by)
    }

    /// Moves the camera so that the point of the level plane through `held` under pixel `from` comes under pixel `to`, as on a map. If
    /// a pixel's ray meets the plane farther than ten times the distance of `held`, or not at all, the camera turns about its eye instead.
    ///
    /// # Errors
    /// As [`Self::orbited`].
    pub fn dragged(&self, held: DVec3, from: DVec2, to: DVec2) -> Result<Self, PinholeError> {
        let (Some(a), Some(b)) = (self.on_level(held, from), self.on_level(held, to)) else {
            // Near and above the horizon a drag turns the camera.
            let angle = (to - from) / self.pinhole.scale_px().max(1e-9);
            return self.looked(angle.x, angle.y);
        };
        self.moved(a - b)
    }

    /// Divides the distance from the eye to `about` (the height of an orthographic picture) by `factor`, clamped to 0.05..=20.
    ///
    /// # Errors
    /// As [`Self::orbited`].
    pub fn zoomed(&self, about: DVec3, factor: f64) -> Result<Self, PinholeError> {
        let share = 1.0 - 1.0 / factor.clamp(0.05, 20.0);
        if let Projection::Orthographic { height } = self.pinhole.projection {
            let sideways = about - self.target;
            let sideways = sideways - sideways.dot(self.pinhole.forward) * self.pinhole.forward;
            let mut next = self.moved(share * sideways)?;
            next.pinhole.projection = Projection::Orthographic { height: height * (1.0 - share) };
            return Ok(next);
        }
        let eye = self.pinhole.eye.lerp(about, share);
        // The target comes nearer by the same factor.
        let ahead = (self.target - self.pinhole.eye).length() * (1.0 - share);
        self.placed(eye, eye + self.pinhole.forward * ahead.max(10.0 * self.pinhole.near))
    }

    /// Moves the camera, without turning it, so that it looks at the middle of a box and shows all of it.
    ///
    /// # Errors
    /// [`PinholeError`] for a box that is empty or not finite.
    pub fn framing(&self, bounds: &Aabb) -> Result<Self, PinholeError> {
        let middle = 0.5 * (bounds.min + bounds.max);
        let p = &self.pinhole;
        let [w, h] = p.image.map(f64::from);
        let corners = bounds.corners().map(|c| c - middle);
        let most = |of: &dyn Fn(DVec3) -> f64| corners.iter().map(|&c| of(c)).fold(f64::NEG_INFINITY, f64::max);
        let behind = most(&|c| -c.dot(p.forward)) + p.near;
        if let Projection::Orthographic { .. } = p.projection {
            let height = most(&|c| (2.0 * c.dot(p.down).abs()).max(2.0 * c.dot(p.right).abs() * h / w));
            let mut next = self.placed(middle - 2.0 * behind * p.forward, middle)?;
            next.pinhole.projection = Projection::Orthographic { height: ROOM * height };
            return Ok(next);
        }
        let [across, down] = [w, h].map(|n| 0.5 * n / p.scale_px());
        let away = |c: DVec3| (c.dot(p.right).abs() / across).max(c.dot(p.down).abs() / down) - c.dot(p.forward);
        self.placed(middle - (ROOM * most(&away)).max(2.0 * behind) * p.forward, middle)
    }

    /// Moves a camera in perspective, without turning it, to the nearest place from which all `points` lie within `share` (0..1) of the
    /// picture's width and height, in its middle; it then looks at the middle of their depths.
    ///
    /// From an eye at depth `e` and offset `x` along an axis of the picture whose half angle has the tangent `t`, all points are inside if
    /// `t e - x` and `t e + x` are at most the least of `t d - p` and of `t d + p` over the depths `d` and offsets `p` of the points: the
    /// largest `e` follows without iteration (ours).
    ///
    /// # Errors
    /// [`PinholeError`] without points, or with points that are not finite.
    pub fn holding(&self, points: &[DVec3], share: f64) -> Result<Self, PinholeError> {
        let p = &self.pinhole;
        let depths = points.iter().map(|c| c.dot(p.forward));
        let [least, greatest] = depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], d| [a.min(d), b.max(d)]);
        let axes = [(p.right, p.image[0]), (p.down, p.image[1])];
        let farthest = |(axis, pixels): (DVec3, u32)| {
            let t = share * 0.5 * f64::from(pixels) / p.scale_px();
            let inside = |side: f64| points.iter().map(move |c| t * c.dot(p.forward) + side * c.dot(axis));
            [-1.0, 1.0].map(|side| inside(side).fold(f64::INFINITY, f64::min)).iter().sum::<f64>() / (2.0 * t)
        };
        let depth = axes.map(farthest).into_iter().fold(least - 2.0 * p.near, f64::min);
        let [x, y] = axes.map(|(axis, _)| middle(points, p.forward, axis, depth));
        let eye = depth * p.forward + x * p.right + y * p.down;
        self.placed(eye, eye + (0.5 * (least + greatest) - depth) * p.forward)
    }

    fn placed(&self, eye: DVec3, target: DVec3) -> Result<Self, PinholeError> {
        let p = &self.pinhole;
        let pinhole = Pinhole::look_at(eye, target, DVec3::Z, p.projection, p.image, p.near, p.far)?;
        Ok(Self { pinhole, target })
    }

    /// Point where the ray of a pixel meets the level plane through `held`, ahead and within ten times the distance of `held`.
    fn on_level(&self, held: DVec3, pixel: DVec2) -> Option<DVec3> {
        let (start, direction) = self.pinhole.line(pixel);
        let direction = direction.normalize();
        let farthest = 10.0 * held.distance(self.pinhole.eye);
        let t = (held.z - start.z) / direction.z;
        (t > 0.0 && t < farthest).then(|| start + t * direction)
    }
}

/// Offset along an axis of the picture of an eye at `depth` whose picture shows points, all of them in front of it, as far to one side of its
/// middle as to the other.
fn middle(points: &[DVec3], forward: DVec3, axis: DVec3, depth: f64) -> f64 {
    let offsets = points.iter().map(|c| c.dot(axis));
    let [mut low, mut high] = offsets.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    for _ in 0..HALVINGS {
        let x = 0.5 * (low + high);
        let tangents = points.iter().map(|c| (c.dot(axis) - x) / (c.dot(forward) - depth));
        let [least, greatest] = tangents.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| [a.min(t), b.max(t)]);
        if least + greatest > 0.0 { low = x } else { high = x }
    }
    0.5 * (low + high)
}

/// `direction` turned about the vertical by `yaw` and towards it by `pitch`, radians.
fn turned(direction: DVec3, yaw: f64, pitch: f64) -> DVec3 {
    let level = direction.truncate().length();
    let height = direction.z.atan2(level);
    let limit = FRAC_PI_2 - LEAST_TILT;
    let wanted = (height + pitch).clamp(-limit, limit);
    let heading = if level > 1e-12 * direction.length() { direction.truncate() / level } else { DVec2::Y };
    let flat = (heading * wanted.cos()).extend(wanted.sin());
    DQuat::from_rotation_z(yaw) * flat * direction.length()
}

#[cfg(test)]
mod tests;
