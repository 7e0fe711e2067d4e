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
mod tests {
    use super::*;

    fn grid(cols: usize, rows: usize, height: impl Fn(usize, usize) -> f32) -> Grid {
        let heights = (0..rows).flat_map(|r| (0..cols).map(move |c| (c, r))).map(|(c, r)| height(c, r)).collect();
        Grid { cols, rows, heights, north_west: DVec2::ZERO, spacing: DVec2::new(30.0, 20.0) }
    }

    /// By definition: floods the ground above ever lower levels until something higher is reached.
    fn searched(grid: &Grid, summit: usize) -> f32 {
        let mut levels: Vec<f32> = grid.heights.iter().copied().filter(|h| *h > f32::NEG_INFINITY).collect();
        levels.sort_by(|a, b| b.total_cmp(a));
        for level in &levels {
            let (mut seen, mut open) = (vec![false; grid.heights.len()], vec![summit]);
            while let Some(node) = open.pop().filter(|n| grid.heights[*n] >= *level) {
                if std::mem::replace(&mut seen[node], true) {
                    continue;
                }
                if grid.is_higher(node, summit) {
                    return grid.heights[summit] - level;
                }
                open.extend(grid.around(node).filter(|n| grid.heights[*n] >= *level && !seen[*n]));
            }
        }
        grid.heights[summit] - levels.last().copied().unwrap_or(0.0)
    }

    #[test]
    fn prominence_is_that_of_its_definition() {
        let mut seed = 3u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 58) as f32
        };
        for _ in 0..6 {
            // Heights of few values: ties and flat tops; some voids.
            let values: Vec<f32> = (0..17 * 13).map(|_| random()).collect();
            let grid = grid(17, 13, |c, r| match values[r * 17 + c] {
                v if v < 3.0 => f32::NEG_INFINITY,
                v => v,
            });
            let found = grid.prominences();
            let mut summits = 0;
            for node in (0..grid.heights.len()).filter(|n| grid.heights[*n] > f32::NEG_INFINITY) {
                let is_summit = !grid.around(node).any(|n| grid.is_higher(n, node));
                summits += usize::from(is_summit);
                let wanted = if is_summit { searched(&grid, node) } else { 0.0 };
                assert_eq!(found[node], wanted, "node {node}");
            }
            assert!(summits > 5);
        }
    }

    #[test]
    fn summits_are_found_beside_their_points_and_belong_to_the_nearest() {
        // Two cones: 1000 high at (40, 20), 600 high at (10, 20), the pass between them at about 300.
        let cone = |c: usize, r: usize, at: [f64; 2], top: f64| {
            top - 20.0 * DVec2::new(c as f64 - at[0], r as f64 - at[1]).length()
        };
        let grid = grid(60, 40, |c, r| cone(c, r, [40.0, 20.0], 1000.0).max(cone(c, r, [10.0, 20.0], 600.0)) as f32);
        let at = |c: f64, r: f64| DVec2::new(30.0 * c, -20.0 * r);
        let points = [at(41.0, 21.0), at(10.0, 20.0), at(12.0, 20.0), at(-5.0, 3.0), at(25.0, 39.0)];
        let found = standings_on(&grid, &points);
        let lowest = grid.heights.iter().copied().fold(f32::INFINITY, f32::min);
        assert_eq!(found[0].prominence, f64::from(1000.0 - lowest));
        assert!((found[0].dominance - (1800.0f64.powi(2) + 800.0f64.powi(2)).sqrt()).abs() < 1.0);
        let node = 20 * 60 + 10;
        assert_eq!(found[1].prominence, f64::from(searched(&grid, node)));
        assert!((80.0..120.0).contains(&found[1].prominence), "{:?}", found[1]);
        // The nearest ground higher than 600 lies 10 columns before the other summit, 20 columns away.
        assert!((found[1].dominance - 30.0 * 11.0).abs() <= 30.0, "{:?}", found[1]);
        assert_eq!(found[2], Standing::default());
        assert_eq!(found[3], Standing::default());
        assert!(standings_on(&grid, &[at(-9.0, 0.0)]) == [Standing::default()]);
    }

    #[test]
    fn blocks_of_fine_ground_keep_their_summits() {
        let height = |i: usize| {
            let (c, r) = ((i % 100) as f32, (i / 100) as f32);
            1000.0 - 3.0 * (c - 50.0).abs() - 3.0 * (r - 50.0).abs()
        };
        let heights = (0..10_000).map(height).collect();
        let ground =
            Heightfield::measured(DVec2::new(500.0, 900.0), DVec2::splat(10.0), 100, 100, heights).expect("ground");
        let grid = Grid::of(&ground, 700);
        assert!(grid.heights.len() <= 700 && grid.heights.contains(&1000.0));
        let summit = DVec2::new(1000.0, 400.0);
        let found = standings_on(&grid, &[summit]);
        assert!(found[0].prominence > 250.0, "{found:?}");
    }
}
