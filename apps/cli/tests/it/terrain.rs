//! Terrain disocclusion as a user meets it: `disocclude`, intents in scene files, films of them, and bad input.

use super::Place;
use belvedere_testkit::data;

const SIDE: usize = 48;

const UTM_32: &str = "PROJCS[\"WGS_1984_UTM_Zone_32N\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",\
    SPHEROID[\"WGS_1984\",6378137.0,298.257223563]],PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],\
    PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"False_Easting\",500000.0],PARAMETER[\"False_Northing\",0.0],\
    PARAMETER[\"Central_Meridian\",9.0],PARAMETER[\"Scale_Factor\",0.9996],PARAMETER[\"Latitude_Of_Origin\",0.0],\
    UNIT[\"Meter\",1.0]]";

/// Rows of hills between lon 8.0 and 8.048; `height` may say none.
fn dem(height: impl Fn(usize, usize) -> Option<f64>) -> String {
    let mut text =
        format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 8.0\nyllcorner 46.0\ncellsize 0.001\nNODATA_value -9999\n");
    for row in 0..SIDE {
        let cells: Vec<String> =
            (0..SIDE).map(|col| height(row, col).map_or("-9999".into(), |h| format!("{h:.1}"))).collect();
        text += &(cells.join(" ") + "\n");
    }
    text
}

fn hills(row: usize, col: usize) -> f64 {
    1000.0 + 180.0 * (0.45 * row as f64).sin() + 40.0 * (0.3 * col as f64).sin()
}

fn place(height: impl Fn(usize, usize) -> Option<f64>) -> Place {
    let place = Place::new();
    place.write("dem.asc", &dem(height));
    let line = "{\"type\":\"LineString\",\"coordinates\":[[8.012,46.014],[8.024,46.028],[8.034,46.036]]}";
    place.write("way.geojson", line);
    place
}

/// A view over the hills from the south.
const VIEW: [&str; 4] = ["--eye", "8.022,46.002,1500", "--look", "8.024,46.03"];

fn report(place: &Place, more: &[&str]) -> serde_json::Value {
    let args = ["disocclude", "dem.asc", "way.geojson", "-o", "out.tif", "--report", "r.json", "--overwrite"];
    // These hills are so rough that limits would keep some of the way hidden.
    place.ok(&[&args[..], &VIEW, &["--no-limits"], more].concat());
    serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON")
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Heights of a raster that was written, with its no-data value, through `info`'s own reader.
fn described(place: &Place, file: &str) -> String {
    place.ok(&["info", file])
}

#[test]
fn everything_asked_for_is_visible_on_the_grid_of_the_input() {
    let holed = || place(|r, c| Some(hills(r, c)).filter(|_| !(r < 4 && c < 4)));
    let place = holed();
    let r = report(&place, &["--displacement", "d.tif", "--features-out", "moved.geojson", "--picture", "p.png"]);
    assert!(super::read(&place.path("p.png")).starts_with(b"\x89PNG") && place.path("p.png.json").exists());
    assert!(number(&r["visible_before"]) < 0.8, "the hills hide much: {r}");
    assert_eq!(number(&r["visible"]), 1.0, "{r}");
    // However steep the ground is, and however near to the way.
    let seen = |r: &serde_json::Value| number(&r["visible_dense"]);
    assert!(seen(&r) >= 0.9999 && r["unresolved"] == serde_json::json!([]), "{r}");
    assert!(!r["warnings"].to_string().contains("stays hidden"), "{}", r["warnings"]);
    // A promise is one of the file. The grid of the input, in degrees, has other samples than the ground that was solved on.
    assert_eq!(r["guaranteed"], number(&r["visible_written"]) >= 0.9999, "{r}");
    let on_solved = report(&holed(), &["--grid", "scene"]);
    assert!(seen(&on_solved) >= 0.9999 && on_solved["guaranteed"] == true, "{on_solved}");
    assert!(number(&r["raised_max_m"]) <= 0.5, "{r}");
    assert!(number(&r["rms_m"]) > 0.5);
    let kept = i32::from(number(&r["visible_written"]) < 0.995);
    for (grid, code) in [("scene", 0), ("input", kept)] {
        let strict =
            ["disocclude", "dem.asc", "way.geojson", "-o", "strict.tif", "--strict", "--no-limits", "--overwrite"];
        let strict = place.run(&[&strict[..], &VIEW, &["--grid", grid]].concat());
        assert_eq!(strict.status.code(), Some(code), "{grid}: {}", String::from_utf8_lossy(&strict.stderr));
    }
    // What is smoothed as in the paper may hide it again, and the same judge says so.
    let paper = report(&holed(), &["--mode", "paper", "--set", "w=0.05"]);
    assert!(seen(&paper) < 0.995 && paper["guaranteed"] == false, "{paper}");
    let strict = ["disocclude", "dem.asc", "way.geojson", "-o", "paper.tif", "--strict", "--mode", "paper"];
    let strict = place.run(&[&strict[..], &["--set", "w=0.05"], &VIEW].concat());
    assert_eq!(strict.status.code(), Some(1), "{}", String::from_utf8_lossy(&strict.stderr));
    for key in ["hidden_worst_m", "max_m", "normal_mean_deg", "normal_p95_deg", "step_p999_m", "smoothing_length_m"] {
        assert!(number(&r[key]) >= 0.0, "{key}");
    }
    for key in ["unresolved", "parameters", "qp", "times", "inputs", "eye"] {
        assert!(!r[key].is_null(), "{key} is missing");
    }
    for file in ["out.tif", "d.tif"] {
        let info = described(&place, file);
        assert!(info.contains("EPSG:4326") && info.contains("48"), "{file}: {info}");
        assert!(!info.to_lowercase().contains("nan"), "{info}");
    }
    let moved: serde_json::Value = serde_json::from_slice(&super::read(&place.path("moved.geojson"))).expect("JSON");
    let feature = &moved["features"][0];
    let (now, before) = (&feature["geometry"]["coordinates"], &feature["properties"]["true_coordinates"]);
    let count = now.as_array().expect("vertices").len();
    assert!(count > 10 && before.as_array().map(Vec::len) == Some(count));
    for k in 0..count {
        assert_eq!((&now[k][0], &now[k][1]), (&before[k][0], &before[k][1]), "the way moves up and down only");
        assert!(number(&now[k][2]) <= number(&before[k][2]) + 0.5);
    }
}

#[test]
fn where_nothing_is_asked_for_nothing_is_guaranteed_and_that_is_said() {
    let place = place(|r, c| Some(hills(r, c)));
    let near = report(&place, &["--set", "ahead_m=5"]);
    let away = ["disocclude", "dem.asc", "way.geojson", "-o", "away.tif", "--report", "away.json"];
    place.ok(&[&away[..], &["--eye", "8.022,46.002,1500", "--look", "8.022,45.9"]].concat());
    let away: serde_json::Value = serde_json::from_slice(&super::read(&place.path("away.json"))).expect("JSON");
    for (r, why) in [(&near, "ahead_m = 5 m"), (&away, "in the picture; the ground stays")] {
        assert_eq!((&r["asked"], &r["points"], &r["guaranteed"]), (&0.into(), &0.into(), &false.into()), "{r}");
        assert_eq!(number(&r["max_m"]), 0.0);
        let said: Vec<String> = r["warnings"].as_array().expect("a list").iter().map(ToString::to_string).collect();
        let nothing: Vec<&String> = said.iter().filter(|w| w.contains("nothing was asked for")).collect();
        assert!(nothing.len() == 1 && nothing[0].contains(why), "{said:?}");
    }
    let all = report(&place, &[]);
    assert!(number(&all["asked"]) > number(&all["points"]) && !all["warnings"].to_string().contains("nothing was"));
}

#[test]
fn figures_say_whether_they_are_of_the_picture_or_of_all_ground() {
    let place = place(|r, c| Some(hills(r, c)));
    let args = ["disocclude", "dem.asc", "way.geojson", "-o", "out.tif", "--picture", "p.png"];
    let said = place.ok(&[&args[..], &VIEW].concat());
    let all = said.split("all the ground, in the picture or not, moved by ").nth(1).expect("the sentence");
    let most: f64 = all.split_whitespace().nth(3).and_then(|n| n.parse().ok()).expect("a number");
    let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
    let shown = number(&record["displacement"]["max_m"]);
    assert!(shown > 0.0 && shown <= most + 0.1, "{shown} of {most}: {said}");
    assert!(record["note"].as_str().is_some_and(|n| n.contains("what is shown is displaced by up to")), "{record}");
}

#[test]
fn the_paper_hides_what_the_guarantee_shows() {
    let place = place(|r, c| Some(hills(r, c)));
    let paper = report(&place, &["--mode", "paper"]);
    assert_eq!(paper["guaranteed"], false);
    assert!(paper["qp"].is_null() && number(&paper["greedy"]["hits"]) > 0.0, "{paper}");
    assert!(number(&paper["visible"]) > number(&paper["visible_before"]));
    let both = report(&place, &["--mode", "paper+qp"]);
    assert_eq!(number(&both["visible"]), 1.0, "{both}");
    let qp = report(&place, &[]);
    assert!(number(&qp["rms_m"]) < number(&paper["rms_m"]), "{} and {}", qp["rms_m"], paper["rms_m"]);
    let wide = report(&place, &["--set", "w=0.05"]);
    assert!(number(&wide["smoothing_length_m"]) > number(&qp["smoothing_length_m"]));
}

#[test]
fn odd_ground_has_a_defined_result() {
    // Nothing hides anything on flat ground, so it stays as it is.
    let flat = report(&place(|_, _| Some(700.0)), &[]);
    assert_eq!((number(&flat["visible"]), number(&flat["max_m"])), (1.0, 0.0), "{flat}");
    // Four nodes are a terrain.
    let tiny = Place::new();
    tiny.write("dem.asc", "ncols 2\nnrows 2\nxllcenter 430000\nyllcenter 5100000\ncellsize 1000\n100 200\n300 400\n");
    tiny.write("dem.prj", UTM_32);
    tiny.write("way.geojson", "{\"type\":\"LineString\",\"coordinates\":[[8.0977,46.0518],[8.1054,46.0563]]}");
    let (eye, look) = ("430500,5099000,2000", "430500,5100500");
    tiny.ok(&["disocclude", "dem.asc", "way.geojson", "-o", "out.tif", "--eye", eye, "--look", look]);
    assert!(described(&tiny, "out.tif").contains("EPSG:32632"));
    // A way over a hole: what lies on the hole is cut off and said.
    let holed = place(|r, c| Some(hills(r, c)).filter(|_| !(18..24).contains(&r)));
    let out = holed.json(&[&["disocclude", "dem.asc", "way.geojson", "-o", "o.tif", "--json"][..], &VIEW].concat());
    assert!(out["warnings"].to_string().contains("cut off"), "{out}");
}

#[test]
fn bad_input_is_one_clear_line() {
    let place = place(|r, c| Some(hills(r, c)));
    let fails = |features: &str, eye: &str, look: &str, more: &[&str]| {
        let args = ["disocclude", "dem.asc", features, "-o", "out.tif", "--eye", eye, "--look", look];
        let line = place.fails(&[&args[..], more].concat());
        assert!(!place.path("out.tif").exists(), "{line}");
        line
    };
    let (eye, look) = ("8.022,46.002,1500", "8.024,46.03");
    assert!(fails("way.geojson", "8.022,46.002,900", look, &[]).contains("below the ground"));
    assert!(fails("way.geojson", "800,46.002,900", look, &[]).contains("no position in the system"));
    assert!(fails("way.geojson", eye, "8.022,46.002", &[]).contains("same point"));
    assert!(fails("way.geojson", eye, look, &["--fov", "180"]).contains("strictly between 0 and 180"));
    assert!(fails("way.geojson", eye, look, &["--set", "margn_m=2"]).contains("margin_m"));
    assert!(fails("way.geojson", eye, look, &["--set", "w"]).contains("key=value"));
    assert!(fails("way.geojson", eye, look, &["--set", "w=-1"]).contains("w is -1"));
    assert!(fails("way.geojson", eye, look, &["--set", "cells=2.5"]).contains("whole number"));
    assert!(fails("way.geojson", eye, look, &["--mode", "magic"]).contains("paper+qp"));
    place.write("far.geojson", "{\"type\":\"LineString\",\"coordinates\":[[9.0,47.0],[9.1,47.1]]}");
    assert!(fails("far.geojson", eye, look, &[]).contains("outside"));
    place.write("dot.geojson", "{\"type\":\"LineString\",\"coordinates\":[[8.02,46.02]]}");
    let dot = fails("dot.geojson", eye, look, &[]);
    assert!(dot.contains("dot.geojson"), "{dot}");
}

/// A scene of the hills in a system of metres. These are so rough that limits would keep some of the way hidden.
fn scene(more: &str) -> String {
    format!(
        "format = 1\n[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'dem.asc'\nsource_crs = 'EPSG:4326'\n\
         [[layer]]\nid = 'way'\nkind = 'line'\nsource = 'way.geojson'\nmust_see = true\n\
         [camera]\neye = {{ lon = 8.022, lat = 46.002, height_m = 1500 }}\nlook_at = {{ lon = 8.024, lat = 46.03, above_ground_m = 0 }}\nimage = [64, 36]\n\
         [[stage]]\nkind = 'terrain_disocclusion'\nlimits = false\n{more}\n"
    )
}

#[test]
fn an_intent_is_solved_and_its_picture_says_what_moved() {
    let place = place(|r, c| Some(hills(r, c)));
    place.write("s.toml", &scene(""));
    let made = place.json(&["render", "s.toml", "-o", "p.png", "--compare", "--json"]);
    assert!(made["outputs"].to_string().contains("p.delta.tif"), "{made}");
    let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
    assert!(record["note"].as_str().is_some_and(|n| n.contains("terrain_disocclusion")), "{record}");
    let stage = &record["scene"]["stage"][0];
    assert_eq!(stage["delta"], "p.delta.tif");
    assert_eq!(stage["delta_sha256"].as_str().map(str::len), Some(64));
    assert_eq!(number(&record["disocclusion"]["visible"]), 1.0);
    // The record is a scene without solver that shows the same.
    place.write("again.json", &record["scene"].to_string());
    let [x, y] = [0, 1].map(|k| number(&record["view"]["eye"][k]));
    place.write("q.json", &format!("[[{x}, {}, 1000], [{}, {}, 900]]", y + 2500.0, x + 300.0, y + 3100.0));
    let project = |scene: &str| place.json(&["project", scene, "--points", "q.json"]);
    let (first, second) = (project("s.toml"), project("again.json"));
    for k in 0..2 {
        for axis in 0..2 {
            let [a, b] = [&first, &second].map(|r| number(&r["points"][k]["pixel"][axis]));
            assert!((a - b).abs() < 1e-6, "{first} {second}");
        }
    }
    let measure = place.json(&["measure", "s.toml"]);
    let share = |which: &str| number(&measure["lines"][which]["sight"]["share"]);
    // Rays of the measure heed the ground nearer than the guard, too, and these hills are steep.
    assert!(share("bent") > share("straight") + 0.2, "{} and {}", share("straight"), share("bent"));
    assert_eq!(number(&measure["terrain"]["visible"]), 1.0);
    place.ok(&["check", "s.toml"]);
    let shown = place.ok(&["show", "s.toml"]);
    assert!(
        shown.contains("mode = \"qp\"") && shown.contains("solver_nodes = 129") && shown.contains("w = 0.3"),
        "{shown}"
    );
    place.ok(&["render", "s.toml", "-o", "straight.png", "--straight"]);
    assert!(!place.path("straight.delta.tif").exists());
    // Before any work is done, and nothing is half written.
    place.write("kept.delta.tif", "mine");
    let line = place.fails(&["render", "s.toml", "-o", "kept.png"]);
    assert!(line.contains("kept.delta.tif") && line.contains("exists"), "{line}");
    assert!(!place.path("kept.png").exists() && !place.path("kept.png.json").exists());
    place.ok(&["render", "s.toml", "-o", "kept.png", "--straight"]);
    place.write("bad.toml", &scene("rise_limit_m = -1"));
    let line = place.fails(&["check", "bad.toml"]);
    assert!(line.contains("bad.toml:") && line.contains("rise_limit_m is -1"), "{line}");
}

#[test]
fn ground_beyond_anything_plausible_is_warned_of_with_what_it_moves_for() {
    let place = place(|r, c| Some(hills(r, c)));
    // Five nodes cannot sink one ridge and not the others.
    let coarse = report(&place, &["--set", "solver_nodes=5"]);
    let warnings = coarse["warnings"].to_string();
    let relief = 440.0;
    assert!(
        number(&coarse["sunk_below_m"]) > 0.2 * relief && warnings.contains("below the lowest of the terrain"),
        "{warnings}"
    );
    assert!(number(&coarse["steepest_deg"]) > number(&coarse["steepest_before_deg"]) + 5.0, "{coarse}");
    assert!(warnings.contains("feature 0 of layer \\\"way\\\" (100 %)"), "{warnings}");
    assert_eq!(number(&coarse["costliest"][0]["share"]), 1.0);
    // From high above little has to move.
    let high = ["disocclude", "dem.asc", "way.geojson", "-o", "out.tif", "--report", "r.json", "--overwrite"];
    place.ok(&[&high[..], &["--eye", "8.022,46.002,6000", "--look", "8.024,46.03"]].concat());
    let high: serde_json::Value = serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON");
    assert!(number(&high["sunk_below_m"]) < 0.2 * relief, "{high}");
    assert!(!high["warnings"].to_string().contains("leave some out"), "{}", high["warnings"]);
}

#[test]
fn what_runs_out_of_time_says_so_and_promises_nothing() {
    let place = place(|r, c| Some(hills(r, c)));
    let short = report(&place, &["--time-limit", "0.000001"]);
    assert!(short["out_of_time"] == true && short["guaranteed"] == false, "{short}");
    assert!(number(&short["visible_dense"]) >= number(&short["visible_dense_before"]), "{short}");
    assert!(short["warnings"].to_string().contains("out of time"), "{}", short["warnings"]);
    let enough = report(&place, &["--time-limit", "600", "--grid", "scene"]);
    assert!(enough["out_of_time"] == false && enough["guaranteed"] == true, "{enough}");
}

#[test]
fn what_resampling_hides_again_is_said_and_another_grid_keeps_it() {
    // A geographic grid: heights are solved on squares in metres, and written back.
    let place = place(|r, c| Some(hills(r, c)));
    let input = report(&place, &[]);
    assert_eq!(input["grid"], "input");
    let share = number(&input["visible_written"]);
    assert!((0.3..=1.0).contains(&share), "{share}");
    let solved = number(&input["visible_dense"]);
    let said = input["warnings"].to_string().contains("written on the grid of the input");
    assert_eq!(solved - share > 1e-4, said, "{input}");
    assert_eq!(input["guaranteed"], share >= 0.9999, "no promise that the file does not keep: {input}");
    // The figure that is printed is that of the file.
    let args = ["disocclude", "dem.asc", "way.geojson", "-o", "out.tif", "--overwrite", "--no-limits"];
    let printed = place.ok(&[&args[..], &VIEW].concat());
    assert!(printed.contains(&format!("{:.1} % after", 100.0 * share.min(solved))), "{printed}: {share}");
    let scene = report(&place, &["--grid", "scene"]);
    assert!(scene["grid"] == "scene" && scene["visible_written"].is_null(), "{scene}");
    assert_eq!(scene["guaranteed"], true);
    // What was promised holds in the file: nothing of the way is hidden on its heights.
    place.write(
        "again.toml",
        "format = 1\n[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'out.tif'\n\
         [[layer]]\nid = 'way'\nkind = 'line'\nsource = 'way.geojson'\nmust_see = true\n\
         [camera]\neye = { lon = 8.022, lat = 46.002, height_m = 1500 }\n\
         look_at = { lon = 8.024, lat = 46.03, above_ground_m = 0 }\nfov_y_deg = 60\nimage = [64, 36]\n",
    );
    let measured = place.json(&["measure", "again.toml"]);
    assert!(number(&measured["lines"]["straight"]["sight"]["share"]) >= 0.995, "{}", measured["lines"]);
}

#[test]
fn a_film_of_giving_ground_goes_on_to_the_same_bytes() {
    let place = place(|r, c| Some(hills(r, c)));
    let animation = "[animation]\nalong = 'way'\nbehind_m = 900\nabove_m = 300\nahead_m = 900\nspeed_mps = 400\nfps = 10\nframes = 4\n";
    place.write("s.toml", &(scene("gamma_time_s = 0.15") + animation));
    place.ok(&["animate", "s.toml", "-o", "whole"]);
    place.ok(&["animate", "s.toml", "-o", "part"]);
    // Frame 2 depends on what frames 0 and 1 left in the solver's memory.
    std::fs::remove_file(place.path("part/frame_00002.png")).expect("removed");
    let made = place.json(&["animate", "s.toml", "-o", "part", "--resume", "--json"]);
    assert_eq!(made["drawn"], 1);
    for file in ["animation.json", "frame_00001.png", "frame_00002.png", "frame_00003.png"] {
        assert_eq!(
            super::read(&place.path(&format!("whole/{file}"))),
            super::read(&place.path(&format!("part/{file}"))),
            "{file}"
        );
    }
    let record: serde_json::Value =
        serde_json::from_slice(&super::read(&place.path("whole/animation.json"))).expect("JSON");
    for frame in 0..4 {
        let terrain = &record["frames"][frame]["terrain"];
        assert_eq!(number(&terrain["visible"]), 1.0, "frame {frame}: {record}");
        // Films are not solved again for what lies between two candidates.
        let seen = number(&terrain["visible_dense"]);
        assert_eq!(terrain["guaranteed"], seen >= 0.9999, "frame {frame}: {record}");
        assert!(terrain["unresolved"] == 0 && seen > 0.9, "frame {frame}: {record}");
    }
}

#[test]
fn andorra_is_shown_with_a_progressive_bend_and_terrain() {
    let Some(readme) = data("README.md") else { return };
    let root = readme.parent().and_then(|p| p.to_str()).expect("folder");
    let scene = belvedere_testkit::workspace_root().join("scenes/andorra_terrain.toml");
    let report = Place::new().json(&["measure", scene.to_str().expect("UTF-8"), "--allow-root", root]);
    let share = number(&report["lines"]["bent"]["sight"]["share"]);
    assert!(share >= 0.99, "{share} of the in-frame length is visible: {}", report["terrain"]);
}

#[test]
fn a_straight_picture_asks_nothing_of_the_ground() {
    let place = place(|r, c| Some(hills(r, c)));
    place.write("s.toml", &scene("rise_limit_m = 0\nslack_price = 0.01"));
    let record = |more: &[&str]| -> serde_json::Value {
        place.ok(&[&["render", "s.toml", "-o", "p.png", "--overwrite"][..], more].concat());
        serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON")
    };
    // What the solver has to say about the ground.
    let bent = record(&[]);
    assert!(bent["warnings"].to_string().contains("under `covered`"), "{}", bent["warnings"]);
    let straight = record(&["--straight"]);
    assert!(!straight["warnings"].to_string().contains("stays hidden"), "{straight}");
    assert!(straight["disocclusion"].is_null() && straight["stages"] == serde_json::json!([]), "{straight}");
}

/// The record of the solver beside a picture of the hills.
fn solved(more: &str) -> (serde_json::Value, Vec<u8>) {
    let place = place(|r, c| Some(hills(r, c)));
    place.write("s.toml", &scene(&format!("solver_nodes = 33\n{more}")).replace("[64, 36]", "[160, 90]"));
    place.ok(&["render", "s.toml", "-o", "p.png"]);
    let record = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
    (record, super::read(&place.path("p.png")))
}

#[test]
fn a_slider_goes_from_moving_the_camera_to_moving_the_ground() {
    let run = |more: &str| {
        let record = solved(more).0;
        let eye = [0, 1, 2].map(|k| number(&record["view"]["eye"][k]));
        (eye, number(&record["disocclusion"]["rms_m"]), number(&record["disocclusion"]["visible"]))
    };
    let [stays, half, free] = ["adjust_viewpoint = 1.0", "adjust_viewpoint = 0.5", "adjust_viewpoint = 0.0"].map(run);
    assert_eq!(run("").0, stays.0);
    assert!(half.0 != stays.0 && half.1 < stays.1 && free.1 < 0.8 * half.1, "{stays:?} {half:?} {free:?}");
    assert!([stays, half, free].iter().all(|r| r.2 == 1.0));
    let place = place(|r, c| Some(hills(r, c)));
    place.write("s.toml", &scene("adjust_viewpoint = 1.5"));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("adjust_viewpoint is 1.5"), "{line}");
}

#[test]
fn at_a_price_ground_stays_and_is_drawn_see_through() {
    let (hard, _) = solved("");
    let (soft, picture) = solved("slack_price = 0.01");
    let of = |r: &serde_json::Value, key: &str| number(&r["disocclusion"][key]);
    assert!(of(&soft, "rms_m") < 0.95 * of(&hard, "rms_m"), "{} {}", of(&soft, "rms_m"), of(&hard, "rms_m"));
    assert!(of(&soft, "visible") < 1.0 && soft["disocclusion"]["guaranteed"] == false);
    assert!(hard["disocclusion"]["covered"].is_null());
    let covered = soft["disocclusion"]["covered"].as_array().expect("covered places");
    assert!(!covered.is_empty() && covered.iter().all(|c| number(&c["over_m"]) > 0.0));
    // The same ground from its solved grid is solid.
    let place = place(|r, c| Some(hills(r, c)));
    place.write("s.toml", &scene("solver_nodes = 33\nslack_price = 0.01").replace("[64, 36]", "[160, 90]"));
    place.ok(&["render", "s.toml", "-o", "p.png"]);
    // The records name the folders, which differ.
    let again = super::light_and_tints::pixels(&super::read(&place.path("p.png")));
    assert!(again == super::light_and_tints::pixels(&picture), "same scene, same pixels");
    let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
    place.write("solid.json", &record["scene"].to_string());
    place.ok(&["render", "solid.json", "-o", "solid.png"]);
    let solid = super::light_and_tints::pixels(&super::read(&place.path("solid.png")));
    assert!(solid != super::light_and_tints::pixels(&picture), "nothing shows through");
}

#[test]
fn what_lies_beyond_the_distance_ahead_is_not_asked_for() {
    let near = solved("ahead_m = 2500").0;
    let all = solved("").0;
    let of = |r: &serde_json::Value, key: &str| number(&r["disocclusion"][key]);
    assert!(of(&near, "points") < 0.6 * of(&all, "points") && of(&near, "rms_m") < of(&all, "rms_m"));
    assert_eq!(of(&near, "visible"), 1.0);
}

#[test]
fn the_demo_finds_a_displacement_in_its_way_before_it_draws() {
    let place = Place::new();
    std::fs::create_dir(place.path("demo")).expect("folder");
    place.write("demo/massif_terrain.delta.tif", "mine");
    let line = place.fails(&["demo", "-o", "demo"]);
    assert!(line.contains("massif_terrain.delta.tif") && !place.path("demo/massif.png").exists(), "{line}");
}

#[test]
fn areas_and_points_are_written_on_the_ground_that_makes_way_for_them() {
    let place = place(|r, c| Some(hills(r, c)));
    // In the valley behind the third row of hills; the node of row 24 and column 24 lies at 8.0245, 46.0235.
    let square = [[8.020, 46.022], [8.028, 46.022], [8.028, 46.025], [8.020, 46.025], [8.020, 46.022]];
    let area = serde_json::json!({ "type": "Polygon", "coordinates": [square] });
    let hut = serde_json::json!({ "type": "Feature", "properties": { "name": "Hut" },
        "geometry": { "type": "Point", "coordinates": [8.0245, 46.0235] } });
    place.write("meadow.geojson", &area.to_string());
    place.write("hut.geojson", &hut.to_string());
    let args =
        ["disocclude", "dem.asc", "meadow.geojson", "hut.geojson", "-o", "out.tif", "--features-out", "moved.geojson"];
    place.ok(&[&args[..], &VIEW].concat());
    let moved: serde_json::Value = serde_json::from_slice(&super::read(&place.path("moved.geojson"))).expect("JSON");
    let of = |kind: &str| {
        let all = moved["features"].as_array().expect("a list");
        let mut found = all.iter().filter(|f| f["geometry"]["type"] == kind);
        let first = found.next().unwrap_or_else(|| panic!("no {kind} in {moved}"));
        assert!(found.next().is_none(), "one {kind}");
        (first["geometry"]["coordinates"].clone(), first["properties"].clone())
    };
    let lowered = |now: &serde_json::Value, before: &serde_json::Value, at: [f64; 2]| {
        for k in 0..2 {
            assert_eq!(now[k], before[k], "moved up and down only");
            assert!((number(&now[k]) - at[k]).abs() < 1e-6, "{now}");
        }
        number(&before[2]) - number(&now[2])
    };
    let (now, tags) = of("Point");
    assert_eq!(tags["name"], "Hut");
    let before = &tags["true_coordinates"];
    assert!((number(&before[2]) - hills(24, 24)).abs() < 15.0, "{before}: on the ground");
    assert!(lowered(&now, before, [8.0245, 46.0235]) > -0.5);
    let (now, tags) = of("Polygon");
    let ring = now[0].as_array().expect("a ring");
    assert!(ring.len() == 5 && ring[0] == ring[4] && now.as_array().map(Vec::len) == Some(1), "{now}");
    for vertex in ring {
        let near = |c: &&[f64; 2]| (0..2).all(|k| (number(&vertex[k]) - c[k]).abs() < 1e-6);
        let corner = square.iter().find(near).unwrap_or_else(|| panic!("{vertex} is no corner"));
        let k = ring.iter().position(|v| v == vertex).expect("there");
        assert!(lowered(vertex, &tags["true_coordinates"][0][k], *corner) > -0.5, "{vertex}");
    }
}

#[test]
#[ignore = "long; .ci/long runs it"]
fn the_eye_moves_where_it_may_and_that_is_said() {
    let place = place(|r, c| Some(hills(r, c)));
    let still = report(&place, &["--set", "adjust_viewpoint=1"]);
    assert!(still["adjusted_eye"].is_null() && !still["warnings"].to_string().contains("moved the eye"), "{still}");
    let moved = report(&place, &["--set", "adjust_viewpoint=0.2"]);
    assert!(moved["adjusted_eye"][2].is_f64() && moved["warnings"].to_string().contains("moved the eye by"), "{moved}");
    assert!(number(&moved["rms_m"]) < number(&still["rms_m"]), "less ground has to move: {moved} {still}");
    let wrong = ["disocclude", "dem.asc", "way.geojson", "-o", "no.tif", "--set", "adjust_viewpoint=2"];
    let line = place.fails(&[&wrong[..], &VIEW].concat());
    assert!(line.contains("adjust_viewpoint is 2"), "{line}");
}

#[test]
fn holes_are_filled_in_what_is_written_where_that_is_asked_for() {
    let place = place(|r, c| Some(hills(r, c)).filter(|_| !((30..32).contains(&r) && (8..10).contains(&c))));
    let voids = |more: &[&str]| {
        report(&place, more);
        number(&place.json(&["info", "out.tif", "--json"])["files"][0]["void_share"])
    };
    let (open, filled) = (voids(&[]), voids(&["--fill-voids"]));
    assert!(open > filled, "{open} {filled}");
}

#[test]
fn a_spike_is_said_and_not_dug_round() {
    let spiked = place(|r, c| Some(hills(r, c) + if (r, c) == (38, 20) { 2500.0 } else { 0.0 }));
    let [spiked, plain] = [spiked, place(|r, c| Some(hills(r, c)))].map(|place| {
        let solved = report(&place, &["--grid", "scene"]);
        let reveal =
            ["reveal", "dem.asc", "way.geojson", "--technique", "terrain", "-o", "p.png", "--report", "v.json"];
        place.ok(&[&reveal[..], &VIEW, &["--size", "64x36"]].concat());
        let revealed: serde_json::Value = serde_json::from_slice(&super::read(&place.path("v.json"))).expect("JSON");
        (solved, revealed["scene_warnings"].to_string())
    });
    assert!(plain.0["spikes"].is_null() && !plain.1.contains("from all neighbours"), "{}", plain.0);
    // The file's sample is spread over up to four nodes of the grid in metres.
    assert!(spiked.0["spikes"].as_array().is_some_and(|s| (1..=4).contains(&s.len())), "{}", spiked.0);
    let ground = |r: &serde_json::Value| number(&r["max_m"]);
    assert!(ground(&spiked.0) < 0.3 * 2500.0 + ground(&plain.0), "{} {}", spiked.0, plain.0);
    assert!(spiked.0["warnings"].to_string().contains("far from all neighbours"), "{}", spiked.0);
    // What the solver has to say is passed on.
    assert!(spiked.1.contains("far from all neighbours"), "{}", spiked.1);
}

#[test]
fn straight_films_solve_nothing() {
    let place = place(|r, c| Some(hills(r, c)));
    let animation = "[animation]\nalong = 'way'\nframes = 2\n";
    place.write("s.toml", &(scene("") + animation));
    let solved = |name: &str, more: &[&str]| {
        place.ok(&[&["animate", "s.toml", "-o", name][..], more].concat());
        let record = super::read(&place.path(&format!("{name}/animation.json")));
        let record: serde_json::Value = serde_json::from_slice(&record).expect("JSON");
        !record["frames"][1]["terrain"].is_null()
    };
    assert!(solved("bent", &[]));
    assert!(!solved("straight", &["--straight"]));
}

#[test]
fn shares_of_disocclusion_are_of_the_whole_way_and_looking_away_shows_nothing() {
    let place = place(|r, c| Some(hills(r, c)));
    let run = |look: &str, fov: &str, more: &[&str]| {
        let args = ["disocclude", "dem.asc", "way.geojson", "-o", "out.tif", "--report", "r.json", "--overwrite"];
        let view = ["--eye", "8.022,46.002,1500", "--look", look, "--fov", fov, "--no-limits", "--grid", "scene"];
        let out = place.run(&[&args[..], &view, more].concat());
        let report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON");
        let shares = ["visible_whole_before", "visible_whole", "in_view"].map(|key| number(&report[key]));
        (shares, String::from_utf8_lossy(&out.stdout).into_owned(), out.status.code())
    };
    let (shares, said, code) = run("8.022,45.99", "60", &["--strict"]);
    assert_eq!((shares, code), ([0.0; 3], Some(1)), "{said}");
    assert!(said.contains("0.0 % before, 0.0 % after, 0.0 % of them in view"), "{said}");
    let ([before, after, inside], said, code) = run("8.024,46.03", "90", &["--strict"]);
    assert!(before < after && after > 0.99 && inside > 0.999 && code == Some(0), "{before} {after} {inside} {said}");
    // A narrow picture that holds a part of the way.
    let ([_, after, inside], said, code) = run("8.032,46.034", "8", &["--strict"]);
    assert!(after <= inside && (0.02..0.8).contains(&inside) && code == Some(1), "{after} {inside} {said}");
}
