//! The accelerator of the greedy pass: parts of a line of sight over blocks that are too low to hide anything are skipped.

use super::super::Field;
use belvedere_sight::SightLine;
use rayon::prelude::*;

/// Cells of the grid along a side of a block.
const SIDE: usize = 16;

/// The highest node of every square block of the untouched ground. The pass only lowers ground, so these stay bounds of it.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockMaxima {
    /// Blocks along both axes.
    size: [usize; 2],
    /// Highest node of each block over the datum, row-major. Nodes on a common border count for both blocks.
    highest: Vec<f64>,
}

impl BlockMaxima {
    /// Bounds of the ground without any displacement.
    pub fn new(field: &Field) -> Self {
        let (cols, rows) = (field.cols(), field.rows());
        let size = [cols, rows].map(|n| (n - 1).div_ceil(SIDE));
        let highest = |block: usize| {
            let (x, y) = (block % size[0] * SIDE, block / size[0] * SIDE);
            let nodes =
                (y..=(y + SIDE).min(rows - 1)).flat_map(|y| &field.heights()[y * cols..][x..=(x + SIDE).min(cols - 1)]);
            nodes.fold(f64::NEG_INFINITY, |a, &b| if b > a { b } else { a }) - field.datum()
        };
        let highest = (0..size[0] * size[1]).into_par_iter().with_min_len(64).map(highest).collect();
        Self { size, highest }
    }

    /// The parts of a line of sight, as shares of the way from point to eye and in order, over blocks that are not
    /// wholly below it.
    ///
    /// * `from`: share at which to begin;
    /// * `height`: of the line at the point and at the eye over the datum, less the clearance.
    pub(super) fn parts_to_check(&self, line: &SightLine<'_>, from: f64, height: [f64; 2]) -> Vec<[f64; 2]> {
        let mut out: Vec<[f64; 2]> = Vec::new();
        let [t0, end] = line.span();
        let (mut t, start, dir) = (t0.max(from), line.from(), line.dir());
        if t >= end {
            return out;
        }
        let (at, side) = (start + t * dir, SIDE as f64);
        let mut block = [0, 1].map(|a| ((at[a] / side).floor() as isize).clamp(0, self.size[a] as isize - 1));
        let exit = |a: usize, block: isize| {
            let border = (block + isize::from(dir[a] > 0.0)) as f64 * side;
            if dir[a] == 0.0 { f64::INFINITY } else { (border - start[a]) / dir[a] }
        };
        let mut exits = [exit(0, block[0]), exit(1, block[1])];
        loop {
            let u = exits[0].min(exits[1]).min(end);
            let lowest = height[0] + (height[1] - height[0]) * if height[1] < height[0] { u } else { t };
            if self.highest[block[1] as usize * self.size[0] + block[0] as usize] > lowest {
                match out.last_mut() {
                    Some(part) if part[1] >= t => part[1] = u,
                    _ => out.push([t, u]),
                }
            }
            let axis = usize::from(exits[1] < exits[0]);
            block[axis] += if dir[axis] > 0.0 { 1 } else { -1 };
            if u >= end || !(0..self.size[axis] as isize).contains(&block[axis]) {
                return out;
            }
            (t, exits[axis]) = (u, exit(axis, block[axis]));
        }
    }
}
