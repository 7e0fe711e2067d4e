//! Which cells touch, and how much.

use super::NO_CELL;
use super::pairs::Pairs;

/// Neighbours of each cell in compressed rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Neighbours {
    start: Vec<u32>,
    cell: Vec<u32>,
    share: Vec<f64>,
}

impl Neighbours {
    /// Border = edges of the grid between nodes of two cells; the rim of the terrain and voids are no border.
    pub(super) fn new(cols: usize, labels: &[u32], cells: usize) -> Self {
        let mut shared = Pairs::new();
        let mut meet = |a: u32, b: u32| {
            if a != b && a != NO_CELL && b != NO_CELL {
                *shared.entry(a, b) += 1u32;
            }
        };
        for row in labels.chunks_exact(cols) {
            row.windows(2).for_each(|w| meet(w[0], w[1]));
        }
        for (&a, &b) in labels.iter().zip(&labels[cols.min(labels.len())..]) {
            meet(a, b);
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
