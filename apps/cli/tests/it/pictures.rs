//! Pictures and their records.

use super::{BARE, Place};

const TOWN: &str = "format = 1
crs = 'local'
[[layer]]
id = 'boxes'
kind = 'boxes'
boxes = [{ base = [0, 100, -20], size = [20, 20, 40], color = '#c02020' }]
[camera]
eye = [0, 0, 0]
look_at = [0, 100, 0]
image = [64, 48]
[[stage]]
kind = 'curved_rays'
[[stage.turn]]
viewpoint = [30, 0, 0]
t0 = [0, 40, 0]
t1 = [0, 50, 0]
t2 = [0, 60, 0]
normal = [0, 1, 0]
";

#[test]
fn a_picture_comes_with_its_record_and_buffers() {
    let place = Place::new();
    place.write("s.toml", TOWN);
    let result = place.json(&["render", "s.toml", "-o", "p.png", "--aux", "depth,id,world,displacement", "--json"]);
    assert_eq!(result["outputs"].as_array().map(Vec::len), Some(6));
    let png = super::read(&place.path("p.png"));
    assert!(png.starts_with(b"\x89PNG") && png.windows(15).any(|w| w == b"belvedere:scene"));
    let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
    assert_eq!(record["renderer"], "cpu");
    assert_eq!(record["inputs"][0]["sha256"].as_str().map(str::len), Some(64));
    assert!(record["note"].as_str().is_some_and(|n| n.contains("displaced")));
    // Past t2 the world is carried along d = C - C' by (y - 50) / 50: 24 units at the front of the box, 36 at its back.
    let moved = record["displacement"]["max_m"].as_f64().expect("a number");
    assert!((24.0..=36.0).contains(&moved), "{moved}");
    let depth = super::read(&place.path("p.depth.npy"));
    assert!(depth.starts_with(b"\x93NUMPY\x01\x00") && depth.len() == 128 + 4 * 64 * 48, "{}", depth.len());
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let place = Place::new();
    place.write("s.toml", TOWN);
    place.ok(&["render", "s.toml", "-o", "a.png", "--threads", "1"]);
    place.ok(&["render", "s.toml", "-o", "b.png", "--threads", "2"]);
    assert_eq!(super::read(&place.path("a.png")), super::read(&place.path("b.png")));
}

#[test]
fn straight_and_compare_differ_as_they_say() {
    let place = Place::new();
    place.write("s.toml", TOWN);
    place.ok(&["render", "s.toml", "-o", "pair.png", "--compare"]);
    let png = super::read(&place.path("pair.png"));
    assert_eq!(u32::from_be_bytes([png[16], png[17], png[18], png[19]]), 2 * 64 + 8, "width of the pair");
    place.ok(&["render", "s.toml", "-o", "straight.png", "--straight"]);
    let record: serde_json::Value =
        serde_json::from_slice(&super::read(&place.path("straight.png.json"))).expect("JSON");
    assert!(record["displacement"].is_null() && record["note"].is_null());
}

#[test]
fn an_empty_scene_is_sky_and_a_huge_picture_is_refused() {
    let place = Place::new();
    place.write("s.toml", BARE);
    place.ok(&["render", "s.toml", "-o", "sky.png", "--size", "16x16"]);
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--compare", "--size", "60000x60000"]);
    assert!(line.contains("--max-mem"), "{line}");
    assert!(!place.path("x.png").exists());
}

#[test]
fn an_eye_under_ground_is_refused() {
    let place = Place::new();
    let scene = "format = 1\n[[layer]]\nid = 'g'\nkind = 'terrain'\nsource = 'builtin:massif?size=65'\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 100, 10]\nimage = [32, 32]\n";
    place.write("s.toml", scene);
    for args in [&["render", "s.toml", "-o", "x.png"][..], &["check", "s.toml"]] {
        let line = place.fails(args);
        assert!(line.contains("under the ground"), "{line}");
    }
    let outside = scene.replace("eye = [0, 0, 10]", "eye = [0, -20000, 3000]");
    place.write("s.toml", &outside);
    place.ok(&["render", "s.toml", "-o", "outside.png"]);
}

#[test]
fn both_methods_measure_curved_rays() {
    let scene = belvedere_testkit::workspace_root().join("scenes/massif_curved_rays.toml");
    let report = Place::new().json(&["measure", scene.to_str().expect("UTF-8")]);
    let lines = &report["lines"];
    let share = |which: &str| lines[which]["sight"]["share"].as_f64().expect("a share");
    assert!(share("bent") > share("straight"), "{} and {}", share("bent"), share("straight"));
    assert!(report["largest_difference"].as_f64().is_some_and(|d| d < 0.01), "{}", report["largest_difference"]);
}
