//! Terrain that comes in several files.

use belvedere::request::{Reveal, Stated};
use belvedere::verbs::reveal::{Setting, reveal};
use std::path::{Path, PathBuf};

const COLS: usize = 80;
const ROWS: usize = 60;

fn height(col: usize, row: usize) -> f64 {
    400.0 + 120.0 * (col as f64 / 9.0).sin() * (row as f64 / 7.0).cos()
}

/// Writes the columns of a range as a grid of its own.
fn tile(path: PathBuf, columns: std::ops::Range<usize>) -> String {
    let row = |r: usize| columns.clone().map(|c| format!("{:.3} ", height(c, r))).collect::<String>() + "\n";
    let header = format!(
        "ncols {}\nnrows {ROWS}\nxllcorner {}\nyllcorner 5000000\ncellsize 30\nNODATA_value -9999\n",
        columns.len(),
        500_000 + 30 * columns.start
    );
    std::fs::write(&path, header + &(0..ROWS).map(row).collect::<String>()).unwrap();
    path.display().to_string()
}

fn route(folder: &Path) -> String {
    let path = folder.join("route.geojson");
    let line = r#"{"type": "LineString", "crs": {"type": "name", "properties": {"name": "EPSG:32632"}},
        "coordinates": [[500300, 5000900], [501200, 5000800], [502100, 5000900]]}"#;
    std::fs::write(&path, line).unwrap();
    path.display().to_string()
}

fn revealed(data: String, features: Vec<String>) -> Result<Vec<[u8; 3]>, String> {
    let (stated, size) = (Stated::in_crs("EPSG:32632"), Some([96, 54]));
    let asked = Reveal { data, features, stated, size, ..Reveal::default() };
    reveal(&asked, &Setting::default()).map(|answer| answer.picture.frame.color).map_err(|e| e.to_string())
}

#[test]
fn tiles_named_one_by_one_or_by_their_folder_are_one_terrain() {
    let folder = tempfile::tempdir().unwrap();
    let route = route(folder.path());
    let whole = tile(folder.path().join("whole.asc"), 0..COLS);
    let tiles = folder.path().join("tiles");
    std::fs::create_dir(&tiles).unwrap();
    let west = tile(tiles.join("west.asc"), 0..40);
    let east = tile(tiles.join("east.asc"), 40..COLS);
    std::fs::write(tiles.join("readme.txt"), "tiles").unwrap();
    let one = revealed(whole, vec![route.clone()]).unwrap();
    assert!(one.iter().any(|c| c[0] > 180 && c[1] < 90), "the route is drawn");
    assert!(revealed(west, vec![east, route.clone()]).unwrap() == one);
    assert!(revealed(tiles.display().to_string(), vec![route.clone()]).unwrap() == one);
    let empty = folder.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let error = revealed(empty.display().to_string(), vec![route]).unwrap_err();
    assert!(error.contains("folder without elevation models"), "{error}");
}
