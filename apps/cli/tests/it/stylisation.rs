//! Stylisation as a user meets it: asked for by the scene or on the command line, recorded, and refused out of range.

use super::{BARE, Place, read};
use serde_json::Value;

const TOWN: &str = "format = 1\ncrs = 'local'\n[[layer]]\nid = 'town'\nkind = 'city'\nsource = 'builtin:town?size=500'\n\
                    [camera]\neye = [-60, -300, 120]\nlook_at = [0, 0, 0]\n";

#[test]
fn edges_and_shades_change_colours_alone_and_are_recorded() {
    let place = Place::new();
    let scene = TOWN;
    place.write("plain.toml", scene);
    place.write("inked.toml", &format!("{scene}[stylisation]\nedges = true\nunsharp = 4\n"));
    let draw = |scene: &str, out: &str, more: &[&str]| {
        let args = ["render", scene, "-o", out, "--size", "320x180", "--aux", "depth,id,world"];
        place.ok(&[&args[..], more].concat());
        let record: Value =
            serde_json::from_slice(&read(&place.path(&format!("{out}.json")))).expect("a record beside the picture");
        (read(&place.path(out)), record["overlay"].clone())
    };
    let (plain, record) = draw("plain.toml", "plain.png", &[]);
    assert!(record["edges"].is_null() && record["unsharp"].is_null(), "{record}");
    let (inked, record) = draw("inked.toml", "inked.png", &[]);
    assert!(plain != inked && record["edges"].as_f64().is_some_and(|e| (e - 0.7).abs() < 1e-6), "{record}");
    assert_eq!(record["unsharp"], 4.0);
    let (asked, _) = draw("plain.toml", "asked.png", &["--stylise"]);
    assert!(asked != plain);
    for buffer in ["depth", "id", "world"] {
        let [a, b] = ["plain", "inked"].map(|name| read(&place.path(&format!("{name}.{buffer}.npy"))));
        assert!(a == b, "{buffer}");
    }
    let [threads, alone] = [["--threads", "2"], ["--threads", "1"]]
        .map(|threads| draw("inked.toml", "again.png", &[&threads[..], &["--overwrite"]].concat()).0);
    assert!(threads == alone, "the picture depends on the number of threads");
}

#[test]
fn strengths_out_of_range_are_refused_with_their_line() {
    for (key, why) in [
        ("edges = 2", "6: edges is 2, it must be in 0..=1"),
        ("unsharp = -1", "6: unsharp is -1, it must be in 0..=10"),
        ("edges = 'yes'", "true, false or a strength was expected"),
        ("edge = true", "did you mean \"edges\"?"),
    ] {
        let place = Place::new();
        place.write("s.toml", &format!("{BARE}[stylisation]\n{key}\n"));
        let line = place.fails(&["check", "s.toml"]);
        assert!(line.contains(why), "{key}: {line}");
    }
}

#[test]
fn ambient_occlusion_darkens_where_things_stand_close_and_moves_nothing() {
    let place = Place::new();
    let lit = TOWN.replace("size=500'", "size=500'\nstyle = { ambient_occlusion = 40 }");
    place.write("plain.toml", TOWN);
    place.write("lit.toml", &lit);
    let draw = |scene: &str, out: &str| {
        place.ok(&["render", scene, "-o", out, "--size", "320x180", "--aux", "depth,id", "--overwrite"]);
        read(&place.path(out))
    };
    let (plain, dark) = (draw("plain.toml", "plain.png"), draw("lit.toml", "lit.png"));
    assert!(plain != dark);
    for buffer in ["depth", "id"] {
        let [a, b] = ["plain", "lit"].map(|name| read(&place.path(&format!("{name}.{buffer}.npy"))));
        assert!(a == b, "{buffer}");
    }
    assert!(draw("lit.toml", "again.png") == dark, "the same scene, other bytes");
    for reach in ["0", "-1"] {
        place.write("bad.toml", &lit.replace("= 40", &format!("= {reach}")));
        let line = place.fails(&["render", "bad.toml", "-o", "bad.png"]);
        assert!(line.contains("ambient_occlusion"), "{reach}: {line}");
    }
}
