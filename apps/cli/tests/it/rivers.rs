//! `--rivers` and the key `rivers`: the ground makes way, and the rivers on it run downhill.

use super::Place;

const SIDE: usize = 48;

fn middle(row: f64) -> f64 {
    24.0 + 9.0 * (row / 6.5).sin()
}

/// A winding valley with a stream and a way along it, between lon 8.0 and 8.048.
fn place() -> Place {
    let place = Place::new();
    let mut dem = format!("ncols {SIDE}\nnrows {SIDE}\nxllcenter 8.0\nyllcenter 46.0\ncellsize 0.001\n");
    for row in 0..SIDE {
        let height = |col: usize| {
            let away = ((col as f64 - middle(row as f64)).abs() - 1.5).max(0.0);
            1000.0 - 2.0 * row as f64 + 420.0 * (1.0 - (-away / 6.0).exp())
        };
        dem += &((0..SIDE).map(|col| format!("{:.2} ", height(col))).collect::<String>() + "\n");
    }
    place.write("dem.asc", &dem);
    let line = |rows: std::ops::Range<u32>, aside: f64| {
        let at = |k: u32| [8.0 + 0.001 * (middle(f64::from(k)) + aside), 46.0 + 0.001 * (47.0 - f64::from(k))];
        let places: Vec<String> = rows.map(at).map(|[x, y]| format!("[{x:.6},{y:.6}]")).collect();
        format!("{{\"type\":\"LineString\",\"coordinates\":[{}]}}", places.join(","))
    };
    place.write("stream.geojson", &line(2..46, 0.0));
    place.write("way.geojson", &line(2..20, 2.0));
    place.write("peak.geojson", "{\"type\":\"Point\",\"coordinates\":[8.02,46.03]}");
    place
}

const VIEW: [&str; 4] = ["--eye", "8.029,46.002,1500", "--look", "8.024,46.037"];

#[test]
fn disocclude_keeps_rivers_downhill_and_reports_them() {
    let place = place();
    let run = |more: &[&str]| -> serde_json::Value {
        let args = ["disocclude", "dem.asc", "way.geojson", "-o", "out.tif", "--report", "r.json", "--overwrite"];
        place.ok(&[&args[..], &VIEW, &["--set", "solver_nodes=24"], more].concat());
        serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON")
    };
    assert!(run(&[])["rivers"].is_null());
    let kept = run(&["--rivers", "stream.geojson"]);
    for key in ["rivers", "rivers_written"] {
        let [river] = &kept[key].as_array().unwrap_or_else(|| panic!("no {key}"))[..] else { panic!("{}", kept[key]) };
        let figure = |name: &str| river[name].as_f64().unwrap_or_else(|| panic!("no {name} in {river}"));
        assert!(figure("excess_m") < 0.05, "{key}: {river}");
        assert!(figure("rise_after_m") <= figure("rise_before_m") + 0.05, "{key}: {river}");
    }
    assert_eq!(kept["layers"].as_array().map(Vec::len), Some(3), "{}", kept["layers"]);
    assert_eq!(kept["parameters"]["rivers"][0], "rivers1");
    let args = ["disocclude", "dem.asc", "way.geojson", "-o", "no.tif"];
    let line = place.fails(&[&args[..], &VIEW, &["--rivers", "peak.geojson"]].concat());
    assert!(line.contains("peak.geojson") && line.contains("no lines"), "{line}");
}

#[test]
fn reveal_takes_rivers_where_the_ground_moves() {
    let place = place();
    let common = ["reveal", "dem.asc", "way.geojson", "-o", "p.png", "--size", "160x90", "--overwrite"];
    let args = [&common[..], &VIEW, &["--rivers", "stream.geojson"]].concat();
    let line = place.fails(&args);
    assert!(line.contains("technique terrain"), "{line}");
    let more = ["--technique", "terrain", "--report", "r.json", "--scene", "s.toml"];
    place.ok(&[&args[..], &more].concat());
    let report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON");
    let rivers = report["disocclusion"]["rivers"].as_array().expect("rivers in the report");
    assert!(rivers.len() == 1 && rivers[0]["excess_m"].as_f64().is_some_and(|m| m < 0.05), "{rivers:?}");
    let scene = String::from_utf8(super::read(&place.path("s.toml"))).expect("UTF-8");
    assert!(scene.contains("rivers = [\"rivers1\"]"), "{scene}");
    place.ok(&["check", "s.toml"]);
    place.write("wrong.toml", &scene.replace("rivers = [\"rivers1\"]", "rivers = [\"rivers2\"]"));
    let line = place.fails(&["check", "wrong.toml"]);
    assert!(line.contains("\"rivers2\" is no line layer") && line.contains("did you mean \"rivers1\"?"), "{line}");
}
