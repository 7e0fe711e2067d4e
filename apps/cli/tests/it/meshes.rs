//! Layers of triangles, from the file to picture, pick and measure.

use super::Place;

/// A pyramid of 40 m before the eye, its front towards it, in red.
const PYRAMID: &str =
    "v -20 80 -20\nv 20 80 -20\nv 20 120 -20\nv -20 120 -20\nv 0 100 20\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

const SCENE: &str = "format = 1
crs = 'EPSG:32631'
[[layer]]
id = 'pyramid'
kind = 'mesh'
source = 'pyramid.obj'
style = { color = '#c02020' }
[[layer]]
id = 'trail'
kind = 'line'
source = 'trail.geojson'
must_see = true
[camera]
eye = [0, 0, 0]
look_at = [0, 100, 0]
image = [64, 48]
";

const TRAIL: &str = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32631"}},"features":[{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[-60,150,0],[60,150,0]]}}]}"#;

fn place() -> Place {
    let place = Place::new();
    place.write("s.toml", SCENE);
    place.write("pyramid.obj", PYRAMID);
    place.write("trail.geojson", TRAIL);
    place
}

#[test]
fn a_mesh_is_drawn_picked_and_in_the_way() {
    let place = place();
    place.write("p.json", "[[32.0, 24.0], [32.0, 30.0], [2.0, 2.0]]");
    let picked = place.json(&["pick", "s.toml", "--pixels", "p.json"]);
    let first = &picked["pixels"][0];
    assert_eq!(first["layer"], "pyramid");
    // The front rises from y = 80 to y = 100 over 40 m: level with the eye it is 90 m away.
    assert!((first["depth"].as_f64().expect("a number") - 90.0).abs() < 1e-9, "{first}");
    assert_eq!(picked["pixels"][2], serde_json::Value::Null);
    for renderer in ["cpu", "exact"] {
        let out = format!("{renderer}.png");
        place.ok(&["render", "s.toml", "-o", &out, "--renderer", renderer, "--aux", "id"]);
        let report = place.json(&["measure", "s.toml", "--renderer", renderer]);
        assert_eq!(report["renderer"], renderer);
        let share = report.to_string();
        assert!(share.contains("straight"), "{share}");
    }
    let check = place.ok(&["check", "s.toml", "--json"]);
    assert!(check.contains("mesh"), "{check}");
}

#[test]
fn a_mesh_hides_what_lies_behind_it() {
    let place = place();
    let seen = |place: &Place| {
        let report = place.json(&["measure", "s.toml", "--renderer", "exact"]);
        report["features"][0].clone()
    };
    let hidden = seen(&place);
    place.write("pyramid.obj", &PYRAMID.replace("80", "280").replace("120", "320").replace("100", "300"));
    let free = seen(&place);
    assert_ne!(hidden, free, "behind the trail the pyramid hides nothing");
}

#[test]
fn transforms_place_a_mesh() {
    let place = place();
    // Turned upside down about x and lifted, moved 60 m on, half as large: its point now hangs at (0, 110, -10).
    let turned =
        "source = 'pyramid.obj'\ntransform = { translate = [0, 160, 0], rotate_deg = [180, 0, 0], scale = 0.5 }";
    place.write("s.toml", &SCENE.replace("source = 'pyramid.obj'", turned));
    place.write("p.json", "[[32.0, 24.0]]");
    let picked = place.json(&["pick", "s.toml", "--pixels", "p.json"]);
    let depth = picked["pixels"][0]["depth"].as_f64().expect("seen");
    // y = 160 - 0.5 y': the back at 100..120 comes to the front, at half its height 160 - 55 = 105.
    assert!((depth - 105.0).abs() < 1e-9, "{depth}");
    let both = turned.replace("scale = 0.5 }", "scale = 0.5 }\ncrs = 'EPSG:32631'");
    place.write("s.toml", &SCENE.replace("source = 'pyramid.obj'", &both));
    assert!(place.fails(&["check", "s.toml"]).contains("either transform or crs"));
}

#[test]
fn mistakes_about_meshes_are_told_with_their_line() {
    let place = place();
    place.write("s.toml", &SCENE.replace("pyramid.obj", "builtin:churhc"));
    assert!(place.fails(&["check", "s.toml"]).contains("did you mean \"church\""));
    place.write("s.toml", &SCENE.replace("pyramid.obj", "trail.geojson"));
    assert!(place.fails(&["check", "s.toml"]).contains("not a mesh that this version reads"));
    place.write("s.toml", &SCENE.replace("style = {", "motion = 'car.csv'\nstyle = {"));
    assert!(place.fails(&["check", "s.toml"]).contains("path \"car.csv\" is not there"));
    place.write("pyramid.obj", "v 0 0 0\n");
    place.write("s.toml", SCENE);
    assert!(place.fails(&["check", "s.toml"]).contains("no triangles"));
}

#[test]
fn parts_are_named_where_they_are_picked_and_chosen_by_name() {
    let place = place();
    let (base, top) = PYRAMID.split_once("f 1").expect("faces");
    place.write("pyramid.obj", &format!("{base}o town hall\nf 1{}", top.replacen("f 2", "o yard\nf 2", 1)));
    place.write("p.json", "[[32.0, 24.0]]");
    let picked = place.json(&["pick", "s.toml", "--pixels", "p.json"]);
    assert_eq!(picked["pixels"][0]["feature"], "town hall");
    let with = |select: &str| SCENE.replace("style = {", &format!("must_see = true\nselect = '{select}'\nstyle = {{"));
    place.write("s.toml", &with("Town Hall"));
    let report = place.json(&["measure", "s.toml"]);
    let surface = &report["surfaces"];
    // The face towards the eye: a triangle of 40 m and 44.7 m, all of it seen.
    let number = |v: &serde_json::Value| v.as_f64().expect("a number");
    assert!((number(&surface["total"]) - 0.5 * 40.0 * 2000f64.sqrt()).abs() < 1e-2, "{surface}");
    for method in ["sight", "buffer"] {
        assert!(number(&surface["straight"][method]["share"]) > 0.97, "{surface}");
    }
    place.write("s.toml", &with("church"));
    let said = place.fails(&["check", "s.toml"]);
    assert!(said.contains("no part is called \"church\"; the 2 parts are town hall, yard"), "{said}");
}
