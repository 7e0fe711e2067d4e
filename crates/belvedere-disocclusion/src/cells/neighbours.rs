//! Adjacency of terrain cells, with the shares of their common borders.

use super::NO_CELL;
use super::pairs::Pairs;
use super::regions::BAND;
use rayon::prelude::*;

/// Neighbours of each cell in compressed rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Neighbours {
    start: Vec<u32>,
    cell: Vec<u32>,
    share: Vec<f64>,
}

impl Neighbours {
    /// A border consists of the grid edges between nodes of two cells; the rim of the terrain and edges to voids do not count.
    pub(super) fn new(cols: usize, labels: &[u32], cells: usize) -> Self {
        let bands: Vec<Pairs<u32>> = labels
            .par_chunks(BAND * cols)
            .enumerate()
            .map(|(band, rows)| {
                let mut out = Pairs::new();
                let mut meet = |a: u32, b: u32| {
                    if a != b && a != NO_CELL && b != NO_CELL {
                        *out.entry(a, b) += 1;
                    }
                };
                for row in rows.chunks_exact(cols) {
                    row.iter().zip(&row[1..]).for_each(|(&a, &b)| meet(a, b));
                }
                // Every row with the next one, the first row of the next band included.
                let below = &labels[(band * BAND * cols + cols).min(labels.len())..];
                rows.iter().zip(below).for_each(|(&a, &b)| meet(a, b));
                out
            })
            .collect();
        let mut shared = Pairs::new();
        for ([a, b], edges) in bands.iter().flat_map(Pairs::iter) {
            *shared.entry(a, b) += edges;
        }
        let both = |([a, b], edges): ([u32; 2], u32)| [(a, b, edges), (b, a, edges)];
        let mut all: Vec<(u32, u32, u32)> = shared.iter().flat_map(both).collect();
        all.sort_unstable();
        let mut border = vec![0u32; cells];
        let mut start = vec![0u32; cells + 1];
        for &(a, _, edges) in &all {
            border[a as usize] += edges;
            start[a as usize + 1] += 1;
        }
        for i in 0..cells {
            start[i + 1] += start[i];
        }
        let share = all.iter().map(|&(a, _, edges)| f64::from(edges) / f64::from(border[a as usize])).collect();
        Self { start, cell: all.iter().map(|n| n.1).collect(), share }
    }

    pub(super) fn of(&self, cell: usize) -> (&[u32], &[f64]) {
        let range = self.start[cell] as usize..self.start[cell + 1] as usize;
        (&self.cell[range.clone()], &self.share[range])
    }
}
