//! Points, volumes and other layers that volumes hide, and what rays have to bend round to show them.

use super::{Place, read};

fn report(place: &Place, name: &str) -> serde_json::Value {
    serde_json::from_slice(&read(&place.path(name))).expect("JSON")
}

/// A wall of 90 x 4 x 40 voxels in air, as text in NRRD; its spacing is half a unit.
fn wall() -> String {
    let value = |i: i32| {
        let [x, y, z] = [i % 90, i / 90 % 12, i / 1080];
        if (4..86).contains(&x) && (4..8).contains(&y) && z < 38 { "200 " } else { "0 " }
    };
    let values: String = (0..90 * 12 * 40).map(value).collect();
    format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 90 12 40\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n{values}")
}

/// A wall of voxels between the eye and a block.
const SCENE: &str = "format = 1
crs = 'local'
unit = 'voxel'
[[layer]]
id = 'wall'
kind = 'volume'
source = 'wall.nrrd'
transfer = 'solid'
transform = { translate = [-22.5, 60, -6] }
[[layer]]
id = 'block'
kind = 'boxes'
boxes = [{ base = [0, 95, 0], size = [5, 3, 5], color = '#d02020' }]
[camera]
eye = [0, 0, 3]
look_at = [0, 100, 3]
fov_y_deg = 40
image = [96, 54]
";

#[test]
fn a_point_in_a_chamber_of_a_volume_is_shown_by_bent_rays() {
    let place = Place::new();
    let see = ["--see", "80,92,62", "--transfer", "solid", "--size", "160x90"];
    let files = ["-o", "e.png", "--report", "e.json", "--scene", "e.toml"];
    let said = place.ok(&[&["reveal", "builtin:engine"][..], &see, &files].concat());
    assert!(said.contains("in the straight picture: 0 %, in the bent one: 100 %"), "{said}");
    assert!(said.contains("point 80, 92, 62 in scene coordinates, voxel 80.0, 92.0, 62.0 of engine"), "{said}");
    let found = report(&place, "e.json");
    assert_eq!((&found["light_straight"], &found["visible"]), (&0.0.into(), &1.0.into()), "{found}");
    // The picture's own record tells the place, too, and how it is marked.
    let record = report(&place, "e.png.json");
    assert_eq!(record["target"], found["target"]);
    assert_eq!(record["target"]["voxels"][0]["layer"], "engine");
    assert!(record["target"]["mark"].as_str().is_some_and(|m| m.contains("ring")), "{}", record["target"]);
    // What is seen at the image of the point in the written scene is the point, or what lies just behind it.
    let picked = |scene: &str| {
        place.write("p.json", "[[80, 92, 62]]");
        let at = place.json(&["project", scene, "--points", "p.json"])["points"][0].clone();
        place.write("q.json", &format!("[{}]", at["pixel"]));
        let hit = place.json(&["pick", scene, "--pixels", "q.json"])["pixels"][0].clone();
        (at["depth"].as_f64().expect("a depth"), hit["depth"].as_f64().expect("a depth"))
    };
    let (wanted, seen) = picked("e.toml");
    assert!(seen >= wanted - 1.5, "the ray ends at {seen}, before the point at {wanted}");
    let straight = std::fs::read_to_string(place.path("e.toml")).expect("a scene");
    let stage = straight.find("[[stage]]").expect("a stage");
    place.write("straight.toml", &straight[..stage]);
    let (wanted, seen) = picked("straight.toml");
    assert!(seen < wanted - 10.0, "without bends {seen} hides {wanted}");
}

#[test]
fn what_no_bend_reaches_is_said_with_the_best_share_that_was_found() {
    let place = Place::new();
    // In the middle of the valve's stem.
    let args =
        ["reveal", "builtin:engine", "--see", "80,92,57", "--transfer", "solid", "--size", "96x54", "-o", "e.png"];
    let [code, warned] = {
        let out = place.run(&[&args[..], &["--strict", "--report", "e.json"]].concat());
        [format!("{:?}", out.status.code()), String::from_utf8_lossy(&out.stderr).into_owned()]
    };
    assert_eq!(code, "Some(1)");
    assert!(warned.contains("opaque matter of engine") && warned.contains("nearest place that is not"), "{warned}");
    let found = report(&place, "e.json");
    assert_eq!(found["visible"], 0.0);
    assert!(found["light_best"].as_f64() < Some(0.5) && found["tried"].as_u64() > Some(1000), "{found}");
    let place_beside = &found["target"]["voxels"][0]["nearest_clear"];
    assert!(place_beside.as_array().is_some_and(|p| p.len() == 3), "{found}");
    let said = place.ok(&[&args[..], &["--overwrite"]].concat());
    assert!(said.contains("no bend of") && said.contains("% at best by a bend, half is needed"), "{said}");
    // A point beside everything.
    let out = place.run(&["reveal", "builtin:engine", "--see", "900,0,0", "--size", "96x54", "-o", "o.png"]);
    assert!(String::from_utf8_lossy(&out.stderr).contains("outside everything"), "{out:?}");
}

#[test]
fn volumes_hide_layers_and_are_layers_that_are_hidden() {
    let place = Place::new();
    place.write("wall.nrrd", &wall());
    place.write("s.toml", SCENE);
    place.ok(&["reveal", "s.toml", "--see", "block", "-o", "b.png", "--report", "b.json"]);
    let found = report(&place, "b.json");
    assert_eq!((&found["visible_straight"], &found["visible"]), (&0.0.into(), &1.0.into()), "{found}");
    // The other way round: the volume behind a box as large.
    let behind = SCENE
        .replace("[-22.5, 60, -6]", "[-22.5, 90, -6]")
        .replace("{ base = [0, 95, 0], size = [5, 3, 5]", "{ base = [0, 50, -6], size = [30, 2, 24]");
    place.write("t.toml", &behind);
    place.ok(&["reveal", "t.toml", "--see", "wall", "-o", "w.png", "--report", "w.json"]);
    let found = report(&place, "w.json");
    let [straight, bent] = ["visible_straight", "visible"].map(|k| found[k].as_f64().expect("a share"));
    assert!(straight < 0.3 && bent > 0.7, "{found}");
}

#[test]
fn a_film_bends_round_a_volume_to_keep_its_target_in_sight() {
    let place = Place::new();
    place.write("wall.nrrd", &wall());
    let block = "boxes = [{ base = [0, 0, 0], size = [5, 3, 5], color = '#d02020' }]\nmotion = 'block.csv'";
    let scene = SCENE.replace("boxes = [{ base = [0, 95, 0], size = [5, 3, 5], color = '#d02020' }]", block);
    let scene = scene.replace("fov_y_deg = 40", "fov_y_deg = 60");
    place.write(
        "s.toml",
        &format!("{scene}[constructor]\nkind = 'target_tracking'\ntarget = 'block'\na = 60\nz0 = 20\n"),
    );
    place.write("block.csv", "t,x,y,z,yaw_deg\n0,-24,95,0,0\n1.2,-22,95,0,0\n");
    place.ok(&["animate", "s.toml", "-o", "film"]);
    let record = report(&place, "film/animation.json");
    let number = |k: usize, key: &str| record["frames"][k]["constructor"][key].as_f64().expect("a figure");
    let hidden: Vec<usize> = (0..31).filter(|k| number(*k, "visible_straight") < 0.5).collect();
    let seen = hidden.iter().filter(|k| number(**k, "visible") > 0.5).count();
    assert!(hidden.len() == 31 && seen > 24, "{seen} of {hidden:?}");
}

#[test]
fn mistakes_are_told_in_one_line() {
    let place = Place::new();
    let line = place.fails(&["reveal", "builtin:dna", "--see", "chain A", "--transfer", "solid", "-o", "x.png"]);
    assert!(line.contains("--transfer is for volumes"), "{line}");
    let line = place.fails(&["reveal", "builtin:engine", "--see", "1,2,3", "--transfer", "sold", "-o", "x.png"]);
    assert!(line.contains("did you mean \"solid\""), "{line}");
    place.write("wall.nrrd", &wall());
    place.write("s.toml", SCENE);
    let line = place.fails(&["reveal", "s.toml", "--see", "1,2,3", "--transfer", "grey", "-o", "x.png"]);
    assert!(line.contains("states its transfer functions itself"), "{line}");
    place.write("none.raw", "abc");
    let line = place.fails(&["reveal", "none.raw", "--see", "1,2,3", "-o", "x.png"]);
    assert!(line.contains("none.raw"), "{line}");
}
