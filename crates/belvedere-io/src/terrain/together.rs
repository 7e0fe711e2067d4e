//! Sources that lie over and beside one another: their order, and those of one lattice as one.

use super::source::SourceGrid;
use crate::crs::CoordinateSystem;
use belvedere_core::{Warning, WarningKind};

/// Metres per degree of latitude, to compare spacings.
const DEGREE_M: f64 = 111_000.0;
/// Spacings that differ by less than this share count as equal.
const ALIKE: f64 = 0.01;
/// Sources of one lattice are blended by the distance from their borders, up to so many samples.
const BLENDED: u8 = 16;

impl SourceGrid {
    /// Spacing of its samples at its middle, metres (or units of a plane that is not known): side of a square as large as a cell.
    pub(super) fn spacing_m(&self) -> f64 {
        let [a, b, _, d, e, _] = self.model_from_index.0;
        let side = (a * e - b * d).abs().sqrt();
        let unit = self.system.as_ref().map(CoordinateSystem::metres_per_unit);
        let [_, lat] = self.model_from_index.apply(0.5 * self.cols as f64, 0.5 * self.rows as f64);
        side * unit.map_or(1.0, |unit| unit.unwrap_or_else(|| DEGREE_M * lat.to_radians().cos().abs().sqrt()))
    }
}

/// Puts sources into an order that does not hang on the one in which they are named: the finest first, then from north to south and west to
/// east.
pub(super) fn arrange(sources: &mut [SourceGrid]) {
    let key = |s: &SourceGrid| {
        let [x, y] = s.model_from_index.apply(0.0, 0.0);
        ((s.spacing_m().ln() / ALIKE).round(), -y, x)
    };
    sources.sort_by(|a, b| {
        let ((a0, a1, a2), (b0, b1, b2)) = (key(a), key(b));
        a0.total_cmp(&b0).then(a1.total_cmp(&b1)).then(a2.total_cmp(&b2)).then_with(|| a.path.cmp(&b.path))
    });
}

/// Distance of each sample from the nearest one without data, or from beyond the grid, by steps to any of eight neighbours; at most `most`.
pub(super) fn depth(heights: &[f32], cols: usize, most: u8) -> Vec<u8> {
    let rows = heights.len() / cols;
    let mut depth: Vec<u8> = heights.iter().map(|h| if h.is_finite() { most } else { 0 }).collect();
    let mut pass = |order: &mut dyn Iterator<Item = usize>, back: isize| {
        for i in order {
            let (c, r) = ((i % cols) as isize, (i / cols) as isize);
            let at = |depth: &[u8], dc: isize, dr: isize| {
                let (c, r) = (c + dc, r + dr);
                let inside = c >= 0 && r >= 0 && c < cols as isize && r < rows as isize;
                if inside { depth[r as usize * cols + c as usize] } else { 0 }
            };
            let before = [(back, 0), (-1, back), (0, back), (1, back)];
            let least = before.into_iter().map(|(dc, dr)| at(&depth, dc, dr)).min().unwrap_or(0);
            depth[i] = depth[i].min(least.saturating_add(1));
        }
    };
    pass(&mut (0..heights.len()), -1);
    pass(&mut (0..heights.len()).rev(), 1);
    depth
}

/// Joins sources that lie on one lattice (tiles with shared or touching edges) into one, so that no seam is left. Where several have
/// data their mean is taken, weighted by the distance from their borders. Others are returned as they are, in their order.
pub(super) fn merge_aligned(
    sources: Vec<SourceGrid>,
    max_nodes: usize,
    warnings: &mut Vec<Warning>,
) -> Vec<SourceGrid> {
    let mut lattices: Vec<Vec<(SourceGrid, [i64; 2])>> = Vec::new();
    for source in sources {
        let offsets: Vec<_> = lattices.iter().map(|of| lattice_offset(&of[0].0, &source)).collect();
        match offsets.iter().position(Option::is_some) {
            Some(k) => lattices[k].push((source, offsets[k].unwrap_or_default())),
            None => lattices.push(vec![(source, [0, 0])]),
        }
    }
    lattices.into_iter().flat_map(|of| merge(of, max_nodes, warnings)).collect()
}

/// Sources of one lattice, each with the columns and rows from the first node of the first to its own, as one; or as they are if they
/// lie too far apart for that.
fn merge(of: Vec<(SourceGrid, [i64; 2])>, max_nodes: usize, warnings: &mut Vec<Warning>) -> Vec<SourceGrid> {
    let apart = |of: Vec<(SourceGrid, [i64; 2])>| of.into_iter().map(|(source, _)| source).collect();
    let least = |axis: usize| of.iter().map(|(_, o)| o[axis]).min().unwrap_or(0);
    let (left, top) = (least(0), least(1));
    let extent = |axis: usize, size: fn(&SourceGrid) -> usize| {
        of.iter().map(|(s, o)| o[axis] + size(s) as i64).max().unwrap_or(0)
    };
    let (cols, rows) = (extent(0, |s| s.cols) - left, extent(1, |s| s.rows) - top);
    let (Ok(cols), Ok(rows)) = (usize::try_from(cols), usize::try_from(rows)) else { return apart(of) };
    if of.len() < 2 || cols.checked_mul(rows).is_none_or(|n| n > max_nodes.saturating_mul(2)) {
        return apart(of);
    }
    let mut mean =
        Mean { heights: vec![f32::INFINITY; cols * rows], weights: vec![0.0; cols * rows], differing: 0, largest: 0.0 };
    for (source, [c0, r0]) in &of {
        let (c0, r0) = ((c0 - left) as usize, (r0 - top) as usize);
        let depth = depth(&source.heights, source.cols, BLENDED);
        for (r, row) in source.heights.chunks_exact(source.cols).enumerate() {
            let start = (r0 + r) * cols + c0;
            mean.add(start, row, &depth[r * source.cols..][..row.len()]);
        }
    }
    let first = &of[0].0;
    if mean.differing > 0 {
        let (differing, largest) = (mean.differing, mean.largest);
        let text = format!(
            "it and other files of its grid differ at {differing} samples that they share, by up to {largest:.1} m; there their mean is taken"
        );
        let warning = Warning::new(WarningKind::Repaired, text).with("count", differing as f64);
        warnings.push(warning.with("largest_m", f64::from(largest)).in_file(&first.path));
    }
    vec![SourceGrid {
        path: first.path.clone(),
        cols,
        rows,
        heights: mean.heights,
        model_from_index: first.model_from_index.after_scale_and_shift(1.0, 1.0, left as f64, top as f64),
        system: first.system.clone(),
        is_elsewhere: first.is_elsewhere,
        samples: of.iter().map(|(s, _)| s.samples).sum(),
        voids: of.iter().map(|(s, _)| s.voids).sum(),
    }]
}

/// Weighted mean of the heights of several sources at each node.
struct Mean {
    heights: Vec<f32>,
    weights: Vec<f32>,
    /// Nodes at which sources differ, and by how much at most, metres.
    differing: usize,
    largest: f32,
}

impl Mean {
    /// Adds a row of heights from node `start` on.
    fn add(&mut self, start: usize, row: &[f32], depth: &[u8]) {
        let there = self.heights[start..].iter_mut().zip(&mut self.weights[start..]);
        for ((height, weight), (&new, &depth)) in there.zip(row.iter().zip(depth)) {
            if !new.is_finite() {
                if height.is_infinite() {
                    *height = new;
                }
                continue;
            }
            let own = f32::from(depth);
            if height.is_finite() && *height != new {
                self.differing += 1;
                self.largest = self.largest.max((new - *height).abs());
                *height = (*height * *weight + new * own) / (*weight + own);
            } else {
                *height = new;
            }
            *weight += own;
        }
    }
}

/// Columns and rows from the first node of `a` to that of `b` if both lie on one lattice.
fn lattice_offset(a: &SourceGrid, b: &SourceGrid) -> Option<[i64; 2]> {
    if a.system != b.system {
        return None;
    }
    let inverse = a.model_from_index.inverse()?;
    let place = |c: f64, r: f64| {
        let [x, y] = b.model_from_index.apply(c, r);
        inverse.apply(x, y)
    };
    let (last_c, last_r) = ((b.cols - 1) as f64, (b.rows - 1) as f64);
    let mut start = place(0.0, 0.0);
    let mut turn = 0.0;
    if a.system.as_ref().is_some_and(CoordinateSystem::is_geographic) {
        // neighbours across the antimeridian are 360 degrees apart in the files
        let around = 360.0 / a.model_from_index.0[0].abs();
        turn = around * (start[0] / around).round();
        start[0] -= turn;
    }
    let start = start.map(f64::round);
    // every corner must fall on the node it should, to a hundredth of a cell
    let on_lattice = [(0.0, 0.0), (last_c, 0.0), (0.0, last_r), (last_c, last_r)].iter().all(|&(c, r)| {
        let p = place(c, r);
        (p[0] - turn - start[0] - c).abs() < 0.01 && (p[1] - start[1] - r).abs() < 0.01
    });
    (on_lattice && start.iter().all(|v| v.abs() < 1e9)).then(|| [start[0] as i64, start[1] as i64])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_counts_steps_to_voids_and_to_the_border() {
        let (cols, rows) = (9, 7);
        let mut heights = vec![1.0f32; cols * rows];
        heights[3 * cols + 6] = f32::NAN;
        let slowly = |c: i32, r: i32| {
            let border = [c + 1, r + 1, cols as i32 - c, rows as i32 - r].into_iter().min().unwrap_or(0);
            border.min((c - 6).abs().max((r - 3).abs())).min(3)
        };
        for (i, depth) in depth(&heights, cols, 3).into_iter().enumerate() {
            let (c, r) = ((i % cols) as i32, (i / cols) as i32);
            assert_eq!(i32::from(depth), slowly(c, r), "{c}, {r}");
        }
    }
}
