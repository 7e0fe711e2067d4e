//! Persistence of summits: regions are merged at their saddles, from the highest saddle down (union-find).

use super::super::Field;
use super::NO_CELL;
use super::pairs::Pairs;
use super::regions::{BAND, Regions};
use rayon::prelude::*;
use std::cmp::Ordering::{self, Equal};

/// For every region the saddle at which its summit is merged into a higher one.
pub(super) struct Persistence {
    /// Height of the summit over that saddle, scene units; infinite if the summit is never merged.
    height: Vec<f64>,
    /// Region beyond that saddle; the region itself if its summit is never merged.
    across: Vec<u32>,
}

/// The summits that are kept, and the cell of every region.
pub(super) struct Kept {
    /// Cell of each region.
    pub(super) cell_of: Vec<u32>,
    /// Node of each cell's summit, ascending.
    pub(super) summits: Vec<u32>,
    /// Persistence of each cell's summit.
    pub(super) persistence: Vec<f64>,
}

/// Highest saddle between two regions: height and index of the lower of two adjacent nodes. Saddles are ordered as nodes are; the
/// default is the lowest possible one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
struct Saddle {
    /// Bits of the height, changed so that they have the order of the heights.
    key: u64,
    node: u32,
}

const SIGN: u64 = 1 << 63;

impl Saddle {
    #[inline]
    fn new(height: f64, node: usize) -> Self {
        // -0 and 0 are one height.
        let bits = (height + 0.0).to_bits();
        Self { key: if bits & SIGN == 0 { bits | SIGN } else { !bits }, node: node as u32 }
    }

    fn height(self) -> f64 {
        f64::from_bits(if self.key & SIGN == 0 { !self.key } else { self.key & !SIGN })
    }
}

impl Persistence {
    pub(super) fn new(field: &Field, regions: &Regions) -> Self {
        let order = Order(field.heights());
        let count = regions.summits.len();
        let mut out = Self { height: vec![f64::INFINITY; count], across: (0..count as u32).collect() };
        // A component is named after the region of its highest summit.
        let mut parent: Vec<u32> = (0..count as u32).collect();
        for (saddle, [a, b]) in saddles(field, regions) {
            let (top_a, top_b) = (find(&mut parent, a), find(&mut parent, b));
            if top_a == top_b {
                continue;
            }
            let summit = |r: u32| regions.summits[r as usize];
            let a_stays = order.compare(summit(top_a), summit(top_b)).is_gt();
            let (stays, goes, beyond) = if a_stays { (top_a, top_b, a) } else { (top_b, top_a, b) };
            parent[goes as usize] = stays;
            out.height[goes as usize] = field.heights()[summit(goes) as usize] - saddle.height();
            out.across[goes as usize] = beyond;
        }
        out
    }

    /// Keeps the `keep` most persistent summits and every one that is never merged; of equal ones the higher. The region of any other
    /// summit joins the region beyond its saddle, and so on up to a kept one.
    pub(super) fn keep(&self, field: &Field, regions: &Regions, keep: usize) -> Kept {
        let order = Order(field.heights());
        let mut ranked: Vec<u32> = (0..self.height.len() as u32).collect();
        ranked.sort_unstable_by(|&a, &b| {
            let (a, b) = (a as usize, b as usize);
            self.height[b]
                .partial_cmp(&self.height[a])
                .unwrap_or(Equal)
                .then_with(|| order.compare(regions.summits[b], regions.summits[a]))
        });
        let endless = ranked.iter().take_while(|&&r| self.height[r as usize] == f64::INFINITY).count();
        ranked.truncate(keep.max(endless));
        ranked.sort_unstable();
        let mut cell_of = vec![NO_CELL; self.height.len()];
        for (cell, &r) in ranked.iter().enumerate() {
            cell_of[r as usize] = cell as u32;
        }
        for r in 0..cell_of.len() {
            let mut end = r;
            while cell_of[end] == NO_CELL {
                end = self.across[end] as usize;
            }
            let (cell, mut on) = (cell_of[end], r);
            while cell_of[on] == NO_CELL {
                cell_of[on] = cell;
                on = self.across[on] as usize;
            }
        }
        let summits = ranked.iter().map(|&r| regions.summits[r as usize]).collect();
        let persistence = ranked.iter().map(|&r| self.height[r as usize]).collect();
        Kept { cell_of, summits, persistence }
    }
}

/// Nodes by height, equal heights by index.
#[derive(Clone, Copy)]
struct Order<'a>(&'a [f64]);

impl Order<'_> {
    fn compare(self, a: u32, b: u32) -> Ordering {
        // Not `total_cmp`, to which -0 and 0 differ; no height is NaN.
        self.0[a as usize].partial_cmp(&self.0[b as usize]).unwrap_or(Equal).then(a.cmp(&b))
    }
}

/// Highest saddle between touching regions, over all eight directions; the highest first.
fn saddles(field: &Field, regions: &Regions) -> Vec<(Saddle, [u32; 2])> {
    let (cols, rows) = (field.cols(), field.rows());
    let bands: Vec<Pairs<Saddle>> = (0..rows.div_ceil(BAND))
        .into_par_iter()
        .map(|band| {
            let mut out = Pairs::new();
            for row in band * BAND..(band * BAND + BAND).min(rows) {
                let line = |row: usize| {
                    let range = row * cols..((row + 1) * cols).min(rows * cols);
                    Line { first: range.start, of: &regions.of_node[range.clone()], heights: &field.heights()[range] }
                };
                line(row).meet_next(&mut out);
                if row + 1 < rows {
                    line(row).meet_below(&line(row + 1), &mut out);
                }
            }
            out
        })
        .collect();
    let mut all = Pairs::new();
    for ([a, b], saddle) in bands.iter().flat_map(Pairs::iter) {
        let best: &mut Saddle = all.entry(a, b);
        *best = saddle.max(*best);
    }
    let mut all: Vec<_> = all.iter().map(|(pair, saddle)| (saddle, pair)).collect();
    all.par_sort_unstable_by(|(a, p), (b, q)| b.cmp(a).then_with(|| p.cmp(q)));
    all
}

/// A row of the grid.
struct Line<'a> {
    /// Index of its first node.
    first: usize,
    of: &'a [u32],
    heights: &'a [f64],
}

impl Line<'_> {
    fn meet_next(&self, out: &mut Pairs<Saddle>) {
        for c in 1..self.of.len() {
            self.meet(c - 1, self, c, out);
        }
    }

    fn meet_below(&self, below: &Self, out: &mut Pairs<Saddle>) {
        let last = self.of.len() - 1;
        for c in 0..last {
            self.meet(c, below, c, out);
            self.meet(c, below, c + 1, out);
            self.meet(c + 1, below, c, out);
        }
        self.meet(last, below, last, out);
    }

    /// Records that node `i` is adjacent to node `j`, which comes later in this row or in the next one.
    #[inline(always)]
    fn meet(&self, i: usize, other: &Self, j: usize, out: &mut Pairs<Saddle>) {
        let (a, b) = (self.of[i], other.of[j]);
        if a != b && a != NO_CELL && b != NO_CELL {
            let (here, there) = (self.heights[i], other.heights[j]);
            // Of equal heights the smaller index is lower: this row's.
            let saddle =
                if here <= there { Saddle::new(here, self.first + i) } else { Saddle::new(there, other.first + j) };
            let best = out.entry(a, b);
            *best = saddle.max(*best);
        }
    }
}

fn find(parent: &mut [u32], mut r: u32) -> u32 {
    while parent[r as usize] != r {
        let up = parent[parent[r as usize] as usize];
        parent[r as usize] = up;
        r = up;
    }
    r
}
