//! The camera that follows a walker along a route, frame by frame.

use super::bends::{FollowingBends, FollowingCamera};
use super::route::RouteLine;
use belvedere_construct::Flight;
use belvedere_core::{DVec2, DVec3, View};

/// Place of the walker below the middle of the picture, in half heights: in the lower third, with room below.
const WALKER_AT: f64 = 0.6;

/// Share by which the camera turns to a walker that the terrain solver moved, per frame.
const TURN: f64 = 0.15;
/// Distance from the middle within which a walker is kept, and beyond which he counts as lost, shares of half the picture.
const EDGE: f64 = 0.85;
const LOST: f64 = 0.97;

/// What a frame changes of the flight so that its ground is seen from above and the walker stays in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Adjustment {
    /// Height by which the eye is lifted, scene units, >= 0.
    pub(crate) lift: f64,
    /// Share of the strength of the bends, 0..=1.
    pub(crate) share: f64,
    /// Height over the undisplaced ground of the walker that the camera turns to, scene units.
    pub(crate) aim: f64,
}

impl Adjustment {
    /// The flight as it is.
    pub(crate) const NONE: Self = Self { lift: 0.0, share: 1.0, aim: 0.0 };

    /// The aim of the frame after one in which the walker was drawn `risen` above the undisplaced ground.
    pub(crate) fn next_aim(aim: f64, risen: f64) -> f64 {
        aim + TURN * (risen - aim)
    }
}

/// Flight, walker and bends of all frames.
#[derive(Debug, Clone)]
pub(crate) struct Following {
    pub(crate) route: RouteLine,
    pub(crate) flight: Flight,
    /// Distance walked in every frame, scene units.
    pub(crate) walked: Vec<f64>,
    /// Whether the point looked at is the stated one; else the walker lies in the lower third of the picture.
    pub(crate) stated_target: bool,
    /// Tangents of half the fields of view, across and upright.
    pub(crate) half: [f64; 2],
    /// The walker on the undisplaced ground in every frame.
    pub(crate) walkers: Vec<DVec3>,
    pub(crate) bends: FollowingBends,
    /// What every frame changes.
    pub(crate) adjustments: Vec<Adjustment>,
}

impl Following {
    /// Camera of a frame.
    pub(crate) fn camera(&self, frame: usize) -> FollowingCamera {
        let walked = self.walked[frame];
        let (eye, target) = self.flight.at(walked);
        let walker = self.flight.walker(walked);
        let Adjustment { lift, aim, .. } = self.adjustments[frame];
        let eye = eye + lift * DVec3::Z;
        let aim = aim * DVec3::Z;
        let look_at = match self.stated_target {
            true => target,
            false => {
                holding(eye, framed(eye, target, walker + aim, self.half[1]), self.walkers[frame] + aim, self.half)
            }
        };
        FollowingCamera { eye, look_at, walker }
    }

    /// Whether the walker, drawn `risen` above the undisplaced ground, lies outside of the picture or close to its edge, although the
    /// camera may turn to him.
    pub(crate) fn loses_walker(&self, frame: usize, view: &View, risen: f64) -> bool {
        let pinhole = view.pinhole();
        let place = pinhole.project(self.walkers[frame] + risen * DVec3::Z).map(|(pixel, _)| {
            let half = pinhole.image.map(|n| 0.5 * f64::from(n));
            ((pixel.x - half[0]) / half[0]).abs().max(((pixel.y - half[1]) / half[1]).abs())
        });
        !self.stated_target && place.map_or(true, |place| place > LOST)
    }
}

/// The point to look at, turned as little as it takes to keep `point` within [`EDGE`] of the picture.
///
/// * `half`: tangents of half the fields of view, across and upright.
fn holding(eye: DVec3, look_at: DVec3, point: DVec3, half: [f64; 2]) -> DVec3 {
    let distance = look_at.distance(eye);
    let (mut forward, to) = ((look_at - eye).normalize_or_zero(), point - eye);
    for _ in 0..24 {
        let Some(right) = forward.cross(DVec3::Z).try_normalize() else { break };
        let up = right.cross(forward);
        let depth = to.dot(forward).max(1e-3 * to.length());
        let excess = |along: f64, half: f64| {
            let (angle, most) = ((along / depth).atan(), (EDGE * half).atan());
            angle - angle.clamp(-most, most)
        };
        let (aside, over) = (excess(to.dot(right), half[0]), excess(to.dot(up), half[1]));
        if aside.abs().max(over.abs()) < 1e-9 {
            break;
        }
        let slope = forward.truncate().length();
        let heading = DVec2::from_angle(-aside / slope.max(0.3)).rotate(forward.truncate() / slope);
        let pitch = (forward.z.clamp(-1.0, 1.0).asin() + over).clamp(-1.4, 1.4);
        forward = (pitch.cos() * heading).extend(pitch.sin());
    }
    eye + distance * forward
}

/// A point in the direction of `target` that puts the walker at its place in the picture.
fn framed(eye: DVec3, target: DVec3, walker: DVec3, half_tan: f64) -> DVec3 {
    let ahead = (target - eye).truncate();
    let Some(heading) = ahead.try_normalize() else { return target };
    let depression = (eye.z - walker.z).atan2((walker - eye).truncate().dot(heading));
    let below = (WALKER_AT * half_tan).atan();
    // Low eyes do not look up to the sky.
    let pitch = (depression - below).max(0.5 * depression).min(1.4);
    let (sin, cos) = pitch.sin_cos();
    eye + ahead.length().max(1.0) * (cos * heading).extend(-sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_walker_lies_in_the_lower_third() {
        let half = 22.5f64.to_radians().tan();
        for height in [400.0, 500.0, 1500.0] {
            let (eye, walker) = (DVec3::new(0.0, 0.0, height), DVec3::new(800.0, 0.0, 0.0));
            let to = framed(eye, DVec3::new(2300.0, 0.0, 0.0), walker, half) - eye;
            let pitch = (-to.z).atan2(to.truncate().length());
            let place = (height.atan2(800.0) - pitch).tan() / half;
            assert!((1.0 / 3.0..0.61).contains(&place), "{height}: {place}");
            assert!(to.truncate().dot(DVec2::X) > 0.0);
        }
    }

    #[test]
    fn the_camera_turns_as_far_as_the_walker_needs_and_not_much_further() {
        let half = [0.8, 0.45];
        let (eye, look_at) = (DVec3::new(0.0, 0.0, 900.0), DVec3::new(2000.0, 100.0, 0.0));
        let place = |look_at: DVec3, p: DVec3| {
            let forward = (look_at - eye).normalize();
            let right = forward.cross(DVec3::Z).normalize();
            let (up, to) = (right.cross(forward), p - eye);
            [to.dot(right) / half[0], to.dot(up) / half[1]].map(|v| v / to.dot(forward))
        };
        let most = |look_at, p| place(look_at, p).into_iter().map(f64::abs).fold(0.0, f64::max);
        for p in [[900.0, 700.0, -300.0], [300.0, -200.0, 100.0], [200.0, 900.0, 0.0], [700.0, 0.0, -900.0]] {
            let p = DVec3::from_array(p);
            assert!(most(look_at, p) > EDGE, "the case is too mild: {p}");
            let kept = most(holding(eye, look_at, p, half), p);
            assert!((EDGE - 0.05..EDGE + 1e-4).contains(&kept), "{p} lies at {kept}");
        }
        let inside = DVec3::new(1000.0, 100.0, 300.0);
        assert!(most(look_at, inside) < EDGE && holding(eye, look_at, inside, half).distance(look_at) < 1e-9);
    }
}
