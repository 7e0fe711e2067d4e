//! Routes found on terrain: paths of least cost that keep to the valleys.

use crate::noise::{Noise, Random, seeded};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, NodeState};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cost of a metre of path: `1 + slope_weight (slope / 0.25)^2 + height_weight h^2 + wander noise`, h = 0 at the lowest and 1 at
/// the highest node of the terrain searched, noise = 0..1, seeded, some ten nodes wide. All weights >= 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RouteCost {
    /// Weight of steep ground; 0.2..=5 is useful.
    pub slope_weight: f64,
    /// Weight of high ground; 2..=50 is useful.
    pub height_weight: f64,
    /// Weight of the noise, by which routes wind over even ground; 0 = none, 0.5..=3 is useful.
    pub wander: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for RouteCost {
    fn default() -> Self {
        Self { slope_weight: 1.5, height_weight: 12.0, wander: 0.0, seed: 0 }
    }
}

/// Errors of the search for a route.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RouteError {
    /// An end does not lie on ground.
    #[error(
        "route {end} ({x:.0}, {y:.0}) lies outside the terrain or among voids (x {x_min:.0}..{x_max:.0}, y {y_min:.0}..{y_max:.0}); move it"
    )]
    NoGround {
        /// "start" or "end".
        end: &'static str,
        /// Scene x, metres.
        x: f64,
        /// Scene y, metres.
        y: f64,
        /// Smallest x of the terrain.
        x_min: f64,
        /// Largest x of the terrain.
        x_max: f64,
        /// Smallest y of the terrain.
        y_min: f64,
        /// Largest y of the terrain.
        y_max: f64,
    },
    /// Voids or obstacles separate the ends.
    #[error(
        "no way leads from the start to the end of the route: voids separate them; choose ends on one side or fill the voids"
    )]
    NoWay,
    /// A weight is negative or not finite.
    #[error("route weights are slope {slope}, height {height}, wander {wander}; all must be finite and at least 0")]
    Weights {
        /// Slope weight given.
        slope: f64,
        /// Height weight given.
        height: f64,
        /// Wander given.
        wander: f64,
    },
    /// No path joins a pair of valley ends.
    #[error(
        "no valley route found on terrain of {cols} x {rows} nodes with {void_percent:.0} % voids; at least 16 x 16 nodes of connected ground are needed"
    )]
    NoValley {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
        /// Share of voids, percent.
        void_percent: f64,
    },
}

/// Cheapest path over the terrain between two scene positions (A* on the eight neighbours of each node, then smoothed a little).
///
/// Keeps a node away from voids. Vertices lie about one grid spacing apart; the first and last are such nodes nearest to `from`
/// and `to`, at most 3 spacings away.
///
/// # Errors
/// [`RouteError::NoGround`], [`RouteError::NoWay`], [`RouteError::Weights`].
///
/// Source: ours (A* of Hart, Nilsson and Raphael 1968).
pub fn least_cost_route(
    terrain: &Heightfield,
    from: DVec2,
    to: DVec2,
    cost: &RouteCost,
) -> Result<Vec<DVec2>, RouteError> {
    let whole = Window { col: 0, row: 0, cols: terrain.cols(), rows: terrain.rows() };
    let blocked = vec![false; whole.cols * whole.rows];
    route_in(terrain, whole, [from, to], cost, &blocked)
}

/// A rectangle of nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub(crate) col: usize,
    pub(crate) row: usize,
    pub(crate) cols: usize,
    pub(crate) rows: usize,
}

impl Window {
    /// Column and row in the terrain of node `i` of the window.
    fn node(&self, i: usize) -> (usize, usize) {
        (self.col + i % self.cols, self.row + i / self.cols)
    }

    fn xy(&self, terrain: &Heightfield, i: usize) -> DVec2 {
        let (col, row) = self.node(i);
        terrain.node_xy(col, row)
    }

    /// Index in the terrain of node `i` of the window.
    fn global(&self, terrain: &Heightfield, i: usize) -> usize {
        let (col, row) = self.node(i);
        row * terrain.cols() + col
    }
}

/// Whether neither the node nor any of its neighbours is a void, so that the drawn surface is whole around it.
fn solid(terrain: &Heightfield, (col, row): (usize, usize)) -> bool {
    (row.saturating_sub(1)..(row + 2).min(terrain.rows())).all(|r| {
        let from = r * terrain.cols();
        let states = terrain.states();
        (from + col.saturating_sub(1)..from + (col + 2).min(terrain.cols())).all(|i| states[i] != NodeState::Void)
    })
}

/// The open node (height not NaN) nearest to fractional column and row `g` of the window, at most 3 nodes away.
fn nearest_open(window: Window, heights: &[f32], g: DVec2) -> Option<usize> {
    let (c, r) = (g.x.round(), g.y.round());
    if !(c >= 0.0 && r >= 0.0 && c < window.cols as f64 && r < window.rows as f64) {
        return None;
    }
    let (c, r) = (c as usize, r as usize);
    let near = (r.saturating_sub(3)..(r + 4).min(window.rows))
        .flat_map(|r| (c.saturating_sub(3)..(c + 4).min(window.cols)).map(move |c| (c, r)))
        .filter(|&(c, r)| !heights[r * window.cols + c].is_nan());
    let away = |(c, r): (usize, usize)| g.distance_squared(DVec2::new(c as f64, r as f64));
    near.min_by(|&a, &b| away(a).total_cmp(&away(b))).map(|(c, r)| r * window.cols + c)
}

/// [`least_cost_route`] within a window and around obstacles (`blocked`, one flag per node of the window).
pub(crate) fn route_in(
    terrain: &Heightfield,
    window: Window,
    ends: [DVec2; 2],
    cost: &RouteCost,
    blocked: &[bool],
) -> Result<Vec<DVec2>, RouteError> {
    let &RouteCost { slope_weight: slope, height_weight: height, wander, .. } = cost;
    if ![slope, height, wander].iter().all(|w| *w >= 0.0 && w.is_finite()) {
        return Err(RouteError::Weights { slope, height, wander });
    }
    let heights: Vec<f32> = (0..window.cols * window.rows)
        .map(|i| {
            let open = !blocked.get(i).copied().unwrap_or(true) && solid(terrain, window.node(i));
            if open { terrain.heights()[window.global(terrain, i)] } else { f32::NAN }
        })
        .collect();
    let [start, end] = [("start", ends[0]), ("end", ends[1])].map(|(name, xy)| {
        let g = terrain.grid_from_scene(xy) - DVec2::new(window.col as f64, window.row as f64);
        nearest_open(window, &heights, g).ok_or_else(|| no_ground(terrain, name, xy))
    });
    let (nodes, _) = search(terrain.spacing(), window, &heights, [start?, end?], cost).ok_or(RouteError::NoWay)?;
    Ok(smooth(terrain, nodes.into_iter().map(|i| window.xy(terrain, i)).collect(), |xy| {
        let g = terrain.grid_from_scene(xy) - DVec2::new(window.col as f64, window.row as f64);
        let i = g.y.round().max(0.0) as usize * window.cols + g.x.round().max(0.0) as usize;
        heights.get(i).is_some_and(|h| !h.is_nan())
    }))
}

fn no_ground(terrain: &Heightfield, end: &'static str, xy: DVec2) -> RouteError {
    let b = terrain.bounds();
    RouteError::NoGround { end, x: xy.x, y: xy.y, x_min: b.min.x, x_max: b.max.x, y_min: b.min.y, y_max: b.max.y }
}

/// A* over the open (not NaN) nodes; returns the nodes from start to end and the cost of the path.
fn search(
    spacing: DVec2,
    window: Window,
    z: &[f32],
    [start, end]: [usize; 2],
    cost: &RouteCost,
) -> Option<(Vec<usize>, f64)> {
    let (cols, rows) = (window.cols, window.rows);
    let (lo, hi) =
        z.iter().filter(|h| !h.is_nan()).fold((f64::MAX, f64::MIN), |(l, h), &v| (l.min(v.into()), h.max(v.into())));
    let noise = Noise::new(cost.seed);
    let irregular = |i: usize| {
        let p = DVec2::new((i % cols) as f64, (i / cols) as f64) / 9.0;
        if cost.wander > 0.0 { cost.wander * (0.5 + 0.8 * noise.fbm(p, 2)).clamp(0.0, 1.0) } else { 0.0 }
    };
    let per_relief = 1.0 / (hi - lo).max(1e-3);
    let step: [(isize, isize, f64); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)]
        .map(|(dc, dr): (isize, isize)| (dc, dr, DVec2::new(dc as f64 * spacing.x, dr as f64 * spacing.y).length()));
    let (end_col, end_row) = ((end % cols) as f64, (end / cols) as f64);
    let to_go = |i: usize| {
        DVec2::new(((i % cols) as f64 - end_col) * spacing.x, ((i / cols) as f64 - end_row) * spacing.y).length()
    };
    let mut best = vec![f32::INFINITY; z.len()];
    let mut came_by = vec![u8::MAX; z.len()];
    let mut heap = BinaryHeap::new();
    best[start] = 0.0;
    // costs are >= 0, so the order of their bits is their order
    heap.push(Reverse(((to_go(start) as f32).to_bits(), start as u32)));
    while let Some(Reverse((key, i))) = heap.pop() {
        let i = i as usize;
        if i == end {
            return Some((trace(&came_by, &step, cols, start, end), best[end].into()));
        }
        if f32::from_bits(key) > best[i] + to_go(i) as f32 * 1.000_001 + 1e-3 {
            continue; // an outdated entry of higher cost
        }
        let (c, r, extra) = ((i % cols) as isize, (i / cols) as isize, irregular(i));
        for (k, &(dc, dr, run)) in step.iter().enumerate() {
            let (nc, nr) = (c + dc, r + dr);
            if nc < 0 || nr < 0 || nc >= cols as isize || nr >= rows as isize {
                continue;
            }
            let j = nr as usize * cols + nc as usize;
            if z[j].is_nan() {
                continue;
            }
            let (zi, zj) = (f64::from(z[i]), f64::from(z[j]));
            let slope = (zj - zi) / run * 4.0;
            let high = (0.5 * (zi + zj) - lo) * per_relief;
            let metre = 1.0 + cost.slope_weight * slope * slope + cost.height_weight * high * high;
            let total = best[i] + (run * (metre + extra)) as f32;
            if total < best[j] {
                best[j] = total;
                came_by[j] = k as u8;
                heap.push(Reverse(((total + to_go(j) as f32).to_bits(), j as u32)));
            }
        }
    }
    None
}

fn trace(came_by: &[u8], step: &[(isize, isize, f64); 8], cols: usize, start: usize, end: usize) -> Vec<usize> {
    let (mut nodes, mut i) = (vec![end], end);
    while i != start {
        let (dc, dr, _) = step[usize::from(came_by[i]) % 8];
        i = (i as isize - dr * cols as isize - dc) as usize;
        nodes.push(i);
    }
    nodes.reverse();
    nodes
}

/// Four passes of the [1 2 1] / 4 mask with fixed ends; no vertex moves farther than half a spacing from its node or off the ground.
fn smooth(terrain: &Heightfield, nodes: Vec<DVec2>, open: impl Fn(DVec2) -> bool) -> Vec<DVec2> {
    let farthest = 0.5 * terrain.spacing().min_element();
    let mut line = nodes.clone();
    for _ in 0..4 {
        let old = line.clone();
        for ((p, w), node) in line.iter_mut().skip(1).zip(old.windows(3)).zip(nodes.iter().skip(1)) {
            let moved = *node + (0.25 * (w[0] + 2.0 * w[1] + w[2]) - *node).clamp_length_max(farthest);
            if terrain.height_at(moved).is_some() && open(moved) {
                *p = moved;
            }
        }
    }
    line.dedup();
    line
}

/// Longest side of the window in which a valley route is searched, metres.
const WINDOW_M: f64 = 24_000.0;

/// A route for terrain without a given one: through the valleys of its most mountainous part, 10 to 30 km long where the terrain allows.
///
/// Of 48 seeded windows those with the greatest relief and the fewest voids are tried; the ends are low ground on opposite sides.
/// Same terrain and seed, same route.
///
/// # Errors
/// [`RouteError::NoValley`].
///
/// Source: ours.
pub fn valley_route(terrain: &Heightfield, seed: u64) -> Result<Vec<DVec2>, RouteError> {
    let cost = RouteCost { wander: 1.5, seed, ..RouteCost::default() };
    let mut random = seeded(seed ^ 0x7661_6c6c);
    let mut windows: Vec<(f64, Window)> = (0..48).map(|_| seeded_window(terrain, &mut random)).collect();
    windows.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, window) in windows.into_iter().take(4) {
        let open = vec![false; window.cols * window.rows];
        for ends in low_ends(terrain, window, &mut random) {
            if let Ok(route) = route_in(terrain, window, ends, &cost, &open) {
                return Ok(route);
            }
        }
    }
    Err(RouteError::NoValley {
        cols: terrain.cols(),
        rows: terrain.rows(),
        void_percent: 100.0 * terrain.share_of(NodeState::Void),
    })
}

/// A window at a seeded position and its rating: relief, reduced by the share of voids.
fn seeded_window(terrain: &Heightfield, random: &mut Random) -> (f64, Window) {
    let nodes = |count: usize, spacing: f64| count.min((WINDOW_M / spacing) as usize + 1).max(2.min(count));
    let (cols, rows) = (nodes(terrain.cols(), terrain.spacing().x), nodes(terrain.rows(), terrain.spacing().y));
    let col = (random.unit() * (terrain.cols() - cols + 1) as f64) as usize;
    let row = (random.unit() * (terrain.rows() - rows + 1) as f64) as usize;
    let window = Window { col: col.min(terrain.cols() - cols), row: row.min(terrain.rows() - rows), cols, rows };
    let stride = (cols.max(rows) / 48).max(1);
    let (mut lo, mut hi, mut voids, mut count) = (f64::MAX, f64::MIN, 0.0f64, 0.0f64);
    for r in (0..rows).step_by(stride) {
        for c in (0..cols).step_by(stride) {
            count += 1.0;
            match terrain.node(window.col + c, window.row + r) {
                Some(p) => (lo, hi) = (lo.min(p.z), hi.max(p.z)),
                None => voids += 1.0,
            }
        }
    }
    ((hi - lo).max(0.0) * (1.0 - 3.0 * voids / count).max(0.0), window)
}

/// Pairs of low nodes on opposite sides of the window, the seeded favourite first.
fn low_ends(terrain: &Heightfield, window: Window, random: &mut Random) -> Vec<[DVec2; 2]> {
    let lowest = |cols: [f64; 2], rows: [f64; 2]| {
        let span = |range: [f64; 2], n: usize| (range[0] * n as f64) as usize..((range[1] * n as f64) as usize).min(n);
        let mut best: Option<DVec3> = None;
        for r in span(rows, window.rows) {
            for c in span(cols, window.cols) {
                let node = terrain.node(window.col + c, window.row + r);
                let node = node.filter(|_| solid(terrain, (window.col + c, window.row + r)));
                best = node.filter(|p| best.is_none_or(|b| p.z < b.z)).or(best);
            }
        }
        best.map(DVec3::truncate)
    };
    let (near, far, all) = ([0.08, 0.2], [0.8, 0.92], [0.15, 0.85]);
    let sides = [
        [lowest(near, all), lowest(far, all)],
        [lowest(all, near), lowest(all, far)],
        [lowest(near, near), lowest(far, far)],
        [lowest(near, far), lowest(far, near)],
    ];
    let first = (random.unit() * 2.0) as usize;
    [first, 1 - first.min(1), 2, 3]
        .into_iter()
        .filter_map(|k| match sides.get(k) {
            Some([Some(a), Some(b)]) if a != b => Some([*a, *b]),
            _ => None,
        })
        .collect()
}

#[cfg(test)]
mod tests;
