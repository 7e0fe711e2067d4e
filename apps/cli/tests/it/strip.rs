//! Stage `strip` as a user meets it: drawn, shown, and refused with its line.

use super::{BARE, Place};

/// A road through a small massif, and the stage with more keys.
fn scene(keys: &str) -> String {
    format!(
        "format = 1\ncrs = \"local\"\n\
         [camera]\neye = [-6500.0, -7000.0, 4200.0]\nlook_at = [-3000.0, -3000.0, 1200.0]\nimage = [160, 90]\n\
         [[layer]]\nkind = \"terrain\"\nid = \"ground\"\nsource = \"builtin:massif?seed=7&size=65\"\n\
         [[layer]]\nkind = \"line\"\nid = \"road\"\nsource = \"builtin:massif?seed=7&size=65\"\n\
         [[stage]]\nkind = \"strip\"\n{keys}\n"
    )
}

#[test]
fn a_strip_is_drawn_and_its_record_says_how_far() {
    let place = Place::new();
    place.write("s.toml", &scene("along = 'road'\nhalf_width_m = 1200"));
    place.ok(&["render", "s.toml", "-o", "a.png"]);
    let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("a.png.json"))).expect("JSON");
    assert_eq!(record["stages"], serde_json::json!(["strip"]));
    let number = |v: &serde_json::Value| v.as_f64().unwrap_or_else(|| panic!("{v} is no number"));
    let strip = &record["strip"];
    assert_eq!(number(&strip["half_width_m"]), 1200.0);
    assert!(number(&strip["least_radius_m"]) >= 1200.0 / 0.8 - 1e-6 && number(&strip["smoothing_m"]) > 0.0, "{strip}");
    assert!(number(&strip["smoothed_off_m"]) > 0.0 && number(&strip["length_m"]) > 10_000.0, "{strip}");
    assert!(number(&record["displacement"]["max_m"]) > 500.0, "{}", record["displacement"]);
    assert!(record["note"].as_str().is_some_and(|n| n.starts_with("bent view (strip)")), "{}", record["note"]);
    // What the strip leaves away is not in the picture: less ground than in the straight one.
    place.ok(&["render", "s.toml", "-o", "b.png", "--straight"]);
    let straight: serde_json::Value = serde_json::from_slice(&super::read(&place.path("b.png.json"))).expect("JSON");
    assert!(straight["strip"].is_null() && straight["stages"] == serde_json::json!([]));
}

#[test]
fn what_is_resolved_opens_to_the_same_view() {
    for keys in
        ["along = 'road'\nhalf_width_m = 1100", "along = 'road'\nshare = 0.4\nhalf_width_m = 900\nsmoothing_m = 1500"]
    {
        let place = Place::new();
        place.write("s.toml", &scene(keys));
        place.write("p.json", "[[-3000, -3500, 1000], [-2500, -3000, 900], [0, 0, 1000], [-4000, -4500, 1500]]");
        place.ok(&["show", "s.toml", "-o", "shown.toml"]);
        let project = |scene: &str| place.ok(&["project", scene, "--points", "p.json"]);
        assert_eq!(project("s.toml"), project("shown.toml"), "{keys}");
        assert_eq!(place.ok(&["show", "shown.toml"]), place.ok(&["show", "s.toml"]), "{keys}");
    }
}

#[test]
fn displaced_points_keep_their_distance_from_a_stated_path() {
    let place = Place::new();
    let keys =
        "kind = 'strip'\nhalf_width_m = 300\nanchor = [0, 0]\npath = [[0, 0], [0, 2000], [1500, 3500], [1500, 6000]]";
    place.write("s.toml", &format!("{BARE}[[stage]]\n{keys}\n"));
    place.write("p.json", "[[0, 0, 5], [1600, 5900, 7], [9000, 0, 0]]");
    let moved = place.json(&["displace", "s.toml", "--points", "p.json"]);
    let text = moved.to_string();
    // The end of the road lies straight ahead, its side is kept, and what is far from it has no image.
    let points: Vec<Vec<f64>> =
        moved["points"].as_array().unwrap_or_else(|| panic!("{text}")).iter().map(numbers).collect();
    assert!(points[0][0].abs() < 1.0 && points[0][1].abs() < 1.0, "{text}");
    assert!((points[1][0] - 100.0).abs() < 30.0 && (points[1][1] - 6500.0).abs() < 200.0, "{text}");
    assert!(points[1][2] == 7.0 && points[2].is_empty(), "{text}");
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    let list = value["displaced"].as_array();
    list.map(|list| list.iter().filter_map(serde_json::Value::as_f64).collect()).unwrap_or_default()
}

/// `scene` fails, and says `expected` on this line.
fn refuses(scene: &str, expected: &str) {
    let place = Place::new();
    place.write("s.toml", scene);
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.strip_prefix("belvedere: s.toml:").is_some_and(|l| l.contains(expected)), "{line}\n{expected}");
}

#[test]
fn strips_that_cannot_be_say_why() {
    let bare = |keys: &str| format!("{BARE}[[stage]]\nkind = 'strip'\n{keys}\n");
    refuses(&bare("half_width_m = 10"), "a strip needs along or path, neither is given; give exactly one");
    refuses(&bare("along = 'a'\npath = [[0, 0], [9, 9]]"), "a strip needs along or path, both are given");
    refuses(&bare("path = [[5, 5]]"), "7: the route has 1 points and is 0 long");
    refuses(
        &bare("path = [[0, 0], [900, 0]]\nhalf_width_m = 0"),
        "8: half_width_m is 0, it must be in 0.000001..=1000000000",
    );
    refuses(&bare("path = [[0, 0], [900, 0]]\nshare = 2"), "8: share is 2, it must be in 0..=1");
    let hairpin = "path = [[0, 0], [3000, 0], [3300, 200], [3000, 400], [0, 400]]\nsmoothing_m = 60";
    refuses(&bare(&format!("{hairpin}\nhalf_width_m = 300")), "the widest that works is");
    refuses(
        &bare("path = [[0, 0], [3000, 0], [3000, 3000], [0, 3000], [0, 10]]"),
        "the route winds back to where it was",
    );
    refuses(&scene("along = 'raod'"), "17: a strip along \"raod\": there is no such layer (did you mean \"road\"?)");
    refuses(
        &scene("along = 'ground'"),
        "17: a strip along \"ground\": the layer is no line; name a layer of kind line",
    );
    refuses(&scene("along = 'road'\nwidth_m = 3"), "unknown key \"width_m\"");
}
