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
        "horizon.remove",
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
        (&["low.phi=north"], "\"north\" is not a number"),
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

#[test]
fn broken_documents_end_in_one_line_with_file_and_place() {
    let place = Place::new();
    place.ok(&["preset", "new", "-o", "good.json", "--from", "demo"]);
    let good = json(&String::from_utf8(read(&place.path("good.json"))).expect("UTF-8"));
    let refused = |about: &str, text: &str, words: &[&str]| {
        place.write("p.json", text);
        let start = std::time::Instant::now();
        let line = place.fails(&["preset", "check", "p.json"]);
        assert!(start.elapsed().as_secs_f64() < 10.0, "{about} takes {:?}", start.elapsed());
        assert!(words.iter().all(|w| line.contains(w)) && line.contains("p.json"), "{about}: {line}");
        assert!(line.len() < 400, "{about}: {line}");
    };
    // A change of the first preset, and what must be said of it.
    let low = |key: &str, value: Value, words: &str| {
        let mut document = good.clone();
        document["presets"][0][key] = value.clone();
        refused(&format!("{key} = {value}"), &document.to_string(), &["\"low\"", words]);
    };
    for (key, value, words) in [
        ("phi", "91", "phi is 91, it must be in -90..=90"),
        ("phi", "1e308", "phi is 1e308"),
        ("tau", "-5", "tau is -5, it must be in 0..=90"),
        ("a", "-5", "a is -5"),
        ("b", "1e300", "b is 1e300"),
        ("e", "0.4", "e = 0.4 does not exceed near depth s = 0.4; give e > s"),
        ("e", "0.1", "does not exceed"),
        ("s", "1e308", "s = 1e308; give e > s"),
        ("control", "[[0, 0], [1, 0], [2, 0]]", "3 control points were given"),
        ("control", "[]", "0 control points were given"),
        ("control", "[[1, 1], [1, 1], [1, 1], [1, 1]]", "move its control points apart"),
        ("knots", "[0, 0, 0, 1]", "4 knots were given, 4 control points need 8"),
        ("knots", "[0, 0, 0, 0, 1, 0.5, 1, 1]", "sort the knots"),
        ("sections", "[\"loa0\"]", "1 sections for 2 tags; exactly 3 are needed"),
        ("phi", "50", "have the same phi = 50 degrees"),
        ("angles", "[[0, 60], [0.5, 60]]", "remove the other"),
        ("tags", "[{\"u\": 0.6, \"delta\": 0.05}, {\"u\": 0.3, \"delta\": 0.05}]", "tag 1 lies at u = 0.3"),
        ("tags", "[{\"u\": 0.3, \"delta\": -0.1}, {\"u\": 0.6, \"delta\": 0.05}]", "tag delta is -0.1"),
        ("tags", "[{\"u\": -0.3, \"delta\": 0.1}, {\"u\": 1.6, \"delta\": 0.05}]", "tag u is -0.3"),
    ] {
        low(key, json(value), words);
    }
    let text = good.to_string();
    let many: Vec<String> = (0..34).map(|k| format!("\"r{k}\"")).collect();
    let tags: Vec<String> = (1..34).map(|k| format!("{{\"u\":{},\"delta\":0}}", f64::from(k) / 34.0)).collect();
    let mut document = good.clone();
    document["presets"][0]["sections"] = json(&format!("[{}]", many.join(",")));
    document["presets"][0]["tags"] = json(&format!("[{}]", tags.join(",")));
    refused("many representations", &document.to_string(), &["different representations, 32 at most"]);
    let keyed = |from: &str, to: &str| text.replacen(from, to, 1);
    for (about, text, words) in [
        ("NaN", keyed("25.0", "NaN"), "not finite"),
        ("1e999", keyed("25.0", "1e999"), "not a finite number"),
        ("null", keyed("25.0", "null"), "presets.0.phi: a number was expected, found null"),
        ("text", keyed("25.0", "\"x\""), "presets.0.phi: a number was expected, found the text \"x\""),
        ("unknown key", keyed("\"phi\"", "\"colour\""), "unknown key \"colour\""),
        ("version 2", keyed("\"version\":1", "\"version\":2"), "has version 2, this program reads version 1"),
        ("given twice", keyed("\"version\":1", "\"version\":1,\"version\":1"), "given twice"),
        ("no presets", "{\"version\":1,\"presets\":[]}".into(), "holds 0 presets"),
        ("deep", format!("{{\"x\":{}{}}}", "[".repeat(5000), "]".repeat(5000)), "nested more than 64 deep"),
        ("large", format!("{text}{}", " ".repeat(17 << 20)), "has 17"),
        ("empty", String::new(), "not valid JSON"),
        ("a list", "[]".into(), "a table was expected, found a list"),
    ] {
        refused(about, &text, &[words]);
    }
    for k in 0..16 {
        refused(&format!("cut at {k} of 16"), &text[..text.len() * k / 16], &["p.json"]);
    }
}
