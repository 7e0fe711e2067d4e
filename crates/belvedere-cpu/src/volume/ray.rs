//! The ray of a pixel as segments inside the box of a volume: cubics in lattice coordinates, by arc length in the scene.

use super::cubic::Cubic;
use crate::trace::curve::{Curve, Span, Split};
use belvedere_core::conic::ConicArc;
use belvedere_core::map::curved_rays::{Bend, C2Arc, RayPiece, Shape};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Volume;

/// Largest distance of a segment from the ray, voxels.
const NEAR: f64 = 1e-3;
/// Relative difference below which two depths belong to one image of a point.
const SAME_DEPTH: f64 = 0.02;
/// Relative change of speed above which a part is halved, so that lengths are accurate to about 1e-5.
const UNEVEN: f64 = 0.1;
/// Largest number of halvings of a part of a bent piece.
const MAX_HALVINGS: u32 = 12;
/// Largest number of halvings of a part of a ray without points.
const MAX_HALVINGS_OF_NOTHING: u32 = 5;

/// Part of a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// Lattice coordinates over the share of the length.
    pub(super) curve: Cubic,
    /// Length, scene units.
    pub(super) length: f64,
    /// Depths at its ends.
    pub(super) depth: [f64; 2],
    /// Whether it does not adjoin the segment before.
    pub(super) is_new: bool,
}

impl Segment {
    /// Depth at a share of its length.
    pub(super) fn depth_at(&self, t: f64) -> f64 {
        self.depth[0] + t * (self.depth[1] - self.depth[0])
    }
}

/// Generates the segments of the rays of a view.
pub(super) struct Rays<'a> {
    view: &'a View,
    split: Split<'a>,
    /// Whether rays consist of straight and curved pieces in closed form.
    pieces: bool,
    /// Range of depths in which surfaces can be seen.
    range: [f64; 2],
}

impl<'a> Rays<'a> {
    /// * `range`: nearest depth, and a depth beyond which no surface is seen.
    pub(super) fn new(view: &'a View, range: [f64; 2]) -> Self {
        let pieces = view.stages().iter().all(|s| s.bends_rays());
        Self { view, split: Split::new(view), pieces, range }
    }

    /// Nearest depth.
    pub(super) fn near(&self) -> f64 {
        self.range[0]
    }

    /// A depth beyond which no surface is seen.
    pub(super) fn deepest(&self) -> f64 {
        self.range[1]
    }

    pub(super) fn view(&self) -> &View {
        self.view
    }

    /// Depth at which the ray of a pixel sees a point that lies on it at about `depth`.
    pub(super) fn depth_of(&self, place: DVec3, depth: f64) -> f64 {
        match self.view.project(place) {
            Ok(image) if (image.depth - depth).abs() <= SAME_DEPTH * depth => image.depth,
            // Another part of the rays sees it first.
            _ => depth,
        }
    }

    /// Calls `each` with the segments of those pixels of a row that `wants` selects.
    ///
    /// * `wants`: the depth to which the ray of a column is followed; `None`: it is not.
    pub(super) fn row(
        &self,
        y: usize,
        width: usize,
        volume: &Volume,
        wants: impl Fn(usize) -> Option<f64>,
        mut each: impl FnMut(usize, &[Segment]),
    ) {
        let y = y as f64 + 0.5;
        let row = if self.pieces { None } else { self.split.row(y, self.range) };
        let mut segments = Vec::new();
        for x in 0..width {
            let Some(far) = wants(x) else { continue };
            let pixel = DVec2::new(x as f64 + 0.5, y);
            segments.clear();
            let mut clip = Clip::new(volume, &mut segments);
            if self.pieces {
                clip.pieces(self.view, pixel, [self.range[0], far]);
            } else {
                let curve = self.split.curve(pixel, row.as_ref());
                clip.chords(&self.split, &curve, [self.range[0], far.min(self.range[1])]);
            }
            each(x, &segments);
        }
    }
}

/// Collects the segments of a ray inside a volume.
struct Clip<'v, 's> {
    volume: &'v Volume,
    most: DVec3,
    out: &'s mut Vec<Segment>,
    /// Whether the next segment adjoins the last one.
    goes_on: bool,
}

/// A point of a bent piece.
#[derive(Clone, Copy)]
struct Knot {
    parameter: f64,
    /// Lattice coordinates, and their derivative by the parameter.
    place: DVec3,
    slope: DVec3,
    /// Length of the derivative in the scene.
    speed: f64,
}

/// A bent piece of a ray over its parameter; points and derivatives in the scene.
trait Arc {
    fn point(&self, u: f64) -> DVec3;
    fn derivative(&self, u: f64) -> DVec3;
    fn depth(&self, u: f64) -> f64;
    /// A triangle that contains the whole piece.
    fn corners(&self) -> [DVec3; 3];
}

macro_rules! arc {
    ($curve:ty) => {
        impl Arc for Bend<$curve> {
            fn point(&self, u: f64) -> DVec3 {
                self.curve.point(u)
            }

            fn derivative(&self, u: f64) -> DVec3 {
                self.curve.derivative(u)
            }

            fn depth(&self, u: f64) -> f64 {
                Bend::<$curve>::depth(self, u)
            }

            fn corners(&self) -> [DVec3; 3] {
                [self.curve.t, self.curve.s, self.curve.q]
            }
        }
    };
}

arc!(ConicArc);
arc!(C2Arc);

impl<'v, 's> Clip<'v, 's> {
    fn new(volume: &'v Volume, out: &'s mut Vec<Segment>) -> Self {
        let most = DVec3::from_array(volume.dims().map(|n| (n - 1) as f64));
        Self { volume, most, out, goes_on: false }
    }

    fn pieces(&mut self, view: &View, pixel: DVec2, [near, far]: [f64; 2]) {
        if view.stages().is_empty() {
            let (from, per_depth) = view.pinhole().line(pixel);
            return self.line(from, per_depth, [near, far]);
        }
        let Ok(pieces) = view.ray(pixel).pieces() else { return };
        for piece in &pieces {
            let depth = [piece.depth[0].max(near), piece.depth[1].min(far)];
            if depth[0] < depth[1] {
                self.piece(piece, depth);
            }
        }
    }

    fn piece(&mut self, piece: &RayPiece, depth: [f64; 2]) {
        match &piece.shape {
            Shape::Line { from, per_depth } => self.line(*from - piece.depth[0] * *per_depth, *per_depth, depth),
            Shape::Conic(arc) => self.conic(arc, depth),
            Shape::C2(arc) => self.bend(arc, depth.map(|w| arc.parameter(w))),
        }
    }

    /// The part of a straight line, given by its point at depth 0 and its change, that lies in the box.
    fn line(&mut self, from: DVec3, per_depth: DVec3, depth: [f64; 2]) {
        let (a, b) = (self.volume.lattice_from_scene(from), *self.volume.lattice_axes() * per_depth);
        let [mut w0, mut w1] = depth;
        for axis in 0..3 {
            let (t0, t1) = ((0.0 - a[axis]) / b[axis], (self.most[axis] - a[axis]) / b[axis]);
            if b[axis] == 0.0 {
                if !(a[axis] >= 0.0 && a[axis] <= self.most[axis]) {
                    w1 = f64::NEG_INFINITY;
                }
            } else {
                w0 = w0.max(t0.min(t1));
                w1 = w1.min(t0.max(t1));
            }
        }
        let goes_on = std::mem::replace(&mut self.goes_on, false);
        if !(w0 < w1 && w1.is_finite()) {
            return;
        }
        let curve = Cubic::line(a + w0 * b, a + w1 * b);
        let length = (w1 - w0) * per_depth.length();
        self.out.push(Segment { curve, length, depth: [w0, w1], is_new: !(goes_on && w0 == depth[0]) });
        self.goes_on = w1 == depth[1];
    }

    /// The part of a conic between two depths that lies in the box, between its crossings of the faces.
    fn conic(&mut self, arc: &Bend<ConicArc>, depth: [f64; 2]) {
        let Some([lo, hi]) = self.meets(arc) else { return };
        let [u0, u1] = depth.map(|w| arc.parameter(w));
        let [t, s, q] = arc.corners().map(|p| self.volume.lattice_from_scene(p));
        let mut ends = [u1; 14];
        ends[0] = u0;
        let mut n = 1;
        for axis in 0..3 {
            for face in [0.0, self.most[axis]] {
                if lo[axis] < face && face < hi[axis] {
                    for u in arc.curve.plane_hits([t, s, q].map(|p| p[axis] - face)).filter(|u| u0 < *u && *u < u1) {
                        ends[n] = u;
                        n += 1;
                    }
                }
            }
        }
        ends[1..n].sort_unstable_by(f64::total_cmp);
        for pair in ends[..=n].windows(2) {
            let middle = self.volume.lattice_from_scene(arc.point(0.5 * (pair[0] + pair[1])));
            if pair[0] < pair[1] && middle.cmpge(DVec3::ZERO).all() && middle.cmple(self.most).all() {
                let [a, b] = [pair[0], pair[1]].map(|u| self.knot(arc, u));
                self.halved(arc, a, b, 0, &Self::whole);
            } else {
                self.goes_on = false;
            }
        }
    }

    /// The part of a bent piece between two parameters that lies in the box.
    fn bend(&mut self, arc: &impl Arc, [u0, u1]: [f64; 2]) {
        if self.meets(arc).is_some() && u0 < u1 {
            let [a, b] = [u0, u1].map(|u| self.knot(arc, u));
            self.halved(arc, a, b, 0, &Self::inside);
        }
    }

    /// Lattice bounds of a bent piece, unless they miss the box.
    fn meets(&mut self, arc: &impl Arc) -> Option<[DVec3; 2]> {
        let [t, s, q] = arc.corners().map(|p| self.volume.lattice_from_scene(p));
        let (lo, hi) = (t.min(s).min(q), t.max(s).max(q));
        let meets = hi.cmpge(DVec3::ZERO).all() && lo.cmple(self.most).all();
        self.goes_on &= meets;
        meets.then_some([lo, hi])
    }

    fn knot(&self, arc: &impl Arc, u: f64) -> Knot {
        let slope = arc.derivative(u);
        let place = self.volume.lattice_from_scene(arc.point(u));
        Knot { parameter: u, place, slope: *self.volume.lattice_axes() * slope, speed: slope.length() }
    }

    /// Divides a part of a bent piece into cubics that are close enough to it, with their lengths and depths.
    fn halved<A: Arc>(
        &mut self,
        arc: &A,
        a: Knot,
        b: Knot,
        halvings: u32,
        keep: &impl Fn(&mut Self, Cubic, f64, [f64; 2]),
    ) {
        let middle = self.knot(arc, 0.5 * (a.parameter + b.parameter));
        // Simpson's rule.
        let length = (b.parameter - a.parameter) * (a.speed + 4.0 * middle.speed + b.speed) / 6.0;
        let curve = Cubic::hermite([a, b].map(|k| k.place), [a, b].map(|k| k.slope * (length / k.speed)));
        // The cubic is parametrised by length: its middle is where half of the length is passed, to first order in the change of speed.
        let (off, along) = (curve.at(0.5) - middle.place, middle.slope);
        let across = off - along * (off.dot(along) / along.length_squared());
        let uneven = (a.speed - b.speed).abs() > UNEVEN * middle.speed;
        if (across.length_squared() > NEAR * NEAR || uneven) && halvings < MAX_HALVINGS {
            self.halved(arc, a, middle, halvings + 1, keep);
            self.halved(arc, middle, b, halvings + 1, keep);
            return;
        }
        keep(self, curve, length, [a, b].map(|k| arc.depth(k.parameter)));
    }

    /// Keeps a cubic that lies in the box.
    fn whole(&mut self, curve: Cubic, length: f64, depth: [f64; 2]) {
        let is_new = !std::mem::replace(&mut self.goes_on, true);
        self.out.push(Segment { curve, length, depth, is_new });
    }

    /// Keeps the parts of a cubic that lie in the box.
    fn inside(&mut self, curve: Cubic, length: f64, depth: [f64; 2]) {
        let mut goes_on = std::mem::replace(&mut self.goes_on, false);
        let (out, ends) = (&mut *self.out, &mut self.goes_on);
        curve.inside(self.most, |[t0, t1]| {
            let w = [t0, t1].map(|t| depth[0] + t * (depth[1] - depth[0]));
            let is_new = !(goes_on && t0 == 0.0) && out.last().is_none_or(|s: &Segment| s.depth[1] != w[0]);
            out.push(Segment { curve: curve.part([t0, t1]), length: length * (t1 - t0), depth: w, is_new });
            goes_on = false;
            *ends = t1 == 1.0;
        });
    }

    /// Chords of a ray that is known only by the inverse of the stages.
    fn chords(&mut self, split: &Split<'_>, curve: &Curve<'_, '_>, range: [f64; 2]) {
        if !(range[0] < range[1]) {
            return;
        }
        for span in curve.spans(range) {
            self.chord(split, curve, &span, 0, range);
        }
    }

    fn chord(&mut self, split: &Split<'_>, curve: &Curve<'_, '_>, span: &Span, halvings: u32, range: [f64; 2]) {
        if span.depth[0] >= range[1] {
            return;
        }
        let Some((a, b)) = span.chord().filter(|_| span.reach.is_finite()) else {
            let most = if span.has_point() { MAX_HALVINGS } else { MAX_HALVINGS_OF_NOTHING };
            if halvings >= most {
                self.goes_on = false;
                return;
            }
            return curve.halves(span).iter().for_each(|half| self.chord(split, curve, half, halvings + 1, range));
        };
        let lift = |p: DVec3| p - split.lift(p) * DVec3::Z;
        let [p, q] = [lift(a), lift(b)].map(|p| self.volume.lattice_from_scene(p));
        // Distance of the ray, or of lifted ground between its ends, from the chord, lattice units.
        let edge = self.volume.voxel_edge();
        let room = (span.reach + split.most_lift(a, b)) / edge;
        let (lo, hi) = (p.min(q) - room, p.max(q) + room);
        if !(hi.cmpge(DVec3::ZERO).all() && lo.cmple(self.most).all()) {
            self.goes_on = false;
            return;
        }
        let whole = span.depth[1] <= range[1];
        let fine = span.reach <= NEAR * edge && (split.ground.is_none() || (b - a).length() <= edge);
        if (!fine || !whole) && halvings < MAX_HALVINGS + 6 {
            return curve.halves(span).iter().for_each(|half| self.chord(split, curve, half, halvings + 1, range));
        }
        let length = (lift(b) - lift(a)).length();
        self.inside(Cubic::line(p, q), length, span.depth);
    }
}
