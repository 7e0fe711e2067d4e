//! Turns to begin with.

use crate::scene_file::{RaysStageDoc, TurnDoc};
use belvedere_core::map::curved_rays::Sharpness;
use belvedere_core::{DQuat, DVec3, Navigation};

/// How far the rays of a new turn are led aside, radians.
const ASIDE: f64 = 0.35;

/// A further turn of curved rays, to the left, for a user to go on from: the first one about the point that the camera looks at, the
/// others behind the last one.
pub fn next_turn(camera: &Navigation, stage: Option<&RaysStageDoc>) -> TurnDoc {
    let eye = camera.pinhole.eye;
    let (from, bend, half) = match stage.and_then(|stage| stage.turn.last()) {
        None => (eye, camera.target, 0.25 * (camera.target - eye).length()),
        Some(last) => {
            let [from, t0, t1, t2] = [last.viewpoint, last.t0, last.t1, last.t2].map(DVec3::from_array);
            let half = 0.5 * (t2 - t0).length();
            let ahead = (t1 - from).normalize_or_zero();
            (from, t1 + 3.0 * half * ahead, half)
        }
    };
    let ahead = (bend - from).normalize_or_zero();
    // The planes stand upright where the rays are level enough for that.
    let level = ahead.truncate().extend(0.0);
    let normal = if level.length() > 0.3 { level.normalize() } else { ahead };
    let viewpoint = bend - DQuat::from_rotation_z(ASIDE) * (bend - from);
    TurnDoc {
        viewpoint: viewpoint.to_array(),
        t0: (bend - half * normal).to_array(),
        t1: bend.to_array(),
        t2: (bend + half * normal).to_array(),
        line: None,
        normal: Some(normal.to_array()),
        m: Sharpness::Bend,
    }
}
