//! Each example runs and does what it says.

#![allow(dead_code, unreachable_pub, reason = "examples are programs: `main` is theirs, `run` is for these tests")]

#[path = "../../examples/curved_rays_round_a_box.rs"]
mod curved_rays_round_a_box;
#[path = "../../examples/own_stage.rs"]
mod own_stage;
#[path = "../../examples/picture_from_arrays.rs"]
mod picture_from_arrays;
#[path = "../../examples/reveal_from_files.rs"]
mod reveal_from_files;
#[path = "../../examples/terrain_solver_alone.rs"]
mod terrain_solver_alone;

#[test]
fn arrays_become_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    picture_from_arrays::run(folder.path()).unwrap();
    let record = std::fs::read_to_string(folder.path().join("hills.png.json")).unwrap();
    assert!(folder.path().join("hills.png").exists() && record.contains("\"renderer\": \"cpu\""), "{record}");
}

#[test]
fn files_become_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // A wall of 300 m south of the route, 30 m a cell; another view shows all of it without any bend, so that there is no pair.
    let row = |r: usize| if (28..32).contains(&r) { "400 ".repeat(60) } else { "100 ".repeat(60) } + "\n";
    let header = "ncols 60\nnrows 60\nxllcorner 8.0\nyllcorner 46.0\ncellsize 0.0003\nNODATA_value -9999\n";
    std::fs::write(at("dem.asc"), header.to_owned() + &(0..60).map(row).collect::<String>()).unwrap();
    let route = r#"{"type": "LineString", "coordinates": [[8.003, 46.0115], [8.015, 46.0115]]}"#;
    std::fs::write(at("route.geojson"), route).unwrap();
    let [dem, route] = ["dem.asc", "route.geojson"].map(|name| at(name).display().to_string());
    let summary = reveal_from_files::run(&dem, &route, at("out.png"), [160, 90]);
    assert!(summary.unwrap().starts_with("visible in the straight picture"));
    assert!(at("out.png").exists() && !at("out.pair.png").exists());
}

#[test]
fn rays_reach_the_ground_behind_a_box() {
    let folder = tempfile::tempdir().unwrap();
    let [straight, bent] = curved_rays_round_a_box::run(folder.path()).unwrap();
    assert_eq!([straight.as_deref(), bent.as_deref()], [Some("building"), Some("ground")]);
}

#[test]
fn a_map_of_ones_own_is_drawn_and_picked() {
    let folder = tempfile::tempdir().unwrap();
    let [straight, ramp] = own_stage::run(folder.path()).unwrap();
    assert_eq!([straight.as_deref(), ramp.as_deref()], [Some("building"), Some("ground")]);
    let record = std::fs::read_to_string(folder.path().join("own_stage.png.json")).unwrap();
    assert!(record.contains("\"own\""), "{record}");
}

#[test]
fn the_solver_works_alone() {
    let report = terrain_solver_alone::run(129).unwrap();
    assert!(report.points > 0 && report.metrics.visible_dense >= report.visible_dense_before, "{report:?}");
}
