//! Light, looks and voids of `reveal`, as pictures, as scene files, and as the guide writes them.

use super::light_and_tints::pixels;
use super::{Place, read};
use serde_json::Value;

/// Nodes along a side of the ground.
const SIDE: usize = 20;

/// Coarse ground of ranges `rise` m high with a hole where `hole` says so, and a short way over it.
pub(super) fn land(rise: f64, hole: impl Fn(usize, usize) -> bool) -> Place {
    let place = Place::new();
    place.write("dem.asc", &heights(rise, hole));
    place.write("way.geojson", "{\"type\":\"LineString\",\"coordinates\":[[8.028,46.025],[8.032,46.035]]}");
    place
}

fn heights(rise: f64, hole: impl Fn(usize, usize) -> bool) -> String {
    let mut text =
        format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 8.0\nyllcorner 46.0\ncellsize 0.0032\nNODATA_value -9999\n");
    for row in 0..SIDE {
        for col in 0..SIDE {
            let height = 1000.0 + rise * (1.12 * row as f64).sin() + 40.0 * (0.64 * col as f64).sin();
            text += &if hole(row, col) { "-9999 ".to_owned() } else { format!("{height:.1} ") };
        }
        text += "\n";
    }
    text
}

const ARGS: [&str; 9] =
    ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "96x54", "--overwrite", "--json"];
const VIEW: [&str; 4] = ["--eye", "8.03,46.006,1900", "--look", "8.03,46.035"];

/// The result of `reveal` with more arguments, the pixels of its picture, and its scene file.
fn revealed(place: &Place, more: &[&str]) -> (Value, Vec<u8>, String) {
    let result = place.json(&[&ARGS[..], &VIEW, &["--scene", "out.toml"], more].concat());
    let scene = String::from_utf8(read(&place.path("out.toml"))).expect("UTF-8");
    (result, pixels(&read(&place.path("out.png"))), scene)
}

fn record(place: &Place) -> Value {
    serde_json::from_slice(&read(&place.path("out.png.json"))).expect("JSON")
}

#[test]
fn every_look_changes_the_picture_and_its_scene_file_draws_the_same() {
    let place = land(0.0, |_, _| false);
    let (_, usual, _) = revealed(&place, &[]);
    for (args, keys) in [
        (
            &["--light-time", "2026-07-01T07:30+02:00"][..],
            &["time = \"2026-07-01T07:30+02:00\"", "relief = \"sun\""][..],
        ),
        (&["--light-time", "2026-07-01T07:30+02:00", "--relief", "swiss"], &["shadows = true", "relief = \"swiss\""]),
        (&["--light", "250,12", "--shadows"], &["azimuth_deg = 250.0", "altitude_deg = 12.0", "shadows = true"]),
        (&["--relief", "none"], &["relief = \"none\""]),
        (&["--hidden", "show"], &["hidden = \"show\""]),
        (&["--stylise"], &["edges = 0.7", "unsharp = 4.0"]),
        (&["--stylise=1"], &["edges = 1.0"]),
        (&["--exaggeration", "1.6"], &["kind = \"relief\"", "exaggeration = [1.6, 1.6]"]),
        (&["--no-mark"], &["mark = false"]),
    ] {
        let (_, picture, scene) = revealed(&place, args);
        assert!(keys.iter().all(|key| scene.contains(key)), "{args:?}: {scene}");
        // Nothing is bent or hidden here.
        assert_eq!(picture == usual, ["--no-mark", "--hidden"].contains(&args[0]), "{args:?}");
        place.ok(&["render", "out.toml", "-o", "again.png", "--overwrite"]);
        assert!(pixels(&read(&place.path("again.png"))) == picture, "{args:?}: another picture from the scene file");
    }
}

#[test]
fn the_looks_hold_for_ground_that_makes_way_and_for_curved_rays() {
    let place = land(250.0, |_, _| false);
    for technique in ["spline", "terrain", "curved_rays"] {
        let more =
            ["--technique", technique, "--exaggeration", "1.2", "--light-time", "2026-07-01T08:00Z", "--stylise"];
        let (result, _, scene) = revealed(&place, &[&["--no-mark", "--hidden", "show"][..], &more].concat());
        assert_eq!(result["technique"], technique);
        for key in [
            "exaggeration = [1.2, 1.2]",
            "time = \"2026",
            "relief = \"sun\"",
            "edges = 0.7",
            "mark = false",
            "hidden = \"show\"",
        ] {
            assert!(scene.contains(key), "{technique}: {key}: {scene}");
        }
        place.ok(&["render", "out.toml", "-o", "again.png", "--overwrite"]);
        let [a, b] = ["out.png", "again.png"].map(|name| pixels(&read(&place.path(name))));
        assert!(a == b, "{technique}: another picture from the scene file");
    }
}

#[test]
fn without_a_mark_the_record_still_says_that_the_view_is_bent() {
    let place = land(250.0, |_, _| false);
    let large = ["--size", "480x270"];
    let args: Vec<&str> = ARGS.into_iter().filter(|a| !["--size", "96x54"].contains(a)).collect();
    let bent = |more: &[&str]| {
        place.json(&[&args[..], &large, &VIEW, more].concat());
        let record = record(&place);
        let said = record["note"].as_str().is_some_and(|note| note.starts_with("bent view"));
        (record["overlay"]["mark"].as_bool(), said, pixels(&read(&place.path("out.png"))))
    };
    let (with, without) = (bent(&[]), bent(&["--no-mark"]));
    assert_eq!((with.0, with.1), (Some(true), true));
    assert_eq!((without.0, without.1), (Some(false), true));
    assert!(with.2 != without.2);
}

#[test]
fn night_is_said_with_the_nearest_day_and_drawn_as_a_relief() {
    let place = land(0.0, |_, _| false);
    let (result, picture, scene) = revealed(&place, &["--light-time", "2026-07-02T01:30:00Z"]);
    let warning =
        result["warnings"].as_array().expect("a list").iter().find(|w| w["subject"] == "light").expect("said");
    let text = warning["text"].as_str().expect("text");
    assert!(text.contains("below the horizon") && text.contains("all ground lies in shadow"), "{text}");
    // Sunrise at 8 E, 46 N is at 3:40 UTC; half an hour later the sun stands 5 degrees high.
    assert!(text.contains("at 2026-07-02T04:") && text.contains("5 degrees high"), "{text}");
    assert!(warning["figures"]["altitude_deg"].as_f64().is_some_and(|deg| deg < -10.0), "{warning}");
    assert!(scene.contains("relief = \"swiss\""), "{scene}");
    let (_, dark, _) = revealed(&place, &["--light-time", "2026-07-02T01:30:00Z", "--relief", "sun"]);
    assert!(picture != dark);
    // The polar night has no day nearby.
    place.write("dem.asc", &heights(0.0, |_, _| false).replace("yllcorner 46.0", "yllcorner 78.0"));
    let way = String::from_utf8(read(&place.path("way.geojson"))).expect("UTF-8").replace(",46.", ",78.");
    place.write("way.geojson", &way);
    let view = ["--eye", "8.03,78.006,1900", "--look", "8.03,78.035", "--light-time", "2026-12-21T12:00:00Z"];
    let result = place.json(&[&ARGS[..], &view].concat());
    assert!(result["warnings"].to_string().contains("does not rise 5 degrees high within a day"), "{result}");
}

#[test]
fn exaggerated_ground_is_judged_as_it_is_drawn() {
    let place = land(250.0, |_, _| false);
    let shares = |more: &[&str]| {
        let result = place.json(&[&ARGS[..], &VIEW, &["--scene", "out.toml"], more].concat());
        let measured = place.json(&["measure", "out.toml", "--json"]);
        assert_eq!(result["visible_bent"], measured["visible"], "{more:?}");
        ["visible_straight", "visible_bent"].map(|key| result[key].as_f64().expect("a share"))
    };
    let (true_heights, flat) = (shares(&[]), shares(&["--exaggeration", "0.05"]));
    assert_eq!(true_heights[0], flat[0], "the straight picture keeps the true heights");
    assert!(true_heights[0] < 0.9 && flat[1] > 0.99, "{true_heights:?}, {flat:?}");
    let said = place.ok(&[&ARGS[..8], &VIEW, &["--exaggeration", "0.05"]].concat());
    assert!(said.contains("with exaggerated heights: ") && said.contains("so nothing is bent"), "{said}");
}

#[test]
fn all_holes_are_filled_on_request() {
    let place = land(0.0, |row, col| (14..19).contains(&row) && (14..19).contains(&col));
    let filled = |more: &[&str]| {
        revealed(&place, more);
        record(&place)["terrain"]["filled_nodes"].as_u64().expect("a count")
    };
    assert_eq!(filled(&[]), 0, "the hole is larger than 3 % of the ground");
    assert!(filled(&["--fill-voids"]) >= 25);
}

#[test]
fn what_cannot_be_is_refused_in_one_line_that_names_the_option() {
    let place = land(0.0, |_, _| false);
    place.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    let terrain = |more: &[&str]| place.fails(&[&ARGS[..], more].concat());
    let model = |more: &[&str]| place.fails(&[&["reveal", "cube.obj", "--see", "cube", "-o", "m.png"], more].concat());
    let massif = ["reveal", "builtin:massif", "builtin:massif", "-o", "m.png", "--light-time", "2026-07-01T08:00Z"];
    for (line, words) in [
        (terrain(&["--light-time", "2026-07-01"]), "\"2026-07-01\" is not a time"),
        (terrain(&["--light", "20,0"]), "altitude above 0"),
        (terrain(&["--light", "20,30", "--light-time", "2026-07-01T08:00Z"]), "cannot be used with"),
        (terrain(&["--exaggeration", "0"]), "0.01..=100"),
        (terrain(&["--stylise=2"]), "edges is 2, it must be in 0..=1"),
        (terrain(&["--fill-voids", "--keep-voids"]), "cannot be used with"),
        (place.fails(&massif), "--light-time: the position of the sun at a time needs a georeferenced scene"),
        (model(&["--light-time", "2026-07-01T08:00Z"]), "--light-time: the position of the sun"),
        (model(&["--exaggeration", "2", "--no-sea"]), "--exaggeration, --no-sea are for terrain with features"),
        (model(&["--relief", "sun"]), "--relief is for terrain with features, not for models and cities; leave it out"),
    ] {
        assert!(line.contains(words), "{line}");
    }
    let drawn = ["--stylise", "--light", "90,30", "--no-mark", "--size", "64x48", "--scene", "m.toml"];
    place.ok(&[&["reveal", "cube.obj", "--see", "cube", "-o", "m.png"][..], &drawn].concat());
    let scene = String::from_utf8(read(&place.path("m.toml"))).expect("UTF-8");
    assert!(["azimuth_deg = 90.0", "edges = 0.7", "mark = false"].iter().all(|key| scene.contains(key)), "{scene}");
}

#[test]
fn the_commands_of_the_guide_run() {
    let place = land(0.0, |row, col| row == 4 && col == 4);
    std::fs::create_dir(place.path("tiles")).expect("folder");
    place.write("tiles/west.asc", &heights(0.0, |_, _| false));
    place.write("tiles/east.asc", &heights(0.0, |_, _| false).replace("xllcorner 8.0", "xllcorner 8.064"));
    place.ok(&["reveal", "dem.asc", "way.geojson", "-o", "map.png", "--size", "64x64", "-q"]);
    place.write("map.pgw", "0.001\n0\n0\n-0.001\n8.0\n46.064\n");
    let page = belvedere_testkit::workspace_root().join("docs/guide/reveal.md");
    let page = String::from_utf8(read(&page)).expect("UTF-8");
    let commands = page.lines().filter(|line| line.starts_with("belvedere "));
    let mut options = String::new();
    let mut count = 0;
    for command in commands {
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        let said = place.run(&[&words[..], &["--size", "64x48"]].concat());
        let errors = String::from_utf8_lossy(&said.stderr);
        assert_eq!(said.status.code(), Some(0), "{command}: {errors}");
        assert_eq!(errors.contains("as lat,lon it lies on it"), command.contains("46.006,8.03"), "{command}: {errors}");
        options += command;
        count += 1;
    }
    assert!(count >= 10, "{count} commands");
    for option in ["--drape", "--labels", "--fill-voids", "--exaggeration", "--light-time", "--stylise", "--no-mark"] {
        assert!(options.contains(option), "no command of the guide shows {option}");
    }
}
