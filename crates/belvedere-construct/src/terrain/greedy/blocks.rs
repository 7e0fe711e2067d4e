//! The ground in square blocks: what a line of sight reads of one lies together.

use super::super::{Cells, Field, NO_CELL};
use belvedere_core::DVec2;
use rayon::prelude::*;
use std::ops::Range;

/// Cells of the grid along a side of a block.
pub(super) const SIDE: usize = 8;
/// Nodes along a side, rims included.
pub(super) const ALONG: usize = SIDE + 1;
const NODES: usize = ALONG * ALONG;
/// Part of a node without data.
pub(super) const NO_PART: u8 = u8::MAX;

/// The untouched ground block by block, with the highest ground of every cell in each. Heights are over the datum.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocks {
    cols: usize,
    rows: usize,
    tiles: Vec<Tile>,
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

/// The nodes of a block row by row; beside the grid its last ones again.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tile {
    /// The nearest to the true ones.
    pub(super) heights: [f32; NODES],
    /// Number within the block of the part that a node belongs to; [`NO_PART`] without data.
    pub(super) part_of: [u8; NODES],
    /// Whether there are several parts, or nodes without data.
    pub(super) mixed: bool,
    /// A slant that no node is higher than: its height at the north-west node, and what it rises by column and row.
    slant: [f32; 3],
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
        let (cols, rows) = ((field.cols() - 1).div_ceil(SIDE), (field.rows() - 1).div_ceil(SIDE));
        let of_row = |row: usize| {
            let (mut tiles, mut parts) = (Vec::with_capacity(cols), Vec::with_capacity(3 * cols));
            let mut ends = Vec::with_capacity(cols);
            for col in 0..cols {
                let corner = [col, row].map(|k| k * SIDE);
                let first = parts.len();
                of_block(field, cells, corner, (row * cols + col) as u32, &mut parts);
                tiles.push(Tile::new(field, cells, corner, &parts[first..]));
                ends.push(parts.len() as u32);
            }
            (tiles, parts, ends)
        };
        let of_rows: Vec<_> = (0..rows).into_par_iter().with_min_len(4).map(of_row).collect();
        let (mut tiles, mut start, mut parts) = (Vec::with_capacity(cols * rows), vec![0], Vec::new());
        for (of_row, of_parts, ends) in of_rows {
            tiles.extend(of_row);
            start.extend(ends.iter().map(|end| parts.len() as u32 + end));
            parts.extend(of_parts);
        }
        let (first, of_cell) = by_cell(&parts, cells.len());
        let highest = |ends: &[u32]| parts[ends[0] as usize..ends[1] as usize].iter().map(|p| p.highest);
        let ceilings = start.windows(2).map(|ends| highest(ends).fold(f32::NEG_INFINITY, f32::max)).collect();
        Self { cols, rows, tiles, start, parts, first, of_cell, ceilings }
    }

    /// Blocks along both axes.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.cols, self.rows]
    }

    /// Grid coordinates of a block's north-west node.
    pub(super) fn corner(&self, block: usize) -> DVec2 {
        DVec2::new((block % self.cols * SIDE) as f64, (block / self.cols * SIDE) as f64)
    }

    pub(super) fn tile(&self, block: usize) -> &Tile {
        &self.tiles[block]
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

impl Tile {
    /// * `corner`: column and row of the north-west node; `parts`: of the block.
    fn new(field: &Field, cells: &Cells, corner: [usize; 2], parts: &[Part]) -> Self {
        let mut out =
            Self { heights: [0.0; NODES], part_of: [NO_PART; NODES], mixed: parts.len() != 1, slant: [0.0; 3] };
        for k in 0..NODES {
            let (x, y) = ((corner[0] + k % ALONG).min(field.cols() - 1), (corner[1] + k / ALONG).min(field.rows() - 1));
            let node = y * field.cols() + x;
            let cell = cells.labels()[node];
            out.heights[k] = (field.heights()[node] - field.datum()) as f32;
            match parts.iter().position(|p| p.cell == cell) {
                Some(part) => out.part_of[k] = part as u8,
                None => out.mixed = true,
            }
        }
        out.slant = slant(&out.heights);
        out
    }

    /// The slant's height at a place of the block, cells from its north-west corner: no ground there is higher.
    #[inline(always)]
    pub(super) fn highest_at(&self, [x, y]: [f64; 2]) -> f64 {
        let [corner, east, south] = self.slant.map(f64::from);
        corner + x * east + y * south
    }
}

/// The slant of least squares, lifted over all nodes.
fn slant(heights: &[f32; NODES]) -> [f32; 3] {
    let middle = (SIDE / 2) as f32;
    // Sum of the squared distances from the middle.
    let spread = ALONG as f32 * (0..ALONG).map(|k| (k as f32 - middle).powi(2)).sum::<f32>();
    let at = |k: usize| [k % ALONG, k / ALONG];
    let mut slopes = [0.0; 2];
    for (k, h) in heights.iter().enumerate() {
        (0..2).for_each(|axis| slopes[axis] += (at(k)[axis] as f32 - middle) * h / spread);
    }
    // In f64, as it is looked up.
    let rise = |k: usize| (0..2).map(|axis| at(k)[axis] as f64 * f64::from(slopes[axis])).sum::<f64>();
    let above = |(k, h): (usize, &f32)| f64::from(*h) - rise(k);
    let corner = heights.iter().enumerate().map(above).fold(f64::NEG_INFINITY, f64::max);
    [(corner as f32).next_up(), slopes[0], slopes[1]]
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

/// Numbers of the parts of each cell, and where each cell's begin.
fn by_cell(parts: &[Part], cells: usize) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0u32; cells + 1];
    parts.iter().for_each(|p| first[p.cell as usize + 1] += 1);
    (0..cells).for_each(|c| first[c + 1] += first[c]);
    let (mut next, mut of_cell) = (first.clone(), vec![0; parts.len()]);
    for (number, part) in parts.iter().enumerate() {
        let at = &mut next[part.cell as usize];
        of_cell[*at as usize] = number as u32;
        *at += 1;
    }
    (first, of_cell)
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
            let ceiling = f64::from(ground.ceilings.of_blocks()[y / SIDE * blocks.cols + x / SIDE]);
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
