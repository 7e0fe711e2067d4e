//! Files that others found odd: a description or one clear line, soon.

use super::Place;
use std::time::{Duration, Instant};

/// No file of the collection may make for endless work; no measurement, for what else the machine does must not matter.
const SOON: Duration = Duration::from_secs(60);

#[test]
fn odd_files_give_a_description_or_one_line() {
    let Some(folder) = belvedere_testkit::data("odd") else { return };
    let known = ["tif", "hgt", "gpx", "shp", "geojson", "obj", "ply", "stl", "STL", "gltf", "glb"];
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("folder") {
        let path = entry.expect("entry").path();
        if !path.extension().and_then(|e| e.to_str()).is_some_and(|e| known.contains(&e)) {
            continue;
        }
        seen += 1;
        let name = path.to_str().expect("UTF-8");
        let started = Instant::now();
        let out = Place::new().run(&["info", name, "--json"]);
        let text = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(started.elapsed() < SOON, "{name} took {:?}", started.elapsed());
        match out.status.code() {
            Some(0) => assert!(serde_json::from_slice::<serde_json::Value>(&out.stdout).is_ok(), "{name}: no JSON"),
            Some(2) => assert!(text.lines().count() == 1 && text.starts_with("belvedere: "), "{name}: {text}"),
            code => panic!("{name}: exit {code:?}: {text}"),
        }
    }
    assert!(seen >= 30, "only {seen} files");
}

#[cfg(unix)]
#[test]
fn ctrl_c_and_the_signal_of_schedulers_end_cleanly() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        // On a busy machine the signal may come before the program listens for it.
        let ended = [300, 1000, 3000].into_iter().any(|wait_ms| ends_cleanly(signal, code, wait_ms));
        assert!(ended, "{signal} never met a program that listened");
    }
}

#[cfg(unix)]
/// Whether the program had begun to listen for signals.
fn ends_cleanly(signal: &str, code: i32, wait_ms: u64) -> bool {
    let place = Place::new();
    let scene = belvedere_testkit::workspace_root().join("scenes/massif.toml");
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_belvedere"))
        .current_dir(place.path("."))
        .args(["render", scene.to_str().expect("UTF-8"), "-o", "x.png", "--size", "6000x4000"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(Duration::from_millis(wait_ms));
    std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    let out = child.wait_with_output().expect("it ends");
    if out.status.code().is_none() {
        return false;
    }
    assert_eq!(out.status.code(), Some(code));
    assert_eq!(String::from_utf8_lossy(&out.stderr), "belvedere: interrupted; nothing was written\n");
    let left: Vec<_> = std::fs::read_dir(place.path(".")).expect("folder").collect();
    assert!(left.is_empty(), "{left:?}");
    true
}

#[test]
fn info_goes_on_after_a_bad_file_and_tells_files_as_they_are() {
    let place = Place::new();
    place.write("bad.gpx", "<gpx><trk>");
    place.write("way.geojson", r#"{"type":"Feature","properties":{"NAMN":"Leden","n":3},"geometry":{"type":"LineString","coordinates":[[1,2],[1.1,2]]}}"#);
    place.write("dem.asc", "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 46\ncellsize 0.01\n1 2 3\n4 5 6\n");
    let out = place.run(&["info", "bad.gpx", "way.geojson", "dem.asc", "--json"]);
    assert_eq!(out.status.code(), Some(2));
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(
        said.starts_with("belvedere: 1 of 3 files cannot be described: bad.gpx") && said.lines().count() == 1,
        "{said}"
    );
    let found: serde_json::Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let files = &found["files"];
    assert_eq!(
        (&files[0]["kind"], &files[1]["kind"], &files[2]["kind"]),
        (&"error".into(), &"features".into(), &"terrain".into())
    );
    assert_eq!((&files[1]["name_field"], &files[1]["named"]), (&"NAMN".into(), &1.into()));
    assert_eq!(files[1]["properties"].as_array().map(Vec::len), Some(2));
    // degrees and the file's own heights, not those of the resampled ground
    assert_eq!((&files[2]["size"], &files[2]["unit"]), (&serde_json::json!([3, 2]), &"degrees".into()));
    assert_eq!(files[2]["heights_m"], serde_json::json!([1.0, 6.0]));
    assert_eq!(files[2]["scene"]["as_in_file"], false);
}

#[test]
fn names_come_from_the_property_that_is_asked_for() {
    let place = Place::new();
    place.write(
        "way",
        r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"Naam":"a","PEAK":"Alp","n":3,"open":true},"geometry":{"type":"Point","coordinates":[11,46]}}]}"#,
    );
    let read = |arguments: &[&str]| -> serde_json::Value {
        let out = place.run(arguments);
        serde_json::from_slice::<serde_json::Value>(&out.stdout).expect("JSON")["files"][0].clone()
    };
    // a name without an ending leaves it to the content
    let found = read(&["info", "way", "--json"]);
    assert_eq!((&found["format"], &found["name_field"]), (&"GeoJSON".into(), &"Naam".into()));
    let kinds: Vec<_> = found["properties"].as_array().expect("list").iter().map(|p| p["kind"].clone()).collect();
    assert_eq!(kinds, ["text", "text", "number", "yes or no"]);
    assert_eq!(read(&["info", "way", "--name-field", "PEAK", "--json"])["name_field"], "PEAK");
    let out = place.run(&["info", "way", "--name-field", "summit"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && said.contains("no feature has the property \"summit\""), "{said}");
}

#[test]
fn names_from_files_do_not_steer_the_terminal() {
    let place = Place::new();
    place.write("s.toml", "format=1\ntitle=\"t\"\ncrs=\"local\"\n[[layer]]\nid=\"\\u001b[31mevil\"\nkind=\"boxes\"\nsource=\"builtin:street\"\n[camera]\neye=[0,-300,100]\nlook_at=[0,0,0]\nimage=[64,48]\n");
    let said = place.ok(&["check", "s.toml"]);
    assert!(!said.contains('\u{1b}') && said.contains("\\u{1b}[31mevil"), "{said}");
}

#[cfg(unix)]
#[test]
fn words_that_are_no_text_are_refused_in_one_line() {
    use std::os::unix::ffi::OsStrExt;
    let place = Place::new();
    let scene = std::ffi::OsStr::from_bytes(b"\xff.toml");
    let out = place.command(&["render"]).arg(scene).arg("--bogus").output().expect("the program starts");
    let said = String::from_utf8(out.stderr).expect("UTF-8");
    assert!(out.status.code() == Some(2) && said.lines().count() == 1 && said.contains("--bogus"), "{said}");
}
