//! Lines draped on the ground and projected onto the image.

use crate::marks::segment;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, Scene};
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::{COARSE_PX, Screen};

/// Largest distance of the vertices from the ground up to which a line counts as lying on it, scene units.
const ON_GROUND: f64 = 1.0;
/// A piece of line under the bend is halved at most this often, and at most [`MOST_HALVINGS`] times while its image is longer than the
/// tolerance.
const MAX_HALVINGS: u32 = 8;
const MOST_HALVINGS: u32 = 40;
/// Distance beyond the image up to which lines are drawn, pixels.
const BESIDE_PX: f64 = 64.0;

/// A point of a line on the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PathPoint {
    pub(crate) pixel: DVec2,
    pub(crate) depth: f64,
    /// The point in the world.
    pub(crate) on_line: LinePoint,
}

/// A point of a line in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LinePoint {
    /// Scene coordinates, lifted.
    pub(crate) p: DVec3,
    /// Length of the line from its beginning, scene units.
    pub(crate) along: f64,
    /// Whether the line lies on the ground here.
    pub(crate) on_ground: bool,
}

impl LinePoint {
    pub(crate) fn lerp(self, other: Self, t: f64) -> Self {
        Self {
            p: self.p.lerp(other.p, t),
            along: self.along + t * (other.along - self.along),
            on_ground: self.on_ground && other.on_ground,
        }
    }
}

/// The first and the last point, and those between that are about a pixel or more from the one before.
fn thinned(points: &[DVec3], screen: &Screen) -> Vec<DVec3> {
    let mut out: Vec<DVec3> = Vec::new();
    for (i, &p) in points.iter().enumerate() {
        let is_near = |last: &DVec3| p.distance(*last) < screen.pixel_size(p);
        if i + 1 == points.len() || !out.last().is_some_and(is_near) {
            out.push(p);
        }
    }
    out
}

/// The line draped on the drawn surface: its vertices, and points every 0.4 node spacings between them, lifted; fewer of both in a coarse
/// picture.
///
/// * `coarse`: the screen of a coarse picture, whose points lie about a pixel apart.
pub(crate) fn drape(scene: &Scene, points: &[DVec3], lift_m: f64, coarse: Option<&Screen>) -> Vec<LinePoint> {
    let thinned = coarse.map(|screen| thinned(points, screen));
    let points = thinned.as_deref().unwrap_or(points);
    let lift = DVec3::Z * lift_m;
    let mut out: Vec<LinePoint> = Vec::with_capacity(points.len() * 3);
    let mut push = |p: DVec3, on_ground: bool| {
        let along = out.last().map_or(0.0, |l| l.along + l.p.distance(p));
        out.push(LinePoint { p, along, on_ground });
    };
    let Some(hf) = scene.terrain() else {
        points.iter().for_each(|&p| push(p + lift, false));
        return out;
    };
    let step = 0.4 * hf.spacing().min_element();
    let mut first = true;
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if !(a.is_finite() && b.is_finite()) {
            continue;
        }
        let ground = is_on_ground(hf, a) && is_on_ground(hf, b);
        let step = coarse.map_or(step, |screen| screen.pixel_size(a).min(screen.pixel_size(b)).max(step));
        let n = if ground { ((b - a).truncate().length() / step).ceil().clamp(1.0, 4096.0) as usize } else { 1 };
        for i in usize::from(!first)..=n {
            let p = a.lerp(b, i as f64 / n as f64);
            let height = if ground { hf.surface_at(p.truncate()) } else { None };
            push(p.with_z(height.unwrap_or(p.z)) + lift, height.is_some());
        }
        first = false;
    }
    out
}

/// The points without draping.
pub(crate) fn as_given(points: &[DVec3]) -> Vec<LinePoint> {
    let mut along = 0.0;
    let mut last: Option<DVec3> = None;
    let finite = points.iter().filter(|p| p.is_finite());
    finite
        .map(|&p| {
            along += last.replace(p).map_or(0.0, |l| l.distance(p));
            LinePoint { p, along, on_ground: false }
        })
        .collect()
}

/// The line draped on the drawn surface, whatever its own heights, lifted: pieces without holes; `coarse` as in [`drape`].
pub(crate) fn lay(scene: &Scene, points: &[DVec3], lift_m: f64, coarse: Option<&Screen>) -> Vec<Vec<LinePoint>> {
    let thinned = coarse.map(|screen| thinned(points, screen));
    let points = thinned.as_deref().unwrap_or(points);
    let Some(hf) = scene.terrain() else { return Vec::new() };
    let step = 0.9 * hf.spacing().min_element();
    let (mut pieces, mut along) = (vec![Vec::new()], 0.0);
    for (i, pair) in points.windows(2).enumerate() {
        let (a, b) = (pair[0].truncate(), pair[1].truncate());
        let length = a.distance(b);
        if !length.is_finite() {
            continue;
        }
        let step = coarse
            .map_or(step, |screen| pair.iter().map(|p| screen.pixel_size(*p)).fold(f64::INFINITY, f64::min).max(step));
        let n = (length / step).ceil().clamp(1.0, 65_536.0) as usize;
        for k in usize::from(i > 0)..=n {
            let xy = a.lerp(b, k as f64 / n as f64);
            match (hf.surface_at(xy), pieces.last_mut()) {
                (Some(z), Some(piece)) => {
                    let p = xy.extend(z + lift_m);
                    along += piece.last().map_or(0.0, |l: &LinePoint| l.p.distance(p));
                    piece.push(LinePoint { p, along, on_ground: true });
                }
                (_, last) => {
                    if last.is_some_and(|l| !l.is_empty()) {
                        pieces.push(Vec::new());
                    }
                }
            }
        }
    }
    pieces
}

fn is_on_ground(hf: &Heightfield, p: DVec3) -> bool {
    let near = |h: Option<f64>| h.is_some_and(|h| (h - p.z).abs() <= ON_GROUND);
    near(hf.height_at(p.truncate())) || near(hf.surface_at(p.truncate()))
}

/// Vertex of a line with the data for clipping.
#[derive(Clone, Copy)]
struct Vertex {
    on_line: LinePoint,
    v: Option<DVec3>,
    margins: [f64; 2],
}

/// Images of a polyline in one pass: pieces without a gap, each of at least two points, straight to the tolerance.
pub(crate) fn project(
    pass: &Pass<'_>,
    screen: &Screen,
    points: &[LinePoint],
    tolerance_px: f64,
) -> Vec<Vec<PathPoint>> {
    let mut tracer = Tracer { pass, screen, tolerance_px, pieces: Vec::new(), open: false };
    let mut last: Option<Vertex> = None;
    for &p in points {
        let next = tracer.vertex(p);
        if let Some(from) = last {
            tracer.segment(from, next, if pass.is_straight() { MOST_HALVINGS } else { 0 });
        }
        last = Some(next);
    }
    tracer.pieces.retain(|piece| piece.len() > 1);
    tracer.pieces
}

struct Tracer<'a> {
    pass: &'a Pass<'a>,
    screen: &'a Screen,
    tolerance_px: f64,
    pieces: Vec<Vec<PathPoint>>,
    open: bool,
}

impl Tracer<'_> {
    fn vertex(&self, on_line: LinePoint) -> Vertex {
        let p = on_line.p;
        let v = self.pass.displace(p).map(|d| self.screen.view_from(d)).filter(|v| v.is_finite());
        Vertex { on_line, v, margins: self.pass.margins(p) }
    }

    /// * `halvings`: how often the piece of line was halved.
    fn segment(&mut self, a: Vertex, b: Vertex, halvings: u32) {
        let may_split = halvings < MAX_HALVINGS || (halvings < MOST_HALVINGS && self.is_long(&a, &b));
        if may_split && self.bends(&a, &b) {
            let m = self.vertex(a.on_line.lerp(b.on_line, 0.5));
            self.segment(a, m, halvings + 1);
            self.segment(m, b, halvings + 1);
            return;
        }
        let (Some(va), Some(vb)) = (a.v, b.v) else {
            self.open = false;
            return;
        };
        // Both ends are seen, at opposite sides of the picture.
        if self.pass.seam().is_some_and(|seam| seam.parts(a.on_line.p, b.on_line.p)) {
            self.open = false;
            return;
        }
        let Some([s, t]) = self.clip((va, a.margins), (vb, b.margins)) else {
            self.open = false;
            return;
        };
        if !self.open || s > 0.0 {
            self.pieces.push(vec![self.point(va.lerp(vb, s), a.on_line.lerp(b.on_line, s))]);
        }
        let end = self.point(va.lerp(vb, t), a.on_line.lerp(b.on_line, t));
        if let Some(piece) = self.pieces.last_mut() {
            piece.push(end);
        }
        self.open = t == 1.0;
    }

    /// Whether a part of the edge in the picture would be drawn wrong if the edge was drawn straight.
    fn bends(&self, a: &Vertex, b: &Vertex) -> bool {
        let (Some(va), Some(vb)) = (a.v, b.v) else { return a.v.is_some() || b.v.is_some() };
        if self.is_short(a.v, b.v) {
            return false;
        }
        let error = self.pass.edge_error(a.on_line.p, b.on_line.p);
        let beside = |v: DVec3| self.screen.outcode(v, BESIDE_PX);
        let around = |v: DVec3| self.screen.outcode_around(v, error.length);
        let may_enter = || error.length.is_finite() && around(va) & around(vb) == 0;
        error.px > self.tolerance_px && (beside(va) & beside(vb) == 0 || may_enter())
    }

    /// Whether the image of an edge is longer than the tolerance.
    fn is_long(&self, a: &Vertex, b: &Vertex) -> bool {
        let distance = |c: &Vertex| c.v.unwrap_or_else(|| self.screen.view_from(c.on_line.p)).length();
        let length = a.on_line.p.distance(b.on_line.p);
        self.screen.length_px(length, distance(a).min(distance(b))) > self.tolerance_px
    }

    /// Whether a segment of a coarse picture is shorter than its tolerance, so that its bend does not matter.
    fn is_short(&self, a: Option<DVec3>, b: Option<DVec3>) -> bool {
        let pixel = |v: DVec3| self.screen.is_drawable(v).then(|| self.screen.pixel(v));
        let ends = (a.and_then(pixel), b.and_then(pixel));
        self.tolerance_px >= COARSE_PX && matches!(ends, (Some(a), Some(b)) if a.distance(b) <= self.tolerance_px)
    }

    /// Parameters of the visible part of a segment.
    fn clip(&self, a: (DVec3, [f64; 2]), b: (DVec3, [f64; 2])) -> Option<[f64; 2]> {
        let distances = |(v, margins): (DVec3, [f64; 2])| {
            self.screen.clip_distances(v).into_iter().chain(margins.map(|m| m.min(1e30)))
        };
        segment::within(distances(a).zip(distances(b)))
    }

    fn point(&self, v: DVec3, on_line: LinePoint) -> PathPoint {
        PathPoint { pixel: self.screen.pixel(v), depth: v.z, on_line }
    }
}

#[cfg(test)]
mod tests;
