//! Rays as segments inside the box of a volume: cubics in lattice coordinates, by arc length in the scene.

use super::arc::{Arc, Joined, Knot, LatticeConic, NEAR};
use super::cubic::Cubic;
use belvedere_core::conic::ConicArc;
use belvedere_core::map::curved_rays::{Bend, RayPiece, Shape};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Volume;
use belvedere_sight::trace::{Curve, Span, Split};

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
    /// Depth over the share of the length.
    pub(super) depth: Cubic<f64>,
    /// Whether it does not adjoin the segment before.
    pub(super) is_new: bool,
}

/// Collects the segments of a ray inside a volume.
pub(super) struct Clip<'v, 's> {
    volume: &'v Volume,
    most: DVec3,
    out: &'s mut Vec<Segment>,
    /// Whether the next segment adjoins the last one.
    goes_on: bool,
    /// Depth at which the last segment ends.
    passed: f64,
}

impl<'v, 's> Clip<'v, 's> {
    pub(super) fn new(volume: &'v Volume, out: &'s mut Vec<Segment>) -> Self {
        let most = DVec3::from_array(volume.dims().map(|n| (n - 1) as f64));
        Self { volume, most, out, goes_on: false, passed: f64::NAN }
    }

    pub(super) fn pieces(&mut self, view: &View, pixel: DVec2, [near, far]: [f64; 2]) {
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
        let places = [self.volume.lattice_from_scene(from), *self.volume.lattice_axes() * per_depth];
        self.lattice_line(places, per_depth.length(), depth);
    }

    /// The same in lattice coordinates.
    ///
    /// * `speed`: length in the scene per unit of depth.
    pub(super) fn lattice_line(&mut self, [a, b]: [DVec3; 2], speed: f64, depth: [f64; 2]) {
        let [mut w0, mut w1] = depth;
        let per_unit = b.recip();
        for axis in 0..3 {
            let (t0, t1) = (-a[axis] * per_unit[axis], (self.most[axis] - a[axis]) * per_unit[axis]);
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
        let length = (w1 - w0) * speed;
        let is_new = !(goes_on && w0 == depth[0]);
        self.keep(Segment { curve, length, depth: Cubic::line(w0, w1), is_new });
        self.goes_on = w1 == depth[1];
    }

    /// The part of a conic between two depths that lies in the box, between its crossings of the faces.
    fn conic(&mut self, arc: &Bend<ConicArc>, depth: [f64; 2]) {
        let [u0, u1] = depth.map(|w| arc.parameter(w));
        let arc = &LatticeConic::new(self.volume, arc);
        let Some([lo, hi]) = self.meets(arc) else { return };
        let [t, s, q] = arc.corners(self.volume);
        let mut ends = [u1; 14];
        ends[0] = u0;
        let mut n = 1;
        for axis in 0..3 {
            for face in [0.0, self.most[axis]] {
                if lo[axis] < face && face < hi[axis] {
                    for u in arc.0.curve.plane_hits([t, s, q].map(|p| p[axis] - face)).filter(|u| u0 < *u && *u < u1) {
                        ends[n] = u;
                        n += 1;
                    }
                }
            }
        }
        ends[1..n].sort_unstable_by(f64::total_cmp);
        for pair in ends[..=n].windows(2) {
            let middle = arc.0.curve.point(0.5 * (pair[0] + pair[1]));
            if pair[0] < pair[1] && middle.cmpge(DVec3::ZERO).all() && middle.cmple(self.most).all() {
                let [a, b] = [pair[0], pair[1]].map(|u| arc.knot(self.volume, u));
                self.halved(arc, a, b, 0, &Self::whole);
            } else {
                self.goes_on = false;
            }
        }
    }

    /// The part of a bent piece between two parameters that lies in the box.
    fn bend(&mut self, arc: &impl Arc, [u0, u1]: [f64; 2]) {
        if self.meets(arc).is_some() && u0 < u1 {
            let [a, b] = [u0, u1].map(|u| arc.knot(self.volume, u));
            self.halved(arc, a, b, 0, &|clip: &mut Self, j: &Joined| clip.inside(j.curve, j.length, j.depth));
        }
    }

    /// Lattice bounds of a bent piece, unless they miss the box.
    fn meets(&mut self, arc: &impl Arc) -> Option<[DVec3; 2]> {
        let [t, s, q] = arc.corners(self.volume);
        let (lo, hi) = (t.min(s).min(q), t.max(s).max(q));
        let meets = hi.cmpge(DVec3::ZERO).all() && lo.cmple(self.most).all();
        self.goes_on &= meets;
        meets.then_some([lo, hi])
    }

    /// Divides a part of a bent piece into cubics that are close enough to it, with their lengths and depths.
    fn halved<A: Arc>(&mut self, arc: &A, a: Knot, b: Knot, halvings: u32, keep: &impl Fn(&mut Self, &Joined)) {
        let middle = arc.knot(self.volume, 0.5 * (a.parameter + b.parameter));
        let joined = Joined::new(&a, &middle, &b);
        if (joined.off_squared > NEAR * NEAR || joined.is_uneven) && halvings < MAX_HALVINGS {
            self.halved(arc, a, middle, halvings + 1, keep);
            self.halved(arc, middle, b, halvings + 1, keep);
            return;
        }
        keep(self, &joined);
    }

    /// Keeps a cubic that lies in the box.
    fn whole(&mut self, Joined { curve, length, depth, .. }: &Joined) {
        let is_new = !std::mem::replace(&mut self.goes_on, true);
        self.keep(Segment { curve: *curve, length: *length, depth: *depth, is_new });
    }

    fn keep(&mut self, segment: Segment) {
        self.passed = segment.depth.at(1.0);
        self.out.push(segment);
    }

    /// Keeps the parts of a cubic that lie in the box.
    fn inside(&mut self, curve: Cubic, length: f64, depth: Cubic<f64>) {
        let mut goes_on = std::mem::replace(&mut self.goes_on, false);
        let most = self.most;
        curve.inside(most, |[t0, t1]| {
            if [t0, t1] == [0.0, 1.0] {
                self.keep(Segment { curve, length, depth, is_new: !goes_on });
            } else {
                let part = depth.part([t0, t1]);
                let is_new = !(goes_on && t0 == 0.0) && self.passed != part.0[0];
                self.keep(Segment { curve: curve.part([t0, t1]), length: length * (t1 - t0), depth: part, is_new });
            }
            goes_on = false;
            self.goes_on = t1 == 1.0;
        });
    }

    /// What follows does not adjoin what was kept.
    pub(super) fn leave(&mut self) {
        self.goes_on = false;
    }

    /// Keeps the parts of a cubic that lie in the box and between two depths.
    ///
    /// * `is_inside`: whether it is known to lie in the box.
    pub(super) fn between(
        &mut self,
        curve: Cubic,
        length: f64,
        depth: Cubic<f64>,
        [near, far]: [f64; 2],
        is_inside: bool,
    ) {
        let [first, last] = [depth.0[0], depth.at(1.0)];
        if last <= near || first >= far {
            return;
        }
        if first >= near && last <= far {
            if !is_inside {
                return self.inside(curve, length, depth);
            }
            let is_new = !std::mem::replace(&mut self.goes_on, true);
            return self.keep(Segment { curve, length, depth, is_new });
        }
        let t0 = if first < near { depth.reaches(near) } else { 0.0 };
        let t1 = if last > far { depth.reaches(far) } else { 1.0 };
        self.inside(curve.part([t0, t1]), length * (t1 - t0), depth.part([t0, t1]));
    }

    /// Chords of a ray that is known only by the inverse of the stages.
    pub(super) fn chords(&mut self, split: &Split<'_>, curve: &Curve<'_, '_>, range: [f64; 2]) {
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
            if !span.has_point() && curve.may_enter(span) == Some(false) {
                self.goes_on = false;
                return;
            }
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
        self.inside(Cubic::line(p, q), length, Cubic::line(span.depth[0], span.depth[1]));
    }
}
