//! Cameras above the ground.

use belvedere::core::{DVec3, Navigation};
use belvedere::scene::Scene;

/// Least height of an eye over the ground, metres.
const EYE_M: f64 = 2.0;

/// The camera raised together with its target if its eye would lie less than 2 m over the ground.
pub fn above_ground(camera: Navigation, scene: &Scene) -> Navigation {
    let eye = camera.pinhole.eye;
    let ground = scene.terrain().and_then(|terrain| terrain.surface_at(eye.truncate()));
    let missing = ground.map_or(0.0, |ground| ground + EYE_M - eye.z);
    let raised = camera.moved(missing.max(0.0) * DVec3::Z);
    if missing > 0.0 { raised.unwrap_or(camera) } else { camera }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere::scene_file::parse;
    use belvedere::{OpenOptions, Session};
    use std::path::Path;

    #[test]
    fn an_eye_under_the_ground_is_raised_with_what_it_looks_at() {
        let text = "format = 1\n[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 300]\n\
            [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n";
        let source = parse(Path::new("s.toml"), text).expect("scene");
        let session = Session::from_document(source, &OpenOptions::default()).expect("session");
        let (pinhole, target) = (session.view().pinhole().clone(), DVec3::new(0.0, 0.0, 300.0));
        let camera = Navigation { pinhole, target };
        assert_eq!(above_ground(camera.clone(), session.scene()).pinhole.eye, camera.pinhole.eye);
        let under = camera.moved(DVec3::new(0.0, 0.0, -4500.0)).expect("a camera");
        let raised = above_ground(under.clone(), session.scene());
        let ground =
            session.scene().terrain().and_then(|t| t.surface_at(raised.pinhole.eye.truncate())).expect("ground");
        assert!((raised.pinhole.eye.z - ground - EYE_M).abs() < 1e-9, "{} over {ground}", raised.pinhole.eye.z);
        let by = |a: DVec3, b: DVec3| (a - b).truncate().length();
        assert!(by(raised.pinhole.eye, under.pinhole.eye) == 0.0 && raised.target.z > under.target.z);
    }
}
