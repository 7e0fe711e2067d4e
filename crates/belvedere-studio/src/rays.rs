//! Turns to begin with, and their handles.

use belvedere::core::map::curved_rays::Sharpness;
use belvedere::core::{DQuat, DVec3, Navigation};
use belvedere::scene_file::{AxisDoc, RaysStageDoc, TurnDoc};

/// Angle by which the rays of a new turn are led aside, radians.
const ASIDE: f64 = 0.35;

/// A further turn of curved rays to the left, as a start for editing: the first one about the point that the camera looks at, others
/// behind the last one.
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
    // The planes are vertical where the rays are level enough.
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

/// Least and largest sharpness of a turn.
const SHARPNESS: [f64; 2] = [0.2, 20.0];
/// Distance of the handle of the least sharpness from the bend point, and the additional distance of that of the largest, in distances between
/// the first and the last plane.
const KNOB: [f64; 2] = [0.5, 1.5];

/// The turn with planes that share a vertical line instead of being parallel, beside the picture on the side of the viewpoint.
///
/// * `before`: the viewpoint before the turn, scene coordinates.
pub fn with_pivot_line(turn: &TurnDoc, before: DVec3) -> TurnDoc {
    let [bend, viewpoint] = [turn.t1, turn.viewpoint].map(DVec3::from_array);
    let (normal, side) = axes(turn);
    let side = if side.dot(viewpoint - before) < 0.0 { -side } else { side };
    // Farther aside than pictures are wide, and far enough that the planes are nearly parallel.
    let away = (8.0 * thickness(turn)).max(3.0 * bend.distance(before));
    let line =
        AxisDoc { point: (bend + away * side).to_array(), dir: side.cross(normal).normalize_or(DVec3::Z).to_array() };
    TurnDoc { line: Some(line), normal: None, ..turn.clone() }
}

/// The turn with parallel planes.
pub fn with_parallel_planes(turn: &TurnDoc) -> TurnDoc {
    TurnDoc { line: None, normal: Some(axes(turn).0.to_array()), ..turn.clone() }
}

/// Position of the handle of a turn's sharpness: in its middle plane, beside the bend point, farther for a sharper turn.
///
/// * `sharpness`: 0.2 to 20.
pub fn sharpness_knob(turn: &TurnDoc, sharpness: f64) -> DVec3 {
    let share = (sharpness / SHARPNESS[0]).ln() / (SHARPNESS[1] / SHARPNESS[0]).ln();
    let away = KNOB[0] + KNOB[1] * share.clamp(0.0, 1.0);
    DVec3::from_array(turn.t1) + away * thickness(turn) * axes(turn).1
}

/// The sharpness, 0.2 to 20, whose handle is nearest to a point.
pub fn sharpness_at(turn: &TurnDoc, point: DVec3) -> f64 {
    let away = (point - DVec3::from_array(turn.t1)).dot(axes(turn).1) / thickness(turn);
    let share = ((away - KNOB[0]) / KNOB[1]).clamp(0.0, 1.0);
    SHARPNESS[0] * (SHARPNESS[1] / SHARPNESS[0]).powf(share)
}

/// Distance between the points of the first and of the last plane, > 0.
fn thickness(turn: &TurnDoc) -> f64 {
    DVec3::from_array(turn.t0).distance(DVec3::from_array(turn.t2)).max(1e-6)
}

/// Normal of the planes, and a level direction within them, if there is one.
fn axes(turn: &TurnDoc) -> (DVec3, DVec3) {
    let [t0, t2] = [turn.t0, turn.t2].map(DVec3::from_array);
    let through = turn.normal.map_or(t2 - t0, DVec3::from_array).normalize_or(DVec3::X);
    let up = if through.z.abs() < 0.9 { DVec3::Z } else { DVec3::Y };
    (through, through.cross(up).normalize_or(DVec3::Y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere::core::{Pinhole, Projection};
    use belvedere::scene_file::parse;
    use belvedere::{OpenOptions, Session};
    use std::path::Path;

    fn turn() -> (DVec3, TurnDoc) {
        let (eye, target) = (DVec3::new(6000.0, -5200.0, 3600.0), DVec3::new(0.0, 0.0, 300.0));
        let lens = Projection::Perspective { fov_y: 0.8 };
        let pinhole = Pinhole::look_at(eye, target, DVec3::Z, lens, [160, 90], 1.0, None).expect("camera");
        (eye, next_turn(&Navigation { pinhole, target }, None))
    }

    #[test]
    fn planes_get_a_line_that_a_camera_can_have_and_lose_it() {
        let (eye, parallel) = turn();
        let pivoted = with_pivot_line(&parallel, eye);
        assert!(pivoted.normal.is_none() && pivoted.line.is_some());
        let text = "format = 1\n[camera]\neye = [6000.0, -5200.0, 3600.0]\nlook_at = [0.0, 0.0, 300.0]\n\
            [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n";
        let mut source = parse(Path::new("s.toml"), text).expect("scene");
        for turn in [pivoted.clone(), with_parallel_planes(&pivoted)] {
            let stage = RaysStageDoc { model: Default::default(), turn: vec![turn], split: None };
            source.document.stage = vec![belvedere::scene_file::StageDoc::CurvedRays(stage)];
            let session = Session::from_document(source.clone(), &OpenOptions::default());
            assert!(session.expect("a view").view().is_bent());
        }
    }

    #[test]
    fn the_knob_of_sharpness_stands_where_its_sharpness_is_read() {
        let (_, turn) = turn();
        for sharpness in [0.2, 1.0, 3.0, 20.0] {
            let read = sharpness_at(&turn, sharpness_knob(&turn, sharpness));
            assert!((read / sharpness - 1.0).abs() < 1e-9, "{read} for {sharpness}");
        }
        assert_eq!(sharpness_at(&turn, DVec3::from_array(turn.t1)), 0.2, "no less than the least");
    }
}
