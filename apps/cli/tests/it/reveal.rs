//! `reveal` on a small range of hills with a hole in it.

use super::Place;

const SIDE: usize = 64;

/// Hills between lon 8.0 and 8.064, without data where `hole` says so.
fn hills(hole: impl Fn(usize, usize) -> bool) -> String {
    ranges(hole, 1000.0, 250.0)
}

/// Ranges of hills `rise` m over and under `middle`.
fn ranges(hole: impl Fn(usize, usize) -> bool, middle: f64, rise: f64) -> String {
    let mut text =
        format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 8.0\nyllcorner 46.0\ncellsize 0.001\nNODATA_value -9999\n");
    for row in 0..SIDE {
        for col in 0..SIDE {
            let height = middle + rise * (0.35 * row as f64).sin() + 40.0 * (0.2 * col as f64).sin();
            text += &if hole(row, col) { "-9999 ".to_owned() } else { format!("{height:.1} ") };
        }
        text += "\n";
    }
    text
}

fn place(hole: impl Fn(usize, usize) -> bool) -> Place {
    let place = Place::new();
    place.write("dem.asc", &hills(hole));
    let line = "{\"type\":\"LineString\",\"coordinates\":[[8.02,46.02],[8.03,46.035],[8.04,46.05]]}";
    place.write("way.geojson", line);
    place
}

/// Reveals `place`'s way and returns the record of the terrain and all warnings.
fn ground(place: &Place, more: &[&str]) -> (serde_json::Value, String) {
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "64x48", "--overwrite", "--json"];
    let view = ["--eye", "8.03,46.002,1900", "--look", "8.03,46.035", "--report", "report.json"];
    let result = place.json(&[&args[..], &view, more].concat());
    let json =
        |name: &str| -> serde_json::Value { serde_json::from_slice(&super::read(&place.path(name))).expect("JSON") };
    let record = json("out.png.json");
    assert_eq!(record["terrain"], json("report.json")["terrain"]);
    (record["terrain"].clone(), result["warnings"].to_string())
}

#[test]
fn the_program_tries_techniques_until_one_shows_enough() {
    let place = place(|_, _| false);
    // Walls of 3 km that no spline bends out of the way.
    place.write("dem.asc", &ranges(|_, _| false, 2000.0, 1500.0));
    let tried = |more: &[&str]| {
        let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "64x48", "--overwrite", "--json"];
        let view = ["--eye", "8.03,46.002,3600", "--look", "8.03,46.035", "--report", "report.json"];
        place.json(&[&args[..], &view, more].concat());
        let report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("report.json"))).expect("JSON");
        report
    };
    let auto = tried(&["--technique", "auto"]);
    let all = auto["tried"].as_array().expect("a list").clone();
    assert!(all.len() >= 2 && all[0]["technique"] == "spline" && all[1]["technique"] == "both", "{all:?}");
    let share = |t: &serde_json::Value| t["visible"].as_f64().expect("a share");
    let most = all.iter().map(share).fold(0.0, f64::max);
    assert_eq!(auto["visible_bent"].as_f64().expect("a share"), most, "{all:?}");
    // Earlier ones were not enough.
    assert!(all[..all.len() - 1].iter().all(|t| share(t) < 0.99), "{all:?}");
    assert!(all.iter().all(|t| t["out_of_time"] == false && t["seconds"].as_f64().is_some()), "{all:?}");
    assert!(tried(&["--technique", "both"])["tried"].is_null());
}

#[test]
fn small_holes_are_filled_marked_and_said_or_kept() {
    let place = place(|row, col| (20..26).contains(&row) && (30..40).contains(&col));
    let count = |ground: &serde_json::Value, key: &str| ground[key].as_u64().expect("a count");
    let (filled, warnings) = ground(&place, &[]);
    assert!(count(&filled, "filled_nodes") >= 40, "{filled}");
    let share = filled["filled_share"].as_f64().expect("a share");
    assert!((share * count(&filled, "nodes") as f64 - count(&filled, "filled_nodes") as f64).abs() < 1e-6);
    assert!(warnings.contains("holes were filled"), "{warnings}");
    let (kept, warnings) = ground(&place, &["--keep-voids"]);
    assert_eq!(count(&kept, "filled_nodes"), 0);
    assert_eq!(count(&kept, "void_nodes"), count(&filled, "void_nodes") + count(&filled, "filled_nodes"));
    assert!(warnings.contains("they stay holes"), "{warnings}");
}

#[test]
fn large_holes_are_not_made_up_and_small_ones_beside_them_are() {
    let large = |row: usize, col: usize| (34..60).contains(&row) && (34..62).contains(&col);
    let alone = place(large);
    let (open, warnings) = ground(&alone, &[]);
    assert_eq!(open["filled_nodes"].as_u64(), Some(0), "{open}");
    assert!(warnings.contains("too large to be filled"), "{warnings}");
    let both = place(|row, col| large(row, col) || ((10..13).contains(&row) && (10..14).contains(&col)));
    let (mixed, warnings) = ground(&both, &[]);
    assert!(mixed["filled_nodes"].as_u64().is_some_and(|n| n > 0), "{mixed}");
    assert!(mixed["void_nodes"].as_u64() >= open["void_nodes"].as_u64(), "{mixed}");
    assert!(warnings.contains("but for a large one, which stays open"), "{warnings}");
}

#[test]
fn impossible_fields_of_view_are_refused() {
    let place = place(|_, _| false);
    for (fov, why) in [("0", "strictly between 0 and 180"), ("180", "180"), ("-5", "180"), ("nan", "give a number")] {
        let line = place.fails(&["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--fov", fov]);
        assert!(line.contains(why), "{line}");
    }
}

#[test]
fn the_palette_is_that_of_the_written_scene() {
    let place = place(|_, _| false);
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "64x48", "--scene", "out.toml"];
    place.ok(&[&args[..], &["--palette", "desert"]].concat());
    let scene = String::from_utf8(super::read(&place.path("out.toml"))).expect("UTF-8");
    assert!(scene.contains("palette = \"desert\""), "{scene}");
}

#[test]
fn what_files_leave_out_the_scene_may_say() {
    let place = place(|row, _| row == 9);
    place.write("dem.asc", &hills(|row, _| row == 9).replace("NODATA_value -9999\n", ""));
    let terrain = |more: &str| {
        let scene = format!("[[layer]]\nid = 'g'\nkind = 'terrain'\nsource = 'dem.asc'\n{more}\n");
        place.write("s.toml", &format!("{scene}[camera]\neye = [0, 0, 9000]\nlook_at = [0, 1, 9000]\n"));
    };
    terrain("source_crs = 'EPSG:4326'\nnodata = -9999");
    place.ok(&["render", "s.toml", "-o", "p.png", "--size", "8x8"]);
    let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
    assert!(record["terrain"]["void_nodes"].as_u64() >= Some(60), "{}", record["terrain"]);
    let all = format!("{}", record["warnings"]);
    assert!(!all.contains("source_crs"), "{all}");
    terrain("source_crs = '4326'");
    assert!(place.fails(&["check", "s.toml"]).contains("source_crs \"4326\" is not known; give \"EPSG:n\""));
}

#[test]
fn info_says_what_it_reads() {
    let place = Place::new();
    place.write("x.docx", "quite unlike anything");
    let said = place.fails(&["info", "x.docx"]);
    for endings in ["terrain and pictures (", ".tif, .tiff, .hgt", ".gpx, .geojson", ".nrrd, .nhdr"] {
        assert!(said.contains(endings), "{endings}: {said}");
    }
    assert!(place.fails(&["info", "none.docx"]).contains("there is no such file"));
}

#[test]
fn files_of_formats_that_are_not_read_yet_are_named() {
    let place = place(|_, _| false);
    place.write("block.parquet", "PAR1");
    place.write("survey.e57", "ASTM-E57");
    for (file, format) in [("block.parquet", "GeoParquet"), ("survey.e57", "E57")] {
        let found = place.json(&["info", file, "--json"]);
        assert_eq!((&found["files"][0]["kind"], &found["files"][0]["format"]), (&"unread".into(), &format.into()));
        assert!(found["files"][0]["note"].as_str().is_some_and(|note| note.starts_with("not read by this version")));
        let line = place.fails(&["reveal", "dem.asc", file, "-o", "out.png"]);
        assert!(line.contains(&format!("is {format} (")) && line.contains("does not read"), "{line}");
        assert!(place.fails(&["reveal", file, "way.geojson", "-o", "out.png"]).contains("does not read"), "{format}");
    }
}

#[test]
fn what_a_revealing_picture_still_hides_is_listed() {
    let place = place(|_, _| false);
    let hidden = |view: [&str; 4]| {
        let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "64x48", "--overwrite", "--json"];
        let result = place.json(&[&args[..], &view, &["--report", "report.json"]].concat());
        let report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("report.json"))).expect("JSON");
        assert_eq!(report["hidden"], result["hidden"]);
        report["hidden"].as_array().expect("a list").clone()
    };
    assert_eq!(hidden(["--eye", "8.03,46.04,9000", "--look", "8.03,46.041,1000"]).len(), 0, "from above");
    // Walls of 3 km that no spline bends out of the way.
    place.write("dem.asc", &ranges(|_, _| false, 2000.0, 1500.0));
    let low = hidden(["--eye", "8.03,46.002,3400", "--look", "8.03,46.035"]);
    assert!(!low.is_empty());
    for run in &low {
        assert_eq!((&run["layer_id"], &run["reason"]), (&"way".into(), &"covered".into()), "{run}");
        assert!(run["to_m"].as_f64() > run["from_m"].as_f64() && run["over_m"].as_f64() > Some(0.0), "{run}");
    }
}

#[test]
fn a_missed_goal_is_a_result_and_exit_1_only_when_strict() {
    let place = place(|_, _| false);
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "64x48", "--overwrite", "--json"];
    // The upper half of the way, seen from above: all of it that is in the frame, but not all of the way.
    let half = ["--eye", "8.04,46.05,2500", "--look", "8.04,46.051,1000", "--fov", "60"];
    let relaxed = place.run(&[&args[..], &half].concat());
    let strict = place.run(&[&args[..], &half, &["--strict"]].concat());
    let code = |out: &std::process::Output| out.status.code();
    assert_eq!((code(&relaxed), code(&strict)), (Some(0), Some(1)), "{}", String::from_utf8_lossy(&strict.stderr));
    let result: serde_json::Value = serde_json::from_slice(&strict.stdout).expect("JSON on standard output");
    assert_eq!(result["goal"]["result"], "missed", "{result}");
    let share = |key: &str| result[key].as_f64().expect("a share");
    assert!(share("in_frame_bent") < 0.7 && share("visible_bent") <= share("in_frame_bent"), "{result}");
    let reason = result["goal"]["reasons"][0].as_str().expect("a reason").to_owned();
    assert!(reason.contains("lies in the frame"), "{reason}");
}

#[test]
fn headline_report_and_measure_give_the_same_shares_of_the_whole() {
    let place = place(|_, _| false);
    let full = ["--eye", "8.03,46.002,1900", "--look", "8.03,46.035"];
    let part = ["--eye", "8.03,46.002,1900", "--look", "8.03,46.035", "--fov", "14"];
    for (view, technique) in [(full, "spline"), (full, "terrain"), (full, "curved_rays")]
        .map(|(view, technique)| (view.to_vec(), technique))
        .into_iter()
        .chain([(part.to_vec(), "spline"), (part.to_vec(), "terrain")])
    {
        let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "96x72", "--overwrite"];
        let more = ["--report", "r.json", "--scene", "r.toml", "--technique", technique];
        let said = place.ok(&[&args[..], &view, &more].concat());
        let report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON");
        let measured = place.json(&["measure", "r.toml", "--json"]);
        let of = |value: &serde_json::Value| value.as_f64().expect("a share");
        let [visible, in_frame] = ["visible_bent", "in_frame_bent"].map(|key| of(&report[key]));
        assert_eq!([visible, in_frame], ["visible", "in_frame"].map(|key| of(&measured[key])), "{technique}");
        assert_eq!([visible, in_frame], ["visible", "in_frame"].map(|key| of(&report["bent"][key])), "{technique}");
        assert!(visible <= in_frame, "{technique}: {visible} of {in_frame}");
        assert_eq!(place.path("out.pair.png").exists(), !report["technique"].is_null(), "{technique}");
        assert_eq!(in_frame < 0.9, view.contains(&"14"), "{technique}: {in_frame}");
        for share in ["visible_straight", "in_frame_straight", "visible_bent", "in_frame_bent"] {
            let words = format!("{:.1} %", 100.0 * of(&report[share]));
            assert!(said.contains(&words), "{technique}: {share} {words} in {said}");
        }
    }
}

/// A gentle slope that hides nothing, and a way over it.
fn slope() -> Place {
    let place = place(|_, _| false);
    place.write("dem.asc", &ranges(|_, _| false, 1000.0, 0.0));
    place
}

#[test]
fn where_nothing_is_hidden_the_answer_is_the_straight_picture_and_a_word() {
    let place = slope();
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "160x90", "--overwrite", "--strict"];
    for technique in ["spline", "terrain", "both", "curved_rays", "auto"] {
        let said =
            place.ok(&[&args[..], &["--report", "r.json", "--scene", "r.toml", "--technique", technique]].concat());
        assert!(said.contains("so nothing is bent"), "{technique}: {said}");
        let report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON");
        assert!(report["technique"].is_null() && report["displacement"].is_null(), "{technique}: {report}");
        let share = |key: &str| report[key].as_f64().expect("a share");
        assert!(share("in_frame_bent") > 0.95 && share("visible_bent") > 0.995 * share("in_frame_bent"), "{technique}");
        let scene = String::from_utf8(super::read(&place.path("r.toml"))).expect("UTF-8");
        assert!(!scene.contains("[[stage]]"), "{technique}: {scene}");
    }
    // There is no pair of two equal pictures, nor that of an earlier picture; the straight picture is written if it is asked for.
    place.write("out.pair.png", "old");
    place.ok(&[&args[..], &["--before", "before.png"]].concat());
    assert!(!place.path("out.pair.png").exists());
    let pixels = |name: &str| super::light_and_tints::pixels(&super::read(&place.path(name)));
    assert!(pixels("before.png") == pixels("out.png"));
}

#[test]
fn drafts_come_with_their_shares_and_the_command_that_makes_each() {
    let place = place(|_, _| false);
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "sheet.png", "--size", "160x90", "--drafts", "3"];
    let said = place.ok(&args);
    let lines: Vec<&str> = said.lines().collect();
    assert!((2..=3).contains(&lines.len()), "{said}");
    assert!(super::read(&place.path("sheet.png")).len() > 1000);
    for line in &lines {
        let (words, command) = line.split_once("belvedere ").expect("a command");
        assert!(words.contains("% in the frame"), "{line}");
        let mut again: Vec<&str> = command.split_whitespace().collect();
        let out = again.iter().position(|a| *a == "-o").expect("an output");
        again[out + 1] = "one.png";
        let result = place.json(&[&again[..], &["--overwrite", "--json"]].concat());
        let visible = result["visible_bent"].as_f64().expect("a share");
        let stated = words.split("visible ").nth(1).and_then(|w| w.split(' ').next()).expect("a share");
        let stated: f64 = stated.parse().expect("a number");
        assert!((stated - 100.0 * visible).abs() < 0.11, "{line}: {visible}");
    }
    let line = place.fails(&[&args[..7], &["--drafts", "0", "--overwrite"]].concat());
    assert!(line.contains("a whole number in 1..=24"), "{line}");
}

/// The camera of a picture, whatever its size.
fn camera(report: &serde_json::Value) -> [serde_json::Value; 3] {
    ["eye", "forward", "fov_y_deg"].map(|key| report["view"][key].clone())
}

#[test]
fn a_sheet_has_the_same_view_at_every_resolution() {
    let place = place(|_, _| false);
    let cameras = ["75", "150", "300"].map(|dpi| {
        let paper = ["--paper", "64x43mm", "--dpi", dpi, "--overwrite"];
        camera(&place.json(&[&["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--json"], &paper[..]].concat()))
    });
    assert!(cameras[0][0].is_array() && cameras[0][2].is_number(), "{cameras:?}");
    assert!(cameras[0] == cameras[1] && cameras[1] == cameras[2], "{cameras:?}");
}

#[test]
fn the_first_file_is_the_subject_and_later_ones_are_context() {
    let place = place(|_, _| false);
    place.write("far.geojson", "{\"type\":\"MultiPoint\",\"coordinates\":[[8.005,46.005],[8.06,46.06],[8.005,46.06]]}");
    let camera_of = |more: &[&str]| {
        let args = ["-o", "out.png", "--size", "160x90", "--overwrite", "--json"];
        let report = place.json(&[&["reveal", "dem.asc", "way.geojson"], more, &args[..]].concat());
        assert!(report["in_frame_bent"].as_f64() > Some(0.95), "{report}");
        (camera(&report), report["warnings"].to_string())
    };
    let (alone, _) = camera_of(&[]);
    let (beside, said) = camera_of(&["far.geojson"]);
    assert_eq!(alone, beside);
    assert!(said.contains("far.geojson is context"), "{said}");
}

#[test]
fn what_is_missing_beside_a_route_or_an_elevation_model_is_said() {
    let place = place(|_, _| false);
    for verb in ["reveal", "render"] {
        let line = place.fails(&[verb, "way.geojson", "-o", "out.png"]);
        assert!(line.contains("the terrain is missing") && line.contains("46.0N 8.0E the tile N46E008"), "{line}");
    }
    let line = place.fails(&["reveal", "dem.asc", "-o", "out.png"]);
    assert!(line.contains("no features are given") && line.contains("belvedere render dem.asc -o x.png"), "{line}");
    let line = place.fails(&["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--fov", "0.02"]);
    assert!(line.starts_with("belvedere: --fov:") && line.contains("10 to 90 degrees are usual"), "{line}");
}
