//! What a written file shows to programs that cut its cells by the other diagonal.

use belvedere::OpenOptions;
use belvedere::io::TerrainRequest;
use belvedere::io::terrain::load_original;
use belvedere::request::{Disocclude, read};
use belvedere::scene::Progress;
use belvedere::verbs::disocclude::{DisoccludeFiles, disocclude};
use belvedere_testkit::Random;
use serde_json::{Value, json};
use std::path::Path;

const CELLS: usize = 60;
const STEP: f64 = 60.0;

/// A place east and north of the corner, or its mirror image.
fn place([x, y]: [f64; 2], mirrored: bool) -> [f64; 2] {
    [500_000.0 + if mirrored { CELLS as f64 * STEP - x } else { x }, 5_000_000.0 + y]
}

/// Solves for a way over rough heights, row by row from the north; the answer, and the written heights.
fn solved(folder: &Path, heights: &[f64], (mirrored, robust): (bool, &str)) -> (Value, Vec<f64>) {
    let mut grid = format!("ncols {CELLS}\nnrows {CELLS}\nxllcorner 500000\nyllcorner 5000000\ncellsize {STEP}\n");
    for row in heights.chunks(CELLS) {
        grid += &(row.iter().map(|h| format!("{h:.6}")).collect::<Vec<_>>().join(" ") + "\n");
    }
    let way = [[400.0, 2500.0], [1700.0, 2900.0], [3200.0, 2450.0]].map(|p| place(p, mirrored));
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32632" } });
    let way = json!({ "type": "FeatureCollection", "crs": crs, "features": [{ "type": "Feature", "properties": {},
        "geometry": { "type": "LineString", "coordinates": way } }] });
    let [dem, features, out] = ["dem.asc", "way.geojson", "out.tif"].map(|name| folder.join(name));
    std::fs::write(&dem, grid).expect("a file");
    std::fs::write(&features, way.to_string()).expect("a file");
    let text = |[x, y]: [f64; 2], z: &str| format!("{x},{y}{z}");
    let [eye, look] = [[1900.0, 200.0], [1850.0, 2600.0]].map(|p| place(p, mirrored));
    let asked = json!({ "data": dem.display().to_string(), "features": [features.display().to_string()],
        "source_crs": "EPSG:32632", "eye": text(eye, ",420"), "look": text(look, ""), "fov": 90, "robust": robust, "show": 1.0, "set": ["solver_nodes=30"] });
    let asked: Disocclude = read(&asked.to_string()).expect("a request");
    let found = disocclude(&asked, &OpenOptions::default()).expect("a solution");
    let files = DisoccludeFiles { out: out.clone(), ..DisoccludeFiles::default() };
    found.write(&files, true, &Progress::silent()).expect("a file");
    let written = load_original(&out, &TerrainRequest::default(), &Progress::silent()).expect("heights").value;
    let written = written.heights().map(|h| f64::from(h.expect("no holes"))).collect();
    (serde_json::to_value(found.document()).expect("an answer"), written)
}

fn rough_heights() -> Vec<f64> {
    let mut random = Random::new(7);
    let height = |i: usize| {
        let [x, y] = [i % CELLS, i / CELLS].map(|k| k as f64 / 7.0);
        200.0 + 90.0 * (x + y.sin()).sin().abs() + 60.0 * (1.3 * y).cos().abs() + random.range(0.0, 25.0)
    };
    (0..CELLS * CELLS).map(height).collect()
}

fn share(answer: &Value, key: &str) -> f64 {
    answer[key].as_f64().expect("a number")
}

#[test]
fn both_diagonals_show_all_where_that_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let [never, auto, always] =
        ["never", "auto", "always"].map(|robust| solved(folder.path(), &rough_heights(), (false, robust)).0);
    for answer in [&never, &auto, &always] {
        assert!(share(answer, "visible_dense") > 0.995 && answer["guaranteed"] == true);
    }
    assert!(share(&always, "visible_other_diagonal") > 0.995, "{}", always["visible_other_diagonal"]);
    assert!(share(&auto, "visible_other_diagonal") > share(&never, "visible_other_diagonal") + 0.002);
    assert!(share(&auto, "rms_m") < 1.31 * share(&never, "rms_m"));
}

#[test]
fn the_other_diagonal_is_that_of_the_mirrored_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let heights = rough_heights();
    let (answer, written) = solved(folder.path(), &heights, (false, "never"));
    let (own, other) = (share(&answer, "visible_dense"), share(&answer, "visible_other_diagonal"));
    assert!(own > 0.995 && other < own - 0.002, "{own} {other}");
    let mirrored: Vec<f64> = written.chunks(CELLS).flat_map(|row| row.iter().rev().copied()).collect();
    let (answer, _) = solved(folder.path(), &mirrored, (true, "never"));
    let before = share(&answer, "visible_dense_before");
    assert!((before - other).abs() < 0.002, "{before} of the mirrored file, {other}");
}
