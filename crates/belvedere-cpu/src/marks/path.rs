//! Lines from the ground to the image.

use crate::lens::{Lens, Pass};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, Scene};

/// A line is judged to lie on the ground if its vertices are this close to it, scene units.
const ON_GROUND: f64 = 1.0;
/// Halvings of a piece of line under the bend.
const MAX_HALVINGS: u32 = 8;

/// A point of a line on the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PathPoint {
    pub(crate) pixel: DVec2,
    pub(crate) depth: f64,
}

/// The line laid on the drawn surface: vertices and enough points between them to follow its triangles, lifted.
pub(crate) fn drape(scene: &Scene, points: &[DVec3], lift_m: f64) -> Vec<DVec3> {
    let lift = DVec3::Z * lift_m;
    let mut out = Vec::with_capacity(points.len() * 3);
    let Some(hf) = scene.terrain() else { return points.iter().map(|&p| p + lift).collect() };
    let step = 0.4 * hf.spacing().min_element();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if !(a.is_finite() && b.is_finite()) {
            continue;
        }
        let ground = is_on_ground(hf, a) && is_on_ground(hf, b);
        let n = if ground { ((b - a).truncate().length() / step).ceil().clamp(1.0, 4096.0) as usize } else { 1 };
        for i in 0..=n {
            if i == 0 && !out.is_empty() {
                continue; // end of the piece before
            }
            let p = a.lerp(b, i as f64 / n as f64);
            let z = if ground { hf.surface_at(p.truncate()).unwrap_or(p.z) } else { p.z };
            out.push(p.with_z(z) + lift);
        }
    }
    out
}

fn is_on_ground(hf: &Heightfield, p: DVec3) -> bool {
    let near = |h: Option<f64>| h.is_some_and(|h| (h - p.z).abs() <= ON_GROUND);
    near(hf.height_at(p.truncate())) || near(hf.surface_at(p.truncate()))
}

/// Vertex of a line with everything that clipping needs.
#[derive(Clone, Copy)]
struct Vertex {
    p: DVec3,
    v: Option<DVec3>,
    margins: [f64; 2],
}

/// Images of a polyline in one pass: pieces without a gap, each of at least two points, straight to the tolerance.
pub(crate) fn project(pass: &Pass<'_>, lens: &Lens, points: &[DVec3], tolerance_px: f64) -> Vec<Vec<PathPoint>> {
    let mut tracer = Tracer { pass, lens, tolerance_px, pieces: Vec::new(), open: false };
    let mut last: Option<Vertex> = None;
    for &p in points {
        let next = tracer.vertex(p);
        if let Some(from) = last {
            tracer.segment(from, next, if pass.is_straight() { 0 } else { MAX_HALVINGS });
        }
        last = Some(next);
    }
    tracer.pieces.retain(|piece| piece.len() > 1);
    tracer.pieces
}

struct Tracer<'a> {
    pass: &'a Pass<'a>,
    lens: &'a Lens,
    tolerance_px: f64,
    pieces: Vec<Vec<PathPoint>>,
    open: bool,
}

impl Tracer<'_> {
    fn vertex(&self, p: DVec3) -> Vertex {
        let v = self.pass.displace(p).map(|d| self.lens.view_from(d)).filter(|v| v.is_finite());
        Vertex { p, v, margins: self.pass.margins(p) }
    }

    fn segment(&mut self, a: Vertex, b: Vertex, halvings: u32) {
        let off = |v: Option<DVec3>| v.map_or(0, |v| self.lens.outcode(v, 64.0));
        let split = halvings > 0
            && match (a.v, b.v) {
                (None, None) => false,
                (Some(_), Some(_)) => off(a.v) & off(b.v) == 0 && self.pass.edge_error_px(a.p, b.p) > self.tolerance_px,
                _ => true,
            };
        if split {
            let m = self.vertex(0.5 * (a.p + b.p));
            self.segment(a, m, halvings - 1);
            self.segment(m, b, halvings - 1);
            return;
        }
        let (Some(va), Some(vb)) = (a.v, b.v) else {
            self.open = false;
            return;
        };
        let Some([s, t]) = self.clip((va, a.margins), (vb, b.margins)) else {
            self.open = false;
            return;
        };
        if !self.open || s > 0.0 {
            self.pieces.push(vec![self.point(va.lerp(vb, s))]);
        }
        let end = self.point(va.lerp(vb, t));
        if let Some(piece) = self.pieces.last_mut() {
            piece.push(end);
        }
        self.open = t == 1.0;
    }

    /// Parameters of the visible part of a segment.
    fn clip(&self, a: (DVec3, [f64; 2]), b: (DVec3, [f64; 2])) -> Option<[f64; 2]> {
        let (mut s, mut t) = (0.0f64, 1.0f64);
        let da = self.lens.clip_distances(a.0).into_iter().chain(a.1.map(|m| m.min(1e30)));
        let db = self.lens.clip_distances(b.0).into_iter().chain(b.1.map(|m| m.min(1e30)));
        for (x, y) in da.zip(db) {
            match (x >= 0.0, y >= 0.0) {
                (true, true) => {}
                (false, false) => return None,
                (true, false) => t = t.min(x / (x - y)),
                (false, true) => s = s.max(x / (x - y)),
            }
        }
        (s < t).then_some([s, t])
    }

    fn point(&self, v: DVec3) -> PathPoint {
        PathPoint { pixel: self.lens.pixel(v), depth: v.z }
    }
}
