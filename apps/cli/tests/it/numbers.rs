//! project, rays, displace against numbers worked out by hand.

use super::{BARE, Place};

fn bare() -> Place {
    let place = Place::new();
    place.write("s.toml", BARE);
    place
}

fn near(value: &serde_json::Value, expected: f64) {
    let value = value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    assert!((value - expected).abs() < 1e-9, "{value}, expected {expected}");
}

#[test]
fn project_answers_in_input_order_with_nulls_for_misses() {
    let place = bare();
    place.write("p.json", "[[10, 100, 5], [0, -3, 0], [1000, 100, 0], [0.0, 0.5, 0.0]]");
    let answer = place.json(&["project", "s.toml", "--points", "p.json"]);
    let f = 360.0 / (22.5f64).to_radians().tan();
    let points = &answer["points"];
    near(&points[0]["pixel"][0], 640.0 + f * 0.1);
    near(&points[0]["pixel"][1], 360.0 - f * 0.05);
    near(&points[0]["depth"], 100.0);
    assert_eq!(points[0]["segment"], 0);
    assert_eq!(points[0]["inside"], true);
    assert!(points[0]["miss"].is_null());
    assert_eq!(
        points[1],
        serde_json::json!({"pixel": null, "depth": null, "segment": null, "inside": false, "miss": "behind_eye"})
    );
    near(&points[2]["pixel"][0], 640.0 + f * 10.0);
    assert_eq!(points[2]["inside"], false);
    assert_eq!(points[3]["inside"], true, "nearer than near is no miss");
}

#[test]
fn rays_are_equidistant_in_depth_from_near_to_far() {
    let place = bare();
    place.write("q.json", "[[640, 360], [0, 720]]");
    let answer = place.json(&["rays", "s.toml", "--pixels", "q.json", "--samples", "3", "--far", "101"]);
    let tan = (22.5f64).to_radians().tan();
    for (i, depth) in [1.0, 51.0, 101.0].into_iter().enumerate() {
        near(&answer["rays"][0][i]["point"][1], depth);
        near(&answer["rays"][1][i]["depth"], depth);
        near(&answer["rays"][1][i]["point"][0], -depth * tan * 1280.0 / 720.0);
        near(&answer["rays"][1][i]["point"][2], -depth * tan);
    }
    assert!(
        place.fails(&["rays", "s.toml", "--pixels", "q.json", "--samples", "3"]).contains("give --far or camera.far")
    );
    assert!(
        place.fails(&["rays", "s.toml", "--pixels", "q.json", "--samples", "0", "--far", "9"]).contains("at least 1")
    );
}

#[test]
fn a_straight_spline_preset_changes_nothing_and_curved_rays_bend_past_t0() {
    let place = Place::new();
    let camera = "format = 1\n[camera]\neye = [0, 0, 100]\nlook_at = [0, 100, 0]\n";
    place.write(
        "spline.toml",
        &format!("{camera}[[stage]]\nkind = 'spline_bend'\npresets = 'identity(45)'\nplane = {{ height_m = 0 }}\n"),
    );
    place.write("p.json", "[[7, 90, 3], [-20, 150, 11]]");
    let answer = place.json(&["displace", "spline.toml", "--points", "p.json"]);
    for (i, p) in [[7.0, 90.0, 3.0], [-20.0, 150.0, 11.0]].iter().enumerate() {
        for k in 0..3 {
            let value = answer["points"][i]["displaced"][k].as_f64().expect("a number");
            assert!((value - p[k]).abs() < 1e-6, "{value} is not {}", p[k]);
        }
        assert_eq!(answer["points"][i]["folded"], false);
    }
    // Parallel planes at 40, 50, 60 ahead; C = C' + 10 x. Past t2 the displacement is h d with h = (y - 50) / (50 - yC) scaled to -1 at C.
    let turn = "[[stage]]\nkind = 'curved_rays'\n[[stage.turn]]\nviewpoint = [10, 0, 0]\nt0 = [0, 40, 0]\nt1 = [0, 50, 0]\nt2 = [0, 60, 0]\nnormal = [0, 1, 0]\n";
    place.write("rays.toml", &format!("{BARE}{turn}"));
    place.write("p.json", "[[1, 30, 2], [1, 100, 2], [1, 50, 0]]");
    let answer = place.json(&["displace", "rays.toml", "--points", "p.json"]);
    near(&answer["points"][0]["displaced"][0], 1.0);
    near(&answer["points"][1]["displaced"][0], 1.0 + 10.0);
    // On t1 half way: m = 1 for planes half way apart, phi = a^2 / (a + b) with a = b = 10 / 100.
    near(&answer["points"][2]["displaced"][0], 1.0 + 10.0 * 0.05);
    let answer = place.json(&["project", "rays.toml", "--points", "p.json"]);
    let segments: Vec<_> = (0..3).map(|i| answer["points"][i]["segment"].as_u64()).collect();
    assert_eq!(segments, [Some(0), Some(2), Some(1)]);
}

#[test]
fn bad_points_name_their_index() {
    let place = bare();
    for (text, expected) in [
        ("[[1, 2, 3], [1, 2]]", "element 1: [x, y, z] of finite numbers was expected, found a list of 2 on line 1"),
        (
            "[[1, 2, 3],\n[1, 2, \"x\"]]",
            "element 1: [x, y, z] of finite numbers was expected, found the text \"x\" on line 2",
        ),
        ("{}", "a list of [x, y, z] was expected, found a table"),
        ("[[1, 2, 1e999]]", "line 1: \"1e999\" is not a finite number; give finite numbers"),
        ("[[1, 2, NaN]]", "line 1: a number is not finite; give finite numbers"),
        ("[[1, 2", "line 1: not valid JSON: it ends too early, a bracket or quote is not closed"),
    ] {
        place.write("p.json", text);
        assert_eq!(place.fails(&["project", "s.toml", "--points", "p.json"]), format!("belvedere: p.json: {expected}"));
    }
}

#[test]
fn huge_numbers_never_become_nan() {
    let place = bare();
    place.write("p.json", "[[1e308, 1e-300, 1e308], [1e308, 1e308, 1e308]]");
    for verb in ["project", "displace"] {
        let text = place.ok(&[verb, "s.toml", "--points", "p.json"]);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
}

#[test]
fn outputs_are_not_overwritten_unasked_and_never_inputs() {
    let place = bare();
    place.write("p.json", "[]");
    place.ok(&["project", "s.toml", "--points", "p.json", "-o", "o.json"]);
    let args = ["project", "s.toml", "--points", "p.json", "-o", "o.json"];
    assert!(place.fails(&args).contains("--overwrite"));
    place.ok(&[&args[..], &["--overwrite"]].concat());
    let over = ["project", "s.toml", "--points", "p.json", "-o", "p.json", "--overwrite"];
    assert!(place.fails(&over).contains("is an input of this command"));
    let written: serde_json::Value = serde_json::from_slice(&super::read(&place.path("o.json"))).expect("JSON");
    assert_eq!(written, serde_json::json!({ "verb": "project", "outputs": ["o.json"], "points": [], "warnings": [] }));
}

#[test]
fn looking_straight_down_needs_a_heading_or_a_spline() {
    let place = Place::new();
    let nadir = "[camera]\neye = [0, 0, 1000]\nlook_at = [0, 0, 0]\n";
    let spline = "[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\nplane = { height_m = 0 }\n";
    place.write("p.json", "[[0, 0, 0], [0, 100, 0], [100, 0, 0]]");
    let image = |scene: &str| {
        place.write("s.toml", scene);
        place.json(&["project", "s.toml", "--points", "p.json"])
    };
    place.write("s.toml", nadir);
    assert!(place.fails(&["project", "s.toml", "--points", "p.json"]).contains("looks along its up direction"));
    // North is up, as with the hint that says so.
    let north = image(&format!("{nadir}{spline}"));
    assert_eq!(north, image(&format!("{nadir}up = [0, 1, 0]\n{spline}")));
    let y = |i: usize| north["points"][i]["pixel"][1].as_f64().expect("a number");
    assert!(y(1) < y(0) && north["points"][2]["pixel"][0].as_f64() > Some(640.0));
    assert_ne!(north, image(&format!("{nadir}up = [1, 0, 0]\n{spline}")), "up is the hint");
}

#[test]
fn endless_and_marked_files_of_points() {
    let place = bare();
    if cfg!(unix) {
        assert!(place.fails(&["project", "s.toml", "--points", "/dev/zero"]).contains("the most that is read"));
    }
    place.write("p.json", "\u{feff}[[0, 5, 0]]");
    assert_eq!(place.json(&["project", "s.toml", "--points", "p.json"])["points"][0]["depth"].as_f64(), Some(5.0));
}

#[test]
fn mistakes_in_arguments_are_one_sentence() {
    let place = bare();
    let line = place.fails(&["project", "s.toml", "--points", "none.json"]);
    assert_eq!(line, "belvedere: none.json: there is no such file; check the name");
    let line = place.fails(&["render", "s.toml"]);
    assert_eq!(
        line,
        "belvedere: the following required arguments were not provided: --out <OUT.png>; see belvedere render --help"
    );
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--size", "-5x3"]);
    assert!(line.ends_with("such as 1280x720; see belvedere render --help"), "{line}");
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--threads", "100000"]);
    assert!(line.contains("give a whole number in 0..=1024"), "{line}");
    let line = place.fails(&["render", "s.toml", "-o", "x.gif"]);
    assert!(
        line.ends_with("pictures are written as PNG, TIFF, JPEG, WebP, SVG or PDF, not .gif; name the output .png"),
        "{line}"
    );
    place.write("q.json", "[]");
    let line = place.fails(&["rays", "s.toml", "--pixels", "q.json", "--samples", "2", "--far", "-5"]);
    assert!(line.contains("rays end at depth -5"), "{line}");
}

#[test]
fn the_features_of_a_scene_are_displaced_as_points_are() {
    let place = Place::new();
    let line = |id: &str, points: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{id}"}},"geometry":{{"type":"LineString","coordinates":{points}}}}}"#
        )
    };
    let far = line("far", "[[1000,30,2],[1000,100,2],[990,140,7]]");
    place.write("a.geojson", &format!(r#"{{"type":"FeatureCollection","features":[{far}]}}"#));
    let turn = "[[stage]]\nkind = 'curved_rays'\n[[stage.turn]]\nviewpoint = [1010, 0, 0]\nt0 = [1000, 40, 0]\nt1 = [1000, 50, 0]\nt2 = [1000, 60, 0]\nnormal = [0, 1, 0]\n";
    let layer = "[[layer]]\nid = \"way\"\nkind = \"line\"\nsource = \"a.geojson\"\n";
    let camera = "format = 1\n[camera]\neye = [1000, 0, 0]\nlook_at = [1000, 100, 0]\n";
    place.write("s.toml", &format!("{camera}{turn}{layer}"));
    place.ok(&["displace", "s.toml", "-o", "moved.geojson"]);
    let moved: serde_json::Value = serde_json::from_slice(&super::read(&place.path("moved.geojson"))).expect("JSON");
    let feature = &moved["features"][0];
    assert_eq!((&feature["properties"]["name"], &feature["properties"]["layer"]), (&"far".into(), &"way".into()));
    let coordinates = |v: &serde_json::Value| -> Vec<[f64; 3]> { serde_json::from_value(v.clone()).expect("points") };
    let now = coordinates(&feature["geometry"]["coordinates"]);
    let before = coordinates(&feature["properties"]["true_coordinates"]);
    assert!(now.len() > 3 && now.len() == before.len(), "{} points: the bend is in them", now.len());
    place.write("p.json", &serde_json::to_string(&before).expect("JSON"));
    let answer = place.json(&["displace", "s.toml", "--points", "p.json"]);
    for (i, p) in now.iter().enumerate() {
        (0..3).for_each(|k| near(&answer["points"][i]["displaced"][k], p[k]));
    }
    // Standard output holds the same, and readers of features take it.
    let printed: serde_json::Value = serde_json::from_str(&place.ok(&["displace", "s.toml"])).expect("JSON");
    assert_eq!(printed, moved);
    assert!(place.ok(&["info", "moved.geojson"]).contains("lines: 1"));
    assert!(place.fails(&["displace", "s.toml", "-o", "moved.shp"]).contains("GeoJSON"));
    place.write("bare.toml", camera);
    assert!(place.fails(&["displace", "bare.toml"]).contains("no lines, areas or points"));
    place.ok(&["displace", "s.toml", "-o", "moved.gpkg"]);
    assert!(place.ok(&["info", "moved.gpkg"]).contains("lines: 1"));
    assert!(super::read(&place.path("moved.gpkg")).starts_with(b"SQLite format 3"));
}
