//! How much the displaced ground still looks like the ground, over the nodes of the picture that move.

use super::super::visibility_qp::{GivenRow, QpSolver};
use super::super::{Field, Hierarchy};
use super::in_picture;
use belvedere_core::quantile::{Rank, quantile};
use belvedere_core::{DVec2, DVec3, View};
use rayon::prelude::*;
use serde::Serialize;

/// A node that moves by less than this counts as still, metres.
const MOVES_M: f64 = 1.0;
/// Nodes that are looked at, at most, about.
const MOST_NODES: usize = 60_000;
/// Fewer moved nodes than this say nothing.
const FEWEST: usize = 30;
/// Height by which a summit may rise over the next higher one, metres.
const ORDER_ALLOWED_M: f64 = 0.5;
/// Levels into which the heights of the nodes are divided for their order.
const LEVELS: f64 = 50.0;
/// Bounds within which a landscape counts as itself. Ours.
const MOST_TURN_DEG: f64 = 4.0;
const MOST_TURN_P95_DEG: f64 = 20.0;
const LEAST_HEIGHTS: f64 = 0.95;
const LEAST_SLOPES: f64 = 0.9;

/// Likeness of the displaced ground to the ground, by the nodes in the picture, hidden or not, with its whole height above and below.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LikenessReport {
    /// Over all nodes in the picture.
    pub picture: LikenessFigures,
    /// Over those that move by more than a metre.
    pub moved: LikenessFigures,
    /// Share of the nodes in the picture that move by more than a metre, 0..=1.
    pub moved_share: f64,
    /// Summits in the picture, of those that stand out by a tenth of the relief at least.
    pub summits: usize,
    /// Pairs of summits, neighbours by height, of which the lower became the higher by more than half a metre.
    pub summits_swapped: usize,
    /// How much of the bounds is used, >= 0; up to 1 the picture is still that of the landscape: over all of its nodes a mean turn of at
    /// most 4 degrees, 95 of 100 turns below 20 degrees, and correlations of at least 0.95 for heights and 0.9 for slopes.
    pub strain: f64,
}

/// Figures of likeness over some nodes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LikenessFigures {
    /// Mean angle between the normals before and after, degrees.
    pub turn_mean_deg: f64,
    /// The angle that 95 of 100 nodes stay below, degrees.
    pub turn_p95_deg: f64,
    /// Rank correlation (Spearman) of heights before and after, in steps of a fiftieth of their range, -1..=1.
    pub heights: f64,
    /// Correlation (Pearson) of slopes before and after, -1..=1.
    pub slopes: f64,
}

impl LikenessFigures {
    const SAME: Self = Self { turn_mean_deg: 0.0, turn_p95_deg: 0.0, heights: 1.0, slopes: 1.0 };

    fn of(seen: &[Seen]) -> Self {
        if seen.len() < FEWEST {
            return Self::SAME;
        }
        let column = |of: &dyn Fn(&Seen) -> f64| seen.iter().map(of).collect::<Vec<f64>>();
        let mut turns = column(&|s| s.turn);
        // On plains the order of heights says nothing.
        let [low, high] = seen
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s.heights[0]), high.max(s.heights[0])]);
        let step = ((high - low) / LEVELS).max(MOVES_M);
        let level = |height: f64| ((height - low) / step).round();
        Self {
            turn_mean_deg: (turns.iter().sum::<f64>() / turns.len() as f64).to_degrees(),
            turn_p95_deg: quantile(&mut turns, 0.95, Rank::Lower).to_degrees(),
            heights: correlation(&ranks(&column(&|s| level(s.heights[0]))), &ranks(&column(&|s| level(s.heights[1])))),
            slopes: correlation(&column(&|s| s.slopes[0]), &column(&|s| s.slopes[1])),
        }
    }

    /// The figure that comes nearest to its bound, or exceeds it most, as a multiple of the bound.
    fn strain(&self) -> f64 {
        let turns = (self.turn_mean_deg / MOST_TURN_DEG).max(self.turn_p95_deg / MOST_TURN_P95_DEG);
        let heights = (1.0 - self.heights) / (1.0 - LEAST_HEIGHTS);
        let slopes = (1.0 - self.slopes) / (1.0 - LEAST_SLOPES);
        turns.max(heights).max(slopes)
    }
}

/// The nodes and summits by which a picture of a terrain is known.
pub(super) struct Likeness<'a> {
    field: &'a Field,
    nodes: Vec<u32>,
    /// Nodes of summits in the picture, the highest first.
    summits: Vec<u32>,
}

/// A node before and after.
struct Seen {
    heights: [f64; 2],
    slopes: [f64; 2],
    turn: f64,
}

impl<'a> Likeness<'a> {
    /// * `summits`: nodes of the most prominent summits of the terrain.
    pub(super) fn new(field: &'a Field, base: &View, summits: &[u32]) -> Self {
        let [cols, rows] = field.nodes();
        let every = ((cols * rows) as f64 / MOST_NODES as f64).sqrt().ceil().max(1.0) as usize;
        let in_picture = |i: u32| {
            let height = field.heights()[i as usize];
            let p: DVec3 = field.scene_from_grid(field.node(i as usize)).extend(height);
            !field.void()[i as usize] && in_picture::nearly_holds(base, p)
        };
        let of_row =
            |row: usize| (0..cols).step_by(every).map(move |col| (row * cols + col) as u32).filter(|i| in_picture(*i));
        let nodes = (0..rows).into_par_iter().step_by(every).flat_map_iter(of_row).collect();
        let mut summits: Vec<u32> = summits.iter().copied().filter(|i| in_picture(*i)).collect();
        summits.sort_by(|a, b| field.heights()[*b as usize].total_cmp(&field.heights()[*a as usize]));
        Self { field, nodes, summits }
    }

    /// See [`LikenessReport::strain`].
    ///
    /// * `u`: displacement of the nodes of a coarser grid.
    pub(super) fn strain(&self, grid: &Hierarchy, u: &[f64]) -> f64 {
        self.of(&|i| grid.at(u, self.field.node(i))).strain
    }

    /// Rows under which no summit rises over the next higher one.
    ///
    /// * `level`: the ground without the curvature of the earth.
    pub(super) fn in_order(&self, level: &Field, qp: &QpSolver) -> Vec<GivenRow> {
        let height = |i: u32| level.heights()[i as usize];
        let row = |[high, low]: [u32; 2]| {
            let places = [low, high].map(|i| level.node(i as usize));
            qp.in_order(places, height(high) - height(low))
        };
        self.pairs().map(row).collect()
    }

    /// Pairs of summits in the picture that are neighbours by height, the higher first.
    fn pairs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.summits.windows(2).map(|pair| [pair[0], pair[1]])
    }

    /// * `moved`: displacement of a node.
    pub(super) fn of(&self, moved: &(dyn Fn(usize) -> f64 + Sync)) -> LikenessReport {
        let mut seen: Vec<Seen> =
            self.nodes.par_iter().with_min_len(1024).map(|i| self.seen(*i as usize, moved)).collect();
        let picture = LikenessFigures::of(&seen);
        let all = seen.len().max(1) as f64;
        seen.retain(|s| (s.heights[1] - s.heights[0]).abs() > MOVES_M);
        let h = self.field.heights();
        let after = |i: u32| h[i as usize] + moved(i as usize);
        let summits_swapped = self.pairs().filter(|[high, low]| after(*low) > after(*high) + ORDER_ALLOWED_M).count();
        LikenessReport {
            picture,
            moved: LikenessFigures::of(&seen),
            moved_share: seen.len() as f64 / all,
            summits: self.summits.len(),
            summits_swapped,
            strain: picture.strain(),
        }
    }

    /// Normals and slopes from central differences, one-sided at rims and voids.
    fn seen(&self, i: usize, moved: &(dyn Fn(usize) -> f64 + Sync)) -> Seen {
        let (field, h) = (self.field, self.field.heights());
        let [cols, rows] = field.nodes();
        let (col, row) = (i % cols, i / cols);
        let slope = |before: Option<usize>, after: Option<usize>, step: f64| {
            let [a, b] = [before, after].map(|j| j.filter(|j| !field.void()[*j]).unwrap_or(i));
            let span = if a == i || b == i { step } else { 2.0 * step };
            let was = (h[b] - h[a]) / span;
            [was, was + (moved(b) - moved(a)) / span]
        };
        let x = slope((col > 0).then(|| i - 1), (col + 1 < cols).then(|| i + 1), field.spacing().x);
        let y = slope((row > 0).then(|| i - cols), (row + 1 < rows).then(|| i + cols), field.spacing().y);
        let [was, is] = [0, 1].map(|k| DVec2::new(x[k], y[k]));
        let (old, new) = (was.extend(1.0), is.extend(1.0));
        Seen {
            heights: [h[i], h[i] + moved(i)],
            slopes: [was.length(), is.length()],
            turn: old.cross(new).length().atan2(old.dot(new)),
        }
    }
}

/// Rank of each value; equal ones share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|a, b| values[*a].total_cmp(&values[*b]).then(a.cmp(b)));
    let (mut out, mut first) = (vec![0.0; values.len()], 0);
    for same in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let rank = first as f64 + 0.5 * (same.len() - 1) as f64;
        same.iter().for_each(|i| out[*i] = rank);
        first += same.len();
    }
    out
}

/// Correlation (Pearson); 1 where one of both is constant.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let (x, y) = (x - mean_a, y - mean_b);
        (aa, bb, ab) = (aa + x * x, bb + y * y, ab + x * y);
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_ignore_how_far_values_lie_apart() {
        assert_eq!(ranks(&[3.0, -7.0, 3.0, 100.0]), [1.5, 0.0, 1.5, 3.0]);
        let (a, b): (Vec<f64>, Vec<f64>) = (0..50).map(|k| (f64::from(k), f64::from(k).exp())).unzip();
        assert!((correlation(&ranks(&a), &ranks(&b)) - 1.0).abs() < 1e-12 && correlation(&a, &b) < 0.5);
        let down: Vec<f64> = a.iter().map(|x| -x).collect();
        assert!((correlation(&a, &down) + 1.0).abs() < 1e-12);
        assert_eq!(correlation(&[2.0; 3], &a[..3]), 1.0);
    }
}
