//! `--curved-earth` and `earth = "curved"`: every view falls away with the distance, whoever gave it.

use super::light_and_tints::pixels;
use super::{Place, read};
use serde_json::Value;
use std::fmt::Write;

/// A plain 140 km long with a low ridge in front of a high wall at its far end, and a way along the ridge.
fn place() -> Place {
    let place = Place::new();
    let mut text = String::from("ncols 25\nnrows 140\nxllcorner 0\nyllcorner 0\ncellsize 1000\n");
    for row in 0..140 {
        let height = match 139 - row {
            117..=119 => 600.0,
            132.. => 3000.0,
            _ => 0.0,
        };
        for col in 0..25 {
            let _ = write!(text, "{:.1} ", height + 3.0 * f64::from(col % 5));
        }
        text.push('\n');
    }
    place.write("dem.asc", &text);
    let way = "{\"type\":\"LineString\",\"coordinates\":[[9000,118500],[12000,118500],[15000,118500]]}";
    place.write("way.geojson", way);
    place
}

const EYE: [&str; 4] = ["--eye", "12500,1500,60", "--look", "12500,118500,300"];

fn revealed(place: &Place, more: &[&str]) -> (Value, Vec<u8>, Value) {
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--scene", "out.toml", "--size", "160x90"];
    let result = place.json(&[&args[..], &["--overwrite", "--json"], more].concat());
    let record = serde_json::from_slice(&read(&place.path("out.png.json"))).expect("JSON");
    (result, pixels(&read(&place.path("out.png"))), record)
}

#[test]
fn a_curved_earth_is_in_every_view_that_reveal_makes_and_its_scene_draws_the_same_picture() {
    let place = place();
    for technique in ["spline", "terrain", "curved_rays", "auto"] {
        for view in [&[&EYE[..], &["--fov", "6"]].concat()[..], &[]] {
            let args = [&["--technique", technique, "--no-limits"], view].concat();
            let (_, flat, record) = revealed(&place, &args);
            assert!(!record["stages"].to_string().contains("earth"), "{args:?}: {}", record["stages"]);
            let (_, curved, record) = revealed(&place, &[&args[..], &["--curved-earth"]].concat());
            assert_eq!(record["stages"][0], "earth", "{args:?}: {}", record["stages"]);
            assert!(flat != curved, "{args:?}: the same picture");
            place.ok(&["render", "out.toml", "-o", "again.png", "--overwrite"]);
            assert!(pixels(&read(&place.path("again.png"))) == curved, "{args:?}: another picture from the scene");
        }
    }
}

#[test]
fn a_target_below_the_horizon_is_hidden_from_a_given_eye_and_on_a_flat_earth_it_is_not() {
    let place = place();
    for (earth, seen) in [("flat", true), ("curved", false)] {
        let scene = format!(
            "format = 1\ncrs = \"local\"\nearth = \"{earth}\"\n[[layer]]\nid = \"ground\"\nkind = \"terrain\"\nsource = \"dem.asc\"\n\
             [camera]\neye = [0.0, 0.0, 500.0]\nlook_at = [0.0, 1000.0, 500.0]\nimage = [160, 90]\n"
        );
        place.write("scene.toml", &scene);
        let args = ["reveal", "scene.toml", "--see", "12500,110000,300", "-o", "t.png", "--overwrite", "--json"];
        let result = place.json(&[&args[..], &EYE, &["--fov", "6"]].concat());
        let straight = result["visible_straight"].as_f64().expect("a share");
        assert_eq!(straight > 0.5, seen, "{earth}: {straight}");
    }
}
