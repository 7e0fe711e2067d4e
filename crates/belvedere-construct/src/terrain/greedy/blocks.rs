//! Highest ground of square blocks, by which a line of sight passes ground that it clears.

use super::super::{Cells, Field, NO_CELL};
use super::Pieces;
use belvedere_core::DVec2;
use rayon::prelude::*;

/// Cells of the grid along a side of a block.
const SIDE: usize = 8;

/// Highest ground of every block of the untouched ground, cell by cell. Heights are over the datum.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocks {
    cols: usize,
    rows: usize,
    /// First part of each block, and the end.
    start: Vec<u32>,
    parts: Vec<Part>,
    /// First entry of each cell of the ground, and the end.
    first: Vec<u32>,
    /// Blocks in which a cell has a part.
    of_cell: Vec<u32>,
}

/// What belongs to one cell of the ground in a block.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    cell: u32,
    highest: f32,
}

impl Blocks {
    /// * `cells`: of a ground with as many nodes as `field`.
    pub fn new(field: &Field, cells: &Cells) -> Self {
        let (cols, rows) = ((field.cols() - 1).div_ceil(SIDE), (field.rows() - 1).div_ceil(SIDE));
        let of_row = |row: usize| {
            let (mut parts, mut ends) = (Vec::with_capacity(3 * cols), Vec::with_capacity(cols));
            for col in 0..cols {
                of_block(field, cells, [col, row].map(|k| k * SIDE), &mut parts);
                ends.push(parts.len() as u32);
            }
            (parts, ends)
        };
        let of_rows: Vec<_> = (0..rows).into_par_iter().with_min_len(4).map(of_row).collect();
        let (mut start, mut parts) = (vec![0], Vec::new());
        for (of_row, ends) in of_rows {
            start.extend(ends.iter().map(|end| parts.len() as u32 + end));
            parts.extend(of_row);
        }
        let (first, of_cell) = by_cell(&start, &parts, cells.len());
        Self { cols, rows, start, parts, first, of_cell }
    }

    /// A bound of the highest untouched ground of each block.
    pub(super) fn ceilings(&self) -> Vec<f32> {
        let parts = |block: &[u32]| &self.parts[block[0] as usize..block[1] as usize];
        let highest = |block: &[u32]| parts(block).iter().map(|p| p.highest).fold(f32::NEG_INFINITY, f32::max);
        self.start.windows(2).map(highest).collect()
    }

    /// Sets the bounds anew of the blocks in which there is ground of a cell.
    pub(super) fn lower(&self, cell: usize, pieces: &[Pieces], ceilings: &mut [f32]) {
        for &block in &self.of_cell[self.first[cell] as usize..self.first[cell + 1] as usize] {
            ceilings[block as usize] = self.ceiling(block as usize, pieces);
        }
    }

    fn ceiling(&self, block: usize, pieces: &[Pieces]) -> f32 {
        let parts = &self.parts[self.start[block] as usize..self.start[block + 1] as usize];
        let highest = |p: &Part| pieces[p.cell as usize].highest(f64::from(p.highest));
        (parts.iter().map(highest).fold(f64::NEG_INFINITY, f64::max) as f32).next_up()
    }

    /// Parts of a line of sight over blocks that may be higher than it, in order; neighbouring ones are one.
    ///
    /// * `start`, `dir`: the line in cells; `span`: the part to look at;
    /// * `height`: the highest that ground may be at 0 and 1, over the datum.
    #[inline(always)]
    pub(super) fn near_parts(
        &self,
        (start, dir): (DVec2, DVec2),
        (t0, t1): (f64, f64),
        height: [f64; 2],
        ceilings: &[f32],
        out: &mut Vec<(f64, f64)>,
    ) {
        let side = SIDE as f64;
        let at = start + t0 * dir;
        let block = |x: f64, d: f64, n: usize| {
            let k = (x / side) as usize;
            // On a border it is the block ahead that counts; the one behind holds the same nodes there.
            let behind = d < 0.0 && k as f64 * side == x && k > 0;
            (k - usize::from(behind)).min(n - 1)
        };
        let (mut col, mut row) = (block(at.x, dir.x, self.cols), block(at.y, dir.y, self.rows));
        let border = |k: usize, axis: usize| {
            let ahead = (k + usize::from(dir[axis] > 0.0)) as f64 * side;
            if dir[axis] == 0.0 { f64::INFINITY } else { (ahead - start[axis]) / dir[axis] }
        };
        let mut next = [border(col, 0), border(row, 1)];
        let stride = DVec2::splat(side) / dir.abs();
        let rise = height[1] - height[0];
        // The lower end of the line over a block is that nearer to the point if it rises.
        let falls = rise < 0.0;
        let (mut t, mut part) = (t0, None);
        while t < t1 {
            let across = usize::from(next[1] < next[0]);
            let exit = next[across].min(t1);
            let limit = height[0] + if falls { exit } else { t } * rise;
            if f64::from(ceilings[row * self.cols + col]) > limit {
                part.get_or_insert(t);
            } else if let Some(from) = part.take() {
                out.push((from, t));
            }
            let on = |k: usize, n: usize| if dir[across] > 0.0 { (k + 1).min(n - 1) } else { k.saturating_sub(1) };
            if across == 0 {
                col = on(col, self.cols);
            } else {
                row = on(row, self.rows);
            }
            next[across] += stride[across];
            t = exit;
        }
        out.extend(part.map(|from| (from, t1)));
    }
}

/// Appends the parts of the block whose north-west corner is given.
fn of_block(field: &Field, cells: &Cells, [col, row]: [usize; 2], out: &mut Vec<Part>) {
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
                None => out.push(Part { cell, highest }),
            }
        }
    }
}

/// Blocks of each cell, and where each cell's begin.
fn by_cell(start: &[u32], parts: &[Part], cells: usize) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0u32; cells + 1];
    parts.iter().for_each(|p| first[p.cell as usize + 1] += 1);
    (0..cells).for_each(|c| first[c + 1] += first[c]);
    let (mut next, mut of_cell) = (first.clone(), vec![0; parts.len()]);
    for (block, ends) in start.windows(2).enumerate() {
        for part in &parts[ends[0] as usize..ends[1] as usize] {
            let at = &mut next[part.cell as usize];
            of_cell[*at as usize] = block as u32;
            *at += 1;
        }
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
        let mut ground = Lowered::new(&blocks, cells.len());
        for cell in (0..cells.len()).step_by(2) {
            ground.change(cell, f64::INFINITY, |_| Affine { scale: 0.7, shift: -3.0 * cell as f64 });
        }
        ground.settle(&blocks);
        let mut close = 0;
        for (from, step) in (0..cols * rows - cols - 1).flat_map(|n| [(n, 1), (n, cols)]) {
            let (to, [x, y]) = (from + step, [from % cols, from / cols]);
            if x + 1 == cols || field.void()[from] || field.void()[to] {
                continue;
            }
            let ceiling = f64::from(ground.ceilings[y / SIDE * blocks.cols + x / SIDE]);
            for weight in (0..=10).map(|k| 0.1 * f64::from(k)) {
                let nearest = if weight > 0.5 { to } else { from };
                let h = (1.0 - weight) * field.heights()[from] + weight * field.heights()[to] - field.datum();
                let z = ground.pieces[cells.labels()[nearest] as usize].highest(h);
                assert!(z <= ceiling, "edge {from} to {to} at {weight}: {z} over {ceiling}");
                close += usize::from(z > ceiling - 1.0);
            }
        }
        assert!(close > 20, "bounds are met by {close} places only");
    }
}
