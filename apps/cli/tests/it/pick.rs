//! pick and the exact renderer through the command line.

use super::Place;

const TOWN: &str = "format = 1\ncrs = 'local'\n[camera]\neye = [0, -100, 20]\nlook_at = [0, 0, 20]\nimage = [100, 100]\n\
    [[layer]]\nkind = 'boxes'\nid = 'town'\nboxes = [{ base = [0, 10, 0], size = [20, 20, 50] }]\n";

#[test]
fn pick_names_what_is_seen_and_null_for_sky() {
    let place = Place::new();
    place.write("s.toml", TOWN);
    place.write("p.json", "[[50, 50], [1, 1]]");
    let answer = place.json(&["pick", "s.toml", "--pixels", "p.json"]);
    let seen = &answer["pixels"][0];
    for (i, expected) in [0.0, 0.0, 20.0].into_iter().enumerate() {
        let value = seen["point"][i].as_f64().expect("a number");
        assert!((value - expected).abs() < 1e-9, "{answer}");
    }
    assert!((seen["depth"].as_f64().expect("a number") - 100.0).abs() < 1e-9);
    assert_eq!(seen["segment"], 0);
    assert_eq!(seen["layer"], "town");
    assert!(seen["feature"].is_null());
    assert!(answer["pixels"][1].is_null(), "{answer}");
}

#[test]
fn pick_agrees_with_project_on_a_bent_scene() {
    let place = Place::new();
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/massif_curved_rays.toml");
    place.write("p.json", "[[640.25, 500.5], [300.5, 400.5], [900, 450.125], [640, 0.5]]");
    let answer = place.json(&["pick", scenes, "--pixels", "p.json"]);
    let pixels = answer["pixels"].as_array().expect("a list");
    let points: Vec<_> = pixels.iter().filter(|p| !p.is_null()).map(|p| p["point"].clone()).collect();
    assert!(points.len() >= 3, "{answer}");
    place.write("q.json", &serde_json::json!(points).to_string());
    let back = place.json(&["project", scenes, "--points", "q.json"]);
    let asked = [[640.25, 500.5], [300.5, 400.5], [900.0, 450.125], [640.0, 0.5]];
    let seen = pixels.iter().zip(asked).filter(|(p, _)| !p.is_null());
    for ((picked, pixel), image) in seen.zip(back["points"].as_array().expect("a list")) {
        // A line is answered with its own nearest point, within half its width.
        let reach = if picked["layer"] == "trail" { 2.0 } else { 1e-6 };
        for k in 0..2 {
            let value = image["pixel"][k].as_f64().expect("a number");
            assert!((value - pixel[k]).abs() < reach, "{picked} {image}");
        }
        assert_eq!(picked["segment"], image["segment"]);
    }
}

#[test]
fn the_exact_renderer_draws_and_says_so() {
    let place = Place::new();
    place.write("s.toml", TOWN);
    place.ok(&["render", "s.toml", "-o", "a.png", "--renderer", "exact", "--aux", "depth"]);
    let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("a.png.json"))).expect("a record");
    assert_eq!(record["renderer"], "exact");
    assert!(place.path("a.depth.npy").exists());
}
