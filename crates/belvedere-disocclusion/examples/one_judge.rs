//! How far apart four methods find the share of what must be seen: the report of the solver, lines of sight and depth buffers of `measure`, and a march
//! along rays.
//!
//! `cargo run --release -p belvedere-disocclusion --example one_judge [CASES]` (default 60): made ground and crops of the data collection
//! (BELVEDERE_DATA) in turn, fine and coarse, a fifth of them twice as steep, with modes `qp`, `paper` and `qp` at a slack price. Prints one line per case.

#![expect(clippy::print_stdout, reason = "it prints figures")]
#![expect(clippy::unwrap_used, reason = "a case that cannot be made is a fault of this program")]

#[path = "../tests/it/one_judge/compared.rs"]
mod compared;

use belvedere_core::DVec2;
use belvedere_disocclusion::{SolverMode, TerrainSettings};
use belvedere_io::{TerrainRequest, load_terrain};
use belvedere_scene::{Heightfield, NodeState, Progress};
use belvedere_testkit::{Random, data};
use compared::{AGREES, case, compared, made};

const SOURCES: [&str; 5] = [
    "bigtujunga/bigtujunga.tif",
    "baltoro/baltoro_srtm.tif",
    "grand_canyon/grandcanyon_dem_3857.tif",
    "gotthard/N46E008.tif",
    "swellendam/srtm_41_19_utm33s.tif",
];

fn main() {
    let cases = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(60);
    let request = TerrainRequest { fill_voids: true, ..TerrainRequest::default() };
    let load =
        |path: &str| Some(load_terrain(&[data(path)?], &request, &Progress::silent()).unwrap().value.heightfield);
    let grounds: Vec<Heightfield> = SOURCES.iter().filter_map(|path| load(path)).collect();
    let mut apart = 0;
    for seed in 0..cases {
        let kind = seed as usize % (grounds.len() + 1);
        let hf = grounds.get(kind).map_or_else(|| made(seed), |hf| crop(hf, seed));
        let case = case(hf, seed, [1280, 720]);
        let mode = if seed % 5 == 2 { SolverMode::Paper } else { SolverMode::Qp };
        let slack_price = (seed % 7 == 3).then_some(50.0);
        let found = compared(&case, TerrainSettings { mode, slack_price, ..TerrainSettings::default() });
        let widest =
            found.shares.iter().map(|s| s.iter().fold(0.0, |w: f64, v| w.max((v - s[0]).abs()))).fold(0.0, f64::max);
        apart += usize::from(widest > AGREES);
        let guaranteed = match (found.view.is_bent(), found.report.guaranteed) {
            (false, _) => "unmoved",
            (true, true) => "guaranteed",
            (true, false) => "",
        };
        println!("{seed} {:.4?} {:.4?} {widest:.4} {guaranteed}", found.shares[0], found.shares[1]);
    }
    println!("{apart} of {cases} cases differ by more than {AGREES}");
}

/// A square part of measured ground, every node or every third, perhaps twice as steep.
fn crop(hf: &Heightfield, seed: u64) -> Heightfield {
    let mut random = Random::new(seed);
    let nodes = 60 + random.below(70);
    let step = if seed % 4 == 1 && hf.cols().min(hf.rows()) > 3 * nodes { 3 } else { 1 };
    let steep = if seed % 5 == 4 { 2.0 } else { 1.0 };
    let [col, row] = [hf.cols(), hf.rows()].map(|n| random.below(n - step * (nodes - 1)));
    let node = |i: usize| hf.node(col + step * (i % nodes), row + step * (i / nodes)).unwrap_or_default();
    let heights = (0..nodes * nodes).map(|i| (steep * node(i).z) as f32).collect();
    let states = vec![NodeState::Measured; nodes * nodes];
    let spacing = DVec2::splat(step as f64 * hf.spacing().min_element());
    Heightfield::new(DVec2::ZERO, spacing, nodes, nodes, heights, states).unwrap()
}
