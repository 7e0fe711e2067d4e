//! A camera as the end of a page's address.

use belvedere::scene_file::{CameraDoc, PointDoc};

/// The camera in words for an address: eye, point looked at, field of view; `None` if it is given by a rule.
#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
pub(crate) fn text_of(camera: &CameraDoc) -> Option<String> {
    let (PointDoc::Scene(eye), Some(PointDoc::Scene(to))) = (&camera.eye, &camera.look_at) else { return None };
    let rounded = |v: &f64| format!("{}", (1e3 * v).round() / 1e3);
    let numbers: Vec<String> = eye.iter().chain(to).chain([&camera.fov_y_deg]).map(rounded).collect();
    Some(format!("view={}", numbers.join(",")))
}

/// Puts the camera of an address into a document's camera. Whether there was one.
#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
pub(crate) fn put(text: &str, camera: &mut CameraDoc) -> bool {
    let Some(list) = text.trim_start_matches('#').strip_prefix("view=") else { return false };
    let Ok(numbers) = list.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>() else { return false };
    let [x, y, z, to_x, to_y, to_z, fov] = numbers[..] else { return false };
    let is_camera = numbers.iter().all(|number| number.is_finite()) && fov > 0.0 && fov < 180.0;
    if !is_camera {
        return false;
    }
    (camera.eye, camera.look_at) = (PointDoc::Scene([x, y, z]), Some(PointDoc::Scene([to_x, to_y, to_z])));
    (camera.heading_deg, camera.pitch_deg, camera.fov_y_deg) = (None, None, fov);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_comes_back_from_an_address_and_nonsense_leaves_it_alone() {
        let text = "format = 1\n[camera]\neye = [1.25, -900, 4000]\nlook_at = [0, 0.5, 300]\nfov_y_deg = 30.0\n";
        let parsed = belvedere::scene_file::parse(std::path::Path::new("s.toml"), text).expect("scene");
        let camera = parsed.document.camera;
        let address = text_of(&camera).expect("an address");
        assert_eq!(address, "view=1.25,-900,4000,0,0.5,300,30");
        let mut other = camera.clone();
        (other.eye, other.look_at, other.fov_y_deg) = (PointDoc::Scene([9.0; 3]), None, 60.0);
        assert!(put(&format!("#{address}"), &mut other));
        assert_eq!(other, camera);
        for nonsense in
            ["", "#about", "view=1,2,3", "view=1,2,3,4,5,6,190", "view=1,2,3,4,5,NaN,30", "view=1,a,2,3,4,5,6,30"]
        {
            assert!(!put(nonsense, &mut other), "{nonsense}");
        }
        assert_eq!(other, camera);
    }
}
