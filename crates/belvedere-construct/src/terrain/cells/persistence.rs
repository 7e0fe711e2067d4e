//! Which summits matter.

use super::super::Field;
use super::NO_CELL;
use super::pairs::Pairs;
use super::regions::Regions;
use std::cmp::Ordering::{self, Equal};

/// How summits give way to higher ones as the water that surrounds them falls.
pub(super) struct Persistence {
    /// Summit minus the saddle at which it gives way; infinite if it never does.
    height: Vec<f64>,
    /// The region beyond that saddle, itself if there is none.
    across: Vec<u32>,
}

/// The summits that stay.
pub(super) struct Kept {
    /// Cell of each region.
    pub(super) cell_of: Vec<u32>,
    /// Node of each cell's summit, ascending.
    pub(super) summits: Vec<u32>,
    /// Persistence of each cell's summit.
    pub(super) persistence: Vec<f64>,
}

/// The highest way from one region to another: the lower of two touching nodes, as index + 1; 0 = none yet.
type Saddle = u32;

impl Persistence {
    pub(super) fn new(field: &Field, regions: &Regions) -> Self {
        let order = Order(field.heights());
        let mut saddles: Vec<([u32; 2], u32)> =
            saddles(field, regions).iter().map(|(pair, saddle)| (pair, saddle - 1)).collect();
        saddles.sort_unstable_by(|(p, a), (q, b)| order.compare(*b, *a).then_with(|| p.cmp(q)));
        let count = regions.summits.len();
        let mut out = Self { height: vec![f64::INFINITY; count], across: (0..count as u32).collect() };
        // A component is named after the region of its highest summit.
        let mut parent: Vec<u32> = (0..count as u32).collect();
        for ([a, b], saddle) in saddles {
            let (top_a, top_b) = (find(&mut parent, a), find(&mut parent, b));
            if top_a == top_b {
                continue;
            }
            let summit = |r: u32| regions.summits[r as usize];
            let a_stays = order.compare(summit(top_a), summit(top_b)).is_gt();
            let (stays, goes, beyond) = if a_stays { (top_a, top_b, a) } else { (top_b, top_a, b) };
            parent[goes as usize] = stays;
            out.height[goes as usize] = field.heights()[summit(goes) as usize] - field.heights()[saddle as usize];
            out.across[goes as usize] = beyond;
        }
        out
    }

    /// The `keep` most persistent summits and every one that gives way to none; of equals the higher one. The regions of
    /// the others follow the regions beyond their saddles to one that is kept.
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

    /// Whether node `a` is higher than node `b`.
    fn above(self, a: u32, b: u32) -> bool {
        let (ha, hb) = (self.0[a as usize], self.0[b as usize]);
        ha > hb || (ha == hb && a > b)
    }
}

/// Highest saddle between touching regions, over all eight directions.
fn saddles(field: &Field, regions: &Regions) -> Pairs<Saddle> {
    let (cols, rows) = (field.cols(), field.rows());
    let order = Order(field.heights());
    let mut out = Pairs::new();
    let of = &regions.of_node;
    let mut meet = |i: usize, j: usize| {
        let (a, b) = (of[i], of[j]);
        if a != b && a != NO_CELL && b != NO_CELL {
            let lower = if order.above(i as u32, j as u32) { j } else { i } as u32;
            let best: &mut Saddle = out.entry(a, b);
            if *best == 0 || order.above(lower, *best - 1) {
                *best = lower + 1;
            }
        }
    };
    for row in 0..rows {
        for col in 0..cols {
            let i = row * cols + col;
            if col + 1 < cols {
                meet(i, i + 1);
            }
            if row + 1 < rows {
                meet(i, i + cols);
                if col + 1 < cols {
                    meet(i, i + cols + 1);
                    meet(i + 1, i + cols);
                }
            }
        }
    }
    out
}

fn find(parent: &mut [u32], mut r: u32) -> u32 {
    while parent[r as usize] != r {
        let up = parent[parent[r as usize] as usize];
        parent[r as usize] = up;
        r = up;
    }
    r
}
