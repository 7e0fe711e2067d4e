//! Cost of the smooth pass by cosine transforms (ours) and by a sparse factor (the paper's method).

use crate::clock::{Stopwatch, median};
use anyhow::Result;
use belvedere::core::DVec2;
use belvedere::disocclusion::TerrainSettings;
use belvedere::disocclusion::internals::{
    ConjugateGradients, ElevationRows, Hierarchy, Smoother, grid_weight, row_weight,
};
use schemars::JsonSchema;
use serde::Serialize;

/// Elevation rows per node of the solver's grid: 1350 on 129 x 129.
const ROWS_PER_NODE: f64 = 1350.0 / 16_641.0;
/// Smoothness of the paper.
const W: f64 = 0.6;

/// The smooth pass on one right-hand side.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct SmoothCost {
    /// Nodes along a side of the solver's grid.
    pub nodes: usize,
    /// Elevation rows.
    pub rows: usize,
    /// Solution by cosine transforms, which prepare no factor: wall time, milliseconds.
    pub cosine_ms: f64,
    /// Cost of the paper's method; `None` in a program that was built without the feature `sparse`.
    pub sparse: Option<SparseCost>,
}

/// The paper's method: the normal equations, factorised once.
#[derive(Debug, Clone, Copy, JsonSchema, Serialize)]
pub struct SparseCost {
    /// Building and factorising, wall time, milliseconds.
    pub factor_ms: f64,
    /// A solution with the factor, wall time, milliseconds.
    pub solve_ms: f64,
    /// Numbers in the factor that are not zero.
    pub entries: usize,
    /// Largest difference from the solution by cosine transforms, metres.
    pub differs_m: f64,
    /// Largest displacement of that solution, metres.
    pub largest_m: f64,
}

/// Costs of both methods without and with elevation rows, on the solver's grid for ground of `nodes` x `nodes` nodes.
pub(crate) fn smooth(nodes: usize, rounds: usize) -> Result<Vec<SmoothCost>> {
    let grid = Hierarchy::new(nodes, nodes, TerrainSettings::default().solver_nodes);
    let count = (ROWS_PER_NODE * grid.nodes() as f64) as usize;
    [0, count].into_iter().map(|rows| cost(&grid, nodes, rows, rounds)).collect()
}

fn cost(grid: &Hierarchy, nodes: usize, count: usize, rounds: usize) -> Result<SmoothCost> {
    // Reproducible numbers in 0..1.
    let number = |i: usize| (i as f64 * 0.618_033_988_749_895).fract();
    let n = grid.cols();
    let points = (0..count).map(|i| DVec2::new(number(i), number(7 * i + 3)) * (nodes - 1) as f64);
    let rows = ElevationRows::new(grid, points, row_weight(1.0, grid.intervals()));
    let mut smoother = Smoother::new(n, n, grid_weight(W, grid.intervals()), 0.0)?;
    let mut wanted: Vec<f64> = (0..n * n).map(|i| -300.0 * smoother.shift() * number(i)).collect();
    rows.add_wanted(|i| -200.0 * number(i), &mut wanted);
    let (mut ours, mut cg, mut times) = (Vec::new(), ConjugateGradients::default(), Vec::new());
    for _ in 0..=rounds {
        let watch = Stopwatch::start();
        if count == 0 {
            ours.clone_from(&wanted);
            smoother.solve(&mut ours);
        } else {
            ours = vec![0.0; n * n];
            cg.solve(&mut smoother, &rows, &wanted, &mut ours, 1e-13, 200);
        }
        times.push(watch.wall_ms());
    }
    let sparse = sparse(n, smoother.shift(), &rows, &wanted, &ours)?;
    Ok(SmoothCost { nodes: n, rows: count, cosine_ms: median(times), sparse })
}

#[cfg(feature = "sparse")]
fn sparse(n: usize, shift: f64, rows: &ElevationRows, wanted: &[f64], ours: &[f64]) -> Result<Option<SparseCost>> {
    let watch = Stopwatch::start();
    let mut factor = belvedere::disocclusion::internals::Cholesky::new(n, n, shift, rows)?;
    let factor_ms = watch.wall_ms();
    let mut theirs = wanted.to_vec();
    let watch = Stopwatch::start();
    factor.solve(&mut theirs);
    let solve_ms = watch.wall_ms();
    let differs_m = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let largest_m = ours.iter().map(|u| u.abs()).fold(0.0, f64::max);
    Ok(Some(SparseCost { factor_ms, solve_ms, entries: factor.entries(), differs_m, largest_m }))
}

#[cfg(not(feature = "sparse"))]
fn sparse(_: usize, _: f64, _: &ElevationRows, _: &[f64], _: &[f64]) -> Result<Option<SparseCost>> {
    Ok(None)
}

impl std::fmt::Display for SmoothCost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { nodes, rows, cosine_ms, sparse } = self;
        write!(f, "smooth pass, {nodes} x {nodes} nodes, {rows} elevation rows: by cosines {cosine_ms:.2} ms; ")?;
        match sparse {
            Some(s) => write!(
                f,
                "by sparse Cholesky factor {:.1} ms ({} entries), solution {:.2} ms, at most {:.1e} m apart of {:.0} m",
                s.factor_ms, s.entries, s.solve_ms, s.differs_m, s.largest_m
            ),
            None => write!(f, "the sparse Cholesky factor is not in this program: build it with --features sparse"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_way_is_there_or_it_is_said_how_to_get_it() {
        let costs = smooth(65, 1).unwrap();
        assert_eq!(costs.iter().map(|c| c.rows > 0).collect::<Vec<_>>(), [false, true]);
        for cost in costs {
            assert!(cost.nodes == 65 && cost.cosine_ms > 0.0);
            assert_eq!(cost.sparse.is_some(), cfg!(feature = "sparse"));
            if let Some(sparse) = cost.sparse {
                assert!(sparse.differs_m <= 1e-8 * sparse.largest_m && sparse.largest_m > 10.0, "{sparse:?}");
                assert!(sparse.entries > 65 * 65 && cost.to_string().contains("sparse Cholesky factor"), "{cost}");
            }
            let without = SmoothCost { sparse: None, ..cost };
            assert!(without.to_string().contains("build it with --features sparse"), "{without}");
        }
    }
}
