//! Rigid layers from the scene file to picture, record, check and errors.

use super::{BARE, Place};

fn scene(layer: &str) -> String {
    let camera = BARE.replace("eye = [0.0, 0.0, 0.0]", "eye = [-42.0, -300.0, 215.0]");
    let camera = camera.replace("look_at = [0.0, 1.0, 0.0]", "look_at = [0.0, 0.0, 0.0]");
    format!("{camera}{layer}[[stage]]\nkind = 'spline_bend'\npresets = 'hybrid-flat-steep-flat'\n")
}

fn town(rigid: &str) -> String {
    scene(&format!("[[layer]]\nid = 'town'\nkind = 'city'\nsource = 'builtin:town?seed=7&size=500'\n{rigid}"))
}

#[test]
fn rigid_layers_are_checked_shown_drawn_recorded_and_picked() {
    let place = Place::new();
    place.write("rigid.toml", &town("rigid = true\n"));
    place.write("bent.toml", &town(""));
    let checked = |name: &str| place.run(&["check", name, "--json"]);
    let text = |out: &std::process::Output| {
        String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr)
    };
    let (rigid, bent) = (text(&checked("rigid.toml")), text(&checked("bent.toml")));
    assert!(rigid.contains("\"rigid\":true") && !rigid.contains("space folds"), "{rigid}");
    assert!(!bent.contains("\"rigid\"") && bent.contains("space folds"), "{bent}");
    let shown = place.ok(&["show", "rigid.toml"]);
    assert!(shown.contains("rigid = true"), "{shown}");
    assert!(!place.ok(&["show", "bent.toml"]).contains("rigid"));

    let draw = |name: &str| {
        let out = format!("{name}.png");
        place.ok(&["render", &format!("{name}.toml"), "-o", &out, "--size", "160x120", "--aux", "displacement"]);
        let record = std::fs::read(place.path(&format!("{out}.json"))).expect("a record");
        serde_json::from_slice::<serde_json::Value>(&record).expect("JSON")
    };
    let (rigid, bent) = (draw("rigid"), draw("bent"));
    assert_eq!(rigid["rigid"], serde_json::json!(["town"]));
    assert!(bent["rigid"].is_null(), "{bent}");
    // What the picture says of displacement is that of the bodies: nothing of it folds.
    assert_eq!(rigid["displacement"]["folded_share"], 0.0);
    assert!(rigid["displacement"]["max_m"].as_f64().expect("a length") > 5.0);

    // A pixel of the town: a place on its ground or in a building of true height.
    place.write("p.json", "[[480, 300]]");
    let picked = place.json(&["pick", "rigid.toml", "--pixels", "p.json"]);
    let point = &picked["pixels"][0];
    assert_eq!(point["layer"], "town", "{picked}");
    let z = point["point"][2].as_f64().expect("a height");
    assert!((-0.1..120.0).contains(&z), "{picked}");
}

#[test]
fn what_has_no_parts_is_not_rigid_and_constructors_say_that_they_cannot() {
    let place = Place::new();
    place.write(
        "ground.toml",
        &scene("[[layer]]\nid = 'g'\nkind = 'terrain'\nsource = 'builtin:massif?size=65'\nrigid = true\n"),
    );
    let error = place.fails(&["check", "ground.toml"]);
    assert!(error.contains("unknown key \"rigid\"") && error.contains("ground.toml"), "{error}");
    let tracking = "[constructor]\nkind = 'target_tracking'\ntarget = 'block'\n";
    let boxes =
        "[[layer]]\nid = 'block'\nkind = 'boxes'\nrigid = true\nboxes = [{ base = [0, 60, 0], size = [9, 9, 9] }]\n";
    place.write("tracking.toml", &(scene(boxes) + tracking));
    let error = place.fails(&["render", "tracking.toml", "-o", "t.png"]);
    assert!(error.contains("layer \"block\" is rigid") && error.contains("rigid = false"), "{error}");
}
