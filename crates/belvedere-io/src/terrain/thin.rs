//! Thinning of grids with more nodes than allowed.

use rayon::prelude::*;
use std::ops::Range;

/// Factor by which each side must shrink to at most `budget` nodes; `None` if it need not.
pub(super) fn thinning(cols: usize, rows: usize, budget: usize) -> Option<usize> {
    let fits = |k: usize| ((cols - 1) / k + 1).saturating_mul((rows - 1) / k + 1) <= budget;
    if fits(1) {
        return None;
    }
    // a step that divides both sides keeps shared edges of tiles; a slightly larger step is accepted
    let k = (2..cols.max(rows)).find(|&k| fits(k))?;
    let even = (k..=k + k / 2 + 1).find(|&n| (cols - 1).is_multiple_of(n) && (rows - 1).is_multiple_of(n));
    Some(even.unwrap_or(k))
}

/// Every k-th node, smoothed by a tent of that width over its valid neighbours; voids stay voids.
pub(super) fn thin(heights: &[f32], cols: usize, rows: usize, k: usize) -> (Vec<f32>, usize, usize) {
    let whole = Rows { heights, cols, rows, first: 0 };
    let (out_cols, out_rows) = thinned_size([cols, rows], k);
    (whole.thinned(k, 0..out_rows), out_cols, out_rows)
}

/// Columns and rows of a grid of every k-th node.
pub(super) fn thinned_size(size: [usize; 2], k: usize) -> (usize, usize) {
    let [cols, rows] = size.map(|n| (n - 1) / k + 1);
    (cols, rows)
}

/// Consecutive rows of a grid.
pub(super) struct Rows<'a> {
    pub(super) heights: &'a [f32],
    pub(super) cols: usize,
    /// Rows of the whole grid.
    pub(super) rows: usize,
    /// Number of the first row at hand.
    pub(super) first: usize,
}

impl Rows<'_> {
    /// Rows `out` of the grid of every k-th node. All rows less than k away from those must be at hand.
    pub(super) fn thinned(&self, k: usize, out: Range<usize>) -> Vec<f32> {
        let (cols, _) = thinned_size([self.cols, self.rows], k);
        let node = |i: usize| self.node(k, [i % cols * k, (out.start + i / cols) * k]);
        (0..cols * out.len()).into_par_iter().with_min_len(1024).map(node).collect()
    }

    fn node(&self, k: usize, [c, r]: [usize; 2]) -> f32 {
        let at = |c: usize, r: usize| self.heights[(r - self.first) * self.cols + c];
        if !at(c, r).is_finite() {
            return at(c, r);
        }
        let reach = k as isize - 1;
        let (mut sum, mut weights) = (0.0f64, 0.0f64);
        for dr in -reach..=reach {
            for dc in -reach..=reach {
                let (Some(cc), Some(rr)) = (c.checked_add_signed(dc), r.checked_add_signed(dr)) else { continue };
                if cc >= self.cols || rr >= self.rows || !at(cc, rr).is_finite() {
                    continue;
                }
                let w = ((k as isize - dc.abs()) * (k as isize - dr.abs())) as f64;
                sum += w * f64::from(at(cc, rr));
                weights += w;
            }
        }
        (sum / weights) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_shared_edges_and_voids() {
        assert_eq!(thinning(1201, 1201, 2_000_000), None);
        assert_eq!(thinning(1201, 1201, 400_000), Some(2));
        assert_eq!(thinning(3601, 3601, 1_000_000), Some(4));
        let mut h = vec![10.0f32; 49];
        h[0] = f32::NAN;
        h[1] = 14.0;
        let (out, cols, rows) = thin(&h, 7, 7, 3);
        assert_eq!((cols, rows), (3, 3));
        assert!(out[0].is_nan() && out[1] > 10.0 && out[8] == 10.0);
    }
}
