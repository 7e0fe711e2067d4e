//! The camera that follows a walker along a route, frame by frame.

use super::bends::{FollowingBends, FollowingCamera};
use super::route::RouteLine;
use belvedere_construct::Flight;
use belvedere_core::DVec3;

/// Place of the walker below the middle of the picture, in half heights: in the lower third, with room below.
const WALKER_AT: f64 = 0.6;

/// What a frame changes of the flight so that its ground is seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Adjustment {
    /// Height by which the eye is lifted, scene units, >= 0.
    pub(crate) lift: f64,
    /// Share of the strength of the bends, 0..=1.
    pub(crate) share: f64,
}

impl Adjustment {
    /// The flight as it is.
    pub(crate) const NONE: Self = Self { lift: 0.0, share: 1.0 };
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
    /// Field of view, radians.
    pub(crate) fov_y: f64,
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
        let eye = eye + self.adjustments[frame].lift * DVec3::Z;
        let look_at = if self.stated_target { target } else { framed(eye, target, walker, self.fov_y) };
        FollowingCamera { eye, look_at, walker }
    }

    /// The walker on the route.
    pub(crate) fn walker(&self, frame: usize) -> Option<DVec3> {
        self.route.at(self.walked[frame])
    }
}

/// A point in the direction of `target` that puts the walker at its place in the picture.
fn framed(eye: DVec3, target: DVec3, walker: DVec3, fov_y: f64) -> DVec3 {
    let ahead = (target - eye).truncate();
    let Some(heading) = ahead.try_normalize() else { return target };
    let depression = (eye.z - walker.z).atan2((walker - eye).truncate().dot(heading));
    let below = (WALKER_AT * (0.5 * fov_y).tan()).atan();
    // Low eyes do not look up to the sky.
    let pitch = (depression - below).max(0.5 * depression).min(1.4);
    let (sin, cos) = pitch.sin_cos();
    eye + ahead.length().max(1.0) * (cos * heading).extend(-sin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec2;

    #[test]
    fn the_walker_lies_in_the_lower_third() {
        let fov_y = 45f64.to_radians();
        for height in [400.0, 500.0, 1500.0] {
            let (eye, walker) = (DVec3::new(0.0, 0.0, height), DVec3::new(800.0, 0.0, 0.0));
            let to = framed(eye, DVec3::new(2300.0, 0.0, 0.0), walker, fov_y) - eye;
            let pitch = (-to.z).atan2(to.truncate().length());
            let place = (height.atan2(800.0) - pitch).tan() / (0.5 * fov_y).tan();
            assert!((1.0 / 3.0..0.61).contains(&place), "{height}: {place}");
            assert!(to.truncate().dot(DVec2::X) > 0.0);
        }
    }
}
