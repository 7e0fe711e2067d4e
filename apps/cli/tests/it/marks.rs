//! What is drawn over pictures: marks, grids, names, heat, ghosts; and pictures of the camera.

use super::Place;

const SCENE: &str = "format = 1
title = 'Test'
crs = 'local'
[[layer]]
id = 'ground'
kind = 'terrain'
source = 'builtin:massif?size=129'
[[layer]]
id = 'trail'
kind = 'line'
source = 'builtin:massif?size=129'
style = { distance_markers_m = 'auto' }
[camera]
eye = [7971.7, -7336.9, 3780.0]
look_at = [-952.3, 1587.0, 2400.0]
fov_y_deg = 51
image = [320, 180]
[[stage]]
kind = 'curved_rays'
[[stage.turn]]
viewpoint = [7971.7, -7336.9, 9380.0]
t0 = [4738.3, -4103.5, 3280.0]
t1 = [2840.4, -2205.6, 2986.5]
t2 = [239.6, 395.1, 2584.3]
normal = [-0.7029, 0.7029, -0.1087]
";

fn record(place: &Place, picture: &str) -> serde_json::Value {
    serde_json::from_slice(&super::read(&place.path(&format!("{picture}.json")))).expect("JSON")
}

/// The record of a picture drawn with these arguments, and its pixels, compressed.
fn drawn(place: &Place, name: &str, args: &[&str]) -> (serde_json::Value, Vec<u8>) {
    place.ok(&[&["render", "s.toml", "-o", name][..], args].concat());
    (record(place, name), super::light_and_tints::pixels(&super::read(&place.path(name))))
}

fn height(png: &[u8]) -> u32 {
    u32::from_be_bytes([png[20], png[21], png[22], png[23]])
}

#[test]
fn bent_pictures_say_so_unless_told_not_to() {
    let place = Place::new();
    place.write("s.toml", SCENE);
    let (marked, with) = drawn(&place, "a.png", &[]);
    let (bare, without) = drawn(&place, "b.png", &["--no-mark"]);
    assert_eq!((&marked["overlay"]["mark"], &bare["overlay"]["mark"]), (&true.into(), &false.into()));
    assert_ne!(with, without);
    let said = marked["overlay"]["mark_words"].as_str().expect("words");
    let metres: f64 = said.split(' ').rev().nth(1).and_then(|n| n.parse().ok()).expect("a number");
    let most = marked["displacement"]["max_m"].as_f64().expect("a number");
    assert!(said.starts_with("bent view: moved by up to ") && metres >= most && metres < 1.02 * most, "{said}: {most}");
    let (straight, _) = drawn(&place, "c.png", &["--straight"]);
    assert_eq!(straight["overlay"]["mark"], false);
    place.write("s.toml", &SCENE.replace("[camera]", "[overlay]\nmark = false\n[camera]"));
    let (_, off) = drawn(&place, "d.png", &[]);
    assert!(off == without, "the key and the switch mean the same");
    place.write("s.toml", SCENE);
    drawn(&place, "e.png", &["--compare"]);
    assert_eq!(height(&super::read(&place.path("e.png"))), 180 + 28, "titles under the halves");
}

#[test]
fn grid_heat_and_ghost_are_drawn_and_recorded() {
    let place = Place::new();
    place.write("s.toml", SCENE);
    let (_, plain) = drawn(&place, "plain.png", &[]);
    let (grid, a) = drawn(&place, "grid.png", &["--grid=1500"]);
    let (auto, b) = drawn(&place, "auto.png", &["--grid"]);
    let (heat, c) = drawn(&place, "heat.png", &["--heatmap"]);
    let (ghost, d) = drawn(&place, "ghost.png", &["--ghost"]);
    assert_eq!(grid["overlay"]["grid"], 1500.0);
    assert!(auto["overlay"]["grid"].as_f64().is_some_and(|g| g > 100.0 && g != 1500.0), "{}", auto["overlay"]);
    let hottest = heat["overlay"]["heatmap_max"].as_f64().expect("a number");
    let most = heat["displacement"]["max_m"].as_f64().expect("a number");
    assert!(hottest >= 0.98 * most && hottest < 1.5 * most, "{hottest} at the end of the scale, {most} measured");
    assert_eq!(ghost["overlay"]["ghost"], true);
    let all = [&plain, &a, &b, &c, &d];
    assert!((0..5).all(|i| (0..i).all(|j| all[i] != all[j])), "five different pictures");
    place.write("s.toml", &SCENE.replace("[camera]", "[overlay]\ngrid = 1500\nheatmap = true\nghost = true\n[camera]"));
    let (keys, _) = drawn(&place, "keys.png", &["--threads", "1"]);
    assert_eq!(keys["overlay"]["grid"], 1500.0);
    assert_eq!(keys["overlay"]["ghost"], true);
    drawn(&place, "again.png", &["--threads", "3"]);
    assert_eq!(super::read(&place.path("keys.png")), super::read(&place.path("again.png")));
}

#[test]
fn highlights_tell_what_the_bend_did() {
    let place = Place::new();
    let scene = SCENE.replace("[[stage]]", "[[layer]]\nid = 'tower'\nkind = 'boxes'\nmust_see = true\nboxes = [{ base = [-952, 1587, 2200], size = [300, 300, 500] }]\n[[stage]]");
    place.write("s.toml", &scene);
    let (_, plain) = drawn(&place, "plain.png", &[]);
    let (usual, a) = drawn(&place, "usual.png", &["--highlight"]);
    let (stages, b) = drawn(&place, "stages.png", &["--highlight=stages"]);
    let (exact, c) = drawn(&place, "exact.png", &["--highlight=stages", "--renderer", "exact"]);
    assert!(plain != a && a != b && b != c);
    let found = &usual["overlay"]["highlight"];
    assert_eq!(found["marks"], serde_json::json!(["shift", "revealed", "ghost_box"]));
    let number = |record: &serde_json::Value, key: &str| record[key].as_f64().expect("a number");
    // Samples of the whole picture, and all of its pixels.
    let (most, sampled) = (number(found, "max_px"), number(&usual["displacement"], "max_px"));
    assert!(most >= 0.98 * sampled && most < 1.3 * sampled, "{most} of all pixels, {sampled} of samples");
    assert!((0.01..0.9).contains(&number(found, "revealed_share")), "{found}");
    let ghosts = found["ghosts"].as_array().expect("ghosts");
    assert!(ghosts.iter().any(|g| g["layer"] == "tower" && number(g, "shift_px") > 5.0), "{found}");
    let turn = &stages["overlay"]["highlight"]["parts"][0];
    assert_eq!(turn["name"], "curved rays");
    // Both renderers show the same.
    let other = &exact["overlay"]["highlight"]["parts"][0];
    for key in ["share", "shown_share"] {
        assert!((number(turn, key) - number(other, key)).abs() < 0.01, "{turn} {other}");
    }
    let (straight, _) = drawn(&place, "straight.png", &["--straight"]);
    assert!(straight["overlay"]["highlight"].is_null());
    // Keys mean what options mean; the number of threads means nothing.
    let keys = "[overlay]\nhighlight = ['shift', 'revealed', 'ghost_box']\n[camera]";
    place.write("s.toml", &scene.replace("[camera]", keys));
    assert!(drawn(&place, "keys.png", &["--threads", "3"]).1 == a);
    let (asked, d) = drawn(&place, "asked.png", &["--highlight=stages"]);
    assert!(d == b, "what is asked for comes before what the scene says: {}", asked["overlay"]);
    for (overlay, words) in [
        ("highlight = ['shift', 'stages']", &["choose one", "s.toml:"][..]),
        ("highlight = ['stages']\nheatmap = true", &["heat map", "choose one"]),
        ("highlight = ['shine']", &["shine"]),
        ("highlight_px = 0", &["highlight_px is 0"]),
    ] {
        place.write("s.toml", &scene.replace("[camera]", &format!("[overlay]\n{overlay}\n[camera]")));
        let line = place.fails(&["render", "s.toml", "-o", "x.png"]);
        assert!(words.iter().all(|w| line.contains(w)), "{line}");
    }
    place.write("s.toml", &scene);
    for args in [&["--highlight=shift", "--heatmap"][..], &["--highlight=shift,stages"], &["--highlight=shine"]] {
        let line = place.fails(&[&["render", "s.toml", "-o", "x.png"][..], args].concat());
        assert!(line.contains("--highlight") && !line.contains("--set"), "{line}");
    }
}

#[test]
fn the_camera_itself_is_drawn_from_above_and_from_outside() {
    let place = Place::new();
    place.write("s.toml", SCENE);
    let (above, a) = drawn(&place, "above.png", &["--overhead"]);
    assert_eq!(above["overlay"]["camera"], "overhead");
    assert!(
        above["view"]["fov_y_deg"].is_null() && above["view"]["down"][1].as_f64().is_some_and(|y| y < -0.99),
        "north is up"
    );
    let (outside, b) = drawn(&place, "o.png", &["--outside", "20000,-20000,9000,0,0,2000"]);
    assert_eq!(outside["view"]["eye"], serde_json::json!([20000.0, -20000.0, 9000.0]));
    let (_, c) = drawn(&place, "auto.png", &["--outside", "auto"]);
    assert!(a != b && b != c);
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--outside", "1,2,3"]);
    assert!(line.contains("X,Y,Z,X,Y,Z"), "{line}");
    place.fails(&["render", "s.toml", "-o", "x.png", "--overhead", "--compare"]);
    place.write("s.toml", &SCENE[..SCENE.find("[[stage]]").expect("stage")]);
    drawn(&place, "straight.png", &["--overhead"]);
}

#[test]
fn named_points_are_drawn_and_bad_styles_refused() {
    let place = Place::new();
    let feature = |name: &str, x: f64, y: f64| {
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{name}"}},"geometry":{{"type":"Point","coordinates":[{x},{y}]}}}}"#
        )
    };
    let points = [feature("Nordgipfel", 300.0, 900.0), feature("Südgipfel", -800.0, -1200.0)].join(",");
    place.write("p.geojson", &format!(r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:32631"}}}},"features":[{points}]}}"#));
    let layer = "[[layer]]\nid = 'summits'\nkind = 'point'\nsource = 'p.geojson'\nstyle = { symbol = 'peak', labels = true, hidden = 'show' }\n";
    let bare = SCENE.replace("'local'", "'EPSG:32631'");
    let scene = bare.replace("[camera]", &format!("{layer}[camera]"));
    place.write("s.toml", &bare);
    let (_, without) = drawn(&place, "without.png", &["--straight"]);
    place.write("s.toml", &scene);
    let (_, named) = drawn(&place, "named.png", &["--straight"]);
    place.write("s.toml", &scene.replace("labels = true", "labels = false"));
    let (_, unnamed) = drawn(&place, "unnamed.png", &["--straight"]);
    assert!(named != unnamed && unnamed != without);
    for (from, to, words) in [
        ("'peak'", "'star'", "star"),
        ("labels = true", "label_px = 0", "label_px is 0"),
        ("'auto'", "0", "distance_markers_m is 0"),
        ("'auto'", "'often'", "a length or \"auto\""),
        ("[camera]", "[overlay]\ngrid = -1\n[camera]", "grid is -1"),
        ("[camera]", "[overlay]\nmarks = false\n[camera]", "\"mark\""),
    ] {
        place.write("s.toml", &scene.replacen(from, to, 1));
        let line = place.fails(&["render", "s.toml", "-o", "x.png"]);
        assert!(line.contains(words), "{line}");
    }
}

#[test]
fn a_line_bears_its_name_where_it_has_one_and_labels_are_asked_for() {
    let place = Place::new();
    let drawn_with = |name: &str, labels: bool| {
        let line = "[[-3500,-3300],[-1200,-1400],[1200,1100],[3500,3600]]";
        place.write(
            "way.geojson",
            &format!(
                r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:32631"}}}},"features":[{{"type":"Feature","properties":{{"name":"{name}"}},"geometry":{{"type":"LineString","coordinates":{line}}}}}]}}"#
            ),
        );
        let layer = format!(
            "[[layer]]\nid = 'named'\nkind = 'line'\nsource = 'way.geojson'\nstyle = {{ labels = {labels}, label_px = 11, hidden = 'show' }}\n[camera]"
        );
        place.write("s.toml", &SCENE.replace("'local'", "'EPSG:32631'").replace("[camera]", &layer));
        drawn(&place, &format!("{labels}{name}.png"), &["--straight"]).1
    };
    let plain = drawn_with("Hochweg", false);
    let named = drawn_with("Hochweg", true);
    assert!(named != plain && named != drawn_with("Talweg", true), "letters are the name's");
    assert!(drawn_with("", true) == plain, "a line without a name bears none");
}

#[test]
fn buffers_are_written_as_open_exr_too() {
    let place = Place::new();
    place.write("s.toml", SCENE);
    let result = place.json(&[
        "render",
        "s.toml",
        "-o",
        "p.png",
        "--aux",
        "depth,id,world,displacement",
        "--aux-format",
        "exr",
        "--json",
    ]);
    assert_eq!(result["outputs"].as_array().map(Vec::len), Some(3));
    let exr = super::read(&place.path("p.exr"));
    assert!(exr.starts_with(&[0x76, 0x2f, 0x31, 0x01]), "the mark of the format");
    for name in ["depth.Z", "displacement.X", "displacement.Z", "id", "world.Y", "worldOrigin"] {
        assert!(exr[..1000].windows(name.len() + 1).any(|w| w == [name.as_bytes(), b"\0"].concat()), "{name}");
    }
    assert!(!place.path("p.depth.npy").exists());
}

#[test]
fn names_of_areas_have_a_size_that_is_checked() {
    let place = Place::new();
    let area = "[[layer]]\nid = 'lake'\nkind = 'area'\nsource = 'builtin:massif?size=65'\nstyle = { labels = true, label_px = -3 }\n";
    place.write("s.toml", &format!("{}{area}", super::BARE));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("label_px is -3"), "{line}");
}
