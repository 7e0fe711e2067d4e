//! `--time-limit` is one for the whole command, and what it ends with is no worse than ground that does not move.

use super::Place;
use std::fmt::Write;
use std::time::{Duration, Instant};

const SIDE: usize = 360;

/// Rough ground in metres, with a long way over it.
fn place() -> Place {
    let place = Place::new();
    let mut text =
        format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 500000\nyllcorner 5100000\ncellsize 30\nNODATA_value -9999\n");
    for row in 0..SIDE {
        for col in 0..SIDE {
            let (x, y) = (col as f64, row as f64);
            let ridges = (0.11 * x + 0.8 * (0.05 * y).sin()).sin() + (0.13 * y + 1.1 * (0.04 * x).cos()).sin();
            let bumps = (0.41 * x + 0.37 * y).sin() * (0.29 * x - 0.5 * y).cos();
            let _ = write!(text, "{:.2} ", 1500.0 + 180.0 * ridges + 30.0 * bumps);
        }
        text.push('\n');
    }
    place.write("dem.asc", &text);
    let ways = (0..8).map(|k| {
        let points: Vec<String> = (0..60)
            .map(|i| {
                let (t, k) = (f64::from(i) / 59.0, f64::from(k));
                let (x, y) = (500_600.0 + 9600.0 * t, 5_102_500.0 + 900.0 * k + 500.0 * (9.0 * t + k).sin());
                format!("[{x:.1},{y:.1}]")
            })
            .collect();
        let line = format!("{{\"type\":\"LineString\",\"coordinates\":[{}]}}", points.join(","));
        format!("{{\"type\":\"Feature\",\"properties\":{{}},\"geometry\":{line}}}")
    });
    let all = ways.collect::<Vec<_>>().join(",");
    place.write("ways.geojson", &format!("{{\"type\":\"FeatureCollection\",\"features\":[{all}]}}"));
    place
}

fn timed(place: &Place, verb: &[&str], limit: &str) -> Duration {
    let view = ["--eye", "505400,5100300,2050", "--look", "505400,5106000", "--overwrite", "--report", "r.json"];
    let began = Instant::now();
    place.ok(&[verb, &view, &["--time-limit", limit]].concat());
    began.elapsed()
}

#[test]
fn a_limit_of_time_is_one_for_the_whole_command_and_ends_with_no_less_than_there_was() {
    let place = place();
    let reveal = ["reveal", "dem.asc", "ways.geojson", "--technique", "terrain", "-o", "p.png", "--size", "320x180"];
    let disocclude = ["disocclude", "dem.asc", "ways.geojson", "-o", "out.tif"];
    for verb in [&reveal[..], &disocclude] {
        // What reading, judging, drawing and writing take at least, on a machine that may have other things to do.
        let rest = timed(&place, verb, "0.001");
        let limit = 1.5;
        let took = timed(&place, verb, "1.5");
        assert!(took <= Duration::from_secs_f64(1.5 * limit) + 2 * rest, "{verb:?}: {took:?}, with no time {rest:?}");
        let report: serde_json::Value = serde_json::from_slice(&super::read(&place.path("r.json"))).expect("JSON");
        let figures = report.get("disocclusion").unwrap_or(&report);
        let share = |key: &str| figures[key].as_f64().unwrap_or_else(|| panic!("{key} of {figures}"));
        assert!(share("visible_dense") >= share("visible_dense_before") - 1e-9, "{figures}");
        assert!(figures["out_of_time"] == false || figures["taken"]["ground"].is_string(), "{figures}");
        assert!(figures["out_of_time"] == false || figures["guaranteed"] == false, "{figures}");
    }
}
