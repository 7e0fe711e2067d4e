//! Rivers run downhill on the heights that `disocclude` writes, also on other grids than the solver's.

use belvedere::OpenOptions;
use belvedere::io::TerrainRequest;
use belvedere::io::terrain::load_original;
use belvedere::places::Place;
use belvedere::request::Disocclude;
use belvedere::scene::Progress;
use belvedere::verbs::disocclude::{DisoccludeFiles, disocclude};
use std::path::Path;

const SIDE: usize = 48;
/// Spacing of the samples, degrees; the first column lies at 8.0 east, the last row at 46.0 north.
const STEP: f64 = 0.001;

/// Column of the middle of a winding valley.
fn middle(row: f64) -> f64 {
    24.0 + 9.0 * (row / 6.5).sin()
}

fn height(col: usize, row: usize) -> f64 {
    let away = ((col as f64 - middle(row as f64)).abs() - 1.5).max(0.0);
    1000.0 - 2.0 * row as f64 + 420.0 * (1.0 - (-away / 6.0).exp())
}

fn degrees([col, row]: [f64; 2]) -> [f64; 2] {
    [8.0 + STEP * col, 46.0 + STEP * (SIDE as f64 - 1.0 - row)]
}

/// Points along the stream, downstream.
fn stream() -> Vec<[f64; 2]> {
    (0..=130).map(|k| 2.0 + f64::from(k) / 3.0).map(|row| [middle(row), row]).collect()
}

fn line(path: &Path, places: &[[f64; 2]]) {
    let places: Vec<String> = places.iter().map(|p| degrees(*p)).map(|[x, y]| format!("[{x:.7},{y:.7}]")).collect();
    let text = format!("{{\"type\":\"LineString\",\"coordinates\":[{}]}}", places.join(","));
    std::fs::write(path, text).unwrap();
}

/// Largest rise downstream along the stream that the written heights add to the given ones.
fn excess(written: &[f64]) -> f64 {
    let surface = |heights: &dyn Fn(usize) -> f64, [x, y]: [f64; 2]| {
        let [col, row] = [x, y].map(|v| (v as usize).min(SIDE - 2));
        let [a, b] = [x - col as f64, y - row as f64];
        let corner = |dx: usize, dy: usize| heights((row + dy) * SIDE + col + dx);
        let (nw, se) = (corner(0, 0), corner(1, 1));
        // Two triangles that share the edge from north-west to south-east.
        if a > b {
            nw + a * (corner(1, 0) - nw) + b * (se - corner(1, 0))
        } else {
            nw + b * (corner(0, 1) - nw) + a * (se - corner(0, 1))
        }
    };
    let [mut bed, mut lowest, mut most] = [f64::INFINITY, f64::INFINITY, 0.0];
    for pair in stream().windows(2) {
        for k in 0..40 {
            let t = f64::from(k) / 40.0;
            let p = [0, 1].map(|i| pair[0][i] + t * (pair[1][i] - pair[0][i]));
            let before = surface(&|i| f64::from(height(i % SIDE, i / SIDE) as f32), p);
            let after = surface(&|i| written[i], p);
            (bed, lowest) = (bed.min(before), lowest.min(after));
            most = f64::max(most, (after - lowest) - (before - bed));
        }
    }
    most
}

#[test]
fn rivers_run_downhill_on_the_grid_of_the_input() {
    let folder = tempfile::tempdir().unwrap();
    let [dem, way, river] = ["dem.asc", "way.geojson", "river.geojson"].map(|name| folder.path().join(name));
    let row = |r: usize| (0..SIDE).map(|c| format!("{:.4} ", height(c, r))).collect::<String>() + "\n";
    let header = format!("ncols {SIDE}\nnrows {SIDE}\nxllcenter 8.0\nyllcenter 46.0\ncellsize {STEP}\n");
    std::fs::write(&dem, header + &(0..SIDE).map(row).collect::<String>()).unwrap();
    let up: Vec<[f64; 2]> = stream().into_iter().filter(|p| p[1] < 30.0).map(|[x, y]| [x + 2.0, y]).collect();
    line(&way, &up);
    // Lines may be drawn upstream.
    line(&river, &stream().into_iter().rev().collect::<Vec<_>>());
    let text = |path: &Path| path.display().to_string();
    let [free, kept] = [false, true].map(|rivers| {
        let [x, y] = degrees([middle(45.0), 45.0]);
        let request = Disocclude {
            data: text(&dem),
            features: vec![text(&way)],
            rivers: if rivers { vec![text(&river)] } else { Vec::new() },
            eye: Some(Place::of([x, y], Some(1060.0))),
            look: Some(Place::of(degrees([24.0, 10.0]), None)),
            set: vec!["solver_nodes=24".into()],
            show: Some(1.0),
            ..Disocclude::default()
        };
        let found = disocclude(&request, &OpenOptions::default()).unwrap();
        let out = folder.path().join("out.tif");
        let files = DisoccludeFiles { out: out.clone(), ..DisoccludeFiles::default() };
        found.write(&files, true, &Progress::silent()).unwrap();
        let read = load_original(&out, &TerrainRequest::default(), &Progress::silent()).unwrap().value;
        let heights: Vec<f64> = read.heights().map(|h| f64::from(h.unwrap())).collect();
        assert_eq!(heights.len(), SIDE * SIDE);
        (excess(&heights), found.solved.report.rivers.len())
    });
    assert_eq!([free.1, kept.1], [0, 1]);
    assert!(free.0 > 0.2, "the stream does not run uphill where nobody asks: {} m", free.0);
    assert!(kept.0 < 0.05, "{} m", kept.0);
}
