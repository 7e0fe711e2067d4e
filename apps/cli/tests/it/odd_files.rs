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
fn ctrl_c_ends_cleanly() {
    let place = Place::new();
    let scene = belvedere_testkit::workspace_root().join("scenes/massif.toml");
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_belvedere"))
        .current_dir(place.path("."))
        .args(["render", scene.to_str().expect("UTF-8"), "-o", "x.png", "--size", "6000x4000"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(Duration::from_millis(300));
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    let out = child.wait_with_output().expect("it ends");
    assert_eq!(out.status.code(), Some(2));
    assert_eq!(String::from_utf8_lossy(&out.stderr), "belvedere: cancelled; nothing was written\n");
    let left: Vec<_> = std::fs::read_dir(place.path(".")).expect("folder").collect();
    assert!(left.is_empty(), "{left:?}");
}
