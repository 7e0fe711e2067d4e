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
}

#[test]
fn a_point_outside_a_volume_is_refused_with_the_range_of_the_scene() {
    let place = Place::new();
    for see in ["900,0,0", "80,92,-0.5"] {
        let line = place.fails(&["reveal", "builtin:engine", "--see", see, "--size", "96x54", "-o", "o.png"]);
        assert!(line.contains("--see: ") && line.contains("outside everything") && line.contains("x 0 to "), "{line}");
        assert!(!place.path("o.png").exists());
    }
}

#[test]
fn a_cutaway_says_how_many_pixels_show_the_target_and_warns_of_few() {
    let place = Place::new();
    place.write("wall.nrrd", &wall());
    place.write("s.toml", SCENE);
    // A point in the middle of the wall, and a block behind it, small and large in the picture.
    let args = ["reveal", "wall.nrrd", "--see", "22,3,9", "--transfer", "solid", "--fallback", "cutaway"];
    for (size, is_small) in [("96x54", true), ("960x540", false)] {
        let out =
            place.run(&[&args[..], &["--size", size, "-o", "p.png", "--report", "p.json", "--overwrite"]].concat());
        let said = String::from_utf8_lossy(&out.stdout).into_owned();
        let found = report(&place, "p.json");
        let pixels = found["fallback"]["pixels_opened"].as_u64().expect("a number of pixels");
        let share = if is_small { "now" } else { "now 100 %," };
        assert!(said.contains(&format!("{share} through an opening of {pixels} pixels")), "{said}");
        assert_eq!(pixels < 100, is_small, "{found}");
        let warned = found["warnings"]
            .as_array()
            .expect("warnings")
            .iter()
            .any(|w| w["figures"]["pixels"].as_f64() == Some(pixels as f64));
        assert_eq!(warned, is_small, "{found}");
    }
    let block = ["render", "c.toml", "-o", "b.png", "--overwrite"];
    for (size, is_small) in [("image = [96, 54]", true), ("image = [960, 540]", false)] {
        let fallback = "[constructor]\nkind = 'manual'\ntarget = 'block'\nfallback = ['cutaway']\n";
        place.write("c.toml", &(SCENE.replace("image = [96, 54]", size) + fallback));
        let out = place.run(&block);
        let (said, warned) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
        let found = report(&place, "b.png.json")["fallback"].clone();
        let pixels = found["pixels_alone"].as_u64().expect("a number of pixels");
        assert!(said.contains(&format!("now 100 % of the {pixels} pixels that it fills")), "{said}");
        assert_eq!(warned.contains("are easily missed"), is_small, "{pixels} pixels: {warned}");
    }
}

#[test]
fn points_of_a_line_behind_one_another_in_a_volume_are_judged_where_the_picture_cuts_it() {
    let place = Place::new();
    place.write("wall.nrrd", &wall());
    let line = "[[layer]]\nid = 'drill'\nkind = 'line'\nsource = 'drill.geojson'\n";
    place.write("drill.geojson", "{\"type\":\"LineString\",\"coordinates\":[[500,61.9,3],[501,64.1,3]]}");
    let fallback = "[constructor]\nkind = 'manual'\ntarget = 'drill'\nfallback = ['cutaway']\n";
    // Away from the origin, where positions could be degrees.
    let moved =
        [("[-22.5, 60, -6]", "[477.5, 60, -6]"), ("[0, 0, 3]", "[500, 0, 3]"), ("[0, 100, 3]", "[500, 100, 3]")];
    let scene = moved.iter().fold(SCENE.to_owned(), |scene, (from, to)| scene.replace(from, to));
    let camera = scene.find("[camera]").expect("a camera");
    place.write("s.toml", &format!("{}{line}{}{fallback}", &scene[..camera], &scene[camera..]));
    place.ok(&["render", "s.toml", "-o", "d.png"]);
    let found = report(&place, "d.png.json")["fallback"].clone();
    // The wall is cut at the near end: matter still hides the far one.
    assert_eq!(found["visible"], 0.5, "{found}");
}

#[test]
fn a_scene_file_is_drawn_at_the_size_that_is_asked_for() {
    let place = Place::new();
    place.write("wall.nrrd", &wall());
    place.write("s.toml", SCENE);
    let image = |size: &[&str]| {
        let args = ["reveal", "s.toml", "--see", "block", "-o", "o.png", "--scene", "o.toml", "--overwrite"];
        place.ok(&[&args[..], size].concat());
        let png = std::fs::read(place.path("o.png")).expect("a picture");
        let drawn = [16, 20].map(|k| u32::from_be_bytes(png[k..k + 4].try_into().expect("four bytes")));
        let written = std::fs::read_to_string(place.path("o.toml")).expect("a scene");
        (drawn, written.replace(char::is_whitespace, ""))
    };
    for (size, [width, height]) in [(&[][..], [96, 54]), (&["--size", "64x48"], [64, 48])] {
        let (drawn, written) = image(size);
        assert_eq!(drawn, [width, height]);
        assert!(written.contains(&format!("image=[{width},{height}")), "{written}");
    }
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

/// Along the channel of the built-in tube.
const CHANNEL: &str = "format = 1
crs = 'local'
unit = 'voxel'
[[layer]]
id = 'tube'
kind = 'volume'
source = 'builtin:tube'
transfer = 'solid'
[camera]
eye = [200, -160, 150]
look_at = [60, 60, 55]
image = [64, 36]
[constructor]
kind = 'path_preview'
centreline = { volume = 'tube', from = [97, 63, 25], to = [97, 56, 86], values = [12, 70] }
position_m = 100
preview_m = 60
";

#[test]
fn a_centreline_traced_between_two_points_is_a_path_to_preview() {
    let place = Place::new();
    place.write("s.toml", CHANNEL);
    place.ok(&["render", "s.toml", "-o", "p.png", "--aux", "world"]);
    let preview = report(&place, "p.png.json")["constructor"].clone();
    assert_eq!(preview["kind"], "path_preview");
    assert!(preview["turns"].as_u64() > Some(2) && preview["reach_m"].as_f64() > Some(50.0), "{preview}");
    // Two turns of radius 38, 62 voxels high, but for the ends.
    let length = preview["centreline"]["length"].as_f64().expect("a length");
    assert!((length - 474.0).abs() < 12.0, "{preview}");
    let clearance = preview["centreline"]["median_clearance"].as_f64().expect("a clearance");
    assert!((7.0..10.5).contains(&clearance), "{preview}");
    // A film walks along it, and what was traced stays the same.
    place.ok(&["animate", "s.toml", "-o", "film", "--frames", "4"]);
    let film = report(&place, "film/animation.json");
    let last = &film["frames"][3]["constructor"];
    assert!((last["position_m"].as_f64().expect("a position") - length).abs() < 0.01 * length, "{last}");
    assert_eq!(last["centreline"], preview["centreline"]);
    // The resolved scene opens to the same picture.
    place.write("again.toml", &place.ok(&["show", "s.toml"]));
    place.ok(&["render", "again.toml", "-o", "again.png"]);
    let pixels = |name: &str| super::light_and_tints::pixels(&read(&place.path(name)));
    assert!(pixels("p.png") == pixels("again.png"));
}

#[test]
fn a_centreline_that_cannot_be_is_one_clear_line() {
    let place = Place::new();
    for (from, to, wanted) in [
        ("values = [12, 70]", "values = [100, 255]", &["from = [97, 63, 25] has the value", "move the point"][..]),
        ("to = [97, 56, 86], values = [12, 70]", "to = [60, 60, 55], values = [0, 10]", &["has the value", "0 to 10"]),
        (
            "to = [97, 56, 86], values",
            "to = [110, 56, 86], values",
            &["not connected by voxels of 12 to 70", "come within"],
        ),
        (", values = [12, 70]", "", &["both sides of the threshold", "give values"]),
        ("volume = 'tube'", "volume = 'tub'", &["\"tub\" is no layer", "did you mean \"tube\""]),
        ("preview_m = 60", "preview_m = 60\npath = 'p.csv'", &["both are given; give exactly one"]),
        ("centreline = ", "# ", &["neither is given; give exactly one"]),
    ] {
        let mut scene = CHANNEL.replace(from, to);
        if from.starts_with(", values") {
            // In the wall.
            scene = scene
                .replace("to = [97, 56, 86]", "to = [109, 60, 55]")
                .replace("from = [97, 63, 25]", "from = [2, 2, 2]");
        }
        place.write("bad.toml", &scene);
        let line = place.fails(&["render", "bad.toml", "-o", "x.png"]);
        assert!(line.contains("bad.toml:") && wanted.iter().all(|w| line.contains(w)), "{line}");
    }
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
