//! The ground in square blocks, and how high each of them is.

use super::super::{Cells, Field, NO_CELL};
use belvedere_core::DVec2;
use rayon::prelude::*;
use std::ops::Range;

/// Cells of the grid along a side of a block.
pub(super) const SIDE: usize = 16;

/// The untouched ground, and block by block the highest ground of every cell in it. Heights are over the datum.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocks {
    /// Of the grid, columns and rows.
    nodes: [usize; 2],
    ground: Vec<Node>,
    /// Blocks along both axes.
    size: [usize; 2],
    /// First part of each block, and the end.
    start: Vec<u32>,
    parts: Vec<Part>,
    /// First entry of each cell of the ground, and the end.
    first: Vec<u32>,
    /// Numbers of the parts of each cell.
    of_cell: Vec<u32>,
    /// Highest ground of each block.
    ceilings: Vec<f32>,
}

/// What a line of sight asks of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    /// The nearest to the true one.
    pub(super) height: f32,
    /// The number of all cells for none.
    pub(super) cell: u32,
}

/// What belongs to one cell of the ground in a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) cell: u32,
    pub(super) block: u32,
    /// No ground of it is higher.
    pub(super) highest: f32,
}

impl Blocks {
    /// * `cells`: of a ground with as many nodes as `field`.
    pub fn new(field: &Field, cells: &Cells) -> Self {
        let nodes = [field.cols(), field.rows()];
        let size = nodes.map(|n| (n - 1).div_ceil(SIDE));
        let of_row = |row: usize| {
            let mut parts = Vec::with_capacity(3 * size[0]);
            let mut ends = Vec::with_capacity(size[0]);
            for col in 0..size[0] {
                let corner = [col, row].map(|k| k * SIDE);
                of_block(field, cells, corner, (row * size[0] + col) as u32, &mut parts);
                ends.push(parts.len() as u32);
            }
            (parts, ends)
        };
        let of_rows: Vec<_> = (0..size[1]).into_par_iter().with_min_len(4).map(of_row).collect();
        let (mut start, mut parts) = (vec![0], Vec::new());
        for (of_row, ends) in of_rows {
            start.extend(ends.iter().map(|end| parts.len() as u32 + end));
            parts.extend(of_row);
        }
        let (first, of_cell) = by_cell(parts.iter().map(|p| p.cell as usize), cells.len());
        let highest = |ends: &[u32]| parts[ends[0] as usize..ends[1] as usize].iter().map(|p| p.highest);
        let ceilings = start.windows(2).map(|ends| highest(ends).fold(f32::NEG_INFINITY, f32::max)).collect();
        let node =
            |(&h, &cell): (&f64, &u32)| Node { height: (h - field.datum()) as f32, cell: cell.min(cells.len() as u32) };
        let ground = field.heights().par_iter().zip(cells.labels()).with_min_len(1 << 16).map(node).collect();
        Self { nodes, ground, size, start, parts, first, of_cell, ceilings }
    }

    /// Nodes of the grid along both axes.
    pub(super) fn nodes(&self) -> [usize; 2] {
        self.nodes
    }

    /// All nodes, row-major; heights of voids mean nothing.
    pub(super) fn ground(&self) -> &[Node] {
        &self.ground
    }

    /// Blocks along both axes.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Grid coordinates of a block's north-west node.
    pub(super) fn corner(&self, block: usize) -> DVec2 {
        DVec2::new((block % self.size[0] * SIDE) as f64, (block / self.size[0] * SIDE) as f64)
    }

    /// A bound of the highest untouched ground of each block.
    pub(super) fn ceilings(&self) -> &[f32] {
        &self.ceilings
    }

    pub(super) fn all_parts(&self) -> &[Part] {
        &self.parts
    }

    /// Numbers of the parts of a block.
    pub(super) fn numbers(&self, block: usize) -> Range<usize> {
        self.start[block] as usize..self.start[block + 1] as usize
    }

    /// Numbers of the parts of a cell.
    pub(super) fn parts_of_cell(&self, cell: usize) -> &[u32] {
        &self.of_cell[self.first[cell] as usize..self.first[cell + 1] as usize]
    }
}

/// Appends the parts of the block whose north-west corner is given.
fn of_block(field: &Field, cells: &Cells, [col, row]: [usize; 2], block: u32, out: &mut Vec<Part>) {
    let (cols, rows, heights, labels) = (field.cols(), field.rows(), field.heights(), cells.labels());
    let first = out.len();
    let mut part = first;
    for y in row..=(row + SIDE).min(rows - 1) {
        let line = |y: usize| (&heights[y * cols..][..cols], &labels[y * cols..][..cols]);
        let lines = [line(y.saturating_sub(1)), line(y), line((y + 1).min(rows - 1))];
        let (here, of) = lines[1];
        for x in col..=(col + SIDE).min(cols - 1) {
            let (cell, mut highest) = (of[x], here[x]);
            if cell == NO_CELL {
                continue;
            }
            // Of an edge between two cells the nearer half is ground of each.
            let (west, east) = (x.saturating_sub(1), (x + 1).min(cols - 1));
            for ((heights, labels), beside) in [(lines[1], west), (lines[1], east), (lines[0], x), (lines[2], x)] {
                if labels[beside] != cell {
                    highest = highest.max(0.5 * (here[x] + heights[beside]));
                }
            }
            let highest = ((highest - field.datum()) as f32).next_up();
            if out.get(part).is_none_or(|p| p.cell != cell) {
                part = first + out[first..].iter().position(|p| p.cell == cell).unwrap_or(out.len() - first);
            }
            match out.get_mut(part) {
                Some(part) => part.highest = part.highest.max(highest),
                None => out.push(Part { cell, block, highest }),
            }
        }
    }
}

/// Where each cell's things begin, and the end; and the numbers of the things of each cell, ascending.
///
/// * `of`: the cell of each thing.
pub(super) fn by_cell(of: impl ExactSizeIterator<Item = usize> + Clone, cells: usize) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0u32; cells + 1];
    of.clone().for_each(|cell| first[cell + 1] += 1);
    (0..cells).for_each(|c| first[c + 1] += first[c]);
    let (mut next, mut numbers) = (first.clone(), vec![0; of.len()]);
    for (number, cell) in of.enumerate() {
        let at = &mut next[cell];
        numbers[*at as usize] = number as u32;
        *at += 1;
    }
    (first, numbers)
}

#[cfg(test)]
mod tests {
    use super::super::super::cells::tests::{field_of, noise};
    use super::super::Affine;
    use super::super::trace::Lowered;
    use super::*;

    #[test]
    fn nothing_stands_out_of_a_block_after_cells_were_lowered() {
        let (cols, rows) = (45, 38);
        let field = field_of(cols, rows, DVec2::splat(30.0), |c, r| {
            let h = noise(r * cols + c, 4);
            if h < 0.02 { f64::NAN } else { 900.0 * h }
        });
        let cells = Cells::new(&field, 60);
        let blocks = Blocks::new(&field, &cells);
        let eye = DVec2::new(20.0, -3.0);
        let mut ground = Lowered::new(&field, &blocks, cells.len(), eye);
        for cell in (0..cells.len()).step_by(2) {
            ground.change(cell, f64::INFINITY, |_| Affine { scale: 0.7, shift: -3.0 * cell as f64 });
        }
        for cell in (0..cells.len()).step_by(3) {
            let below = 30.0 * (5 + cell % 30) as f64;
            ground.change(cell, below, |a| Affine { shift: a.shift - 200.0, ..a });
        }
        ground.settle(&blocks);
        let mut close = 0;
        for (from, step) in (0..cols * rows - cols - 1).flat_map(|n| [(n, 1), (n, cols)]) {
            let (to, [x, y]) = (from + step, [from % cols, from / cols]);
            if x + 1 == cols || field.void()[from] || field.void()[to] {
                continue;
            }
            let ceiling = f64::from(ground.ceilings.of_blocks()[y / SIDE * blocks.size[0] + x / SIDE]);
            for weight in (0..=10).map(|k| 0.1 * f64::from(k)) {
                let nearest = if weight > 0.5 { to } else { from };
                let h = (1.0 - weight) * field.heights()[from] + weight * field.heights()[to] - field.datum();
                let at = DVec2::new(x as f64, y as f64) + weight * if step == 1 { DVec2::X } else { DVec2::Y };
                let rho = ((at - eye) * field.spacing()).length();
                let z = ground.pieces[cells.labels()[nearest] as usize].at(rho).of(h);
                assert!(z <= ceiling, "edge {from} to {to} at {weight}: {z} over {ceiling}");
                close += usize::from(z > ceiling - 1.0);
            }
        }
        assert!(close > 20, "bounds are met by {close} places only");
    }
}
