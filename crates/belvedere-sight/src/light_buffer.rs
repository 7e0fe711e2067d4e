//! Which solids can come between points and the sun: a grid across the sun's direction, and for every cell the solids that rays from it
//! may meet, those nearest to the sun first.
//!
//! Source: Haines and Greenberg 1986, "The light buffer: a shadow testing accelerator". Cells that grow with the spread of the rays, and
//! cells that are filled when they are first asked for, are ours.

use crate::beam::{Beam, LightAxes};
use crate::shadow::{Bundle, Rays, Shadow};
use crate::{MeshTree, Obstacles};
use belvedere_core::{Aabb, DVec3};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Grids of cells, each `COARSER` times as wide as the one before.
const LEVELS: usize = 3;
const COARSER: f64 = 4.0;
/// Cells along a side of the squares for which memory is taken together.
const TILE: usize = 16;
/// Fewest and most cells of the finest grid, and most along a side.
const CELLS: [usize; 2] = [1 << 12, 1 << 18];
const ALONG: f64 = 4096.0;
/// Most shadows that are kept, in all and for each point: of more solids the trees answer, for less memory, and sooner where few points ask.
const SHADOWS: usize = 1 << 21;
const PER_POINT: usize = 2;
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
    /// Of all boxes, then of the triangles of all meshes.
    shadows: Vec<Shadow>,
    /// Number of the first shadow of each mesh.
    first: Vec<usize>,
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
    /// Numbers of the shadows of solids, those nearest to the sun first.
    solids: Box<[u32]>,
    /// Place along the light above which no ground is.
    ground: f64,
}

/// A box or a triangle that a ray may meet.
#[derive(Debug, Clone, Copy, Default)]
pub struct Blocker(u32);

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
    #[inline]
    pub fn blockers(&self) -> &[Blocker] {
        &self.blockers[..self.count]
    }

    /// Keeps the blockers for which `is_kept` holds.
    #[inline]
    pub fn retain(&mut self, is_kept: impl Fn(Blocker) -> bool) {
        let mut kept = 0;
        for i in 0..self.count {
            if is_kept(self.blockers[i]) {
                self.blockers[kept] = self.blockers[i];
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// Tries a blocker before all others from now on.
    #[inline]
    pub fn prefer(&mut self, position: usize) {
        self.blockers[..self.count].swap(0, position);
    }
}

impl<'a> LightBuffer<'a> {
    /// Bytes of a box or triangle, its entries in cells included.
    pub const BYTES: u64 = 128;

    /// Prepares the shadows of all solids, of which there may be at most two million, and two for each point; of more the buffer tells nothing. Cells are filled later.
    /// * `axes`: orthonormal, the last towards the sun, which is up;
    /// * `spread`: distance by which rays depart from it along the other axes, per unit along it;
    /// * `points`: number of points that will be asked for, about: few of them are worth neither many cells nor many shadows.
    pub fn new(obstacles: Obstacles<'a>, axes: [DVec3; 3], spread: f64, points: usize) -> Self {
        let bounds = obstacles.solid_bounds();
        let bounds = if bounds.is_empty() { Aabb::of([DVec3::ZERO]) } else { bounds };
        let half = 0.5 * (bounds.max - bounds.min);
        let light = LightAxes { origin: bounds.center(), axes };
        let slack = SLACK * bounds.min.abs().max(bounds.max.abs()).max_element().max(1e-3);
        let triangles = |tree: &MeshTree<'_>| tree.mesh().triangles().len();
        let solids =
            obstacles.boxes().boxes().len() + obstacles.meshes().iter().map(|(_, m)| triangles(m)).sum::<usize>();
        if solids > SHADOWS.min(PER_POINT * points) {
            let (shadows, first, levels) = (Vec::new(), Vec::new(), Vec::new());
            return Self { light, spread, low: bounds.min.z, slack, shadows, first, levels, obstacles };
        }
        let boxes = obstacles.boxes().boxes().par_iter().map(|shape| Shadow::of_box(&shape.reach_along(&light), slack));
        let mut shadows: Vec<Shadow> = boxes.collect();
        let mut first = Vec::new();
        for (_, tree) in obstacles.meshes() {
            let mesh = tree.mesh();
            let triangles = (0..mesh.triangles().len()).into_par_iter();
            first.push(shadows.len());
            shadows.par_extend(triangles.map(|i| Shadow::of_triangle(mesh.corners(i).map(|p| light.place(p)), slack)));
        }
        let solid = light.reach_of_box(bounds.center(), [half.x * DVec3::X, half.y * DVec3::Y, half.z * DVec3::Z]);
        let extent = [0, 1].map(|k| solid.high[k] - solid.low[k]);
        let most = (points / 16).min(4 * shadows.len()).clamp(CELLS[0], CELLS[1]);
        // Rays from the foot of the lowest solid to the top of the highest, and some room for the starts.
        let departure = 1.5 * spread * 2.0 * half.z / axes[2].z + slack;
        let even = (extent[0] * extent[1] / most as f64).sqrt();
        let side = (2.0 * departure).max(even).max(extent[0].max(extent[1]) / ALONG);
        let level = |k: usize| {
            let side = COARSER.powi(k as i32) * side;
            let reach = 0.5 * side;
            let size = extent.map(|extent| ((extent + 2.0 * reach) / side) as usize + 1);
            let tiles = size.map(|n| n.div_ceil(TILE)).iter().product();
            let from = [0, 1].map(|axis| solid.low[axis] - reach);
            Level { reach, side, from, size, tiles: (0..tiles).map(|_| OnceLock::new()).collect() }
        };
        let levels = (0..LEVELS).map(level).collect();
        Self { light, spread, low: bounds.min.z, slack, shadows, first, levels, obstacles }
    }

    /// The solids.
    pub fn obstacles(&self) -> &Obstacles<'a> {
        &self.obstacles
    }

    /// What the rays of a bundle may meet; `None` where the buffer does not tell. No ray meets a solid that is not found.
    pub fn around(&self, bundle: &Bundle) -> Option<Found> {
        let rays = Rays::new(&self.light, bundle, self.spread, self.slack);
        let needed = rays.half[0].max(rays.half[1]) + self.spread * bundle.length.max(0.0);
        let level = self.levels.iter().find(|level| needed <= level.reach)?;
        let mut found = Found { blockers: [Blocker::default(); MOST], count: 0, is_over_ground: false };
        let Some(place) = level.cell_of(rays.at) else { return Some(found) };
        let cell = level.cell(place, || self.fill(level, place));
        let lowest = bundle.center.z - bundle.half.map(|h| h.z.abs()).iter().sum::<f64>();
        found.is_over_ground = lowest >= self.low - self.slack && rays.start > cell.ground;
        for number in &cell.solids {
            let shadow = &self.shadows[*number as usize];
            if f64::from(shadow.top) < rays.start {
                break;
            }
            if shadow.may_meet(&rays) {
                *found.blockers.get_mut(found.count)? = Blocker(*number);
                found.count += 1;
            }
        }
        Some(found)
    }

    /// Whether the segment `a b` meets a blocker: the test of [`MeshTree::is_crossed`](crate::MeshTree::is_crossed) or of
    /// [`BoxTree::near`](crate::BoxTree::near).
    #[inline]
    pub fn is_met(&self, blocker: Blocker, a: DVec3, b: DVec3) -> bool {
        let number = blocker.0 as usize;
        match self.mesh_of(number) {
            Some(mesh) => self.obstacles.meshes()[mesh].1.crossing(number - self.first[mesh], a, b).is_some(),
            None => self.obstacles.boxes().boxes()[number].is_met(a, b),
        }
    }

    /// Index of the layer of a blocker in the scene.
    pub fn layer_of(&self, blocker: Blocker) -> usize {
        let number = blocker.0 as usize;
        match self.mesh_of(number) {
            Some(mesh) => self.obstacles.meshes()[mesh].0,
            None => self.obstacles.boxes().boxes()[number].layer,
        }
    }

    /// Position, among the meshes, of the mesh of a shadow; `None` for a box.
    fn mesh_of(&self, number: usize) -> Option<usize> {
        self.first.iter().rposition(|first| *first <= number)
    }

    fn fill(&self, level: &Level, [col, row]: [usize; 2]) -> Cell {
        let section = [0, 1].map(|k| {
            let from = level.from[k] + level.side * [col, row][k] as f64;
            [from - level.reach - self.slack, from + level.side + level.reach + self.slack]
        });
        let beam = Beam { light: self.light, section };
        let mut solids = Vec::new();
        let mut add = |number: usize| {
            if self.shadows[number].is_in(&beam) {
                solids.push(number as u32);
            }
        };
        self.obstacles.boxes().in_beam(&beam, &mut add);
        for ((_, tree), first) in self.obstacles.meshes().iter().zip(&self.first) {
            tree.in_beam(&beam, |triangle| add(first + triangle));
        }
        solids.sort_by(|a, b| self.shadows[*b as usize].top.total_cmp(&self.shadows[*a as usize].top));
        let low = self.low - 2.0 * self.slack;
        let grounds = self.obstacles.grounds().iter().map(|(_, ground)| ground.highest_along(&beam, low));
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
