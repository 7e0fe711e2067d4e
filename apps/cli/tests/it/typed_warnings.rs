//! Warnings in machine-readable output are objects; on standard error they stay sentences.

use super::{Place, read};
use serde_json::Value;

const SCENE: &str = "format = 1
[camera]
eye = [200, -300, 400]
look_at = [200, 200, 0]
image = [48, 32]
[[layer]]
id = 'hills'
kind = 'terrain'
source = 'dem.asc'
";

fn place() -> Place {
    let place = Place::new();
    let rows: String =
        (0..20).map(|r| (0..20).map(|c| format!("{} ", (c * r) % 7)).collect::<String>() + "\n").collect();
    let header = "ncols 20\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 20\n";
    place.write("dem.asc", &format!("{header}{rows}1 2 3 4\n"));
    place.write("s.toml", SCENE);
    place
}

/// The warning of a kind in a list of them.
fn of_kind<'w>(warnings: &'w Value, kind: &str) -> &'w Value {
    let found = warnings.as_array().expect("a list").iter().find(|w| w["kind"] == kind);
    found.unwrap_or_else(|| panic!("no {kind} in {warnings}"))
}

#[test]
fn every_machine_readable_answer_gives_the_same_objects() {
    let place = place();
    let out = place.run(&["render", "s.toml", "-o", "p.png", "--json"]);
    let result: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let ignored = of_kind(&result["warnings"], "ignored");
    assert_eq!((&ignored["subject"], &ignored["figures"]["count"]), (&"hills".into(), &4.0.into()), "{ignored}");
    let assumed = of_kind(&result["warnings"], "assumed");
    assert!(assumed["subject"] == "hills" && assumed.get("figures").is_none(), "no empty figures: {assumed}");
    let record: Value = serde_json::from_slice(&read(&place.path("p.png.json"))).expect("JSON");
    // The record names files relative to the scene.
    let folder = place.0.path().canonicalize().expect("folder").join("").display().to_string();
    assert_eq!(record["warnings"].to_string(), result["warnings"].to_string().replace(&folder, ""));
    assert_eq!(place.json(&["check", "s.toml", "--json"])["warnings"], result["warnings"]);
    let stderr = String::from_utf8(out.stderr).expect("UTF-8");
    let said: Vec<&str> = stderr.lines().filter_map(|line| line.strip_prefix("belvedere: warning: ")).collect();
    let texts: Vec<&str> = result["warnings"].as_array().unwrap().iter().map(|w| w["text"].as_str().unwrap()).collect();
    // On standard error the option that settles it may follow.
    assert!(said.len() == texts.len() && said.iter().zip(&texts).all(|(s, t)| s.starts_with(t)), "{said:?} {texts:?}");
    assert!(said.iter().any(|line| line.ends_with(" (--source-crs)")) && assumed["key"] == "source_crs", "{said:?}");

    let info = place.json(&["info", "dem.asc", "--json"]);
    let found = of_kind(&info["files"][0]["warnings"], "ignored");
    assert!(found["subject"] == "dem.asc", "a file without a scene: {found}");
}
