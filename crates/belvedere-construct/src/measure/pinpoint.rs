//! Depths of the terrain at positions of a picture, to the precision of arithmetic: the triangles of the ground are projected into
//! the picture and tested against each position, however small they are. A drawn picture resolves no more than its pixels.

use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Heightfield, Scene};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Side of the bins into which positions are sorted, pixels.
const BIN: f64 = 4.0;
/// Where a displacement bends a triangle, it is quartered until its edges lie within this of their images, pixels; and the most
/// quarterings.
const STRAIGHT: (f64, u32) = (0.01, 5);
/// The same where ground is displaced upwards alone: a pixel far away is tens of metres of ground, which lines of sight clear by
/// decimetres.
const UPRIGHT: (f64, u32) = (1e-3, 7);
/// Quarterings of triangles that reach behind the near plane; parts that still reach behind it are left out.
const QUARTERINGS: u32 = 6;

/// A vertex in the picture: pixel, and what is linear over the picture of a plane in space (inverse depth; depth of parallel pictures).
type Vertex = Option<(DVec2, f64)>;

/// Positions in the picture, sorted into square bins.
struct Bins<'a> {
    places: &'a [DVec2],
    cols: usize,
    rows: usize,
    /// First of each bin in `order`.
    first: Vec<u32>,
    order: Vec<u32>,
}

impl<'a> Bins<'a> {
    fn new(places: &'a [DVec2], [width, height]: [u32; 2]) -> Self {
        let [cols, rows] = [width, height].map(|n| (f64::from(n) / BIN).ceil().max(1.0) as usize);
        let bin = |p: &DVec2| {
            let index = |v: f64, n: usize| ((v / BIN).max(0.0) as usize).min(n - 1);
            index(p.y, rows) * cols + index(p.x, cols)
        };
        let bins: Vec<usize> = places.iter().map(bin).collect();
        let mut first = vec![0u32; cols * rows + 1];
        bins.iter().for_each(|b| first[b + 1] += 1);
        (0..cols * rows).for_each(|b| first[b + 1] += first[b]);
        let (mut next, mut order) = (first.clone(), vec![0; places.len()]);
        for (i, b) in bins.into_iter().enumerate() {
            order[next[b] as usize] = i as u32;
            next[b] += 1;
        }
        Self { places, cols, rows, first, order }
    }

    /// Whether a box touches a bin that holds a position.
    fn holds(&self, low: DVec2, high: DVec2) -> bool {
        let mut any = false;
        self.near(low, high, |_, _| any = true);
        any
    }

    /// Calls `visit` with every position in the bins that a box touches.
    fn near(&self, low: DVec2, high: DVec2, mut visit: impl FnMut(usize, DVec2)) {
        let size = DVec2::new(self.cols as f64, self.rows as f64) * BIN;
        if !(high.x >= 0.0 && high.y >= 0.0 && low.x <= size.x && low.y <= size.y) {
            return;
        }
        let index = |v: f64, n: usize| ((v / BIN).max(0.0) as usize).min(n - 1);
        let across = index(low.x, self.cols)..=index(high.x, self.cols);
        for row in index(low.y, self.rows)..=index(high.y, self.rows) {
            let [from, to] = [row * self.cols + across.start(), row * self.cols + across.end() + 1];
            for &i in &self.order[self.first[from] as usize..self.first[to] as usize] {
                visit(i as usize, self.places[i as usize]);
            }
        }
    }
}

/// Depth of the nearest terrain at each position (pixels) of the picture of `view`; infinite where there is no terrain.
///
/// * `flat`: triangles stay flat between their corners, as rasterisers may draw ground that is displaced upwards, however it is displaced between
///   them.
pub(super) fn depths(scene: &Scene, view: &View, places: &[DVec2], flat: bool) -> Vec<f64> {
    let found: Vec<AtomicU64> = places.iter().map(|_| AtomicU64::new(f64::INFINITY.to_bits())).collect();
    let bins = Bins::new(places, view.pinhole().image);
    for layer in &scene.layers {
        if let Some(terrain) = layer.kind.terrain() {
            over_terrain(&terrain.heightfield, view, &bins, (&found, flat));
        }
    }
    found.into_iter().map(|bits| f64::from_bits(bits.into_inner())).collect()
}

fn over_terrain(hf: &Heightfield, view: &View, bins: &Bins<'_>, (found, flat): (&[AtomicU64], bool)) {
    let cols = hf.cols();
    let parallel = view.pinhole().is_orthographic();
    let vertex = |p: DVec3| -> Vertex {
        let image = view.project(p).ok().filter(|image| image.depth >= view.pinhole().near)?;
        Some((image.pixel, if parallel { image.depth } else { image.depth.recip() }))
    };
    let row = |row: usize| -> Vec<(DVec3, Vertex)> {
        let node = |col: usize| {
            let p = hf.node(col, row).unwrap_or(DVec3::NAN);
            (p, if p.is_finite() { vertex(p) } else { None })
        };
        (0..cols).map(node).collect()
    };
    let is_upright = view.stages().iter().all(|s| s.is_upright());
    let (straight_px, bendings) = if is_upright { UPRIGHT } else { STRAIGHT };
    let draw = Draw { bins, found, vertex: &vertex, parallel, bent: view.is_bent() && !flat, straight_px, bendings };
    let strip = |first: usize| {
        let last = (first + STRIP).min(hf.rows() - 1);
        let mut upper = row(first);
        for y in first + 1..=last {
            let lower = row(y);
            for x in 0..cols - 1 {
                let [nw, ne, sw, se] = [upper[x], upper[x + 1], lower[x], lower[x + 1]];
                draw.triangle([nw, ne, se], 0);
                draw.triangle([nw, se, sw], 0);
            }
            upper = lower;
        }
    };
    let strips: Vec<usize> = (0..hf.rows() - 1).step_by(STRIP).collect();
    strips.into_par_iter().for_each(strip);
}

/// Rows of grid cells that one task projects.
const STRIP: usize = 16;

struct Draw<'a> {
    bins: &'a Bins<'a>,
    found: &'a [AtomicU64],
    vertex: &'a (dyn Fn(DVec3) -> Vertex + Sync),
    parallel: bool,
    /// Whether the view bends straight lines.
    bent: bool,
    /// Tolerance within which an edge counts as straight, pixels.
    straight_px: f64,
    /// Most quarterings of a triangle that is not straight.
    bendings: u32,
}

impl Draw<'_> {
    /// The four triangles of half the size: `a ab ca`, `ab b bc`, `ca bc c` and the middle one.
    fn quarters(&self, [a, b, c]: [(DVec3, Vertex); 3]) -> [[(DVec3, Vertex); 3]; 4] {
        let middle = |a: (DVec3, Vertex), b: (DVec3, Vertex)| {
            let p = 0.5 * (a.0 + b.0);
            (p, (self.vertex)(p))
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    }

    fn triangle(&self, corners: [(DVec3, Vertex); 3], quarterings: u32) {
        if corners.iter().any(|(p, _)| !p.is_finite()) || corners.iter().all(|(_, v)| v.is_none()) {
            return;
        }
        let [(_, Some(a)), (_, Some(b)), (_, Some(c))] = corners else {
            if quarterings < QUARTERINGS {
                self.quarters(corners).into_iter().for_each(|part| self.triangle(part, quarterings + 1));
            }
            return;
        };
        let (low, high) = (a.0.min(b.0).min(c.0), a.0.max(b.0).max(c.0));
        if self.bent && quarterings < self.bendings {
            // A bent triangle may reach out of the box of its corners.
            let beside = 0.25 * (high - low);
            if !self.bins.holds(low - beside, high + beside) {
                return;
            }
            let parts = self.quarters(corners);
            let [ab, ca, bc] = [parts[0][1].1, parts[0][2].1, parts[1][2].1];
            let off = |v: Vertex, a: (DVec2, f64), b: (DVec2, f64)| {
                v.is_none_or(|(p, _)| {
                    let along = (b.0 - a.0).normalize_or_zero();
                    along == DVec2::ZERO || along.perp_dot(p - a.0).abs() > self.straight_px
                })
            };
            if off(ab, a, b) || off(bc, b, c) || off(ca, c, a) {
                parts.into_iter().for_each(|part| self.triangle(part, quarterings + 1));
                return;
            }
        }
        let area = (b.0 - a.0).perp_dot(c.0 - a.0);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        self.bins.near(low, high, |i, p| {
            let weights = [
                (c.0 - b.0).perp_dot(p - b.0) / area,
                (a.0 - c.0).perp_dot(p - c.0) / area,
                (b.0 - a.0).perp_dot(p - a.0) / area,
            ];
            if weights.iter().all(|w| *w >= 0.0) {
                let value = weights[0] * a.1 + weights[1] * b.1 + weights[2] * c.1;
                let depth = if self.parallel { value } else { value.recip() };
                // The bits of numbers above 0 are in their order.
                self.found[i].fetch_min(depth.max(0.0).to_bits(), Ordering::Relaxed);
            }
        });
    }
}
