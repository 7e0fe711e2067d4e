//! `preset` as a user meets it: a document made, changed, checked, plotted and drawn by.

use super::{Place, read};
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn builtins_are_listed_by_effect() {
    let place = Place::new();
    let text = place.ok(&["preset", "list"]);
    for word in ["progressive (also steep-flat, panorama): a map in front, a horizon behind", "phi  40", "facing 0.035"]
    {
        assert!(text.contains(word), "{word}: {text}");
    }
    let listed = json(&place.ok(&["preset", "list", "--json"]));
    assert_eq!(listed["presets"].as_array().map(Vec::len), Some(8));
    assert_eq!(place.ok(&["preset", "show", "flat-steep"]), place.ok(&["preset", "show", "degressive"]));
}

#[test]
fn a_preset_is_made_from_the_template_in_a_few_operations_and_drawn() {
    let place = Place::new();
    place.ok(&["preset", "new", "-o", "own.toml", "--from", "demo"]);
    let operations = [
        "low.remove",
        "high.remove",
        "medium.name=own",
        "own.point.4=1,0.24",
        "own.range=0.45,2",
        "own.tau=0",
        "own.merge=1",
    ];
    place.ok(&[&["preset", "set", "own.toml"][..], &operations].concat());
    let shown = place.ok(&["preset", "show", "own.toml"]);
    assert!(shown.contains("name = \"own\"") && shown.contains("0.24") && shown.contains("e = 2.0"), "{shown}");
    place.ok(&["preset", "show", "own.toml", "-o", "own.json"]);
    assert_eq!(json(&String::from_utf8(read(&place.path("own.json"))).expect("UTF-8"))["presets"][0]["name"], "own");
    let checked = json(&place.ok(&["preset", "check", "own.json", "--json"]));
    assert!(checked["presets"][0]["facing"].as_f64().is_some_and(|f| f > 0.0), "{checked}");
    place.ok(&["preset", "plot", "own.toml", "-o", "own.png"]);
    assert!(read(&place.path("own.png")).len() > 10_000);
    let scene = "format = 1\ncrs = 'local'\n[[layer]]\nid = 'g'\nkind = 'terrain'\nsource = 'builtin:massif?size=65'\n\
                 [representations]\nloa0 = ['g']\nloa2 = ['g']\n\
                 [camera]\neye = [0, -6000, 5000]\nlook_at = [0, 0, 1000]\n[[stage]]\nkind = 'spline_bend'\npresets = 'own.toml'\n";
    place.write("s.toml", scene);
    place.ok(&["render", "s.toml", "-o", "s.png", "--size", "160x90"]);
    place.ok(&["preset", "set", "own.toml", "--capture", "own=s.toml"]);
    let phi =
        json(&place.ok(&["preset", "check", "own.toml", "--json"]))["presets"][0]["phi"].as_f64().expect("an angle");
    assert!((phi - (4000f64 / 6000.0).atan().to_degrees()).abs() < 1e-6, "{phi}");
}

#[test]
fn what_fails_changes_nothing_and_says_where() {
    let place = Place::new();
    place.ok(&["preset", "new", "-o", "own.toml"]);
    let before = read(&place.path("own.toml"));
    for (args, why) in [
        (&["low.phi=20", "low.remove-point=2"][..], "a curve needs 4 control points"),
        (&["low.phi=north"], "\"north\" is no value"),
        (&["nobody.phi=20"], "there are \"low\", \"medium\", \"high\""),
        (&[], "nothing to do"),
        (&["--capture", "low"], "write PRESET=SCENE.toml"),
    ] {
        let line = place.fails(&[&["preset", "set", "own.toml"][..], args].concat());
        assert!(line.contains(why), "{args:?}: {line}");
        assert!(read(&place.path("own.toml")) == before, "{args:?}");
    }
    assert!(place.fails(&["preset", "new", "-o", "own.toml"]).contains("--overwrite"));
    assert!(place.fails(&["preset", "set", "gone.toml", "low.phi=1"]).contains("preset new"));
    assert!(place.fails(&["preset", "plot", "progresive", "-o", "a.png"]).contains("progressive"));
    place.write(
        "broken.toml",
        "version = 1\n[[presets]]\nphi = 10\ns = 2\ne = 1\ncontrol = [[0,0],[1,0],[2,0],[3,0]]\n",
    );
    assert!(place.fails(&["preset", "check", "broken.toml"]).contains("does not exceed near depth"));
    // Six sections read badly: a warning, and with --strict a missed goal.
    place.ok(&["preset", "set", "own.toml", "low.split=1", "low.split=1"]);
    assert_eq!(place.run(&["preset", "check", "own.toml", "--strict"]).status.code(), Some(1));
}
