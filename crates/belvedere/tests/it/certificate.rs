//! What a certificate claims holds over the samples of the file, and over no other file.

use belvedere::OpenOptions;
use belvedere::io::TerrainRequest;
use belvedere::io::terrain::load_original;
use belvedere::request::{Disocclude, read};
use belvedere::scene::Progress;
use belvedere::verbs::disocclude::{DisoccludeFiles, disocclude};
use serde_json::{Value, json};

const SIDE: usize = 80;
const STEP: f64 = 0.0009;

fn height(i: usize) -> f64 {
    let [x, y] = [i % SIDE, i / SIDE].map(|k| k as f64 / 9.0);
    300.0 + 120.0 * (x + (1.1 * y).sin()).sin().abs() + 70.0 * (1.3 * y).cos()
}

/// Longitude and latitude of a node.
fn place([col, row]: [f64; 2]) -> [f64; 2] {
    [10.0 + STEP * (col + 0.5), 47.0 + STEP * (SIDE as f64 - row - 0.5)]
}

/// Height of flat triangles, cut from north-west to south-east; `None` beside the samples.
fn surface(z: &[f64], [col, row]: [f64; 2]) -> Option<f64> {
    let last = (SIDE - 1) as f64;
    if !(0.0..=last).contains(&col) || !(0.0..=last).contains(&row) {
        return None;
    }
    let [c, r] = [col, row].map(|v| (v as usize).min(SIDE - 2));
    let [u, v] = [col - c as f64, row - r as f64];
    let at = |dc: usize, dr: usize| z[(r + dr) * SIDE + c + dc];
    let (east, south) =
        if u > v { (at(1, 0) - at(0, 0), at(1, 1) - at(1, 0)) } else { (at(1, 1) - at(0, 1), at(0, 1) - at(0, 0)) };
    Some(at(0, 0) + u * east + v * south)
}

/// Share of the lines' amounts over which the ground rises nowhere, by many places along each.
fn clear(certificate: &Value, z: &[f64]) -> f64 {
    let (mut seen, mut all) = (0.0, 0.0);
    for line in certificate["lines"].as_array().expect("lines") {
        let chain: Vec<[f64; 3]> = serde_json::from_value(line["line"].clone()).expect("places");
        let amount = line["amount"].as_f64().expect("an amount");
        let hides = |a: [f64; 3], b: [f64; 3]| {
            let steps = 1 + (10.0 * (b[0] - a[0]).hypot(b[1] - a[1])) as usize;
            (0..=steps).any(|k| {
                let t = k as f64 / steps as f64;
                let [col, row, height] = [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]));
                surface(z, [col, row]).is_some_and(|ground| ground > height + 0.011)
            })
        };
        let is_clear = !chain.windows(2).any(|pair| hides(pair[0], pair[1]));
        (seen, all) = (seen + if is_clear { amount } else { 0.0 }, all + amount);
    }
    seen / all
}

#[test]
fn what_is_claimed_holds_over_the_file_and_over_no_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let [dem, way, out, lines] =
        ["dem.asc", "way.geojson", "out.tif", "lines.json"].map(|name| folder.path().join(name));
    let before: Vec<f64> = (0..SIDE * SIDE).map(height).collect();
    let mut grid = format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 10\nyllcorner 47\ncellsize {STEP}\n");
    for row in before.chunks(SIDE) {
        grid += &(row.iter().map(|h| format!("{h:.3}")).collect::<Vec<_>>().join(" ") + "\n");
    }
    std::fs::write(&dem, grid).expect("a file");
    let places: Vec<[f64; 2]> =
        (0..40).map(|k| place([10.0 + 1.5 * f64::from(k), 20.0 + 5.0 * (0.4 * f64::from(k)).sin()])).collect();
    std::fs::write(&way, json!({ "type": "LineString", "coordinates": places }).to_string()).expect("a file");
    let text = |[x, y]: [f64; 2], z: &str| format!("{x},{y}{z}");
    for (curved, show) in [(false, 1.0), (true, 0.8)] {
        let asked = json!({ "data": dem.display().to_string(), "features": [way.display().to_string()], "source_crs": "EPSG:4326",
            "eye": text(place([39.0, 78.0]), ",560"), "look": text(place([39.0, 20.0]), ""), "fov": 90, "show": show, "curved_earth": curved });
        let asked: Disocclude = read(&asked.to_string()).expect("a request");
        let found = disocclude(&asked, &OpenOptions::default()).expect("a solution");
        let files =
            DisoccludeFiles { out: out.clone(), certificate: Some(lines.clone()), ..DisoccludeFiles::default() };
        found.write(&files, true, &Progress::silent()).expect("files");
        let text = std::fs::read_to_string(&lines).expect("a certificate");
        let certificate: Value = serde_json::from_str(&text).expect("JSON");
        let claimed = certificate["visible_share"].as_f64().expect("a share");
        let written = load_original(&out, &TerrainRequest::default(), &Progress::silent()).expect("heights").value;
        let after: Vec<f64> = written.heights().map(|h| f64::from(h.expect("no holes"))).collect();
        let count = certificate["lines"].as_array().map_or(0, Vec::len);
        assert!((200..=5000).contains(&count) && certificate["samples"] == json!([SIDE, SIDE]), "{count} lines");
        let (is, was) = (clear(&certificate, &after), clear(&certificate, &before));
        assert!((is - claimed).abs() < 0.005 && claimed > 0.75, "{curved}: {is}, claimed {claimed}");
        assert!(was < claimed - 0.2, "{was} over the file as it was");
    }
}
