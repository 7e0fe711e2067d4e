//! Constructors of curved rays and layers that move, in scene files and films.

use super::{Place, read};

/// A small block behind a tower; both stand on nothing.
const SCENE: &str = "format = 1
crs = 'local'
[camera]
eye = [0, 0, 6]
look_at = [0, 100, 4]
fov_y_deg = 50
image = [96, 54]
[[layer]]
kind = 'boxes'
id = 'tower'
boxes = [{ base = [0, 60, 0], size = [8, 4, 30] }]
[[layer]]
kind = 'boxes'
id = 'van'
boxes = [{ base = [0, 0, 0], size = [4, 2, 3], color = '#d02020' }]
motion = 'van.csv'
[constructor]
kind = 'target_tracking'
target = 'van'
";

fn place() -> Place {
    let place = Place::new();
    place.write("s.toml", SCENE);
    place.write("van.csv", "t,x,y,z,yaw_deg\n0,-25,95,0,0\n2,25,95,0,90\n");
    place
}

#[test]
fn a_film_keeps_its_target_in_sight_and_goes_on_to_the_same_bytes() {
    let place = place();
    place.ok(&["animate", "s.toml", "-o", "film"]);
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("film/animation.json"))).expect("JSON");
    let frames = record["frames"].as_array().expect("frames");
    assert_eq!(frames.len(), 51, "until the van comes to rest, 25 frames a second");
    let number = |frame: &serde_json::Value, key: &str| frame["constructor"][key].as_f64().expect("a figure");
    let hidden: Vec<usize> = (0..51).filter(|k| number(&frames[*k], "visible_straight") < 0.5).collect();
    assert!(hidden.len() >= 4, "the tower hides the van in frames {hidden:?}");
    // It takes the set speed a few frames to step aside.
    let seen = hidden.iter().filter(|k| number(&frames[**k], "visible") > 0.5).count();
    assert!(seen + 4 >= hidden.len() && seen > 0, "{seen} of {hidden:?}");
    for pair in frames.windows(2) {
        let step = (number(&pair[1], "f") - number(&pair[0], "f")).abs();
        assert!(step <= 1.5 / 25.0 * (1.0 + 1e-9), "f moves by {step} in a frame");
    }
    // The van is where its motion says, and it moves.
    assert_ne!(frames[0]["sha256"], frames[1]["sha256"]);
    // What is missing is drawn again, with the memory of the frames before.
    let kept = read(&place.path("film/frame_00030.png"));
    std::fs::remove_file(place.path("film/frame_00030.png")).expect("removed");
    place.ok(&["animate", "s.toml", "-o", "film", "--resume"]);
    assert!(read(&place.path("film/frame_00030.png")) == kept, "another picture");
}

#[test]
fn a_still_bends_at_once_and_its_record_says_so() {
    let place = place();
    place.write("van.csv", "0,0,95,0\n");
    place.ok(&["render", "s.toml", "-o", "bent.png"]);
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("bent.png.json"))).expect("JSON");
    let constructor = &record["constructor"];
    assert_eq!(constructor["kind"], "target_tracking");
    assert!(constructor["visible_straight"].as_f64() < Some(0.5) && constructor["visible"] == 1.0, "{constructor}");
    assert_eq!(record["stages"], serde_json::json!(["curved_rays"]));
    assert!(record["note"].as_str().is_some_and(|note| note.contains("curved_rays")));
    // The resolved scene opens to the same picture.
    place.write("again.toml", &place.ok(&["show", "s.toml"]));
    place.ok(&["render", "again.toml", "-o", "again.png"]);
    let pixels = |name: &str| super::light_and_tints::pixels(&read(&place.path(name)));
    assert!(pixels("bent.png") == pixels("again.png"));
}

#[test]
fn what_cannot_be_is_one_clear_line() {
    let place = place();
    let fails = |from: &str, to: &str, words: &[&str]| {
        place.write("bad.toml", &SCENE.replace(from, to));
        let line = place.fails(&["render", "bad.toml", "-o", "x.png"]);
        assert!(words.iter().all(|w| line.contains(w)), "{line}");
    };
    fails("target = 'van'", "target = 'can'", &["bad.toml:19", "\"can\" is no layer", "\"van\""]);
    fails("motion = 'van.csv'", "motion = 'gone.csv'", &["bad.toml:", "gone.csv"]);
    fails("kind = 'target_tracking'", "kind = 'target_tracking'\nf_step = 2.0", &["f_step is 2", "(0, 1]"]);
    place.write("van.csv", "0,0,95,0\n0,1,95,0\n");
    fails("", "", &["van.csv:2", "times must rise"]);
    place.write("van.csv", "0,0,95\n");
    fails("", "", &["van.csv:1", "t,x,y,z[,yaw_deg]"]);
    place.write("van.csv", "t,x,y,z\n");
    fails("", "", &["van.csv:1", "at least one row"]);
}

#[test]
fn a_path_is_previewed_round_its_turns_and_filmed_along_it() {
    let place = Place::new();
    // A corner: blocks on both sides of a street that turns left and then right.
    place.write("path.csv", "x,y,z\n0,0,2\n0,100,2\n-60,160,2\n-60,300,2\n");
    let scene = |path: &str, more: &str| {
        format!(
            "format = 1\ncrs = 'local'\n[camera]\neye = [0, -50, 10]\nlook_at = [0, 100, 0]\nimage = [96, 54]\n\
             [[layer]]\nkind = 'boxes'\nid = 'blocks'\nboxes = [\n\
             {{ base = [-60, 50, 0], size = [80, 60, 30] }}, {{ base = [60, 150, 0], size = [80, 200, 30] }}]\n\
             [constructor]\nkind = 'path_preview'\npath = '{path}'\npreview_m = 150\n{more}"
        )
    };
    place.write("s.toml", &scene("path.csv", ""));
    place.ok(&["render", "s.toml", "-o", "p.png"]);
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("p.png.json"))).expect("JSON");
    let preview = &record["constructor"];
    assert_eq!((&preview["kind"], &preview["turns"]), (&"path_preview".into(), &1.into()), "{preview}");
    assert_eq!(preview["reach_m"], 150.0);
    assert!(record["inputs"].to_string().contains("path.csv"), "the path is among the inputs");
    // A film walks along it; the last position is the end of the path.
    place.ok(&["animate", "s.toml", "-o", "film", "--frames", "6"]);
    let film: serde_json::Value = serde_json::from_slice(&read(&place.path("film/animation.json"))).expect("JSON");
    let at = |k: usize| film["frames"][k]["constructor"]["position_m"].as_f64().expect("a position");
    let length = 100.0 + 2f64.sqrt() * 60.0 + 140.0;
    assert!((at(1) - length / 5.0).abs() < 1e-6 && (at(5) - length).abs() < 1e-3 * length, "{} {}", at(1), at(5));
    for (path, words) in [
        ("gone.csv", ["\"gone.csv\" is no layer", "gone.csv"]),
        ("blocks", ["\"blocks\" is no line and does not move", "line layer"]),
    ] {
        place.write("bad.toml", &scene(path, ""));
        let line = place.fails(&["render", "bad.toml", "-o", "x.png"]);
        assert!(words.iter().all(|w| line.contains(w)), "{line}");
    }
    place.write("bad.toml", &scene("path.csv", "lens = { width_m = 0 }"));
    assert!(place.fails(&["check", "bad.toml"]).contains("width_m is 0"));
}

/// Ground 6 km wide with a gorge that winds through it eastwards, and the river at its bottom.
fn meanders(place: &Place, seed: f64) {
    const CELLS: usize = 150;
    let cell = 6000.0 / CELLS as f64;
    let course =
        |x: f64| 3000.0 + 700.0 * (x / (560.0 + 60.0 * seed) + seed).sin() + 200.0 * (x / 240.0 + 2.0 * seed).sin();
    let mut grid = format!("ncols {CELLS}\nnrows {CELLS}\nxllcorner 0\nyllcorner 0\ncellsize {cell}\n");
    for row in 0..CELLS {
        let y = 6000.0 - cell * (row as f64 + 0.5);
        let height = |column: usize| {
            let x = cell * (column as f64 + 0.5);
            800.0 - 0.01 * x + (1.1 * ((y - course(x)).abs() - 60.0).max(0.0)).min(500.0)
        };
        let row: Vec<String> = (0..CELLS).map(|column| format!("{:.1}", height(column))).collect();
        grid += &(row.join(" ") + "\n");
    }
    place.write("ground.asc", &grid);
    let river: Vec<[f64; 2]> = (10..=140).map(|k| 40.0 * f64::from(k)).map(|x| [x, course(x)]).collect();
    let line = serde_json::json!({ "type": "LineString", "coordinates": river });
    place.write(
        "river.geojson",
        &serde_json::json!({ "type": "Feature", "properties": {}, "geometry": line }).to_string(),
    );
    place.write(
        "river.toml",
        "format = 1\ncrs = 'local'\n[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'ground.asc'\n\
         [[layer]]\nid = 'river'\nkind = 'line'\nsource = 'river.geojson'\nmust_see = true\n\
         [camera]\neye = [0, 3000, 3000]\nlook_at = [3000, 3000, 800]\nimage = [320, 180]\n\
         [constructor]\nkind = 'path_preview'\npath = 'river'\nposition_m = 900\npreview_m = 3000\n",
    );
}

#[test]
fn a_preview_tells_the_length_of_the_path_that_measure_finds_in_its_picture() {
    for seed in [0.0, 1.3, 2.9] {
        let place = Place::new();
        meanders(&place, seed);
        let said = place.json(&["render", "river.toml", "-o", "river.png", "--json"])["warnings"].to_string();
        let record: serde_json::Value = serde_json::from_slice(&read(&place.path("river.png.json"))).expect("JSON");
        let measured = place.json(&["measure", "river.toml"]);
        let number =
            |value: &serde_json::Value| value.as_f64().unwrap_or_else(|| panic!("seed {seed}: no figure in {record}"));
        let preview = &record["constructor"];
        let [reach, followed, seen, wanted] =
            ["reach_m", "followed_m", "seen_m", "wanted_m"].map(|key| number(&preview[key]));
        let shown = number(&measured["features"][0]["bent"]["sight"]["visible"]);
        assert!((seen - shown).abs() < 0.02 * wanted, "seed {seed}: {seen} m in the record, {shown} m measured");
        assert!(reach <= seen + 1.0 && reach <= followed + 1.0 && followed <= wanted + 1.0, "seed {seed}: {preview}");
        // A reach that falls short is said.
        assert_eq!(said.contains("the preview shows"), reach < 0.95 * wanted, "seed {seed}: {reach} of {wanted} m");
    }
}

#[test]
fn a_probe_looks_behind_a_row_of_houses_in_stills_and_films() {
    let place = Place::new();
    // A row of houses, and others behind it.
    let row = |y: i32, h: i32| {
        let house = |x: i32| format!("{{ base = [{}, {y}, 0], size = [18, 14, {}] }}", 20 * x, h + x % 2);
        (-4..5).map(house).collect::<Vec<_>>().join(", ")
    };
    place.write(
        "s.toml",
        &format!(
            "format = 1\ncrs = 'local'\n[camera]\neye = [0, -120, 14]\nlook_at = [0, 60, 8]\nimage = [96, 54]\n\
             [[layer]]\nkind = 'boxes'\nid = 'houses'\nboxes = [{}, {}, {}, {}]\n[constructor]\nkind = 'auto_probe'\n\
             cap_per_s = 1.0\n",
            row(0, 16),
            row(40, 9),
            row(75, 8),
            row(110, 10)
        ),
    );
    place.ok(&["render", "s.toml", "-o", "p.png"]);
    let record: serde_json::Value = serde_json::from_slice(&read(&place.path("p.png.json"))).expect("JSON");
    let probe = &record["constructor"];
    let number = |of: &serde_json::Value, key: &str| of[key].as_f64().expect("a figure");
    assert_eq!(probe["kind"], "auto_probe");
    assert!(number(probe, "seen") > 1.3 * number(probe, "seen_straight"), "{probe}");
    assert!(number(probe, "gained") > number(probe, "lost") && number(probe, "turns") >= 1.0, "{probe}");
    assert_eq!(record["stages"], serde_json::json!(["curved_rays"]));
    place.write("again.toml", &place.ok(&["show", "s.toml"]));
    place.ok(&["render", "again.toml", "-o", "again.png"]);
    let pixels = |name: &str| super::light_and_tints::pixels(&read(&place.path(name)));
    assert!(pixels("p.png") == pixels("again.png"), "the same scene, the same way");
    // A resting camera makes a film of the turns as they come in.
    place.ok(&["animate", "s.toml", "-o", "film", "--frames", "4", "--fps", "2"]);
    let film: serde_json::Value = serde_json::from_slice(&read(&place.path("film/animation.json"))).expect("JSON");
    let entered = |k: usize| number(&film["frames"][k]["constructor"], "entered");
    assert!((entered(0), entered(1), entered(2)) == (0.0, 0.5, 1.0), "{} {}", entered(1), entered(2));
    let seen = |k: usize| number(&film["frames"][k]["constructor"], "seen");
    assert!(seen(3) > seen(0) && seen(0) == number(probe, "seen_straight"));
    let kept = read(&place.path("film/frame_00002.png"));
    std::fs::remove_file(place.path("film/frame_00002.png")).expect("removed");
    place.ok(&["animate", "s.toml", "-o", "film", "--frames", "4", "--fps", "2", "--resume"]);
    assert!(read(&place.path("film/frame_00002.png")) == kept, "another picture");
}

#[test]
fn reveal_looks_round_what_hides_a_layer_atoms_or_a_point() {
    let place = place();
    place.write("s.toml", &SCENE.replace("motion = 'van.csv'\n", "").replace("base = [0, 0, 0]", "base = [0, 95, 0]"));
    let report = |name: &str| -> serde_json::Value { serde_json::from_slice(&read(&place.path(name))).expect("JSON") };
    let said = place.ok(&[
        "reveal", "s.toml", "--see", "van", "-o", "van.png", "--report", "van.json", "--scene", "van.toml", "--before",
        "b.png",
    ]);
    assert!(said.contains("visible in the straight picture: 0 %, in the bent one: 100 %"), "{said}");
    let found = report("van.json");
    assert_eq!((&found["visible_straight"], &found["visible"]), (&0.0.into(), &1.0.into()), "{found}");
    assert!(found["motion"].as_f64() < Some(0.3), "{found}");
    for file in ["van.png", "van.png.json", "van.pair.png", "b.png"] {
        assert!(place.path(file).exists(), "{file} is not there");
    }
    // The scene that is written shows the same, without any constructor.
    place.ok(&["render", "van.toml", "-o", "again.png"]);
    // The outline of the target is drawn by `reveal` alone.
    let [revealed, again] = ["van.png.json", "again.png.json"].map(report);
    assert_eq!((&revealed["view"], &revealed["displacement"]), (&again["view"], &again["displacement"]));
    // A point, and atoms of a molecule that has no file.
    place.ok(&["reveal", "s.toml", "--see", "0,95,3.5", "-o", "p.png", "--report", "p.json"]);
    assert_eq!(report("p.json")["visible"], 1.0);
    place.ok(&["reveal", "builtin:dna?pairs=6", "--see", "resi 3 and name P", "--size", "96x54", "-o", "m.png"]);
    for (see, words) in
        [("vam", ["\"vam\" is no layer", "did you mean \"van\""]), ("1,2", ["\"1,2\" is no layer", "a point x,y,z"])]
    {
        let line = place.fails(&["reveal", "s.toml", "--see", see, "-o", "x.png"]);
        assert!(words.iter().all(|w| line.contains(w)), "{line}");
    }
    // Ground cannot be a target; the nearest name is suggested.
    for (source, word) in [("builtin:canyon", "no model that can be looked into"), ("builtin:canyom", "\"canyon\"")] {
        let line = place.fails(&["reveal", source, "--see", "1,2,3", "-o", "x.png"]);
        assert!(line.contains(word), "{line}");
    }
    let line = place.fails(&["reveal", "builtin:dna", "--see", "chain Q", "-o", "x.png"]);
    assert!(line.contains("chain Q") && line.contains("chains are A, B"), "{line}");
    place.write("x.tif", "no model");
    assert!(
        place.fails(&["reveal", "x.tif", "--see", "a", "-o", "x.png"]).contains("no model that can be looked into")
    );
    assert!(
        place
            .fails(&["reveal", "s.toml", "--see", "van", "--technique", "terrain", "-o", "x.png"])
            .contains("--technique of a part of a model or city is curved_rays or spline")
    );
}

#[test]
fn curved_rays_show_more_of_a_route_than_straight_ones() {
    let place = Place::new();
    let massif = "builtin:massif?seed=7&size=129";
    place.ok(&[
        "reveal",
        massif,
        massif,
        "--technique",
        "curved_rays",
        "--eye=6000,3200,+300",
        "--look=3200,3200",
        "--size",
        "160x90",
        "-o",
        "r.png",
        "--report",
        "r.json",
    ]);
    let report: serde_json::Value = serde_json::from_slice(&read(&place.path("r.json"))).expect("JSON");
    assert_eq!(report["technique"], "curved_rays");
    let (straight, bent) = (report["visible_straight"].as_f64(), report["visible_bent"].as_f64());
    assert!(bent > straight.map(|s| s + 0.1), "{straight:?} -> {bent:?}");
}

/// A tower of two parts behind a wall, in one file.
fn town() -> String {
    let cube = |name: &str, [x, y]: [f64; 2], size: [f64; 3], first: usize| {
        let corner = |k: usize| {
            let at = |axis: usize, from: f64| from + if k >> axis & 1 == 1 { size[axis] } else { 0.0 };
            format!("v {} {} {}\n", at(0, x), at(1, y), at(2, 0.0))
        };
        let face = |f: [usize; 4]| format!("f {}\n", f.map(|k| (first + k).to_string()).join(" "));
        let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        format!("o {name}\n{}{}", (0..8).map(corner).collect::<String>(), faces.map(face).concat())
    };
    [
        cube("Wall", [-12.0, 0.0], [24.0, 2.0, 20.0], 1),
        cube("Church", [-4.0, 40.0], [8.0, 8.0, 12.0], 9),
        cube("Ground", [-80.0, -20.0], [160.0, 120.0, 0.1], 17),
    ]
    .concat()
}

#[test]
fn a_named_part_of_a_mesh_is_looked_for() {
    let place = Place::new();
    place.write("town.obj", &town());
    let from = ["--eye", "0,-80,12", "--look", "0,40,8", "--size", "96x54"];
    let answer = place.json(&[&["reveal", "town.obj", "--see", "church", "-o", "c.png", "--json"][..], &from].concat());
    assert!(answer["visible_straight"].as_f64() < Some(0.2), "{answer}");
    assert!(answer["visible"].as_f64() > Some(0.9), "{answer}");
    let line = place.fails(&["reveal", "town.obj", "--see", "chruch", "-o", "d.png"]);
    assert!(line.contains("no part of a mesh") && line.contains("did you mean \"Church\""), "{line}");
    assert!(!place.path("d.png").exists());
}

#[test]
fn what_no_bend_shows_is_shown_by_a_fallback_and_the_record_says_how() {
    let place = Place::new();
    let scene = "format = 1\ncrs = 'local'\n[[layer]]\nid = 'shell'\nkind = 'boxes'\nboxes = [
        { base = [0, 44, -20], size = [60, 2, 40] }, { base = [0, 56, -20], size = [60, 2, 40] },
        { base = [-31, 50, -20], size = [2, 14, 40] }, { base = [31, 50, -20], size = [2, 14, 40] },
        { base = [0, 50, 20], size = [64, 14, 2] }, { base = [0, 50, -22], size = [64, 14, 2] }]
[[layer]]\nid = 'core'\nkind = 'boxes'\nboxes = [{ base = [0, 50, -3], size = [6, 4, 6] }]
[camera]\neye = [0, -60, 10]\nlook_at = [0, 50, 0]\nimage = [240, 160]\n";
    place.write("s.toml", scene);
    let reveal = ["reveal", "s.toml", "--see", "core", "--overwrite", "-o", "r.png"];
    let said = place.ok(&[&reveal[..], &["--fallback", "transparency", "--scene", "r.toml"]].concat());
    assert!(said.contains("shell (1 part drawn transparent)") && said.contains("now 100 %"), "{said}");
    // The scene that was written shows the same.
    let again = place.ok(&["render", "r.toml", "-o", "again.png"]);
    assert!(again.contains("fallback for core: shell"), "{again}");
    for kind in ["transparency", "cutaway", "explosion"] {
        let rule = format!("[constructor]\nkind = 'manual'\ntarget = 'core'\nfallback = ['shell:{kind}']\n");
        place.write("k.toml", &(scene.to_owned() + &rule));
        for renderer in ["cpu", "exact"] {
            place.ok(&["render", "k.toml", "-o", "k.png", "--overwrite", "--renderer", renderer]);
            let record: serde_json::Value = serde_json::from_slice(&read(&place.path("k.png.json"))).expect("JSON");
            let found = &record["fallback"];
            assert_eq!((&found["changed"][0]["layer"], &found["changed"][0]["kind"]), (&"shell".into(), &kind.into()));
            assert!(found["visible_before"] == 0.0 && found["visible"] == 1.0, "{found}");
        }
    }
    for (rule, words) in [
        ("kind = 'manual'\nfallback = ['cutaway']", "needs target"),
        ("kind = 'manual'\ntarget = 'core'\nfallback = ['melt']", "possible are transparency"),
        ("kind = 'manual'\ntarget = 'core'\nfallback = ['shel:cutaway']", "shell"),
        ("kind = 'manual'\ntarget = 'cor'\nfallback = ['cutaway']", "core"),
    ] {
        place.write("bad.toml", &format!("{scene}[constructor]\n{rule}\n"));
        let line = place.fails(&["render", "bad.toml", "-o", "x.png"]);
        assert!(line.contains(words), "{line}");
    }
    let line = place.fails(&[&reveal[..], &["--fallback", "melt"]].concat());
    assert!(line.contains("--fallback") && line.contains("explosion"), "{line}");
}
