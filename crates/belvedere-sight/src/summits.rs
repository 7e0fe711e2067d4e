//! How summits stand out of the ground: prominence (height over the key saddle, the highest pass to higher ground) and dominance (distance
//! to the nearest higher ground).

use belvedere_core::DVec2;
use belvedere_scene::Heightfield;

/// Most nodes of the grid that is looked at; finer grounds keep the highest node of every block.
const MOST_NODES: usize = 4_000_000;
/// How far a summit may lie from its point, scene units: names stand beside their summits on most maps.
const REACH_M: f64 = 300.0;

/// How a summit stands out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Standing {
    /// Height over the key saddle, scene units, >= 0; of the highest summit of the ground, over its lowest node. A key saddle beyond the
    /// rim of the ground is not known: then this is too high rather than too low.
    pub prominence: f64,
    /// Distance to the nearest higher ground, scene units, >= 0; without any on the ground, the ground's diagonal.
    pub dominance: f64,
}

/// Heights on a grid of at most [`MOST_NODES`] nodes.
struct Grid {
    cols: usize,
    rows: usize,
    /// -inf at voids.
    heights: Vec<f32>,
    north_west: DVec2,
    spacing: DVec2,
}

impl Grid {
    fn of(ground: &Heightfield, most: usize) -> Self {
        let block = ((ground.cols() * ground.rows()) as f64 / most as f64).sqrt().ceil().max(1.0) as usize;
        let (cols, rows) = (ground.cols().div_ceil(block), ground.rows().div_ceil(block));
        let mut heights = vec![f32::NEG_INFINITY; cols * rows];
        for row in 0..ground.rows() {
            for col in 0..ground.cols() {
                if let Some(p) = ground.node(col, row) {
                    let h = &mut heights[row / block * cols + col / block];
                    *h = h.max(p.z as f32);
                }
            }
        }
        let spacing = ground.spacing() * block as f64;
        let middle = 0.5 * (block - 1) as f64 * ground.spacing() * DVec2::new(1.0, -1.0);
        Self { cols, rows, heights, north_west: ground.north_west() + middle, spacing }
    }

    /// The highest node of the ground in the block of a node.
    fn highest_of_block(&self, ground: &Heightfield, node: usize) -> Option<u32> {
        let block = (self.spacing / ground.spacing()).round();
        let (block, first) = (block.x as usize, [node % self.cols, node / self.cols].map(|k| k * block.x as usize));
        let [cols, rows] =
            [0, 1].map(|axis| first[axis]..(first[axis] + block).min([ground.cols(), ground.rows()][axis]));
        let nodes = rows.flat_map(|row| cols.clone().map(move |col| (col, row)));
        let heights = nodes.filter_map(|(col, row)| Some((ground.node(col, row)?.z, row * ground.cols() + col)));
        heights.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|(_, node)| node as u32)
    }

    /// Nodes around a node that are on the grid.
    fn around(&self, node: usize) -> impl Iterator<Item = usize> + use<'_> {
        let (col, row) = ((node % self.cols) as i64, (node / self.cols) as i64);
        let steps = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
        let to = move |(c, r): (i64, i64)| (col + c, row + r);
        let inside = move |(c, r): &(i64, i64)| (0..self.cols as i64).contains(c) && (0..self.rows as i64).contains(r);
        steps.into_iter().map(to).filter(inside).map(|(c, r)| r as usize * self.cols + c as usize)
    }

    /// Whether one node is higher than another; equal ones stand in their order.
    fn is_higher(&self, a: usize, b: usize) -> bool {
        (self.heights[a], b) > (self.heights[b], a)
    }

    /// The highest node within [`REACH_M`] of a point that is reached without going down, or the point's own.
    fn summit_near(&self, at: DVec2) -> Option<usize> {
        let g = (at - self.north_west) / self.spacing * DVec2::new(1.0, -1.0);
        let [col, row] = [g.x.round(), g.y.round()];
        let inside = col >= 0.0 && row >= 0.0 && col < self.cols as f64 && row < self.rows as f64;
        let mut node = inside.then(|| row as usize * self.cols + col as usize)?;
        if self.heights[node] == f32::NEG_INFINITY {
            return None;
        }
        let place = |node: usize| DVec2::new((node % self.cols) as f64, (node / self.cols) as f64);
        let near = |node: &usize| ((place(*node) - g) * self.spacing).length() <= REACH_M;
        while let Some(up) = self
            .around(node)
            .filter(near)
            .filter(|n| self.is_higher(*n, node))
            .reduce(|a, b| if self.is_higher(a, b) { a } else { b })
        {
            node = up;
        }
        Some(node)
    }

    /// Prominence of every node that is the highest of its surroundings, others 0: nodes are flooded from the highest down, and where two
    /// floods meet the lower summit has found its key saddle.
    fn prominences(&self) -> Vec<f32> {
        let mut order: Vec<u32> =
            (0..self.heights.len() as u32).filter(|n| self.heights[*n as usize] > f32::NEG_INFINITY).collect();
        order.sort_unstable_by(|a, b| self.heights[*b as usize].total_cmp(&self.heights[*a as usize]).then(a.cmp(b)));
        let mut floods = Floods { parent: vec![u32::MAX; self.heights.len()] };
        let mut out = vec![0.0f32; self.heights.len()];
        // The root of a flood is its summit.
        for &node in &order {
            floods.parent[node as usize] = node;
            for other in self.around(node as usize) {
                if floods.parent[other] == u32::MAX {
                    continue;
                }
                let (a, b) = (floods.root(node) as usize, floods.root(other as u32) as usize);
                if a == b {
                    continue;
                }
                let (high, low) = if self.is_higher(a, b) { (a, b) } else { (b, a) };
                out[low] = self.heights[low] - self.heights[node as usize];
                floods.parent[low] = high as u32;
            }
        }
        let lowest = order.last().map_or(0.0, |node| self.heights[*node as usize]);
        for &node in order.iter().filter(|node| floods.parent[**node as usize] == **node) {
            out[node as usize] = self.heights[node as usize] - lowest;
        }
        out
    }

    /// Distance from a node to the nearest higher one, searched in growing squares.
    fn dominance(&self, node: usize) -> f64 {
        let (col, row) = ((node % self.cols) as i64, (node / self.cols) as i64);
        let least_spacing = self.spacing.min_element();
        let mut best = f64::INFINITY;
        for ring in 1..self.cols.max(self.rows) as i64 {
            if ring as f64 * least_spacing > best {
                break;
            }
            let mut look = |c: i64, r: i64| {
                if (0..self.cols as i64).contains(&c) && (0..self.rows as i64).contains(&r) {
                    let other = r as usize * self.cols + c as usize;
                    if self.heights[other] > self.heights[node] {
                        let off = DVec2::new((c - col) as f64, (r - row) as f64) * self.spacing;
                        best = best.min(off.length());
                    }
                }
            };
            for k in -ring..=ring {
                look(col + k, row - ring);
                look(col + k, row + ring);
            }
            for k in 1 - ring..ring {
                look(col - ring, row + k);
                look(col + ring, row + k);
            }
        }
        let diagonal = (DVec2::new(self.cols as f64, self.rows as f64) * self.spacing).length();
        best.min(diagonal)
    }
}

/// Nodes that belong together, each leading to the summit of its flood; `u32::MAX`: not flooded.
struct Floods {
    parent: Vec<u32>,
}

impl Floods {
    fn root(&mut self, mut node: u32) -> u32 {
        while self.parent[node as usize] != node {
            // Halves the way for the next time.
            let up = self.parent[self.parent[node as usize] as usize];
            self.parent[node as usize] = up;
            node = up;
        }
        node
    }
}

/// How the summits at points stand out of the ground: each the highest node within 300 m that is reached uphill. Of points at one summit the
/// nearest has it, the others stand out by nothing; points off the ground too.
///
/// Takes O(n log n) for n nodes, of which at most four million are looked at.
pub fn standings(ground: &Heightfield, points: &[DVec2]) -> Vec<Standing> {
    standings_on(&Grid::of(ground, MOST_NODES), points)
}

/// Nodes of the most prominent summits of the ground, the most prominent first.
///
/// * `count`: summits at most; `least`: least prominence, share of the range of heights; `most`: nodes that are looked at: finer grounds keep
///   the highest node of every block.
///
/// Takes O(n log n) for n nodes that are looked at.
pub fn most_prominent(ground: &Heightfield, count: usize, least: f64, most: usize) -> Vec<u32> {
    let grid = Grid::of(ground, most);
    let prominences = grid.prominences();
    // The highest summit stands out by the range of heights.
    let least = least * f64::from(prominences.iter().copied().fold(0.0, f32::max));
    let mut order: Vec<usize> = (0..prominences.len()).filter(|node| f64::from(prominences[*node]) > least).collect();
    order.sort_unstable_by(|a, b| prominences[*b].total_cmp(&prominences[*a]).then(a.cmp(b)));
    order.truncate(count);
    order.into_iter().filter_map(|node| grid.highest_of_block(ground, node)).collect()
}

fn standings_on(grid: &Grid, points: &[DVec2]) -> Vec<Standing> {
    let summits: Vec<Option<usize>> = points.iter().map(|at| grid.summit_near(*at)).collect();
    if summits.iter().all(Option::is_none) {
        return vec![Standing::default(); points.len()];
    }
    let place = |node: usize| {
        grid.north_west + DVec2::new((node % grid.cols) as f64, -((node / grid.cols) as f64)) * grid.spacing
    };
    let mut owners: std::collections::BTreeMap<usize, (f64, usize)> = std::collections::BTreeMap::new();
    for (i, node) in summits.iter().enumerate().filter_map(|(i, node)| Some((i, (*node)?))) {
        let far = place(node).distance(points[i]);
        let owner = owners.entry(node).or_insert((far, i));
        if far < owner.0 {
            *owner = (far, i);
        }
    }
    let prominences = grid.prominences();
    let mut out = vec![Standing::default(); points.len()];
    for (node, (_, i)) in owners {
        out[i] = Standing { prominence: f64::from(prominences[node].max(0.0)), dominance: grid.dominance(node) };
    }
    out
}

#[cfg(test)]
mod tests;
