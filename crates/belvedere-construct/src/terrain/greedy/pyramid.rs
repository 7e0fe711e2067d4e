//! Largest heights of ever larger blocks, by which a line of sight skips ground that it clears.

use super::super::Field;
use super::super::cells::BLOCKS;
use super::super::line_of_sight::{SightSample, SightWalk};
use belvedere_core::DVec2;
use rayon::prelude::*;

/// Sides of the blocks, cells.
const SIDES: [usize; 3] = [BLOCKS[0], BLOCKS[1], 64];

/// Largest heights of the square blocks of the ground (a maximum mipmap, Tevs et al. 2008, in steps of four).
///
/// Transforms only lower the ground, so the pyramid of the untouched ground bounds it throughout.
#[derive(Debug, Clone, PartialEq)]
pub struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Debug, Clone, PartialEq)]
struct Level {
    side: f64,
    /// One over `side`.
    per_side: f64,
    cols: usize,
    rows: usize,
    max: Vec<f32>,
}

impl Pyramid {
    /// One pass over the nodes.
    pub fn new(field: &Field) -> Self {
        let mut levels = vec![finest(field)];
        for side in SIDES.into_iter().skip(1) {
            let next = coarser(&levels[levels.len() - 1], side as f64);
            levels.push(next);
        }
        Self { levels }
    }

    /// Appends the crossings of a line of sight (`height`: at tau 0 and 1) between `from` and its end with ground that
    /// might be higher than it by more than `-clearance`; all of those, and some others.
    ///
    /// * `now`: highest ground in a block (level, index) as it is now, or a bound of it, from its untouched highest ground.
    #[inline(always)]
    pub(super) fn near_misses(
        &self,
        walk: &mut SightWalk<'_>,
        start: DVec2,
        height: [f64; 2],
        (clearance, from): (f64, f64),
        now: impl Fn(usize, usize, f64) -> f64,
        out: &mut Vec<SightSample>,
    ) {
        let (t0, t1) = walk.span();
        // Small enough to be nothing, large enough to step over a border in f64.
        const NUDGE: f64 = 1e-10;
        let dir = walk.dir();
        let per_cell = dir.recip();
        let at = |t: f64| height[0] + t * (height[1] - height[0]) - clearance;
        let top = self.levels.len() - 1;
        let (mut t, mut level) = (t0.max(from), 0);
        while t < t1 {
            let (block, exit) = self.levels[level].block(start, dir, per_cell, t + NUDGE);
            let exit = exit.max(t + NUDGE).min(t1);
            let (max, limit) = (f64::from(self.levels[level].max[block]), at(t).min(at(exit)));
            let clear = max <= limit || now(level, block, max) <= limit;
            if !clear && level > 0 {
                level -= 1;
                continue;
            }
            if clear {
                level = (level + 1).min(top);
            } else {
                walk.skip_to(t);
                walk.samples_to(exit, out);
            }
            t = exit;
        }
    }
}

impl Level {
    /// The block at `t`, and where the line leaves it.
    #[inline(always)]
    fn block(&self, start: DVec2, dir: DVec2, per_cell: DVec2, t: f64) -> (usize, f64) {
        // Sides are powers of two.
        let at = (start + t * dir) * self.per_side;
        let index = |x: f64, n: usize| (x.max(0.0) as usize).min(n - 1);
        let (col, row) = (index(at.x, self.cols), index(at.y, self.rows));
        let exit = |axis: usize, i: usize| {
            let border = (i + usize::from(dir[axis] > 0.0)) as f64 * self.side;
            if dir[axis] == 0.0 { f64::INFINITY } else { (border - start[axis]) * per_cell[axis] }
        };
        (row * self.cols + col, exit(0, col).min(exit(1, row)))
    }
}

fn finest(field: &Field) -> Level {
    let side = SIDES[0];
    let (cols, rows) = ((field.cols() - 1).div_ceil(side), (field.rows() - 1).div_ceil(side));
    let mut max = vec![f32::NEG_INFINITY; cols * rows];
    max.par_chunks_mut(cols).enumerate().with_min_len(16).for_each(|(row, out)| {
        for y in row * side..=(row * side + side).min(field.rows() - 1) {
            let line = &field.heights()[y * field.cols()..][..field.cols()];
            for (col, out) in out.iter_mut().enumerate() {
                let nodes = &line[col * side..=(col * side + side).min(field.cols() - 1)];
                let highest = nodes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                *out = out.max((highest as f32).next_up());
            }
        }
    });
    Level { side: side as f64, per_side: 1.0 / side as f64, cols, rows, max }
}

fn coarser(fine: &Level, side: f64) -> Level {
    let by = (side / fine.side) as usize;
    let (cols, rows) = (fine.cols.div_ceil(by), fine.rows.div_ceil(by));
    let mut max = vec![f32::NEG_INFINITY; cols * rows];
    for row in 0..fine.rows {
        for col in 0..fine.cols {
            let to = row / by * cols + col / by;
            max[to] = max[to].max(fine.max[row * fine.cols + col]);
        }
    }
    Level { side, per_side: 1.0 / side, cols, rows, max }
}
