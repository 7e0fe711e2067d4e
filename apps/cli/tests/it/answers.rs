//! Every verb that answers in JSON keeps to its schema, and the report file has the shape of standard output.

use super::Place;
use super::schema_check::{Strictness, check};
use super::trusted::hills;
use serde_json::{Value, json};

const SCENE: &str = "format = 1\n[camera]\neye = [6000, -5200, 3600]\nlook_at = [0, 0, 300]\nimage = [32, 24]\n[[layer]]\nkind = 'terrain'\n\
     id = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n[[layer]]\nkind = 'line'\nid = 'way'\nsource = 'builtin:massif?seed=7&size=65'\n\
     must_see = true\n[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n";
const CITY: &str = r#"{"type":"FeatureCollection","features":[
    {"type":"Feature","properties":{"height":9},"geometry":{"type":"Polygon","coordinates":[[[8.0,46.0],[8.0002,46.0],[8.0002,46.0002],[8.0,46.0002],[8.0,46.0]]]}},
    {"type":"Feature","properties":{"height":6},"geometry":{"type":"Polygon","coordinates":[[[8.0004,46.0],[8.0006,46.0],[8.0006,46.0002],[8.0004,46.0002],[8.0004,46.0]]]}}]}"#;

fn place() -> Place {
    let place = Place::new();
    place.write("s.toml", SCENE);
    place.write("dem.asc", &hills());
    let line = "{\"type\":\"LineString\",\"coordinates\":[[8.012,46.014],[8.024,46.028],[8.034,46.036]]}";
    place.write("way.geojson", line);
    place.write("town.geojson", CITY);
    place.write("points.json", "[[0, 0, 300], [6000, -9000, 3600]]");
    place.write("pixels.json", "[[16, 20], [16, 0.5]]");
    std::fs::create_dir_all(place.path("app/pkg")).expect("folder");
    place
}

fn schema(place: &Place, verb: &str) -> Value {
    serde_json::from_str(&place.ok(&["schema", verb])).expect("a schema")
}

/// Runs a verb with `--json` and checks its answer.
fn answer(place: &Place, args: &[&str]) -> Value {
    let text = place.ok(&[args, &["--json", "--quiet"]].concat());
    let value: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?}: {e}: {text}"));
    assert_eq!(check(&schema(place, args[0]), &value, Strictness::NoUnknownKeys), Ok(()), "{args:?}: {text}");
    value
}

const EYE: [&str; 4] = ["--eye", "8.022,46.002,1500", "--look", "8.024,46.03"];

#[test]
fn every_verb_keeps_to_its_schema() {
    let place = place();
    let commands: Vec<Vec<&str>> = vec![
        vec!["render", "s.toml", "-o", "a.png"],
        vec!["animate", "s.toml", "-o", "frames", "--turntable", "--frames", "2"],
        vec!["export", "s.toml", "-o", "a.glb"],
        vec!["project", "s.toml", "--points", "points.json"],
        vec!["displace", "s.toml", "--points", "points.json"],
        vec!["rays", "s.toml", "--pixels", "pixels.json", "--samples", "2", "--far", "9000"],
        vec!["pick", "s.toml", "--pixels", "pixels.json"],
        vec!["measure", "s.toml"],
        vec!["check", "s.toml"],
        vec!["show", "s.toml"],
        vec!["show", "s.toml", "-o", "shown.toml"],
        vec!["info", "dem.asc", "way.geojson", "--adapters"],
        vec!["info", "builtin:massif?seed=7", "town.geojson"],
        vec!["preset", "list"],
        vec!["preset", "check", "map"],
        vec!["preset", "show", "map"],
        vec!["preset", "new", "-o", "mine.toml"],
        vec!["generalise", "town.geojson", "-o", "levels"],
        vec!["trust", "s.toml"],
        vec!["trust", "--list"],
        vec!["trust", "--forget"],
        vec!["completions", "bash", "-o", "belvedere.bash"],
        vec!["man", "man"],
        vec!["reveal", "dem.asc", "way.geojson", "--drafts", "1", "--size", "32x24", "-o", "d.png"],
    ];
    let mut seen: Vec<&str> = commands.iter().map(|args| args[0]).collect();
    for args in commands {
        let found = answer(&place, &args);
        assert!(
            found["verb"] == args[0] || found["verb"].is_null() && ["show", "preset"].contains(&args[0]),
            "{found}"
        );
    }
    // One file of several that cannot be described has its reason in the answer.
    let out = place.run(&["info", "way.geojson", "s.toml", "--json"]);
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    assert_eq!(check(&schema(&place, "info"), &answer, Strictness::NoUnknownKeys), Ok(()));
    assert!(out.status.code() == Some(2) && answer["files"][1]["kind"] == "error", "{answer}");
    // `demo` and `figures` answer as `man` does and take long, the others are tried below and in packed.rs.
    seen.extend(["demo", "figures", "pack", "disocclude"]);
    for verb in belvedere::verbs::schemas::VERBS {
        assert!(seen.contains(&verb), "{verb} is not tried");
    }
}

#[test]
fn a_report_file_has_the_shape_of_standard_output() {
    let place = place();
    let reveal = [&["reveal", "dem.asc", "way.geojson", "--size", "32x24"][..], &EYE].concat();
    let technique =
        |name| [&reveal[..], &["--technique", name, "-o", "a.png", "--report", "f.json", "--overwrite"]].concat();
    let commands = [
        technique("spline"),
        technique("terrain"),
        technique("curved_rays"),
        vec![
            "reveal",
            "town.geojson",
            "--see",
            "16.0,0.0,1.0",
            "--size",
            "32x24",
            "-o",
            "see.png",
            "--report",
            "f.json",
            "--overwrite",
        ],
        [&["disocclude", "dem.asc", "way.geojson", "-o", "d.tif", "--report", "f.json", "--overwrite"][..], &EYE]
            .concat(),
        vec!["measure", "s.toml", "-o", "f.json", "--overwrite"],
        vec!["project", "s.toml", "--points", "points.json", "-o", "f.json", "--overwrite"],
    ];
    for args in commands {
        let printed = answer(&place, &args);
        let file: Value = serde_json::from_slice(&super::read(&place.path("f.json"))).expect("JSON");
        assert_eq!(check(&schema(&place, args[0]), &file, Strictness::NoUnknownKeys), Ok(()), "{args:?}");
        assert_eq!(file, printed, "{args:?}");
        assert!(printed["outputs"].as_array().is_some_and(|names| names.contains(&json!("f.json"))), "{args:?}");
        if args[0] != "project" {
            for key in ["visible_straight", "visible_bent", "in_frame_straight", "in_frame_bent"] {
                let share = printed[key].as_f64().unwrap_or_else(|| panic!("{args:?}: {key}: {printed}"));
                assert!((0.0..=1.0).contains(&share), "{args:?}: {key} {share}");
            }
        }
    }
}

#[test]
fn an_answer_that_breaks_its_schema_is_noticed() {
    let place = place();
    let schema = schema(&place, "project");
    let good = answer(&place, &["project", "s.toml", "--points", "points.json"]);
    let refused = |change: fn(&mut Value)| {
        let mut bad = good.clone();
        change(&mut bad);
        check(&schema, &bad, Strictness::NoUnknownKeys).expect_err("a bad answer")
    };
    assert!(refused(|a| a["more"] = json!(1)).contains("more"));
    assert!(refused(|a| a["verb"] = json!("rays")).contains("verb"));
    assert!(refused(|a| a["points"][0]["depth"] = json!("far")).contains("depth"));
    assert!(refused(|a| drop(a["points"][0].as_object_mut().map(|p| p.remove("inside")))).contains("inside"));
    assert!(refused(|a| a["points"][0]["pixel"] = json!([1.0])).contains("pixel"));
    let mut more = good.clone();
    more["more"] = json!(1);
    assert_eq!(check(&schema, &more, Strictness::AsWritten), Ok(()), "later versions may add keys");
}

#[test]
fn scenes_points_and_routes_come_from_standard_input() {
    let place = place();
    let with = |args: &[&str], input: &str| place.piped(args, input.as_bytes());
    let plain = place.ok(&["project", "s.toml", "--points", "points.json"]);
    assert_eq!(with(&["project", "-", "--points", "points.json"], SCENE).0, plain);
    assert_eq!(with(&["project", "s.toml", "--points", "-"], "[[0, 0, 300], [6000, -9000, 3600]]").0, plain);
    let way = String::from_utf8(super::read(&place.path("way.geojson"))).expect("text");
    let gpx = "<?xml version=\"1.0\"?><gpx version=\"1.1\"><trk><trkseg><trkpt lat=\"46.014\" lon=\"8.012\"/><trkpt lat=\"46.028\" lon=\"8.024\"/>\
               <trkpt lat=\"46.036\" lon=\"8.034\"/></trkseg></trk></gpx>";
    let reveal = |data: &'static str, out: &'static str| {
        [&["reveal", "dem.asc", data, "--size", "32x24", "-o", out, "--json"][..], &EYE].concat()
    };
    let shares = |text: &str| {
        let found: Value = serde_json::from_str(text).expect("JSON");
        ["visible_straight", "visible_bent"].map(|key| found[key].as_f64().expect("a share"))
    };
    let expected = shares(&place.ok(&reveal("way.geojson", "a.png")));
    assert_eq!(shares(&with(&reveal("-", "b.png"), &way).0), expected);
    assert_eq!(shares(&with(&reveal("-", "c.png"), gpx).0), expected);
    for (args, input, expected) in [
        (&["project", "-", "--points", "-"][..], SCENE, "only one input can be standard input"),
        (&["check", "-"], "", "standard input is empty"),
        (&["check", "-"], "format = 1\nlayers = 1\n", "-:2"),
        (&["info", "-"], "<html></html>", "standard input is no GPX"),
        (&["reveal", "dem.asc", "-", "-o", "d.png", "--scene", "d.toml"], &way, "standard input has no name"),
    ] {
        let (_, said, code) = with(args, input);
        assert!(code == Some(2) && said.contains(expected) && said.lines().count() == 1, "{args:?}: {said}");
    }
    assert!(!place.path("-").exists());
}
