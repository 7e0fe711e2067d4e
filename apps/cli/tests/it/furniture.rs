//! Furniture of pictures, contours and edges, as the command line reaches them.

use super::Place;
use super::light_and_tints::pixels;
use serde_json::Value;

/// A mountain on the map with ways in classes, from a file that names OpenStreetMap.
fn place(more: &str) -> Place {
    let place = Place::new();
    let way = |id: u32, kind: &str, y: i32| {
        format!(
            r#"{{"type":"Feature","properties":{{"@id": "way/{id}","kind":"{kind}"}},
            "geometry":{{"type":"LineString","coordinates":[[-3000,{y}],[3000,{y}]]}}}}"#
        )
    };
    let ways = [way(1, "track", -1500), way(2, "path", 0), way(3, "track", 1500)].join(",");
    let crs = r#""crs":{"type":"name","properties":{"name":"local"}}"#;
    place.write("ways.geojson", &format!(r#"{{"type":"FeatureCollection",{crs},"features":[{ways}]}}"#));
    place.write("s.toml", &scene(more));
    place
}

fn scene(more: &str) -> String {
    format!(
        "format = 1
title = 'Round the massif'
crs = 'local'
{more}
[camera]
eye = [0, -9000, 6000]
look_at = [0, 0, 800]
image = [640, 400]
[[layer]]
id = 'ground'
kind = 'terrain'
source = 'builtin:massif?size=129'
style = {{ palette = 'clear' }}
[[layer]]
id = 'ways'
kind = 'line'
source = 'ways.geojson'
must_see = true
style = {{ hidden = 'show', labels = true, color_by = {{ property = 'kind' }} }}
"
    )
}

fn record(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&super::read(&place.path(name))).expect("a record")
}

#[test]
fn furniture_is_a_table_of_the_scene_and_an_option_and_the_record_says_what_there_is() {
    let place = place("");
    let draw = |more: &[&str]| {
        place.ok(&[&["render", "s.toml", "-o", "p.png", "--samples", "1", "--overwrite"], more].concat());
        pixels(&super::read(&place.path("p.png")))
    };
    let bare = draw(&[]);
    let said = record(&place, "p.png.json");
    assert_eq!(said["attribution"][0], "© OpenStreetMap contributors", "also where the picture does not say so");
    assert!(said.get("furniture").is_none(), "{said}");
    let all = draw(&["--furniture", "all"]);
    assert!(bare != all);
    let found = record(&place, "p.png.json")["furniture"].clone();
    assert_eq!(found["title"], "Round the massif");
    assert_eq!(found["attribution"], "© OpenStreetMap contributors");
    assert_eq!(found["legend"], 4, "heights, the property and its two classes: {found}");
    assert!(found["source"].as_str().is_some_and(|text| text.contains("ways.geojson")), "{found}");
    assert!(found["compass"]["on_ground"].as_bool().is_some() && found["scale"].is_array(), "{found}");
    let titled = draw(&["--title", "Elsewhere"]);
    assert!(titled != bare && titled != draw(&["--furniture", "title"]));
    assert_eq!(bare, draw(&["--furniture", "none"]));
    place.write("s.toml", &scene("[furniture]\ntitle = 'Elsewhere'"));
    assert_eq!(titled, draw(&[]));
    assert_eq!(bare, draw(&["--furniture", "none"]), "an option stands before the scene");
}

#[test]
fn vectors_hold_the_words_of_the_furniture() {
    let table = "[furniture]\ntitle = true\nlegend = true\nattribution = true\nscale = true\ncompass = 'corner'\ndate = 'May 2026'\nnames = { ways = 'Ways' }";
    let place = place(table);
    place.ok(&["render", "s.toml", "-o", "p.svg"]);
    let svg = String::from_utf8(super::read(&place.path("p.svg"))).expect("text");
    for text in
        ["Round the massif", "Ways: kind", ">track<", ">path<", "© OpenStreetMap contributors", "May 2026", ">N<"]
    {
        assert!(svg.contains(text), "{text}");
    }
    for group in ["title", "map-legend", "attribution", "compass", "scale"] {
        assert!(svg.contains(&format!("id=\"{group}\"")), "{group}");
    }
    place.ok(&["render", "s.toml", "-o", "p.pdf"]);
    assert!(super::read(&place.path("p.pdf")).starts_with(b"%PDF"));
}

#[test]
fn wrong_furniture_is_told_in_one_line() {
    let place = place("[furniture]\nnames = { way = 'Ways' }");
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("\"way\"") && line.contains("ways") && line.contains("s.toml:"), "{line}");
    for (table, named) in [
        ("legend_at = 'middle'", "middle"),
        ("scale = []", "scale"),
        ("compass = 'sky'", "compass"),
        ("titel = 'x'", "title"),
    ] {
        place.write("s.toml", &scene(&format!("[furniture]\n{table}")));
        let line = place.fails(&["check", "s.toml"]);
        assert!(line.contains(named), "{line}");
    }
    place.write("s.toml", &scene(""));
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--furniture", "legend,crown"]);
    assert!(line.contains("crown") && line.contains("attribution"), "{line}");
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--edge", "sharp"]);
    assert!(line.contains("sharp") && line.contains("block"), "{line}");
}

#[test]
fn contours_and_edges_are_keys_and_options() {
    let place = place("");
    let draw = |more: &[&str]| {
        place.ok(&[&["render", "s.toml", "-o", "p.png", "--samples", "1", "--overwrite"], more].concat());
        pixels(&super::read(&place.path("p.png")))
    };
    let with = |style: &str| {
        let text = scene("").replace("palette = 'clear'", &format!("palette = 'clear', {style}"));
        place.write("s.toml", &text);
        let found = draw(&[]);
        place.write("s.toml", &scene(""));
        found
    };
    let bare = draw(&[]);
    for (option, style) in [
        ("--contours", "contours = true"),
        ("--contours=100", "contours = 100"),
        ("--edge=soft", "edge = 'soft'"),
        ("--edge=mat", "edge = 'mat'"),
        ("--edge=block", "edge = 'block'"),
    ] {
        let found = draw(&[option]);
        assert!(found != bare, "{option} changes nothing");
        assert_eq!(found, with(style), "{option}");
    }
    assert!(draw(&["--contours=100"]) != draw(&["--contours=200"]));
    assert_eq!(bare, with("edge = 'plain', contours = false"));
    place.write("s.toml", &scene("").replace("palette = 'clear'", "contours = -5"));
    assert!(place.fails(&["check", "s.toml"]).contains("contours"));
}
