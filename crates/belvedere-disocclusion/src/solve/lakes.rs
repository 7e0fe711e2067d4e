//! Lakes and reservoirs: each moves as a whole or not at all.
//!
//! A lake is an area of water that the elevation model shows level. The program ties the nodes of its own grid that lie on one
//! together; every node of the terrain on it then gets the same displacement. Nodes of the bank stay free.

use super::super::visibility_qp::Levels;
use super::super::{Field, Hierarchy};
use belvedere_core::{DVec2, polygon};
use belvedere_scene::{AreaSurface, LayerKind, Scene};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// An area of water is level if four fifths of its heights lie within this range, metres: elevation models of 90 m scatter as much on
/// small lakes between steep banks. Rivers drawn as areas that fall by more are not level.
const LEVEL_M: f64 = 30.0;
/// Ground inside a shore that rises over the water by more than this is bank, metres: elevation models are rounded to it.
pub const BANK_M: f64 = 1.0;
/// Nodes of the solver's grid that are tied at most; if there are more, every second column and row is taken, then every third, and so on.
const MOST_TIED: usize = 800;
/// Least number of nodes of the solver's grid that can stand for a lake.
const FEWEST_TIED: usize = 4;

/// A lake and how it moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LakeReport {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Its name; empty if it has none.
    pub name: String,
    /// Middle height of the elevation model on it.
    pub height_m: f64,
    /// Displacement of the lake, metres.
    pub moved_m: f64,
    /// Largest difference of displacement between two of its nodes, metres; 0 but for rounding.
    pub range_m: f64,
    /// Nodes of the terrain on it.
    pub nodes: usize,
}

/// Nodes of the terrain on one lake.
#[derive(Debug, Clone)]
struct Lake {
    layer: usize,
    feature: usize,
    name: String,
    height: f64,
    nodes: Vec<u32>,
    /// Nodes of the bank inside the shore, with their height over the water, metres: they sink at least as far as the water, and at
    /// most to its level.
    bank: Vec<(u32, f64)>,
    /// Nodes next to the lake: they sink at least as far as the water, so that it does not run up a bank that stayed.
    shore: Vec<u32>,
}

impl Lake {
    /// The node of its water next to the middle of that.
    fn middle(&self, cols: usize) -> u32 {
        let place = |n: u32| DVec2::new((n as usize % cols) as f64, (n as usize / cols) as f64);
        let middle = self.nodes.iter().map(|n| place(*n)).sum::<DVec2>() / self.nodes.len().max(1) as f64;
        let away = |n: &&u32| place(**n).distance_squared(middle);
        self.nodes.iter().min_by(|a, b| away(a).total_cmp(&away(b))).copied().unwrap_or(0)
    }
}

/// The lakes of a scene on its terrain.
#[derive(Debug, Clone, Default)]
pub(super) struct Lakes {
    lakes: Vec<Lake>,
    cols: usize,
}

/// Areas of water.
pub(super) fn waters(scene: &Scene) -> Vec<Water> {
    let mut out = Vec::new();
    for (layer, content) in scene.layers.iter().enumerate() {
        if let LayerKind::Area(areas) = &content.kind
            && areas.surface == AreaSurface::Water
        {
            out.extend(areas.features.iter().enumerate().map(|(feature, area)| Water {
                layer,
                feature,
                name: area.name.clone(),
                rings: area.rings.clone(),
            }));
        }
    }
    out
}

/// An area of water.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Water {
    layer: usize,
    feature: usize,
    name: String,
    /// Scene x, y.
    rings: Vec<Vec<DVec2>>,
}

impl Lakes {
    pub(super) fn new(waters: &[Water], field: &Field) -> Self {
        let mut lakes = Vec::<Lake>::new();
        // Overlapping areas are one lake: files with several layers contain the same lake twice.
        let mut owner = BTreeMap::<u32, usize>::new();
        for water in waters {
            let rings: Vec<Vec<DVec2>> =
                water.rings.iter().map(|r| r.iter().map(|p| field.grid_from_scene(*p)).collect()).collect();
            let nodes = nodes_inside(&rings, field);
            let Some(height) = level_of(&nodes, field) else { continue };
            let Water { layer, feature, ref name, .. } = *water;
            let new = Lake { layer, feature, name: name.clone(), height, nodes, bank: Vec::new(), shore: Vec::new() };
            let others: BTreeSet<usize> = new.nodes.iter().filter_map(|n| owner.get(n).copied()).collect();
            let at = others.first().copied().unwrap_or(lakes.len());
            if at == lakes.len() {
                lakes.push(Lake { nodes: Vec::new(), ..new.clone() });
            }
            let joined: Vec<u32> = others.iter().flat_map(|k| std::mem::take(&mut lakes[*k].nodes)).collect();
            let all: BTreeSet<u32> = joined.into_iter().chain(new.nodes).collect();
            owner.extend(all.iter().map(|n| (*n, at)));
            lakes[at].nodes = all.into_iter().collect();
        }
        lakes.retain(|lake| !lake.nodes.is_empty());
        for lake in &mut lakes {
            lake.shore = beside(&lake.nodes, field, |n| owner.contains_key(&n));
            let rise = |n: u32| (n, field.heights()[n as usize] - lake.height);
            let (bank, water) = lake.nodes.iter().map(|n| rise(*n)).partition::<Vec<_>, _>(|(_, rise)| *rise > BANK_M);
            lake.bank = bank;
            lake.nodes = water.into_iter().map(|(n, _)| n).collect();
        }
        Self { lakes, cols: field.cols() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lakes.is_empty()
    }

    /// Nodes of each lake.
    pub(super) fn nodes(&self) -> impl Iterator<Item = &[u32]> {
        self.lakes.iter().map(|lake| lake.nodes.as_slice())
    }

    /// The nodes of a solver's grid on each lake, which are tied together; empty for a lake with too few of them.
    pub(super) fn tied(&self, grid: &Hierarchy) -> Vec<Vec<u32>> {
        let tied = |own: Vec<[usize; 2]>| if own.len() < FEWEST_TIED { Vec::new() } else { own };
        let places: Vec<Vec<[usize; 2]>> = self.lakes.iter().map(|lake| self.on_grid(lake, grid)).map(tied).collect();
        let all = |every: usize| -> Vec<Vec<u32>> {
            let kept = |[col, row]: &&[usize; 2]| col % every == 0 && row % every == 0;
            let node = |[col, row]: &[usize; 2]| (row * grid.cols() + col) as u32;
            let of = |p: &Vec<[usize; 2]>| p.iter().filter(kept).map(node).collect();
            places.iter().map(of).collect()
        };
        let few = |sets: &Vec<Vec<u32>>| sets.iter().map(Vec::len).sum::<usize>() <= MOST_TIED;
        (1..).map(all).find(few).unwrap_or_default()
    }

    /// Columns and rows of the nodes of a solver's grid that are nodes of the terrain on a lake.
    fn on_grid(&self, lake: &Lake, grid: &Hierarchy) -> Vec<[usize; 2]> {
        let [across, down] = [grid.step().x as usize, grid.step().y as usize].map(|s| s.max(1));
        let place = |n: &u32| [*n as usize % self.cols, *n as usize / self.cols];
        let on = lake.nodes.iter().map(place).filter(|[x, y]| x % across == 0 && y % down == 0);
        on.map(|[x, y]| [x / across, y / down]).collect()
    }

    /// Of each lake the node of the terrain with which it moves: one that is tied on the solver's grid, else the one next to its middle.
    fn leaders(&self, grid: &Hierarchy) -> Vec<u32> {
        let [across, down] = [grid.step().x as usize, grid.step().y as usize].map(|s| s.max(1));
        let of_grid = |n: u32| {
            let n = n as usize;
            ((n / grid.cols()) * down * self.cols + (n % grid.cols()) * across) as u32
        };
        let leader = |(lake, tied): (&Lake, Vec<u32>)| match tied.first() {
            Some(node) => of_grid(*node),
            None => lake.middle(self.cols),
        };
        self.lakes.iter().zip(self.tied(grid)).map(leader).collect()
    }

    /// What rows of a program on `grid` must know of the lakes.
    pub(super) fn levels(&self, grid: &Hierarchy) -> Levels {
        let place = |n: u32| DVec2::new((n as usize % self.cols) as f64, (n as usize / self.cols) as f64);
        let mut levels = Levels { lakes: self.leaders(grid).into_iter().map(place).collect(), ..Levels::default() };
        for (k, lake) in self.lakes.iter().enumerate() {
            let of = |rise: f64| move |n: &u32| (*n, (k as u32, rise));
            levels.nodes.extend(lake.shore.iter().map(of(f64::INFINITY)));
            levels.nodes.extend(lake.bank.iter().map(|(n, rise)| (*n, (k as u32, *rise))));
            levels.nodes.extend(lake.nodes.iter().map(of(0.0)));
        }
        levels
    }

    /// Makes a displacement of the terrain's nodes level on each lake, see [`Self::leaders`]. The shore sinks at least as far as the water.
    pub(super) fn level(&self, grid: &Hierarchy, u: &mut [f64]) {
        for (lake, leader) in self.lakes.iter().zip(self.leaders(grid)) {
            let moved = u[leader as usize];
            lake.nodes.iter().for_each(|n| u[*n as usize] = moved);
            lake.shore.iter().for_each(|n| u[*n as usize] = u[*n as usize].min(moved));
            for &(n, rise) in &lake.bank {
                u[n as usize] = u[n as usize].max(moved - rise).min(moved);
            }
        }
    }

    /// Lowers each lake, with its shore and bank, to its lowest node; returns whether any lake was not level.
    pub(super) fn sink(&self, u: &mut [f64]) -> bool {
        let mut sank = false;
        for lake in &self.lakes {
            let [low, high] =
                lake.nodes.iter().map(|n| u[*n as usize]).fold([f64::MAX, f64::MIN], |[a, b], v| [a.min(v), b.max(v)]);
            if low < high {
                sank = true;
                let beside = lake.shore.iter().chain(lake.bank.iter().map(|(n, _)| n));
                lake.nodes.iter().chain(beside).for_each(|n| u[*n as usize] = u[*n as usize].min(low));
            }
        }
        sank
    }

    /// Sets the change of detail to zero on every lake.
    pub(super) fn clear(&self, detail: &mut [f64]) {
        self.nodes().flatten().for_each(|n| detail[*n as usize] = 0.0);
    }

    /// Report of every lake.
    ///
    /// * `moved`: displacement of a node of the terrain.
    pub(super) fn report(&self, moved: impl Fn(usize) -> f64) -> Vec<LakeReport> {
        let of = |lake: &Lake| {
            let values = || lake.nodes.iter().map(|n| moved(*n as usize));
            let [low, high] = values().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
            LakeReport {
                layer: lake.layer,
                feature: lake.feature,
                name: lake.name.clone(),
                height_m: lake.height,
                moved_m: 0.5 * (low + high),
                range_m: high - low,
                nodes: lake.nodes.len(),
            }
        };
        self.lakes.iter().map(of).collect()
    }
}

/// Nodes of the terrain inside rings of grid coordinates, by the even-odd rule; none in holes of the data.
fn nodes_inside(rings: &[Vec<DVec2>], field: &Field) -> Vec<u32> {
    let (cols, rows) = (field.cols(), field.rows());
    let corners = || rings.iter().flatten().filter(|p| p.is_finite());
    let [low, high] = corners().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p.y), b.max(p.y)]);
    let mut out = Vec::new();
    let mut crossings = Vec::new();
    for row in low.ceil().max(0.0) as usize..rows.min((high.floor() + 1.0).max(0.0) as usize) {
        crossings.clear();
        crossings.extend(rings.iter().flat_map(|ring| polygon::crossings(ring, row as f64)));
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let from = pair[0].ceil().max(0.0) as usize;
            let to = ((pair[1].floor() + 1.0).max(0.0) as usize).min(cols);
            out.extend((from..to).map(|col| row * cols + col).filter(|i| !field.void()[*i]).map(|i| i as u32));
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// The neighbours of nodes, those of the ground's cells around them, that have data and are not on a lake themselves.
fn beside(nodes: &[u32], field: &Field, on_lake: impl Fn(u32) -> bool) -> Vec<u32> {
    let (cols, rows) = (field.cols(), field.rows());
    let around = |n: &u32| {
        let [x, y] = [*n as usize % cols, *n as usize / cols];
        let square =
            move |row: usize| (x.saturating_sub(1)..(x + 2).min(cols)).map(move |col| (row * cols + col) as u32);
        (y.saturating_sub(1)..(y + 2).min(rows)).flat_map(square)
    };
    let all: BTreeSet<u32> = nodes.iter().flat_map(around).collect();
    all.into_iter().filter(|n| !on_lake(*n) && !field.void()[*n as usize]).collect()
}

/// Middle height of nodes, if they are level.
fn level_of(nodes: &[u32], field: &Field) -> Option<f64> {
    let mut heights: Vec<f64> = nodes.iter().map(|n| field.heights()[*n as usize]).collect();
    heights.sort_by(f64::total_cmp);
    let last = heights.len().checked_sub(1)?;
    (heights[last * 9 / 10] - heights[last / 10] <= LEVEL_M).then(|| heights[last / 2])
}
