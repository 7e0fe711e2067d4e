//! Outputs: standard output, and what is noticed before the work.

use super::Place;
use super::trusted::hills;

const SIZE: [&str; 2] = ["--size", "32x24"];

/// A scene of generated ground, and data.
fn place() -> Place {
    let place = Place::new();
    place.write(
        "s.toml",
        "format = 1\n[camera]\neye = [6000, -5200, 3600]\nlook_at = [0, 0, 300]\nimage = [32, 24]\n[[layer]]\nkind = 'terrain'\nid = 'ground'\n\
         source = 'builtin:massif?seed=7&size=65'\n[[stage]]\nkind = 'spline_bend'\npresets = 'progressive'\n",
    );
    place.write("dem.asc", &hills());
    let line = "{\"type\":\"LineString\",\"coordinates\":[[8.012,46.014],[8.024,46.028],[8.034,46.036]]}";
    place.write("way.geojson", line);
    place
}

/// Names of the files in the folder.
fn files(place: &Place) -> Vec<String> {
    let entries = std::fs::read_dir(place.path(".")).expect("folder").flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn pictures_and_documents_go_to_standard_output() {
    let place = place();
    let before = files(&place);
    let out = place.run(&["render", "s.toml", "-o", "-"]);
    assert_eq!((out.status.code(), out.stderr.len()), (Some(0), 0));
    assert_eq!(files(&place), before, "no record, nothing else");
    place.ok(&["render", "s.toml", "-o", "a.png"]);
    assert!(out.stdout == super::read(&place.path("a.png")));
    let reveal = ["reveal", "dem.asc", "way.geojson", "--eye", "8.022,46.002,1500", "--look", "8.024,46.03"];
    let out = place.run(&[&reveal[..], &SIZE, &["-o", "-", "--report", "r.json"]].concat());
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.success() && said.contains("visible in the straight picture"), "{said}");
    place.ok(&[&reveal[..], &SIZE, &["-o", "b.png", "--quiet"]].concat());
    assert!(out.stdout == super::read(&place.path("b.png")));
    assert!(place.path("r.json").exists() && !place.path("-.pair.png").exists());
    place.write("q.json", "[[3, 4]]");
    for args in
        [&["pick", "s.toml", "--pixels", "q.json"][..], &["show", "s.toml"], &["schema"], &["preset", "show", "map"]]
    {
        assert_eq!(place.ok(&[args, &["-o", "-"]].concat()), place.ok(args), "{args:?}");
    }
    assert!(place.ok(&["preset", "new", "-o", "-"]).contains("[[presets]]"));
    assert!(place.run(&["preset", "plot", "map", "-o", "-"]).stdout.starts_with(b"\x89PNG"));
    assert!(place.run(&["export", "s.toml", "-o", "-"]).stdout.starts_with(b"glTF"));
    assert!(!place.path("-").exists());
}

#[test]
fn what_does_not_fit_one_stream_is_refused() {
    let place = place();
    let before = files(&place);
    let several = "writes several files, which standard output cannot hold";
    for (args, expected) in [
        (&["render", "s.toml", "-o", "-", "--aux", "depth"][..], several),
        (&["demo", "-o", "-"], several),
        (&["figures", "spline", "-o", "-"], several),
        (&["animate", "s.toml", "-o", "-", "--turntable"], several),
        (&["pack", "s.toml", "-o", "-"], several),
        (&["generalise", "way.geojson", "-o", "-"], several),
        (&["render", "s.toml", "-o", "-", "--json"], "--json prints on standard output, too"),
        (&["reveal", "dem.asc", "way.geojson", "-o", "a.png", "--report", "-"], "only -o takes standard output"),
        (&["reveal", "dem.asc", "way.geojson", "-o", "-", "--drafts", "2"], "--drafts prints commands"),
        (
            &["disocclude", "dem.asc", "way.geojson", "--eye", "8.022,46.002,1500", "--look", "8.024,46.03", "-o", "-"],
            "an elevation model is written to a file",
        ),
    ] {
        let line = place.fails(args);
        assert!(line.contains(expected), "{args:?}: {line}");
    }
    assert_eq!(files(&place), before);
}

#[test]
fn two_outputs_of_one_name_are_refused_before_the_work() {
    let place = place();
    std::fs::create_dir(place.path("sub")).expect("folder");
    let before = files(&place);
    let reveal = ["reveal", "dem.asc", "way.geojson", "-o", "a.png"];
    let disocclude =
        ["disocclude", "dem.asc", "way.geojson", "--eye", "8.022,46.002,1500", "--look", "8.024,46.03", "-o", "a.tif"];
    for args in [
        [&reveal[..], &["--report", "a.png.json"]].concat(),
        [&reveal[..], &["--before", "sub/../a.png"]].concat(),
        [&reveal[..], &["--report", "r.json", "--scene", "./r.json"]].concat(),
        [&reveal[..], &["--before", "a.pair.png"]].concat(),
        [&reveal[..], &["--timings", "a.png"]].concat(),
        [&disocclude[..], &["--displacement", "a.tif"]].concat(),
        [&disocclude[..], &["--report", "x.json", "--features-out", "x.json"]].concat(),
        vec!["render", "s.toml", "-o", "a.png", "--timings", "a.png.json"],
        vec!["schema", "-o", "a.json", "--timings", "a.json"],
    ] {
        let line = place.fails(&args);
        assert!(line.ends_with("is named for two outputs; give each a name of its own"), "{args:?}: {line}");
    }
    assert_eq!(files(&place), before);
}

/// Every verb with an output in a folder, without the output.
const VERBS: &[&[&str]] = &[
    &["reveal", "dem.asc", "way.geojson"],
    &["disocclude", "dem.asc", "way.geojson", "--eye", "8.022,46.002,1500", "--look", "8.024,46.03"],
    &["render", "s.toml"],
    &["animate", "s.toml", "--turntable"],
    &["export", "s.toml"],
    &["project", "s.toml", "--points", "none.json"],
    &["rays", "s.toml", "--pixels", "none.json", "--samples", "2"],
    &["pick", "s.toml", "--pixels", "none.json"],
    &["measure", "s.toml"],
    &["show", "s.toml"],
    &["schema"],
    &["bench"],
    &["demo"],
    &["figures", "spline"],
    &["generalise", "way.geojson"],
    &["pack", "s.toml"],
    &["preset", "show", "map"],
    &["preset", "new"],
    &["preset", "plot", "map"],
];

#[test]
fn outputs_that_cannot_be_written_are_noticed_before_the_work() {
    let place = place();
    place.write("file", "");
    let before = files(&place);
    let mut bad = vec!["file/x.png"];
    // A file system in which nobody can make a file.
    if cfg!(target_os = "linux") {
        bad.push("/proc/x.png");
    }
    for args in VERBS {
        for out in &bad {
            let line = place.fails(&[args, &["-o", out][..]].concat());
            assert!(line.contains(out.trim_end_matches("/x.png")) && !line.contains("none.json"), "{args:?}: {line}");
        }
        let more = [args, &["-o", "fine", "--timings", "none/t.json"][..]].concat();
        let line = place.fails(&more);
        assert!(line.contains("folder none does not exist; create it first"), "{args:?}: {line}");
    }
    for option in ["--report", "--before", "--scene"] {
        let args = ["reveal", "dem.asc", "way.geojson", "-o", "a.png", option];
        assert!(place.fails(&[&args[..], &["none/x.png"]].concat()).contains("folder none does not exist"));
    }
    assert!(place.fails(&["render", "s.toml", "-o", "."]).contains("is no file name"));
    assert!(place.fails(&["export", "s.toml", "-o", "a.obj"]).contains("name the output .glb"));
    assert_eq!(files(&place), before, "nothing is left of the tries");
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_read_only_is_noticed() {
    use std::os::unix::fs::PermissionsExt;
    let place = place();
    std::fs::create_dir(place.path("shut")).expect("folder");
    std::fs::set_permissions(place.path("shut"), PermissionsExt::from_mode(0o555)).expect("mode");
    if std::fs::write(place.path("shut/probe"), "").is_ok() {
        // Permissions bind no administrator: the program may write, too, and does.
        place.ok(&["render", "s.toml", "-o", "shut/a.png"]);
        return;
    }
    let line = place.fails(&["render", "s.toml", "-o", "shut/a.png"]);
    assert!(line.contains("cannot be written: folder") && line.ends_with("choose another folder"), "{line}");
}

#[test]
fn times_are_written_where_they_are_asked_for_and_not_into_records() {
    let place = place();
    place.ok(&["render", "s.toml", "-o", "a.png", "--timings", "t.json"]);
    let times: serde_json::Value = serde_json::from_slice(&super::read(&place.path("t.json"))).expect("JSON");
    assert_eq!(times["verb"], "render");
    let total = times["total_ms"].as_f64().expect("a time");
    let drawn = times["parts"]["draw_ms"].as_f64().expect("a time");
    assert!(drawn > 0.0 && drawn <= total, "{times}");
    let record = String::from_utf8(super::read(&place.path("a.png.json"))).expect("UTF-8");
    assert!(
        !record.contains("_ms\"") && !record.contains("milliseconds") && record.contains("triangles_in"),
        "{record}"
    );
}
