//! Opacity of solids from the scene file to picture, record, pick, measure and errors.

use super::{BARE, Place};

fn scene(opacity: &str) -> String {
    let camera = BARE.replace("eye = [0.0, 0.0, 0.0]", "eye = [0.0, -300.0, 30.0]");
    let camera = camera.replace("look_at = [0.0, 1.0, 0.0]", "look_at = [0.0, 0.0, 30.0]");
    let wall = "boxes = [{ base = [0.0, 0.0, 0.0], size = [120.0, 20.0, 60.0] }]";
    let target = "boxes = [{ base = [0.0, 60.0, 20.0], size = [30.0, 10.0, 20.0], color = '#d03020' }]";
    format!(
        "{camera}[[layer]]\nid = 'wall'\nkind = 'boxes'\n{wall}\nstyle = {{ {opacity} }}\n\
         [[layer]]\nid = 'target'\nkind = 'boxes'\nmust_see = true\n{target}\n"
    )
}

#[test]
fn a_wall_that_is_seen_through_hides_nothing_and_is_recorded_and_picked() {
    let place = Place::new();
    place.write("wall.toml", &scene(""));
    place.write("pane.toml", &scene("opacity = 0.4"));
    place.write("none.toml", &scene("opacity = 0"));
    assert!(place.ok(&["show", "pane.toml"]).contains("opacity = 0.4"));
    assert!(!place.ok(&["show", "wall.toml"]).contains("opacity"));
    let draw = |name: &str| {
        let out = format!("{name}.png");
        place.ok(&["render", &format!("{name}.toml"), "-o", &out, "--size", "160x120"]);
        let record = std::fs::read(place.path(&format!("{out}.json"))).expect("a record");
        serde_json::from_slice::<serde_json::Value>(&record).expect("JSON")
    };
    let (wall, pane) = (draw("wall"), draw("pane"));
    assert!(wall["see_through"].is_null(), "{wall}");
    assert_eq!(pane["see_through"][0]["layer"], "wall");
    assert!((pane["see_through"][0]["opacity"].as_f64().expect("a number") - 0.4).abs() < 1e-6);

    // Measures agree by both methods: the wall hides the target, what is seen through does not.
    let share = |name: &str, method: &str| {
        let measured = place.json(&["measure", name]);
        let share = measured["features"][0]["straight"][method]["share"].as_f64();
        share.unwrap_or_else(|| panic!("{name}: {measured}"))
    };
    for method in ["sight", "buffer"] {
        let [wall, pane, none] = ["wall.toml", "pane.toml", "none.toml"].map(|name| share(name, method));
        assert!(wall == 0.0 && pane == none && none > 0.3, "{method}: {wall}, {pane}, {none}");
    }
    place.write("p.json", "[[640, 360]]");
    let picked = |name: &str| place.json(&["pick", name, "--pixels", "p.json"])["pixels"][0]["layer"].clone();
    assert_eq!([picked("pane.toml"), picked("none.toml")], ["wall", "target"]);
}

#[test]
fn opacities_beyond_their_range_and_of_other_layers_are_errors() {
    let place = Place::new();
    for opacity in ["1.5", "-0.1"] {
        place.write("s.toml", &scene(&format!("opacity = {opacity}")));
        let error = place.fails(&["check", "s.toml"]);
        assert!(error.contains("opacity is") && error.contains("it must be in 0..=1"), "{error}");
    }
    place.write("t.toml", &format!("{BARE}[[layer]]\nid = 'g'\nkind = 'terrain'\nsource = 'builtin:massif?size=65'\nstyle = {{ opacity = 0.5 }}\n"));
    let error = place.fails(&["check", "t.toml"]);
    assert!(error.contains("opacity"), "{error}");
}
