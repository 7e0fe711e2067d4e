//! Steepest ascent.

use super::super::Field;
use super::NO_CELL;
use rayon::prelude::*;

/// The region of every summit, however small: all nodes whose steepest ascent ends there.
pub(super) struct Regions {
    /// Region of each node; [`NO_CELL`] at voids.
    pub(super) of_node: Vec<u32>,
    /// Node of each region's summit, ascending.
    pub(super) summits: Vec<u32>,
}

impl Regions {
    pub(super) fn new(field: &Field) -> Self {
        let up = ascent(field);
        let mut of_node = vec![NO_CELL; up.len()];
        let mut summits = Vec::new();
        for (i, &next) in up.iter().enumerate() {
            if next as usize == i {
                of_node[i] = summits.len() as u32;
                summits.push(i as u32);
            }
        }
        // Every path is walked once: up to where the answer is known, and back.
        for i in 0..up.len() {
            if of_node[i] != NO_CELL || up[i] == NO_CELL {
                continue;
            }
            let mut top = i;
            while of_node[top] == NO_CELL {
                top = up[top] as usize;
            }
            let (region, mut node) = (of_node[top], i);
            while of_node[node] == NO_CELL {
                of_node[node] = region;
                node = up[node] as usize;
            }
        }
        Self { of_node, summits }
    }
}

/// The neighbour in the direction of steepest ascent among the eight around each node, itself at a summit; [`NO_CELL`] at
/// voids. Of equally steep ways the one to the largest index.
fn ascent(field: &Field) -> Vec<u32> {
    let (cols, rows) = (field.cols(), field.rows());
    let heights = field.heights();
    let solid = !field.void().contains(&true);
    let around = Around::new(field);
    let mut up = vec![0u32; heights.len()];
    up.par_chunks_mut(cols).enumerate().with_min_len(64).for_each(|(row, out)| {
        let inner = row > 0 && row + 1 < rows && solid;
        for (col, out) in out.iter_mut().enumerate() {
            let i = row * cols + col;
            *out = if inner && col > 0 && col + 1 < cols {
                around.steepest(heights, i)
            } else {
                around.steepest_at_the_rim(field, col, row)
            };
        }
    });
    up
}

/// The eight neighbours in ascending order of their indices.
struct Around {
    offset: [isize; 8],
    per_m: [f64; 8],
}

const STEPS: [(isize, isize); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

impl Around {
    fn new(field: &Field) -> Self {
        let d = field.spacing();
        Self {
            offset: STEPS.map(|(x, y)| y * field.cols() as isize + x),
            per_m: STEPS.map(|(x, y)| 1.0 / (x as f64 * d.x).hypot(y as f64 * d.y)),
        }
    }

    /// Whether a neighbour that is `slope` steep and comes `k`-th is higher in the order and no worse than `best`.
    fn better(k: usize, slope: f64, best: f64) -> bool {
        // Equal heights: the larger index is higher.
        slope >= best && (k >= 4 || slope > 0.0)
    }

    fn steepest(&self, heights: &[f64], i: usize) -> u32 {
        let h = heights[i];
        let (mut best, mut to) = (0.0, i);
        for k in 0..8 {
            let j = i.wrapping_add_signed(self.offset[k]);
            let slope = (heights[j] - h) * self.per_m[k];
            let better = Self::better(k, slope, best);
            best = if better { slope } else { best };
            to = if better { j } else { to };
        }
        to as u32
    }

    fn steepest_at_the_rim(&self, field: &Field, col: usize, row: usize) -> u32 {
        let i = row * field.cols() + col;
        if field.void()[i] {
            return NO_CELL;
        }
        let (mut best, mut to) = (0.0, i);
        for (k, (x, y)) in STEPS.into_iter().enumerate() {
            let (Some(c), Some(r)) = (col.checked_add_signed(x), row.checked_add_signed(y)) else { continue };
            let j = r * field.cols() + c;
            if c >= field.cols() || r >= field.rows() || field.void()[j] {
                continue;
            }
            let slope = (field.heights()[j] - field.heights()[i]) * self.per_m[k];
            if Self::better(k, slope, best) {
                (best, to) = (slope, j);
            }
        }
        to as u32
    }
}
