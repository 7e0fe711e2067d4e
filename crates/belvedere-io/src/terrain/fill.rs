//! Filling of holes by a smooth membrane (Laplace's equation, multigrid).

use crate::IoError;
use belvedere_scene::Progress;

/// Relaxation sweeps per level: the coarser level gives the smooth part, the sweeps only the detail.
const SWEEPS: usize = 40;
/// Over-relaxation, 1..2.
const OMEGA: f32 = 1.75;

/// One level of the pyramid: NaN = to be filled, infinite = outside, never filled.
struct Level {
    cols: usize,
    rows: usize,
    heights: Vec<f32>,
}

impl Level {
    /// Height at a node of the next finer level: bilinear between the middles of the known coarse cells.
    fn at_fine(&self, c: usize, r: usize) -> f32 {
        let beside = |fine: usize, n: usize| {
            let near = fine / 2;
            let other = if fine.is_multiple_of(2) { near.checked_sub(1) } else { Some(near + 1).filter(|&k| k < n) };
            (near, other)
        };
        let ((c0, c1), (r0, r1)) = (beside(c, self.cols), beside(r, self.rows));
        let (mut sum, mut weights) = (0.0f32, 0.0f32);
        for (row, wr) in [(Some(r0), 0.75f32), (r1, 0.25)] {
            for (col, wc) in [(Some(c0), 0.75f32), (c1, 0.25)] {
                if let (Some(col), Some(row)) = (col, row)
                    && self.heights[row * self.cols + col].is_finite()
                {
                    sum += wr * wc * self.heights[row * self.cols + col];
                    weights += wr * wc;
                }
            }
        }
        sum / weights
    }
}

/// Marks holes (NaN, joined along rows and columns) of more than `most` nodes as outside; returns their number.
pub(super) fn leave_open(cols: usize, heights: &mut [f32], most: usize) -> usize {
    let mut seen = vec![false; heights.len()];
    let (mut hole, mut large) = (Vec::new(), 0);
    for start in 0..heights.len() {
        if seen[start] || !heights[start].is_nan() {
            continue;
        }
        seen[start] = true;
        hole.clear();
        hole.push(start);
        let mut next = 0;
        while let Some(&i) = hole.get(next) {
            next += 1;
            let c = i % cols;
            let beside = [
                (c > 0).then(|| i - 1),
                (c + 1 < cols).then(|| i + 1),
                i.checked_sub(cols),
                (i + cols < heights.len()).then(|| i + cols),
            ];
            for k in beside.into_iter().flatten() {
                if heights[k].is_nan() && !std::mem::replace(&mut seen[k], true) {
                    hole.push(k);
                }
            }
        }
        if hole.len() > most {
            large += 1;
            hole.iter().for_each(|&i| heights[i] = f32::INFINITY);
        }
    }
    large
}

/// Replaces NaN by the solution of Laplace's equation with the known heights as boundary values and no flow through the
/// outside (infinite) and the border: multigrid from coarse to fine, each level relaxed by Gauss-Seidel with
/// over-relaxation (any textbook). Known heights are not touched; the same input gives the same bits.
pub(super) fn fill(cols: usize, rows: usize, heights: &mut Vec<f32>, progress: &Progress) -> Result<(), IoError> {
    if !heights.iter().any(|h| h.is_nan()) || !heights.iter().any(|h| h.is_finite()) {
        return Ok(());
    }
    let mut pyramid = vec![Level { cols, rows, heights: std::mem::take(heights) }];
    while let Some(finest) = pyramid.last()
        && finest.heights.iter().any(|h| h.is_nan())
    {
        pyramid.push(coarser(finest));
    }
    let levels = pyramid.len();
    let mut coarse: Option<Level> = None;
    while let Some(mut level) = pyramid.pop() {
        progress.tick("filling voids", 1.0 - (pyramid.len() + 1) as f64 / levels as f64)?;
        if let Some(coarse) = &coarse {
            let unknown: Vec<usize> = (0..level.heights.len()).filter(|&i| level.heights[i].is_nan()).collect();
            for &i in &unknown {
                let (c, r) = (i % level.cols, i / level.cols);
                level.heights[i] = coarse.at_fine(c, r);
            }
            relax(&mut level, &unknown);
        }
        coarse = Some(level);
    }
    if let Some(finest) = coarse {
        *heights = finest.heights;
    }
    Ok(())
}

/// The level of half the size: means of the known nodes; NaN where none is known and one is to be filled, else infinite.
fn coarser(fine: &Level) -> Level {
    let (cols, rows) = (fine.cols.div_ceil(2), fine.rows.div_ceil(2));
    let mut heights = Vec::with_capacity(cols * rows);
    for r in 0..rows {
        for c in 0..cols {
            let (mut sum, mut count, mut wanted) = (0.0f64, 0u32, false);
            for (rr, cc) in [(2 * r, 2 * c), (2 * r, 2 * c + 1), (2 * r + 1, 2 * c), (2 * r + 1, 2 * c + 1)] {
                if rr >= fine.rows || cc >= fine.cols {
                    continue;
                }
                let h = fine.heights[rr * fine.cols + cc];
                if h.is_finite() {
                    sum += f64::from(h);
                    count += 1;
                }
                wanted |= h.is_nan();
            }
            heights.push(match (count, wanted) {
                (0, true) => f32::NAN,
                (0, false) => f32::INFINITY,
                _ => (sum / f64::from(count)) as f32,
            });
        }
    }
    Level { cols, rows, heights }
}

fn relax(level: &mut Level, unknown: &[usize]) {
    let (cols, rows) = (level.cols, level.rows);
    let heights = &mut level.heights;
    for sweep in 0..SWEEPS {
        let mut update = |i: usize| {
            let (c, r) = (i % cols, i / cols);
            let (mut sum, mut count) = (0.0f32, 0.0f32);
            let mut add = |h: f32| {
                if h.is_finite() {
                    sum += h;
                    count += 1.0;
                }
            };
            if c > 0 {
                add(heights[i - 1]);
            }
            if c + 1 < cols {
                add(heights[i + 1]);
            }
            if r > 0 {
                add(heights[i - cols]);
            }
            if r + 1 < rows {
                add(heights[i + cols]);
            }
            if count > 0.0 {
                // the last sweeps settle without overshoot
                let omega = if sweep + 4 < SWEEPS { OMEGA } else { 1.0 };
                let mean = sum / count;
                heights[i] = if heights[i].is_finite() { heights[i] + omega * (mean - heights[i]) } else { mean };
            }
        };
        if sweep.is_multiple_of(2) {
            unknown.iter().copied().for_each(&mut update);
        } else {
            unknown.iter().rev().copied().for_each(&mut update);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_hole_is_judged_by_itself() {
        // A hole of 9 nodes, one of 4 that touches it only at a corner, and one at the border.
        let (cols, rows) = (12, 10);
        let holes = [(2..5, 2..5), (5..7, 5..7), (11..12, 0..3)];
        let inside = |c: usize, r: usize| holes.iter().position(|(cs, rs)| cs.contains(&c) && rs.contains(&r));
        let made = |i: usize| if inside(i % cols, i / cols).is_some() { f32::NAN } else { i as f32 };
        for (most, open) in [(9, 0), (8, 1), (4, 1), (3, 2), (2, 3), (0, 3)] {
            let mut heights: Vec<f32> = (0..cols * rows).map(made).collect();
            assert_eq!(leave_open(cols, &mut heights, most), open, "at most {most}");
            fill(cols, rows, &mut heights, &Progress::silent()).unwrap();
            for (i, h) in heights.iter().enumerate() {
                let size = inside(i % cols, i / cols).map(|k| [9, 4, 3][k]);
                assert_eq!(h.is_finite(), size.is_none_or(|n| n <= most), "node {i}, at most {most}");
            }
        }
    }

    #[test]
    fn holes_beside_every_border_are_filled_with_the_plane_around_them() {
        let (cols, rows) = (15, 15);
        let plane = |i: usize| 100.0 + 3.0 * (i % cols) as f32 - 2.0 * (i / cols) as f32;
        // One node of ground is left between a hole and its border.
        let holes = [(1..3, 6..9), (12..14, 6..9), (6..9, 1..3), (6..9, 12..14)];
        let inside = |i: usize| holes.iter().any(|(cs, rs)| cs.contains(&(i % cols)) && rs.contains(&(i / cols)));
        let mut heights: Vec<f32> = (0..cols * rows).map(|i| if inside(i) { f32::NAN } else { plane(i) }).collect();
        fill(cols, rows, &mut heights, &Progress::silent()).unwrap();
        for (i, h) in heights.iter().enumerate() {
            assert!((h - plane(i)).abs() < 0.05, "node {}, {}: {h} of {}", i % cols, i / cols, plane(i));
        }
    }
}
