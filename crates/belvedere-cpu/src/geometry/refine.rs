//! Subdivision of triangles until the error of their bent edges is within the tolerance, and clipping.

use crate::geometry::block::{SoupTriangle, SoupVertex};
use crate::screen::{PLANES, SUB, Screen, ScreenVertex, Snap};
use belvedere_core::map::unroll::Seam;
use belvedere_core::{DVec3, EdgeError};
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::COARSE_PX;

/// An edge is halved at most this often: of an edge of 10^8 m a tenth of a millimetre is left.
const MOST_HALVINGS: u8 = 40;
/// The same where the error has no bound, at the borders of a domain, unless the image is longer than the tolerance; the borders of a strip
/// are long.
const MAX_BLIND_HALVINGS: u8 = 9;
const MAX_BLIND_HALVINGS_BESIDE_STRIPS: u8 = 6;
/// Fewest of them in a coarse picture.
const LEAST_BLIND_HALVINGS: u8 = 3;
/// Stages are assumed to enlarge what lies at a border by this factor at most.
const BORDER_STRETCH: f64 = 2.0;
/// Tolerance of a picture that is not coarse, pixels; each doubling saves a halving.
const FINE_PX: f64 = 0.5;
/// Distance beyond the image up to which triangles whose bend is unknown are refined.
const MARGIN_PX: f64 = 4096.0;
/// A triangle bends inside by at most this factor more than along its edges: a paraboloid does.
const INSIDE: f64 = 4.0 / 3.0;
/// Level of an edge that must not be split.
const FROZEN: u8 = u8::MAX;

/// Whether an edge of a coarse picture is no longer than its tolerance, so that its bend does not matter.
pub(crate) fn is_short(a: ScreenVertex, b: ScreenVertex, tolerance_px: f64) -> bool {
    let [x, y] = [a.x - b.x, a.y - b.y].map(|n| f64::from(n) / f64::from(SUB));
    tolerance_px >= COARSE_PX && x * x + y * y <= tolerance_px * tolerance_px
}

/// A vertex before clipping.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    p: DVec3,
    /// View space after displacement; `None` without image.
    v: Option<DVec3>,
    /// Image that the corner shares with another piece of the surface, if any.
    image: Option<ScreenVertex>,
    margins: [f64; 2],
    weights: [f64; 2],
}

impl Corner {
    /// Whether the point has no image: outside the domain or behind the eye.
    pub(crate) fn is_missing(&self) -> bool {
        self.v.is_none_or(|v| !(v.z > 0.0))
    }
}

/// Turns parent triangles into screen triangles.
pub(crate) struct Refiner<'a> {
    pass: &'a Pass<'a>,
    screen: &'a Screen,
    tolerance_px: f64,
    blind_halvings: u8,
    seam: Option<Seam>,
    pub(crate) out: Vec<SoupTriangle>,
    pub(crate) splits: u64,
}

impl<'a> Refiner<'a> {
    /// * `out`: a buffer to reuse.
    pub(crate) fn new(pass: &'a Pass<'a>, screen: &'a Screen, tolerance_px: f64, mut out: Vec<SoupTriangle>) -> Self {
        out.clear();
        let most = if pass.has_border() { MAX_BLIND_HALVINGS_BESIDE_STRIPS } else { MAX_BLIND_HALVINGS };
        let saved = (tolerance_px / FINE_PX).log2().floor().clamp(0.0, 16.0) as u8;
        let blind_halvings = most.saturating_sub(saved).max(LEAST_BLIND_HALVINGS);
        Self { pass, screen, tolerance_px, blind_halvings, seam: pass.seam(), out, splits: 0 }
    }

    pub(crate) fn corner(&self, p: DVec3) -> Corner {
        let v = self.pass.displace(p).map(|d| self.screen.view_from(d)).filter(|v| v.is_finite());
        Corner { p, v, image: None, margins: self.pass.margins(p), weights: [0.0; 2] }
    }

    /// A corner whose image grid blocks share.
    pub(crate) fn node(&self, p: DVec3, image: Option<ScreenVertex>) -> Corner {
        Corner { image, ..self.corner(p) }
    }

    /// Draws a parent triangle; `split[i]` allows splitting the edge from corner `i` to the next.
    /// * `weights`: of vertices 1 and 2 of the parent, per corner.
    pub(crate) fn triangle(&mut self, mut corners: [Corner; 3], weights: [[f32; 2]; 3], split: [bool; 3], parent: u32) {
        for (corner, weights) in corners.iter_mut().zip(weights) {
            corner.weights = weights.map(f64::from);
        }
        let levels = split.map(|s| if s { 0 } else { FROZEN });
        match self.seam.filter(|seam| (0..3).any(|i| seam.parts(corners[i].p, corners[(i + 1) % 3].p))) {
            Some(seam) => self.cut_open(&seam, corners, parent),
            None => self.refine(corners, levels, parent),
        }
    }

    /// Cuts a triangle along the plane of a seam, on which new corners lie close to either side. Neighbours cut a common edge at one place.
    fn cut_open(&mut self, seam: &Seam, c: [Corner; 3], parent: u32) {
        let mut sides: [Vec<Corner>; 2] = [Vec::new(), Vec::new()];
        for (i, from) in c.iter().enumerate() {
            let to = &c[(i + 1) % 3];
            sides[usize::from(!seam.is_left(from.p))].push(*from);
            if let Some((share, points)) = seam.crossing(from.p, to.p) {
                let weights = [0, 1].map(|k| from.weights[k] + share * (to.weights[k] - from.weights[k]));
                for (side, p) in sides.iter_mut().zip(points) {
                    side.push(Corner { weights, ..self.corner(p) });
                }
            }
        }
        for side in sides {
            for k in 1..side.len().saturating_sub(1) {
                self.refine([side[0], side[k], side[k + 1]], [0; 3], parent);
            }
        }
    }

    fn refine(&mut self, c: [Corner; 3], levels: [u8; 3], parent: u32) {
        if (0..2).any(|m| c.iter().all(|c| !(c.margins[m] > 0.0))) {
            return;
        }
        let errors: [EdgeError; 3] = std::array::from_fn(|i| {
            if levels[i] == FROZEN { EdgeError::NONE } else { self.edge_error(&c[i], &c[(i + 1) % 3]) }
        });
        if c.iter().all(|c| c.v.is_none()) && errors == [EdgeError::NONE; 3] {
            return;
        }
        if self.is_off_image(&c, &errors) {
            return;
        }
        let split: [bool; 3] = std::array::from_fn(|i| {
            let allowed = || {
                let limit = if errors[i].length.is_finite() { MOST_HALVINGS } else { self.blind_halvings };
                levels[i] < limit || levels[i] < MOST_HALVINGS && self.is_long(&c[i], &c[(i + 1) % 3])
            };
            self.error_px(&errors[i]) > self.tolerance_px && allowed()
        });
        if split == [false; 3] {
            return self.emit(&c, parent);
        }
        self.split(c, levels, split, parent);
    }

    /// Error of drawing the edge straight; none where it does not matter.
    fn edge_error(&self, a: &Corner, b: &Corner) -> EdgeError {
        if a.is_missing() && b.is_missing() && self.pass.crosses(a.p, b.p) {
            return self.border_error(a, b);
        }
        // An edge without images matters only beside an edge with one.
        if a.v.is_none() && b.v.is_none() {
            return EdgeError::NONE;
        }
        let image = |c: &Corner| c.v.filter(|v| self.screen.is_drawable(*v)).map(|v| self.screen.snap(v));
        if self.tolerance_px >= COARSE_PX
            && let (Some(from), Some(to)) = (image(a), image(b))
            && is_short(from, to, self.tolerance_px)
        {
            return EdgeError::NONE;
        }
        if a.v.is_none() || b.v.is_none() {
            return self.border_error(a, b);
        }
        // Always in the same direction: two triangles must judge their common edge alike to the last bit.
        let swap = a.p.to_array().partial_cmp(&b.p.to_array()) == Some(std::cmp::Ordering::Greater);
        let (from, to) = if swap { (b, a) } else { (a, b) };
        self.pass.edge_error(from.p, to.p)
    }

    /// Error of an edge in pixels. Of an edge that passes the eye what is drawn lies beyond the near plane.
    fn error_px(&self, error: &EdgeError) -> f64 {
        if error.px.is_finite() {
            return error.px;
        }
        let beyond = self.screen.near - error.length;
        if beyond > 0.0 { error.length * self.screen.scale_at_rim() / beyond } else { f64::INFINITY }
    }

    /// Error of an edge that crosses the border of the domain: it is halved towards the border until it is too short to be seen.
    /// How long it is in the image is judged by the least depth of its ends, with and without stages.
    fn border_error(&self, a: &Corner, b: &Corner) -> EdgeError {
        let beside_border = [a, b].iter().any(|c| c.v.is_none());
        let depth = |c: &Corner| c.v.map_or(f64::INFINITY, |v| v.z).min(self.screen.view_from(c.p).z);
        let depth = depth(a).min(depth(b));
        let per_unit = if self.screen.ortho { self.screen.scale } else { self.screen.scale / depth };
        let length_px = (a.p - b.p).length() * per_unit;
        if beside_border && per_unit > 0.0 && BORDER_STRETCH * length_px <= self.tolerance_px {
            EdgeError::NONE
        } else {
            EdgeError::UNKNOWN
        }
    }

    /// Whether the image of an edge is longer than the tolerance.
    fn is_long(&self, a: &Corner, b: &Corner) -> bool {
        let distance = |c: &Corner| c.v.unwrap_or_else(|| self.screen.view_from(c.p)).length();
        self.screen.length_px(a.p.distance(b.p), distance(a).min(distance(b))) > self.tolerance_px
    }

    /// Whether no point of the triangle is in the picture, however it bends within the errors of its edges.
    fn is_off_image(&self, c: &[Corner; 3], errors: &[EdgeError; 3]) -> bool {
        let all = |code: &dyn Fn(DVec3) -> u8| c.iter().fold(u8::MAX, |all, c| all & c.v.map_or(0, code));
        let error = errors.iter().fold(0.0f64, |most, error| most.max(error.length));
        if error.is_finite() {
            return all(&|v| self.screen.outcode_around(v, INSIDE * error)) != 0;
        }
        let longest = (0..3).map(|i| c[i].p.distance(c[(i + 1) % 3].p)).fold(0.0, f64::max);
        let is_far = || all(&|v| self.screen.outcode_around(v, BORDER_STRETCH * longest)) != 0;
        all(&|v| self.screen.outcode(v, MARGIN_PX)) != 0 && is_far()
    }

    fn split(&mut self, c: [Corner; 3], levels: [u8; 3], split: [bool; 3], parent: u32) {
        let next = |l: u8| if l == FROZEN { FROZEN } else { l + 1 };
        let mid: [Option<Corner>; 3] = std::array::from_fn(|i| split[i].then(|| self.middle(&c[i], &c[(i + 1) % 3])));
        self.splits += split.iter().filter(|&&s| s).count() as u64;
        // A new inner edge counts as often halved as the most halved edge of its triangle.
        let inner = levels.iter().zip(split).filter(|(_, s)| *s).map(|(&l, _)| next(l)).max().unwrap_or(0);
        match mid {
            [Some(m0), Some(m1), Some(m2)] => {
                let n = levels.map(next);
                self.refine([c[0], m0, m2], [n[0], inner, n[2]], parent);
                self.refine([m0, c[1], m1], [n[0], n[1], inner], parent);
                self.refine([m2, m1, c[2]], [inner, n[1], n[2]], parent);
                self.refine([m0, m1, m2], [inner; 3], parent);
            }
            _ => {
                // One or two edges: cut off corner i+1 .. or halve. Rotate so that edge 0 is split and edge 2 is not.
                let Some(i) = (0..3).find(|&i| split[i] && !split[(i + 2) % 3]) else { return };
                let r = |k: usize| (i + k) % 3;
                let (a, b, d) = (c[r(0)], c[r(1)], c[r(2)]);
                let (la, lb, ld) = (levels[r(0)], levels[r(1)], levels[r(2)]);
                let Some(m) = mid[r(0)] else { return };
                if let Some(n) = mid[r(1)] {
                    self.refine([m, b, n], [next(la), next(lb), inner], parent);
                    self.refine([a, m, n], [next(la), inner, inner], parent);
                    self.refine([a, n, d], [inner, next(lb), ld], parent);
                } else {
                    self.refine([a, m, d], [next(la), inner, ld], parent);
                    self.refine([m, b, d], [next(la), lb, inner], parent);
                }
            }
        }
    }

    fn middle(&self, a: &Corner, b: &Corner) -> Corner {
        let weights = [0, 1].map(|i| 0.5 * (a.weights[i] + b.weights[i]));
        Corner { weights, ..self.corner(0.5 * (a.p + b.p)) }
    }

    /// Clips and draws a triangle whose edges are straight enough.
    fn emit(&mut self, c: &[Corner; 3], parent: u32) {
        let [Some(v0), Some(v1), Some(v2)] = c.map(|c| c.v) else { return };
        let v = [v0, v1, v2];
        if v.iter().all(|&v| self.screen.is_drawable(v)) && c.iter().all(|c| c.margins.iter().all(|&m| m >= 0.0)) {
            let vertex = |i: usize| SoupVertex {
                screen: c[i].image.unwrap_or_else(|| self.screen.snap(v[i])),
                weights: c[i].weights.map(|w| w as f32),
            };
            self.out.push(SoupTriangle { v: [vertex(0), vertex(1), vertex(2)], parent });
            return;
        }
        let mut polygon: Vec<ClipVertex> = (0..3)
            .map(|i| ClipVertex { image: c[i].image, ..self.clip_vertex(v[i], c[i].weights, c[i].margins) })
            .collect();
        for plane in 0..PLANES + 2 {
            if polygon.iter().all(|p| p.distance[plane] >= 0.0) {
                continue;
            }
            polygon = self.clip(&polygon, plane);
            if polygon.len() < 3 {
                return;
            }
        }
        let screen: Vec<SoupVertex> = polygon
            .iter()
            .map(|p| SoupVertex {
                screen: p.image.unwrap_or_else(|| self.screen.snap(p.v)),
                weights: p.weights.map(|w| w as f32),
            })
            .collect();
        for k in 1..screen.len() - 1 {
            self.out.push(SoupTriangle { v: [screen[0], screen[k], screen[k + 1]], parent });
        }
    }

    fn clip_vertex(&self, v: DVec3, weights: [f64; 2], margins: [f64; 2]) -> ClipVertex {
        let mut distance = [0.0; PLANES + 2];
        distance[..PLANES].copy_from_slice(&self.screen.clip_distances(v));
        distance[PLANES..].copy_from_slice(&margins.map(|m| m.min(1e30)));
        ClipVertex { v, image: None, weights, margins, distance }
    }

    /// The part of a polygon on the positive side of a plane. New vertices are computed from the inner end towards the
    /// outer, so that two triangles with a common edge cut it at the very same point.
    fn clip(&self, polygon: &[ClipVertex], plane: usize) -> Vec<ClipVertex> {
        let mut out = Vec::with_capacity(polygon.len() + 1);
        for (i, a) in polygon.iter().enumerate() {
            let b = &polygon[(i + 1) % polygon.len()];
            let (a_in, b_in) = (a.distance[plane] >= 0.0, b.distance[plane] >= 0.0);
            if a_in {
                out.push(*a);
            }
            if a_in != b_in {
                let (inner, outer) = if a_in { (a, b) } else { (b, a) };
                let (di, d_o) = (inner.distance[plane], outer.distance[plane]);
                let t = di / (di - d_o);
                let lerp = |p: f64, q: f64| p + t * (q - p);
                let weights = [0, 1].map(|k| lerp(inner.weights[k], outer.weights[k]));
                let margins = [0, 1].map(|k| lerp(inner.margins[k].min(1e30), outer.margins[k].min(1e30)));
                let mut cut = self.clip_vertex(inner.v + t * (outer.v - inner.v), weights, margins);
                cut.distance[plane] = 0.0;
                out.push(cut);
            }
        }
        out
    }
}

#[derive(Debug, Clone, Copy)]
struct ClipVertex {
    v: DVec3,
    image: Option<ScreenVertex>,
    weights: [f64; 2],
    margins: [f64; 2],
    distance: [f64; PLANES + 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_short_edges_of_coarse_pictures_are_not_judged() {
        let at = |x: i32, y: i32| ScreenVertex { x: x * SUB, y: y * SUB, q: 1.0 };
        assert!(is_short(at(3, 4), at(6, 8), 5.0) && is_short(at(6, 8), at(3, 4), 5.0));
        assert!(!is_short(at(3, 4), at(7, 8), 5.0), "longer than the tolerance");
        assert!(!is_short(at(3, 4), at(3, 4), 0.5), "a picture at rest");
        assert!(!is_short(at(-100_000, 0), at(100_000, 0), 8.0), "no overflow");
    }
}
