//! The whole circle around a place as a user meets it: a stage of scenes, and an option for data.

use super::{Place, read};
use serde_json::Value;

/// A small massif.
const GROUND: &str = "[[layer]]\nkind = \"terrain\"\nid = \"ground\"\nsource = \"builtin:massif?seed=7&size=65\"\n";

fn scene(camera: &str, stage: &str) -> String {
    format!(
        "format = 1\ncrs = \"local\"\n[camera]\neye = [-3000.0, -3000.0, 3200.0]\nimage = [360, 60]\n{camera}\n{GROUND}\
         [[stage]]\nkind = \"unroll\"\n{stage}\n"
    )
}

fn record(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&read(&place.path(name))).expect("JSON")
}

#[test]
fn columns_of_a_scene_are_azimuths_and_rows_are_slopes() {
    let place = Place::new();
    place.write("s.toml", &scene("heading_deg = 90\npitch_deg = 5", ""));
    // One place to the east, one to the north, one to the west, each 1000 away, and one straight below.
    place.write("p.json", "[[-2000, -3000, 3200], [-3000, -2000, 3100], [-4000, -3001, 3200], [-3000, -3000, 0]]");
    let found = place.json(&["project", "s.toml", "--points", "p.json"]).to_string();
    let pixels: Vec<[f64; 2]> = found
        .split("\"pixel\":[")
        .skip(1)
        .map(|part| {
            let numbers: Vec<f64> = part.split([',', ']']).take(2).map(|n| n.parse().expect("a number")).collect();
            [numbers[0], numbers[1]]
        })
        .collect();
    let per_degree = 1.0;
    let middle = 30.0 - 5f64.to_radians().tan() * per_degree * 180.0 / std::f64::consts::PI;
    assert!((pixels[0][0] - 180.0).abs() < 1e-6 && (pixels[0][1] - middle).abs() < 1e-6, "{found}");
    assert!(
        (pixels[1][0] - 90.0).abs() < 1e-6 && (pixels[1][1] - middle - 0.1 * 180.0 / std::f64::consts::PI).abs() < 1e-6
    );
    assert!(pixels[2][0] < 1.0 || pixels[2][0] > 359.0, "{found}");
    assert_eq!(pixels.len(), 3, "what lies straight below has no azimuth: {found}");
}

#[test]
fn what_is_resolved_opens_to_the_same_view() {
    for (camera, stage) in
        [("heading_deg = 20\npitch_deg = 0", ""), ("look_at = [0, 0, 2500]", "span_deg = 200\nfrom = 'sphere'")]
    {
        let place = Place::new();
        place.write("s.toml", &scene(camera, stage));
        place.write("p.json", "[[-2000, -3500, 1000], [500, 0, 900], [-4000, -4500, 1500]]");
        place.ok(&["show", "s.toml", "-o", "shown.toml"]);
        let project = |scene: &str| place.ok(&["project", scene, "--points", "p.json"]);
        assert_eq!(project("s.toml"), project("shown.toml"), "{camera}");
        assert_eq!(place.ok(&["show", "shown.toml"]), place.ok(&["show", "s.toml"]), "{camera}");
    }
}

#[test]
fn data_are_seen_all_around_from_a_place_on_them() {
    let place = Place::new();
    place.write(
        "g.toml",
        &format!("format = 1\ncrs = \"local\"\n[camera]\neye = [0, 0, 9000]\nlook_at = [0, 1, 0]\n{GROUND}"),
    );
    let draw = |out: &str, more: &[&str]| {
        let args = [&["render", "g.toml", "--panorama=-3000,-3000,+30", "-o", out, "--size", "360x60"], more].concat();
        place.ok(&args);
        record(&place, &format!("{out}.json"))
    };
    let said = draw("a.png", &[]);
    assert_eq!(said["stages"], serde_json::json!(["unroll"]));
    let camera = &said["scene"]["camera"];
    let eye: Vec<f64> = serde_json::from_value(camera["eye"].clone()).expect("a point");
    assert!((eye[0], eye[1]) == (-3000.0, -3000.0) && eye[2] > 100.0, "{camera}");
    for (k, more) in [["--heading", "90"], ["--span", "120"], ["--pitch", "10"]].iter().enumerate() {
        let out = format!("{k}.png");
        draw(&out, more);
        assert_ne!(read(&place.path(&out)), read(&place.path("a.png")), "{more:?}");
    }
    draw("s.png", &["--sphere"]);
    assert_ne!(read(&place.path("s.png")), read(&place.path("a.png")));
}

#[test]
fn what_cannot_be_unrolled_is_said() {
    let place = Place::new();
    for (camera, stage, said) in [
        ("heading_deg = 0\npitch_deg = 0", "span_deg = 400", "span_deg is 400"),
        ("heading_deg = 0\npitch_deg = 80", "", "80 degrees below the horizon"),
        ("heading_deg = 0\npitch_deg = 0\nprojection = 'orthographic'\northo_height_m = 100", "", "needs an eye"),
    ] {
        place.write("s.toml", &scene(camera, stage));
        let refused = place.fails(&["render", "s.toml", "-o", "x.png"]);
        assert!(refused.contains(said) && refused.contains("s.toml:"), "{stage}: {refused}");
    }
    place.write("s.toml", &scene("heading_deg = 0\npitch_deg = 0", ""));
    let two = place.fails(&["render", "s.toml", "--panorama", "0,0,+5", "-o", "x.png"]);
    assert!(two.contains("--panorama"), "{two}");
}
