//! Limits of the displaced ground: its depth below the lowest node of the terrain, and its slope.
//!
//! The program does not know these limits. Ground that it digs too deep or too steep is filled up again, to the least surface above
//! it that keeps them. This is never higher than the terrain was, which keeps the limits itself. Filling up to a level floor below
//! the eye hides little, for lines of sight run above the floor. But a facet between a node that was filled up and one that was not
//! rises with the first, and where the displacement is drawn bilinear between nodes, filled ground is rough. The judge finds what that
//! hides, and what filling up steep sides hides.
//!
//! The sea does not move, and land that stands over it does not sink below it. Lines of sight from above the sea to land run above it, so
//! that filling up to it hides next to nothing.
//!
//! The program has no rows for the floor: where they were tried they contradicted those of lines of sight, for a displacement of the
//! solver's grid is smooth and cannot flatten the ground within a cell as filling up does.

use super::super::{Field, Hierarchy};
use super::waters::Waters;
use belvedere_scene::{Heightfield, Sea};
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};
use std::ops::Range;

/// Depth to which the ground may sink below the lowest node of the terrain, share of the relief.
const DEEPER: f64 = 0.2;
/// Steepest slope of the ground, as a multiple of the slope that 999 of 1000 triangles of the terrain stay below.
const STEEPER: f64 = 2.0;
const STEEP_SHARE: f64 = 0.999;
/// Cosine of 22.5 degrees: if slopes along rows, columns and diagonals are this share of a limit, no direction between exceeds it.
const DIRECTIONS: f64 = 0.923_879_532_511_286_7;
/// Rounds in which ground is filled up for rivers at most.
const RIVER_ROUNDS: usize = 200;
/// Tolerance of the limits, metres.
const KEPT: f64 = 1e-6;

/// Limits that the displaced ground must keep.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Limits {
    /// Lowest height.
    floor: f64,
    /// Steepest slope between two nodes, rise over run; pairs of nodes that were steeper may stay so.
    slope: f64,
    /// Height of the sea, and which nodes are sea.
    sea: Option<(f64, Vec<bool>)>,
}

/// Report of the limits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LimitsReport {
    /// Lowest height that the ground may have: a fifth of the relief below the lowest.
    pub floor_m: f64,
    /// Steepest that it may become where it was not steeper, degrees: twice the slope that 999 of 1000 triangles stay below.
    pub steepest_deg: f64,
    /// Share of the ground that the program alone would have sunk deeper or made steeper, 0..=1.
    pub held_share: f64,
    /// Largest height by which ground was filled up, metres.
    pub held_most_m: f64,
}

/// Bounds of the terrain by cells of the solver's grid: most displacements are known to keep the limits without testing every node.
#[derive(Debug, Clone)]
pub(super) struct LimitedTerrain {
    limits: Limits,
    /// Lowest height and steepest slope of each block.
    blocks: Vec<[f64; 2]>,
    /// Blocks with sea; empty where there is none.
    with_sea: Vec<bool>,
    spacing: f64,
}

impl LimitedTerrain {
    /// * `ground`: whose field this is.
    pub(super) fn new(ground: &Heightfield, field: &Field, grid: &Hierarchy) -> Self {
        let limits = Limits { sea: Sea::nodes(ground), ..Limits::of(field) };
        let [cols, rows] = [grid.cols().max(2) - 1, grid.rows().max(2) - 1];
        let [across, down] = [grid.step().x as usize, grid.step().y as usize];
        let block = |b: usize| {
            let (x, y) = (b % cols * across, b / cols * down);
            lowest_and_steepest(field, [x, (x + across).min(field.cols() - 1)], [y, (y + down).min(field.rows() - 1)])
        };
        let blocks = (0..cols * rows).into_par_iter().map(block).collect();
        let has_sea = |b: usize| {
            let (x, y) = (b % cols * across, b / cols * down);
            let row =
                |y: usize| limits.sea_of(y * field.cols() + x..y * field.cols() + (x + across + 1).min(field.cols()));
            (y..(y + down + 1).min(field.rows())).any(row)
        };
        let with_sea = (0..limits.sea.as_ref().map_or(0, |_| cols * rows)).map(has_sea).collect();
        Self { limits, blocks, with_sea, spacing: field.spacing().min_element() }
    }

    /// Whether a displacement certainly keeps the limits, by bounds for each block.
    pub(super) fn surely_kept(&self, grid: &Hierarchy, u: &[f64]) -> bool {
        let cols = grid.cols().max(2) - 1;
        let reach = grid.step().min_element() * self.spacing;
        self.blocks.iter().enumerate().all(|(i, [low, steep])| {
            let (x, y) = (i % cols, i / cols);
            let node =
                |dx: usize, dy: usize| u[(y + dy).min(grid.rows() - 1) * grid.cols() + (x + dx).min(grid.cols() - 1)];
            let corners = [node(0, 0), node(1, 0), node(0, 1), node(1, 1)];
            let [least, most] =
                corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
            let across = (most - least) / reach;
            if self.with_sea.get(i) == Some(&true) && corners != [0.0; 4] {
                return false;
            }
            // Along a diagonal both slopes add up.
            low + least >= self.limits.floor_at(*low)
                && (across == 0.0 || steep + std::f64::consts::SQRT_2 * across <= self.limits.slope)
        })
    }

    /// Estimate, from one node per block, of the greatest depth of a displacement below the lowest height that is allowed.
    pub(super) fn beyond(&self, grid: &Hierarchy, u: &[f64]) -> f64 {
        let cols = grid.cols().max(2) - 1;
        let node = |i: usize| (i / cols).min(grid.rows() - 1) * grid.cols() + i % cols;
        let over = |(i, block): (usize, &[f64; 2])| self.limits.floor.min(block[0]) - block[0] - u[node(i)];
        self.blocks.iter().enumerate().map(over).fold(0.0, f64::max)
    }

    /// Makes a displacement of the nodes keep the limits; `None` if it does already.
    pub(super) fn keep(&self, field: &Field, waters: &Waters, u: &mut [f64]) -> Option<LimitsReport> {
        self.limits.keep(field, waters, u)
    }
}

impl Limits {
    fn of(field: &Field) -> Self {
        let mut slopes = facet_slopes(field);
        let steep = match slopes.len() {
            0 => 0.0,
            n => {
                let k = ((n - 1) as f64 * STEEP_SHARE) as usize;
                f64::from(*slopes.select_nth_unstable_by(k, f32::total_cmp).1).sqrt()
            }
        };
        Self { floor: field.datum() - DEEPER * field.relief(), slope: DIRECTIONS * STEEPER * steep, sea: None }
    }

    /// Lowest height of ground that was this high.
    fn floor_at(&self, height: f64) -> f64 {
        let sea = self.sea.as_ref().map_or(f64::NEG_INFINITY, |(level, _)| level.min(height));
        self.floor.min(height).max(sea)
    }

    fn sea_of(&self, mut nodes: Range<usize>) -> bool {
        self.sea.as_ref().is_some_and(|(_, sea)| nodes.any(|i| sea[i]))
    }

    /// Raises the displaced ground until it keeps the limits, lakes are level and no river runs uphill; without rivers the result is
    /// the least such ground.
    fn keep(&self, field: &Field, waters: &Waters, u: &mut [f64]) -> Option<LimitsReport> {
        let (h, lakes, ways) = (field.heights(), &waters.lakes, Ways::over(field));
        let solid = |i: usize| !field.void()[i];
        if let Some((_, sea)) = &self.sea {
            // It may have risen by the tolerance of ceilings.
            u.iter_mut().zip(sea).filter(|(_, sea)| **sea).for_each(|(u, _)| *u = u.min(0.0));
        }
        let lowest = |i: usize| if self.sea_of(i..i + 1) { h[i] } else { self.floor_at(h[i]) };
        let mut ground: Vec<f64> = (0..h.len()).into_par_iter().map(|i| (h[i] + u[i]).max(lowest(i))).collect();
        for lake in lakes.nodes() {
            let highest = highest(lake, |n| ground[n] - h[n]);
            lake.iter().for_each(|n| ground[*n as usize] = h[*n as usize] + highest);
        }
        let allowed = |i: usize, j: usize, d: f64| (self.slope * d).max((h[i] - h[j]).abs());
        let around = |i: usize| ways.from(i).filter(|(j, _)| solid(*j));
        let short = |i: usize| around(i).any(|(j, d)| ground[j] < ground[i] - allowed(i, j, d) - KEPT);
        let all = (0..h.len()).into_par_iter().with_min_len(4096);
        let steep: Vec<Node> = all.filter(|&i| solid(i) && short(i)).map(|i| Node(ground[i], i)).collect();
        let lake_of = lakes.nodes().flat_map(|lake| lake.iter().map(move |n| (*n, lake))).collect();
        let mut rising = Rising { h, lake_of, ground, open: BinaryHeap::from(steep) };
        for _ in 0..RIVER_ROUNDS {
            while let Some(Node(height, i)) = rising.open.pop() {
                if height < rising.ground[i] {
                    continue;
                }
                around(i).for_each(|(j, d)| rising.lift(j, height - allowed(i, j, d)));
            }
            if waters.rivers.is_empty() {
                break;
            }
            let mut moved: Vec<f64> = rising.ground.iter().zip(h).map(|(z, h)| z - h).collect();
            let mut raised = Vec::new();
            waters.rivers.raise(&mut moved, &mut raised);
            if raised.is_empty() {
                break;
            }
            raised.into_iter().for_each(|n| rising.put(n, h[n] + moved[n]));
        }
        let (mut held, mut most, mut nodes) = (0usize, 0.0f64, 0usize);
        for i in (0..h.len()).filter(|&i| solid(i)) {
            let raised = rising.ground[i] - h[i] - u[i];
            nodes += 1;
            if raised > KEPT {
                (held, most) = (held + 1, most.max(raised));
                u[i] = rising.ground[i] - h[i];
            }
        }
        for lake in lakes.nodes() {
            let highest = highest(lake, |n| u[n]);
            lake.iter().for_each(|n| u[*n as usize] = highest);
        }
        (held > 0).then(|| LimitsReport {
            floor_m: self.floor,
            steepest_deg: (self.slope / DIRECTIONS).atan().to_degrees(),
            held_share: held as f64 / nodes as f64,
            held_most_m: most,
        })
    }
}

fn highest(lake: &[u32], of: impl Fn(usize) -> f64) -> f64 {
    lake.iter().map(|n| of(*n as usize)).fold(f64::MIN, f64::max)
}

/// Ground that rises, and the nodes that may stand too high over their neighbours.
struct Rising<'a> {
    /// Heights of the undisplaced ground.
    h: &'a [f64],
    lake_of: BTreeMap<u32, &'a [u32]>,
    ground: Vec<f64>,
    open: BinaryHeap<Node>,
}

impl Rising<'_> {
    /// Raises a node to a height, if it is lower, and the rest of its lake with it.
    #[inline]
    fn lift(&mut self, j: usize, least: f64) {
        if self.ground[j] < least {
            self.put(j, least);
        }
    }

    fn put(&mut self, j: usize, height: f64) {
        self.ground[j] = height;
        self.open.push(Node(height, j));
        for &k in self.lake_of.get(&(j as u32)).into_iter().copied().flatten() {
            let k = k as usize;
            let with = self.h[k] + (height - self.h[j]);
            if k != j && self.ground[k] < with {
                self.ground[k] = with;
                self.open.push(Node(with, k));
            }
        }
    }
}

/// A node and its height, the highest first.
struct Node(f64, usize);

impl Ord for Node {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

/// Directions from a node to its neighbours.
struct Ways {
    size: [isize; 2],
    /// Columns, rows and distance in plan.
    all: [(isize, isize, f64); 8],
}

impl Ways {
    fn over(field: &Field) -> Self {
        let d = field.spacing();
        let all = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
        let all = all.map(|(dx, dy)| (dx, dy, (dx as f64 * d.x).hypot(dy as f64 * d.y)));
        Self { size: [field.cols() as isize, field.rows() as isize], all }
    }

    /// The neighbours of a node, with their distances.
    fn from(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let [cols, rows] = self.size;
        let (x, y) = (i as isize % cols, i as isize / cols);
        self.all.iter().filter_map(move |(dx, dy, d)| {
            let (col, row) = (x + dx, y + dy);
            let inside = col >= 0 && row >= 0 && col < cols && row < rows;
            inside.then_some(((row * cols + col) as usize, *d))
        })
    }
}

/// Lowest height and steepest slope between neighbours of a block of grid cells, from its first to its last columns and rows of nodes.
fn lowest_and_steepest(field: &Field, [x0, x1]: [usize; 2], [y0, y1]: [usize; 2]) -> [f64; 2] {
    let (cols, h, void, d) = (field.cols(), field.heights(), field.void(), field.spacing());
    let steps = [(1, 0, d.x), (0, 1, d.y), (1, 1, d.length()), (-1, 1, d.length())].map(|(x, y, d)| (x, y, d.recip()));
    let (mut low, mut steepest) = (f64::INFINITY, 0.0f64);
    for y in y0..=y1 {
        for x in x0..=x1 {
            let i = y * cols + x;
            if void[i] {
                continue;
            }
            low = low.min(h[i]);
            for (dx, dy, per) in steps {
                let (col, row) = (x as isize + dx, y + dy);
                if col >= x0 as isize && col <= x1 as isize && row <= y1 {
                    let j = row * cols + col as usize;
                    let slope = (h[j] - h[i]).abs() * per;
                    if slope > steepest && !void[j] {
                        steepest = slope;
                    }
                }
            }
        }
    }
    [low, steepest]
}

/// Squared slopes of the triangles with data, rise over run.
fn facet_slopes(field: &Field) -> Vec<f32> {
    let (cols, h, d) = (field.cols(), field.heights(), field.spacing());
    let per = [d.x.recip(), d.y.recip()];
    let row = |row: usize| {
        (row * cols..row * cols + cols - 1).flat_map(move |nw| {
            let [ne, sw, se] = [nw + 1, nw + cols, nw + cols + 1];
            let halves = [([nw, ne, se], h[ne] - h[nw], h[se] - h[ne]), ([nw, sw, se], h[se] - h[sw], h[sw] - h[nw])];
            halves.into_iter().filter(|(corners, ..)| corners.iter().all(|&k| !field.void()[k])).map(
                move |(_, x, y)| {
                    let (x, y) = (x * per[0], y * per[1]);
                    (x * x + y * y) as f32
                },
            )
        })
    };
    (0..field.rows().saturating_sub(1)).into_par_iter().flat_map_iter(row).collect()
}

#[cfg(test)]
mod tests;
