//! On the grid that is written the sea stays where it is, and no land sinks below it.

use belvedere::OpenOptions;
use belvedere::io::TerrainRequest;
use belvedere::io::terrain::load_original;
use belvedere::request::{Disocclude, read};
use belvedere::scene::Progress;
use belvedere::verbs::disocclude::{DisoccludeFiles, disocclude};
use serde_json::json;

const SIDE: usize = 90;
const STEP: f64 = 0.0006;

/// Hills that fall into a sea in the south.
fn height(i: usize) -> f64 {
    let [x, y] = [i % SIDE, i / SIDE].map(|k| k as f64 / SIDE as f64);
    let hills = 240.0 + 140.0 * (9.0 * x + 3.0 * y).sin() * (11.0 * y).cos() + 60.0 * (31.0 * x).sin();
    (hills * (1.0 - 1.7 * y)).max(0.0)
}

/// Longitude and latitude of a node.
fn place([col, row]: [f64; 2]) -> [f64; 2] {
    [14.0 + STEP * (col + 0.5), 46.0 + STEP * (SIDE as f64 - row - 0.5)]
}

#[test]
fn the_sea_stays_on_the_grid_of_the_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let [dem, way, out] = ["dem.asc", "way.geojson", "out.tif"].map(|name| folder.path().join(name));
    let before: Vec<f64> = (0..SIDE * SIDE).map(height).collect();
    let mut grid = format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 14\nyllcorner 46\ncellsize {STEP}\n");
    for row in before.chunks(SIDE) {
        grid += &(row.iter().map(|h| format!("{h:.3}")).collect::<Vec<_>>().join(" ") + "\n");
    }
    std::fs::write(&dem, grid).expect("a file");
    let places: Vec<[f64; 2]> =
        (0..30).map(|k| place([5.0 + 2.6 * f64::from(k), 30.0 + 6.0 * f64::from(k).sin()])).collect();
    std::fs::write(&way, json!({ "type": "LineString", "coordinates": places }).to_string()).expect("a file");
    let text = |[x, y]: [f64; 2], z: &str| format!("{x},{y}{z}");
    let [eye, look] = [[44.0, 86.0], [44.0, 20.0]].map(place);
    let asked = json!({ "data": dem.display().to_string(), "features": [way.display().to_string()], "source_crs": "EPSG:4326",
        "eye": text(eye, ",60"), "look": text(look, ""), "fov": 90, "show": 1.0 });
    let asked: Disocclude = read(&asked.to_string()).expect("a request");
    let found = disocclude(&asked, &OpenOptions::default()).expect("a solution");
    found
        .write(&DisoccludeFiles { out: out.clone(), ..DisoccludeFiles::default() }, true, &Progress::silent())
        .expect("a file");
    let written = load_original(&out, &TerrainRequest::default(), &Progress::silent()).expect("heights").value;
    let after: Vec<f64> = written.heights().map(|h| f64::from(h.expect("no holes"))).collect();
    let (mut sea, mut moved) = (0, 0.0f64);
    for (h, z) in before.iter().zip(&after) {
        assert!(if *h == 0.0 { *z == 0.0 } else { *z > -1e-3 }, "{h} became {z}");
        (sea, moved) = (sea + usize::from(*h == 0.0), moved.max((h - z).abs()));
    }
    let [straight, bent] = found.shares().map(|s| s.visible);
    assert!(sea > 1000 && moved > 20.0 && bent > straight + 0.2, "{sea} nodes of sea, {moved} m, {straight} {bent}");
}
