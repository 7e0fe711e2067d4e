//! Stage `tube` and the option that straightens data as a user meets them.

use super::{Place, read};
use serde_json::Value;

/// The built-in tube with a stage of these keys.
fn scene(keys: &str) -> String {
    format!(
        "format = 1\ncrs = \"local\"\nunit = \"voxel\"\n\
         [camera]\neye = [200.0, -160.0, 150.0]\nlook_at = [60.0, 60.0, 55.0]\nimage = [120, 80]\n\
         [[layer]]\nkind = \"volume\"\nid = \"tube\"\nsource = \"builtin:tube\"\n\
         [[stage]]\nkind = \"tube\"\n{keys}\n"
    )
}

const TRACED: &str =
    "centreline = { volume = 'tube', from = [97.0, 63.0, 25.0], to = [97.0, 56.0, 86.0], values = [12, 70] }";

fn record(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&read(&place.path(name))).expect("JSON")
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

#[test]
fn a_tube_is_drawn_and_its_record_says_how_true_it_is() {
    let place = Place::new();
    place.write("s.toml", &scene(TRACED));
    place.ok(&["render", "s.toml", "-o", "a.png"]);
    let said = record(&place, "a.png.json");
    assert_eq!(said["stages"], serde_json::json!(["tube"]));
    let tube = &said["tube"];
    let [line, length] = ["line_m", "length_m"].map(|key| number(&tube[key]));
    assert!((length / line - 1.0).abs() < 0.01, "the line is {line} long, straightened {length}");
    let clearance = number(&tube["centreline"]["median_clearance"]);
    assert!((number(&tube["radius_m"]) - 4.0 * clearance).abs() < 1e-9, "{tube}");
    assert!(number(&tube["smoothed_off_m"]) < 0.5 * clearance, "{tube}");
    let ends: Vec<Vec<f64>> = serde_json::from_value(tube["ends"].clone()).expect("two points");
    let apart = ends[0].iter().zip(&ends[1]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    assert!((apart - length).abs() < 1e-6, "the ends of a straight line of {length} are {apart} apart");
    assert!(said["note"].as_str().is_some_and(|n| n.starts_with("bent view (tube)")), "{}", said["note"]);
    place.ok(&["render", "s.toml", "-o", "b.png", "--straight"]);
    assert!(record(&place, "b.png.json")["tube"].is_null());
}

#[test]
fn what_is_resolved_opens_to_the_same_view() {
    let points = "points = [[0, 0, 0], [0, 40, 10], [30, 60, 20], [60, 60, 60]]";
    for keys in [TRACED.to_owned(), format!("{points}\nradius_m = 20\nshare = 0.5\nsmoothing_m = 4")] {
        let place = Place::new();
        place.write("s.toml", &scene(&keys));
        place.write("p.json", "[[97, 62, 26], [5, 20, 8], [0, 0, 1000], [31, 60, 20]]");
        place.ok(&["show", "s.toml", "-o", "shown.toml"]);
        let project = |scene: &str| place.ok(&["project", scene, "--points", "p.json"]);
        assert_eq!(project("s.toml"), project("shown.toml"), "{keys}");
        assert_eq!(place.ok(&["show", "shown.toml"]), place.ok(&["show", "s.toml"]), "{keys}");
    }
}

#[test]
fn data_are_straightened_along_two_points_or_a_file_and_cut_open() {
    let place = Place::new();
    place.write("v.toml", scene(TRACED).split("[[stage]]").next().expect("a part"));
    let between = "97,63,25:97,56,86";
    place.ok(&["render", "v.toml", "--straighten", between, "--size", "160x40", "-o", "x.png"]);
    assert!(number(&record(&place, "x.png.json")["tube"]["centreline"]["length"]) > 100.0);
    place.write("line.csv", "x,y,z\n97,63,25\n60,97,30\n22,60,38\n60,23,46\n97,60,54\n");
    place.ok(&["render", "v.toml", "--straighten", "line.csv", "--radius", "16", "-o", "cut.png"]);
    let said = record(&place, "cut.png.json");
    let camera = &said["scene"]["camera"];
    assert_eq!((camera["projection"].as_str(), number(&said["tube"]["radius_m"])), (Some("orthographic"), 16.0));
    // As wide as it is long: the picture takes the shape of the tube.
    let image: [f64; 2] = serde_json::from_value(camera["image"].clone()).expect("a size");
    let beyond = if said["tube"]["whole"] == true { 32.0 } else { 0.0 };
    let shape = (number(&said["tube"]["length_m"]) + beyond) / 32.0;
    assert!((image[0] / image[1] / shape - 1.0).abs() < 0.02, "{image:?} for {shape}");
    assert_eq!(said["scene"]["layer"][0]["transfer"], "slice");
    for more in [&["--uncut"][..], &["--side", "90"]] {
        place.ok(&[
            &["render", "v.toml", "--straighten", "line.csv", "--radius", "16", "-o", "o.png", "--overwrite"],
            more,
        ]
        .concat());
        assert_ne!(read(&place.path("o.png")), read(&place.path("cut.png")), "{more:?}");
    }
}

#[test]
fn what_cannot_be_straightened_is_said() {
    let place = Place::new();
    for (keys, said) in [
        ("radius_m = 3", "a tube needs path, points or centreline, 0 are given"),
        ("path = 'nowhere.csv'", "nowhere.csv"),
        ("points = [[0, 0, 0], [0, 0, 0]]", "at least 2 points apart"),
        ("points = [[0, 0, 0], [0, 0, 9]]\nradius_m = 0", "radius_m is 0"),
        ("points = [[0, 0, 0], [0, 0, 9]]\nshare = 2", "share is 2"),
    ] {
        place.write("s.toml", &scene(keys));
        let refused = place.fails(&["render", "s.toml", "-o", "x.png"]);
        assert!(refused.contains(said) && refused.contains("s.toml:"), "{keys}: {refused}");
    }
    place.write("s.toml", &scene(TRACED));
    let two = place.fails(&["render", "s.toml", "--straighten", "0,0,0:1,1,1", "-o", "x.png"]);
    assert!(two.contains("--straighten"), "{two}");
    place.write("m.toml", "format = 1\n[camera]\neye = [0, 0, 9]\nlook_at = [0, 9, 0]\n");
    let none = place.fails(&["render", "m.toml", "--straighten", "0,0,0:1,1,1", "-o", "x.png"]);
    assert!(none.contains("one volume, and there are 0"), "{none}");
}
