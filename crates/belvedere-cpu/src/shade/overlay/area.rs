//! Areas on the ground: point-in-polygon test and distance from the border, by a grid of edges.

use crate::cache::lock;
use belvedere_composite::color::{Rgb, linear};
use belvedere_core::{DVec2, polygon};
use belvedere_scene::{AreaFeature, AreaLayer, AreaSurface, Color};
use std::sync::{Arc, Mutex};

/// Largest number of indexes that are kept between frames.
const KEPT: usize = 8;

/// An area layer ready for look-up per pixel.
#[derive(Debug)]
pub(crate) struct AreaMap {
    /// Index of the layer in the scene.
    pub(crate) layer: u32,
    /// Fill and its opacity.
    paint: (Rgb, f32),
    /// The same of each feature, where some have their own; else empty.
    own_paint: Vec<(Rgb, f32)>,
    pub(crate) surface: AreaSurface,
    pub(crate) has_outline: bool,
    index: Arc<EdgeIndex>,
}

/// Edges of areas in a grid.
#[derive(Debug)]
struct EdgeIndex {
    /// All edges, in the order of the areas.
    source: Vec<Edge>,
    min: DVec2,
    cell: DVec2,
    per_cell: DVec2,
    size: [usize; 2],
    /// Features that contain the centre of a cell, and edges near the cell; ranges into the two lists.
    cells: Vec<Cell>,
    features: Vec<u32>,
    edges: Vec<Edge>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    features: [u32; 2],
    edges: [u32; 2],
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    a: DVec2,
    b: DVec2,
    feature: u32,
}

/// Indexes of the areas of the last frames.
#[derive(Debug, Default)]
pub(crate) struct AreaCache(Mutex<Vec<Arc<EdgeIndex>>>);

impl AreaCache {
    /// The index of edges, from the last frames if it was made for the same ones; `None` without edges.
    fn get(&self, edges: Vec<Edge>) -> Option<Arc<EdgeIndex>> {
        let known = |kept: &[Arc<EdgeIndex>]| kept.iter().position(|index| index.source == edges);
        let mut kept = lock(&self.0);
        if let Some(at) = known(&kept) {
            kept[at..].rotate_left(1);
            return kept.last().cloned();
        }
        drop(kept);
        let made = Arc::new(EdgeIndex::new(edges)?);
        let mut kept = lock(&self.0);
        if kept.len() >= KEPT {
            kept.remove(0);
        }
        kept.push(made.clone());
        Some(made)
    }
}

/// Distance and direction of the nearest border.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Border {
    /// Distance, scene units, positive inside.
    pub(crate) inside: f64,
    /// Unit vector towards it.
    pub(crate) across: DVec2,
    /// The feature that holds the point, or the nearest one.
    pub(crate) feature: u32,
}

impl AreaMap {
    /// `None` for a layer without a finite edge.
    pub(crate) fn new(layer: u32, area: &AreaLayer, cache: &AreaCache) -> Option<Self> {
        Some(Self {
            layer,
            paint: paint(area.fill),
            own_paint: own_paint(area),
            surface: area.surface,
            has_outline: area.outline.is_some(),
            index: cache.get(all_edges(area))?,
        })
    }

    /// The nearest border; infinitely far where no edge is near.
    pub(crate) fn border(&self, p: DVec2) -> Border {
        self.index.border(p)
    }

    /// Fill of a feature, and its opacity.
    #[inline]
    pub(crate) fn paint_of(&self, feature: u32) -> (Rgb, f32) {
        self.own_paint.get(feature as usize).copied().unwrap_or(self.paint)
    }
}

impl EdgeIndex {
    fn new(source: Vec<Edge>) -> Option<Self> {
        let first = source.first()?.a;
        let (mut min, mut max) = (first, first);
        for e in &source {
            (min, max) = (min.min(e.a), max.max(e.a));
        }
        // About four cells per edge, near square.
        let extent = (max - min).max(DVec2::splat(1e-6));
        let pitch = (extent.x * extent.y / (4 * source.len()) as f64).sqrt().max(extent.max_element() / 1024.0);
        let size = [extent.x, extent.y].map(|e| (e / pitch).ceil().clamp(1.0, 1024.0) as usize);
        let cell = DVec2::new(extent.x / size[0] as f64, extent.y / size[1] as f64);
        let cells = vec![Cell::default(); size[0] * size[1]];
        let (features, edges) = (Vec::new(), Vec::new());
        let mut index = Self { source: Vec::new(), min, cell, per_cell: 1.0 / cell, size, cells, features, edges };
        index.sort_in(&source);
        index.source = source;
        Some(index)
    }

    fn sort_in(&mut self, edges: &[Edge]) {
        let [w, h] = self.size;
        let mut near: Vec<Vec<u32>> = vec![Vec::new(); w * h];
        let mut crossings: Vec<Vec<(u32, f64)>> = vec![Vec::new(); h];
        for (i, e) in edges.iter().enumerate() {
            let (lo, hi) = ((e.a.min(e.b) - self.min) / self.cell, (e.a.max(e.b) - self.min) / self.cell);
            let range = |lo: f64, hi: f64, n: usize| {
                ((lo - 0.3).floor().max(0.0) as usize)..=((hi + 0.3).floor().max(0.0) as usize).min(n - 1)
            };
            for y in range(lo.y, hi.y, h) {
                for x in range(lo.x, hi.x, w) {
                    if self.passes_near(e, x, y) {
                        near[y * w + x].push(i as u32);
                    }
                }
                let yc = self.min.y + (y as f64 + 0.5) * self.cell.y;
                if (e.a.y > yc) != (e.b.y > yc) {
                    crossings[y].push((e.feature, e.a.x + (yc - e.a.y) / (e.b.y - e.a.y) * (e.b.x - e.a.x)));
                }
            }
        }
        for y in 0..h {
            crossings[y].sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            let mut inside: Vec<Vec<u32>> = vec![Vec::new(); w];
            for pair in crossings[y].chunk_by(|a, b| a.0 == b.0).flat_map(|c| c.chunks_exact(2)) {
                let at = |x: f64| (((x - self.min.x) / self.cell.x - 0.5).ceil().max(0.0) as usize).min(w);
                inside[at(pair[0].1)..at(pair[1].1).max(at(pair[0].1))].iter_mut().for_each(|c| c.push(pair[0].0));
            }
            for (x, inside) in inside.iter().enumerate() {
                let (f, e) = (self.features.len() as u32, self.edges.len() as u32);
                self.features.extend(inside);
                self.edges.extend(near[y * w + x].iter().map(|&i| edges[i as usize]));
                self.cells[y * w + x] =
                    Cell { features: [f, self.features.len() as u32], edges: [e, self.edges.len() as u32] };
            }
        }
    }

    /// Whether the edge passes through the cell grown by 0.3 cells.
    fn passes_near(&self, e: &Edge, x: usize, y: usize) -> bool {
        let c = self.min + DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * self.cell;
        let normal = (e.b - e.a).perp();
        let reach = 0.8 * (normal.x.abs() * self.cell.x + normal.y.abs() * self.cell.y);
        normal.dot(c - e.a).abs() <= reach
    }

    fn border(&self, p: DVec2) -> Border {
        let far = |inside: f64, feature: u32| Border { inside, across: DVec2::X, feature };
        let g = (p - self.min) * self.per_cell;
        let reach = 0.3;
        let [w, h] = self.size.map(|n| n as f64);
        if !(g.x >= -reach && g.y >= -reach && g.x <= w + reach && g.y <= h + reach) {
            return far(f64::NEG_INFINITY, 0);
        }
        let (x, y) = ((g.x.max(0.0) as usize).min(self.size[0] - 1), (g.y.max(0.0) as usize).min(self.size[1] - 1));
        let cell = self.cells[y * self.size[0] + x];
        let list = |[a, b]: [u32; 2]| a as usize..b as usize;
        let (features, edges) = (&self.features[list(cell.features)], &self.edges[list(cell.edges)]);
        if edges.is_empty() {
            return match features.first() {
                Some(&feature) => far(f64::INFINITY, feature),
                None => far(f64::NEG_INFINITY, 0),
            };
        }
        let centre = self.min + DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * self.cell;
        let ways = edges.iter().map(|e| (polygon::to_segment(p, e.a, e.b), e.feature));
        let nearest = ways.min_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()));
        let (nearest, beside) = nearest.unwrap_or((DVec2::INFINITY, 0));
        let parity = |feature: u32| {
            let crossed = edges.iter().filter(|e| e.feature == feature && crosses(centre, p, e.a, e.b)).count();
            features.contains(&feature) ^ (crossed % 2 == 1)
        };
        let holder = features.iter().copied().chain(edges.iter().map(|e| e.feature)).find(|&f| parity(f));
        let (depth, across) = (nearest.length(), nearest.normalize_or(DVec2::X));
        Border { inside: if holder.is_some() { depth } else { -depth }, across, feature: holder.unwrap_or(beside) }
    }
}

fn paint(fill: Color) -> (Rgb, f32) {
    (linear([fill.r, fill.g, fill.b]), f32::from(fill.a) / 255.0)
}

/// Paint of every feature, if some have a colour of their own.
fn own_paint(area: &AreaLayer) -> Vec<(Rgb, f32)> {
    let own = |f: &AreaFeature| f.style.and_then(|style| style.color);
    match area.features.iter().any(|f| own(f).is_some()) {
        true => area.features.iter().map(|f| paint(own(f).unwrap_or(area.fill))).collect(),
        false => Vec::new(),
    }
}

fn all_edges(area: &AreaLayer) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (feature, f) in area.features.iter().enumerate() {
        for ring in &f.rings {
            for (i, &a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                if a != b && a.is_finite() && b.is_finite() {
                    edges.push(Edge { a, b, feature: feature as u32 });
                }
            }
        }
    }
    edges
}

/// Whether the segments `p q` and `a b` cross; an end exactly on the other's line counts for one side.
fn crosses(p: DVec2, q: DVec2, a: DVec2, b: DVec2) -> bool {
    let side = |o: DVec2, d: DVec2, x: DVec2| (d - o).perp_dot(x - o) > 0.0;
    side(p, q, a) != side(p, q, b) && side(a, b, p) != side(a, b, q)
}

#[cfg(test)]
mod tests;
