//! Regions of steepest ascent, one for every summit.

use super::super::Field;
use super::NO_CELL;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Rows of the grid that are handled as one task. Results do not depend on it.
pub(super) const BAND: usize = 32;

/// The region of every summit, however small: all nodes whose steepest ascent ends there.
pub(super) struct Regions {
    /// Region of each node; [`NO_CELL`] at voids.
    pub(super) of_node: Vec<u32>,
    /// Node of each region's summit, ascending.
    pub(super) summits: Vec<u32>,
}

/// Marks the node at which an ascent leaves its band; otherwise a region.
const LEAVES: u32 = 1 << 31;
/// Not yet known.
const UNKNOWN: u32 = NO_CELL - 1;

impl Regions {
    pub(super) fn new(field: &Field) -> Self {
        let cols = field.cols();
        let around = Around::new(field);
        let mut of_node = vec![UNKNOWN; field.heights().len()];
        let bands = of_node.par_chunks_mut(BAND * cols).enumerate();
        let summits: Vec<Vec<u32>> = bands
            .map(|(band, out)| climb(band * BAND, cols, &around.ascent(field, band * BAND, out.len() / cols), out))
            .collect();
        let mut offset = vec![0u32];
        offset.extend(summits.iter().scan(0u32, |sum, s| {
            *sum += s.len() as u32;
            Some(*sum)
        }));
        let rims = Rims::new(&of_node, cols, &offset);
        of_node.par_chunks_mut(BAND * cols).enumerate().for_each(|(band, out)| {
            for region in out.iter_mut().filter(|r| **r != NO_CELL) {
                *region = if *region & LEAVES == 0 {
                    *region + offset[band]
                } else {
                    rims.region((*region & !LEAVES) as usize)
                };
            }
        });
        Self { of_node, summits: summits.concat() }
    }
}

/// Finds for every node of a band its region, counted from the first summit of the band, or the node at which its ascent leaves the
/// band. Returns the summits. Every path is followed once, up to the first node whose answer is known, and back.
fn climb(first_row: usize, cols: usize, ascent: &[u8], out: &mut [u32]) -> Vec<u32> {
    let first = first_row * cols;
    let offset = NEIGHBOURS.map(|(x, y)| y * cols as isize + x);
    let mut summits = Vec::new();
    for (i, &way) in ascent.iter().enumerate() {
        if way == SUMMIT {
            out[i] = summits.len() as u32;
            summits.push((first + i) as u32);
        } else if way == VOID {
            out[i] = NO_CELL;
        }
    }
    let mut path = Vec::new();
    for i in 0..out.len() {
        let mut node = i;
        let end = loop {
            if out[node] != UNKNOWN {
                break out[node];
            }
            path.push(node);
            // Outside the band the index wraps around or lies beyond the end.
            let next = node.wrapping_add_signed(offset[ascent[node] as usize]);
            if next >= out.len() {
                break (first.wrapping_add(next)) as u32 | LEAVES;
            }
            node = next;
        };
        path.drain(..).for_each(|node| out[node] = end);
    }
    summits
}

/// Regions of the first and last rows of the bands, where ascents from the next bands arrive.
struct Rims {
    cols: usize,
    /// First and last row of each band in turn.
    region: Vec<u32>,
}

impl Rims {
    fn new(of_node: &[u32], cols: usize, offset: &[u32]) -> Self {
        let rows = of_node.len() / cols;
        let last = |band: usize| (band * BAND + BAND).min(rows) - 1;
        let rim_rows = (0..rows.div_ceil(BAND)).flat_map(|band| [band * BAND, last(band)]);
        let region = rim_rows.flat_map(|row| row * cols..(row + 1) * cols).map(|start| {
            let mut node = start;
            loop {
                let found = of_node[node];
                if found == NO_CELL {
                    break NO_CELL;
                }
                if found & LEAVES == 0 {
                    break found + offset[node / cols / BAND];
                }
                node = (found & !LEAVES) as usize;
            }
        });
        Self { cols, region: region.collect() }
    }

    fn region(&self, node: usize) -> u32 {
        let (row, col) = (node / self.cols, node % self.cols);
        let rim = 2 * (row / BAND) + usize::from(!row.is_multiple_of(BAND));
        self.region[rim * self.cols + col]
    }
}

/// Task for the inner nodes of a row, with the widest available SIMD registers.
struct Inner<'a> {
    around: &'a Around,
    lines: [&'a [f64]; 3],
    out: &'a mut [u8],
}

impl WithSimd for Inner<'_> {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        self.around.inner(simd, self.lines, self.out)
    }
}

/// The eight neighbours in ascending order of their indices.
struct Around {
    per_m: [f64; 8],
}

const NEIGHBOURS: [(isize, isize); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
/// Codes beyond the eight neighbours: a node without a higher neighbour, and one without data.
const SUMMIT: u8 = 8;
const VOID: u8 = 9;

impl Around {
    fn new(field: &Field) -> Self {
        let d = field.spacing();
        Self { per_m: NEIGHBOURS.map(|(x, y)| 1.0 / (x as f64 * d.x).hypot(y as f64 * d.y)) }
    }

    /// For each node of some rows the neighbour in the direction of steepest ascent, [`SUMMIT`] or [`VOID`]; of equally steep
    /// directions the one to the largest index.
    fn ascent(&self, field: &Field, first: usize, count: usize) -> Vec<u8> {
        let (cols, rows) = (field.cols(), field.rows());
        let mut out = vec![SUMMIT; cols * count];
        for (row, out) in (first..).zip(out.chunks_exact_mut(cols)) {
            let around = row.saturating_sub(1)..(row + 2).min(rows);
            let solid = !field.void()[around.start * cols..around.end * cols].contains(&true);
            let mut col = 0;
            if solid && around.len() == 3 {
                let lines = [row - 1, row, row + 1].map(|r| &field.heights()[r * cols..(r + 1) * cols]);
                out[0] = self.at_the_rim(field, 0, row);
                col = Arch::new().dispatch(Inner { around: self, lines, out });
            }
            while col < cols {
                out[col] = self.at_the_rim(field, col, row);
                col += 1;
            }
        }
        out
    }

    /// Whether a neighbour that is `slope` steep and comes `k`-th is higher in the order and no worse than `best`.
    fn better(k: usize, slope: f64, best: f64) -> bool {
        // Equal heights: the larger index is higher.
        slope >= best && (k >= 4 || slope > 0.0)
    }

    /// Handles nodes from 1 on of a row between two others, as many as fill whole SIMD registers; returns the next node.
    #[inline(always)]
    fn inner<S: Simd>(&self, simd: S, lines: [&[f64]; 3], out: &mut [u8]) -> usize {
        let (width, zero) = (S::F64_LANES, simd.splat_f64s(0.0));
        let load = |y: isize, at: usize| S::as_simd_f64s(&lines[(y + 1) as usize][at..at + width]).0[0];
        let mut start = 1;
        while start + width < out.len() {
            let here = load(0, start);
            let (mut best, mut to) = (zero, simd.splat_f64s(f64::from(SUMMIT)));
            for (k, (x, y)) in NEIGHBOURS.into_iter().enumerate() {
                let rise = simd.sub_f64s(load(y, start.wrapping_add_signed(x)), here);
                let slope = simd.mul_f64s(rise, simd.splat_f64s(self.per_m[k]));
                // As in `better`.
                let mut better = simd.greater_than_or_equal_f64s(slope, best);
                if k < 4 {
                    better = simd.and_m64s(better, simd.greater_than_f64s(slope, zero));
                }
                best = simd.select_f64s(better, slope, best);
                to = simd.select_f64s(better, simd.splat_f64s(k as f64), to);
            }
            let mut ways = [0.0; 8];
            S::as_mut_simd_f64s(&mut ways[..width]).0[0] = to;
            for (out, way) in out[start..start + width].iter_mut().zip(ways) {
                *out = way as u8;
            }
            start += width;
        }
        start
    }

    fn at_the_rim(&self, field: &Field, col: usize, row: usize) -> u8 {
        let i = row * field.cols() + col;
        if field.void()[i] {
            return VOID;
        }
        let (mut best, mut to) = (0.0, SUMMIT);
        for (k, (x, y)) in NEIGHBOURS.into_iter().enumerate() {
            let (Some(c), Some(r)) = (col.checked_add_signed(x), row.checked_add_signed(y)) else { continue };
            let j = r * field.cols() + c;
            if c >= field.cols() || r >= field.rows() || field.void()[j] {
                continue;
            }
            let slope = (field.heights()[j] - field.heights()[i]) * self.per_m[k];
            if Self::better(k, slope, best) {
                (best, to) = (slope, k as u8);
            }
        }
        to
    }
}
