//! Which solids can come between points and the sun: a grid across the sun's direction, and for every cell the solids that rays from it
//! may meet, those nearest to the sun first.
//!
//! Source: Haines and Greenberg 1986, "The light buffer: a shadow testing accelerator". Cells that grow with the spread of the rays, and
//! cells that are filled when they are first asked for, are ours.

use crate::Obstacles;
use crate::beam::{Beam, LightAxes, Reach};
use belvedere_core::{Aabb, DVec3};
use std::sync::OnceLock;

/// Grids of cells, each `COARSER` times as wide as the one before.
const LEVELS: usize = 3;
const COARSER: f64 = 4.0;
/// Cells along a side of the squares for which memory is taken together.
const TILE: usize = 16;
/// Fewest and most cells of the finest grid.
const CELLS: [usize; 2] = [1 << 12, 1 << 18];
/// Most solids that are found; where there are more, the trees are faster.
const MOST: usize = 24;
/// Widening of all bounds against rounding, as a share of the coordinates' size.
const SLACK: f64 = 1e-12;

/// Solids of a scene and what of them rays towards the sun can meet.
pub struct LightBuffer<'a> {
    obstacles: Obstacles<'a>,
    light: LightAxes,
    /// Distance across the light by which rays depart from it per unit along it, along each of the axes.
    spread: f64,
    /// Least height of the boxes and meshes.
    low: f64,
    slack: f64,
    levels: Vec<Level>,
}

struct Level {
    /// Distance from the points of a cell, across the light, within which solids are its own.
    reach: f64,
    side: f64,
    from: [f64; 2],
    size: [usize; 2],
    tiles: Vec<OnceLock<Box<[OnceLock<Cell>]>>>,
}

/// What rays from the points of a cell can meet.
struct Cell {
    /// Those nearest to the sun first.
    solids: Box<[Blocker]>,
    /// Place along the light above which no ground is.
    ground: f64,
}

/// A box or a triangle that a ray may meet.
#[derive(Debug, Clone, Copy)]
pub struct Blocker {
    /// Bounds across the light.
    low: [f32; 2],
    high: [f32; 2],
    /// Farthest place along the light.
    top: f32,
    /// Position of its mesh among the meshes, or [`BOX`].
    mesh: u32,
    number: u32,
}

/// In the place of a mesh: the blocker is a box.
const BOX: u32 = u32::MAX;

/// The starts of a bundle of rays towards the sun.
#[derive(Debug, Clone, Copy)]
pub struct Bundle {
    /// Middle of the starts, scene coordinates.
    pub center: DVec3,
    /// The starts lie in the middle plus shares -1..=1 of these two.
    pub half: [DVec3; 2],
    /// Length of the longest ray along the light, scene units.
    pub length: f64,
}

/// What the rays of a bundle may meet.
#[derive(Debug, Clone)]
pub struct Found {
    blockers: [Blocker; MOST],
    count: usize,
    /// Whether the rays certainly meet no ground.
    pub is_over_ground: bool,
}

impl Found {
    /// The boxes and triangles, in an order of no meaning.
    pub fn blockers(&self) -> &[Blocker] {
        &self.blockers[..self.count]
    }

    /// Keeps the blockers for which `is_kept` holds.
    pub fn retain(&mut self, is_kept: impl Fn(&Blocker) -> bool) {
        let mut kept = 0;
        for i in 0..self.count {
            if is_kept(&self.blockers[i]) {
                self.blockers[kept] = self.blockers[i];
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Tries a blocker before all others from now on.
    pub fn prefer(&mut self, position: usize) {
        self.blockers[..self.count].swap(0, position);
    }
}

impl<'a> LightBuffer<'a> {
    /// Prepares the grids; cells are filled later.
    /// * `axes`: orthonormal, the last towards the sun, which is up;
    /// * `spread`: distance by which rays depart from it along the other axes, per unit along it;
    /// * `points`: number of points that will be asked for, about: few of them are not worth many cells.
    pub fn new(obstacles: Obstacles<'a>, axes: [DVec3; 3], spread: f64, points: usize) -> Self {
        let bounds = obstacles.solid_bounds();
        let bounds = if bounds.is_empty() { Aabb::of([DVec3::ZERO]) } else { bounds };
        let half = 0.5 * (bounds.max - bounds.min);
        let light = LightAxes { origin: bounds.center(), axes };
        let solid = light.reach_of_box(bounds.center(), [half.x * DVec3::X, half.y * DVec3::Y, half.z * DVec3::Z]);
        let slack = SLACK * bounds.min.abs().max(bounds.max.abs()).max_element().max(1e-3);
        let triangles: usize = obstacles.meshes().iter().map(|(_, tree)| tree.mesh().triangles().len()).sum();
        let solids = triangles + obstacles.boxes().boxes().len();
        let most = (points / 16).min(4 * solids).clamp(CELLS[0], CELLS[1]);
        let extent = [0, 1].map(|k| solid.high[k] - solid.low[k]);
        let departure = 1.5 * spread * 2.0 * half.z / axes[2].z + slack;
        let side =
            (2.0 * departure).max((extent[0] * extent[1] / most as f64).sqrt()).max(extent[0].max(extent[1]) / 4096.0);
        let level = |k: usize| {
            let side = COARSER.powi(k as i32) * side;
            let reach = 0.5 * side;
            let size = extent.map(|extent| ((extent + 2.0 * reach) / side) as usize + 1);
            let tiles = size.map(|n| n.div_ceil(TILE)).iter().product();
            let from = [0, 1].map(|axis| solid.low[axis] - reach);
            Level { reach, side, from, size, tiles: (0..tiles).map(|_| OnceLock::new()).collect() }
        };
        Self { light, spread, low: bounds.min.z, slack, levels: (0..LEVELS).map(level).collect(), obstacles }
    }

    /// The solids.
    pub fn obstacles(&self) -> &Obstacles<'a> {
        &self.obstacles
    }

    /// What the rays of a bundle may meet; `None` where the buffer does not tell. No ray meets a solid that is not found.
    pub fn around(&self, bundle: &Bundle) -> Option<Found> {
        let at = self.light.place(bundle.center);
        let half: [f64; 3] = std::array::from_fn(|k| {
            bundle.half.map(|h| h.dot(self.light.axes[k]).abs()).iter().sum::<f64>() + self.slack
        });
        let start = at[2] - half[2];
        let needed = half[0].max(half[1]) + self.spread * bundle.length.max(0.0);
        let level = self.levels.iter().find(|level| needed <= level.reach)?;
        let none = Blocker { low: [0.0; 2], high: [0.0; 2], top: 0.0, mesh: BOX, number: 0 };
        let mut found = Found { blockers: [none; MOST], count: 0, is_over_ground: false };
        let Some(place) = level.cell_of(at) else { return Some(found) };
        let cell = level.cell(place, || self.fill(level, place));
        let lowest = bundle.center.z - bundle.half.map(|h| h.z.abs()).iter().sum::<f64>();
        found.is_over_ground = lowest >= self.low - self.slack && start > cell.ground;
        for blocker in cell.solids.iter().take_while(|blocker| f64::from(blocker.top) >= start) {
            let depart = self.spread * (f64::from(blocker.top) - start);
            let is_met = [0, 1].into_iter().all(|k| {
                let reach = half[k] + depart;
                f64::from(blocker.low[k]) <= at[k] + reach && f64::from(blocker.high[k]) >= at[k] - reach
            });
            if is_met {
                *found.blockers.get_mut(found.count)? = *blocker;
                found.count += 1;
            }
        }
        Some(found)
    }

    /// Whether the segment `a b` meets a blocker: the test of [`MeshTree::is_crossed`](crate::MeshTree::is_crossed) or of
    /// [`BoxTree::near`](crate::BoxTree::near).
    pub fn is_met(&self, blocker: &Blocker, a: DVec3, b: DVec3) -> bool {
        match self.obstacles.meshes().get(blocker.mesh as usize) {
            Some((_, tree)) => tree.crossing(blocker.number as usize, a, b).is_some(),
            None => self.obstacles.boxes().boxes()[blocker.number as usize].is_met(a, b),
        }
    }

    /// Index of the layer of a blocker in the scene.
    pub fn layer_of(&self, blocker: &Blocker) -> usize {
        match self.obstacles.meshes().get(blocker.mesh as usize) {
            Some((layer, _)) => *layer,
            None => self.obstacles.boxes().boxes()[blocker.number as usize].layer,
        }
    }

    fn fill(&self, level: &Level, [col, row]: [usize; 2]) -> Cell {
        let section = [0, 1].map(|k| {
            let from = level.from[k] + level.side * [col, row][k] as f64;
            [from - level.reach - self.slack, from + level.side + level.reach + self.slack]
        });
        let beam = Beam { light: self.light, section };
        let mut solids = Vec::new();
        let mut add = |reach: Reach, mesh: u32, number: usize| {
            if beam.holds(&reach) {
                let low = [0, 1].map(|k| ((reach.low[k] - self.slack) as f32).next_down());
                let high = [0, 1].map(|k| ((reach.high[k] + self.slack) as f32).next_up());
                let top = ((reach.high[2] + self.slack) as f32).next_up();
                solids.push(Blocker { low, high, top, mesh, number: number as u32 });
            }
        };
        let boxes = self.obstacles.boxes();
        boxes.in_beam(&beam, |number| add(boxes.boxes()[number].reach_along(&self.light), BOX, number));
        for (mesh, (_, tree)) in self.obstacles.meshes().iter().enumerate() {
            tree.in_beam(&beam, |number| add(tree.reach_along(number, &self.light), mesh as u32, number));
        }
        solids.sort_by(|a, b| b.top.total_cmp(&a.top));
        let grounds =
            self.obstacles.grounds().iter().map(|(_, ground)| ground.highest_along(&beam, self.low - 2.0 * self.slack));
        let ground = grounds.fold(f64::NEG_INFINITY, f64::max) + self.slack;
        Cell { solids: solids.into_boxed_slice(), ground }
    }
}

impl Level {
    fn cell_of(&self, at: [f64; 3]) -> Option<[usize; 2]> {
        let place = [0, 1].map(|k| ((at[k] - self.from[k]) / self.side).floor());
        let is_in = (0..2).all(|k| place[k] >= 0.0 && place[k] < self.size[k] as f64);
        is_in.then(|| place.map(|x| x as usize))
    }

    fn cell(&self, [col, row]: [usize; 2], fill: impl FnOnce() -> Cell) -> &Cell {
        let tile = &self.tiles[row / TILE * self.size[0].div_ceil(TILE) + col / TILE];
        let cells = tile.get_or_init(|| (0..TILE * TILE).map(|_| OnceLock::new()).collect());
        cells[row % TILE * TILE + col % TILE].get_or_init(fill)
    }
}
