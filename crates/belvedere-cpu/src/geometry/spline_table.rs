//! A spline bend as a table along the curve.

use crate::points::{Points, each};
use belvedere_core::map::spline::SplineBend;
use belvedere_core::{DVec2, DVec3, SpaceMap};

/// Pieces of the curve between its ends; with its two extensions a power of two.
const PIECES: usize = 510;
/// Largest accepted error of a point on the curve, curve units, and of a unit normal. The eye is about one curve unit away
/// from the curve, so both stay far below 0.01 pixel.
const PLACE_ERROR: f64 = 1e-7;
const NORMAL_ERROR: f64 = 1e-6;
/// Halvings that find where the curvature of a piece has a kink.
const HALVINGS: usize = 16;
/// Places of a piece where its error is judged, shares of its length.
const JUDGED: [f64; 3] = [0.25, 0.5, 0.75];
/// Entries of the table in single precision: pieces, and second parts of pieces that are cut.
const ENTRIES: usize = 1024;

/// Cubic pieces of equal length along the curve for its point and its normal, ours; pieces whose error is too large (at
/// corners of the curve) fall back on the stage itself.
#[derive(Debug)]
pub(crate) struct SplineTable<'a> {
    bend: &'a SplineBend,
    /// Pivot, right, heading, normal; then the plane of the curve.
    origin: DVec3,
    axes: [DVec3; 3],
    curve_axes: [DVec3; 2],
    /// Scene units of one piece and its inverse, and pieces from the near end to the pivot.
    piece_length: f64,
    pieces_per_unit: f64,
    piece_of_origin: f64,
    /// Piece k at index k + 1; the straight extensions first and last.
    pieces: Vec<Piece>,
}

/// `c[0] + c[1] t + c[2] t^2 + c[3] t^3`, t = 0..1: point (u, v) relative to the pivot in scene units, normal (u, v).
#[derive(Debug, Clone, Copy)]
struct Piece {
    c: [[f64; 4]; 4],
    good: bool,
}

/// Point and normal with their derivatives by pieces.
#[derive(Clone, Copy)]
struct Knot {
    value: [f64; 4],
    slope: [f64; 4],
}

impl<'a> SplineTable<'a> {
    pub(crate) fn new(bend: &'a SplineBend) -> Self {
        let length = bend.curve().length();
        let piece_length = bend.scale() * length / PIECES as f64;
        let mut table = Self {
            bend,
            origin: bend.pivot(),
            axes: bend.axes(),
            curve_axes: bend.curve_axes(),
            piece_length,
            pieces_per_unit: 1.0 / piece_length,
            piece_of_origin: bend.coordinates(bend.pivot()).l / length * PIECES as f64,
            pieces: Vec::with_capacity(PIECES + 2),
        };
        let knots: Option<Vec<Knot>> = (0..=PIECES).map(|k| table.knot(k as f64, 0.0)).collect();
        let Some(knots) = knots.filter(|_| table.piece_length.is_finite() && table.piece_length > 0.0) else {
            return table;
        };
        let straight = |k: Knot| Piece {
            c: std::array::from_fn(|i| [k.value[i], if i < 2 { k.slope[i] } else { 0.0 }, 0.0, 0.0]),
            good: true,
        };
        table.pieces.push(straight(knots[0]));
        for k in 0..PIECES {
            let mut piece = Piece::between(knots[k], knots[k + 1]);
            piece.good = table.is_close(&piece, [k as f64, (k + 1) as f64]);
            table.pieces.push(piece);
        }
        table.pieces.push(straight(knots[PIECES]));
        table
    }

    /// The curve at `k` pieces from its near end.
    /// * `side`: pieces to where its curvature is taken, for places where it jumps.
    fn knot(&self, k: f64, side: f64) -> Option<Knot> {
        let p = self.origin + (k - self.piece_of_origin) * self.piece_length * self.axes[1];
        let flat = |v: DVec3| self.curve_axes.map(|axis| v.dot(axis));
        let place = flat(self.bend.apply(p).ok()? - self.origin);
        let jacobian = self.bend.jacobian(p).ok()?;
        let [along, normal] = [self.axes[1], self.axes[2]].map(|axis| flat(jacobian * axis));
        // The point lies on the plane up to rounding, where lengths along the curve are kept.
        // At its ends the curvature is that of the curve, not that of its straight extensions.
        let curve = self.bend.curve();
        let inside = 1e-6 * curve.length() / PIECES as f64;
        let l = self.bend.coordinates(p).l + side * curve.length() / PIECES as f64;
        let l = l.clamp(inside, curve.length() - inside);
        let turn = -curve.curvature_at(l) / self.bend.scale() * self.piece_length;
        Some(Knot {
            value: [place[0], place[1], normal[0], normal[1]],
            slope: [along[0] * self.piece_length, along[1] * self.piece_length, turn * along[0], turn * along[1]],
        })
    }

    /// Whether a piece from one place to another is close to the curve between them.
    fn is_close(&self, piece: &Piece, [from, to]: [f64; 2]) -> bool {
        let limit = PLACE_ERROR * self.bend.scale();
        JUDGED.iter().all(|&t| {
            let Some(exact) = self.knot(from + t * (to - from), 0.0) else { return false };
            let ([u, v, nu, nv], [pu, pv, pnu, pnv]) = (exact.value, piece.at(t));
            (DVec2::new(u, v) - DVec2::new(pu, pv)).length() <= limit
                && (DVec2::new(nu, nv) - DVec2::new(pnu, pnv)).length() <= NORMAL_ERROR
        })
    }

    /// The cubic between two places of the curve.
    fn between(&self, [from, to]: [f64; 2]) -> Option<Piece> {
        let side = 1e-3 * (to - from);
        let scaled = |knot: Knot| Knot { slope: knot.slope.map(|slope| slope * (to - from)), ..knot };
        let ends = [self.knot(from, side)?, self.knot(to, -side)?].map(scaled);
        Some(Piece::between(ends[0], ends[1]))
    }

    /// Piece `k` cut in two where its curvature has a kink, and the place; `None` if that is not enough.
    fn cut(&self, k: f64) -> Option<([Piece; 2], f64)> {
        // The first part is as long as it is close to the curve: it ends at the kink or little behind it.
        let [mut lo, mut hi] = [k, k + 1.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (lo + hi);
            if self.is_close(&self.between([k, middle])?, [k, middle]) {
                lo = middle;
            } else {
                hi = middle;
            }
        }
        let places = [[k, lo], [lo, k + 1.0]];
        let [a, b] = [self.between(places[0])?, self.between(places[1])?];
        (lo > k && self.is_close(&b, places[1])).then_some(([a, b], lo))
    }

    /// The table as seen from the eye; `None` if one of its pieces is not close enough to the curve.
    pub(crate) fn seen_from(&self, eye: DVec3) -> Option<SplineFromEye> {
        if self.pieces.len() != PIECES + 2 {
            return None;
        }
        let offset = eye - self.origin;
        let [right, heading, normal] = self.axes.map(|axis| axis.dot(offset));
        let at_eye = heading * self.pieces_per_unit + self.piece_of_origin;
        let in_plane = self.curve_axes.map(|axis| axis.dot(right * self.axes[0] - offset));
        // A piece in powers of the position from `from` on, in pieces, where `piece` has it from `begins` on and is `length` long.
        let entry = |piece: &Piece, [begins, length]: [f64; 2], from: f64| {
            let [u, v, nu, nv] = piece.c.map(|[a, b, c, d]| {
                let slope = b / length;
                [a + (from - begins) * slope, slope, c / length.powi(2), d / length.powi(3)]
            });
            let lifted = |place: [f64; 4], turned: [f64; 4], at: f64| {
                let [a, b, c, d]: [f64; 4] = std::array::from_fn(|power| place[power] + normal * turned[power]);
                [a + at, b, c, d]
            };
            let rows = [lifted(u, nu, in_plane[0]), lifted(v, nv, in_plane[1]), nu, nv];
            let c = std::array::from_fn(|power| rows.map(|row| row[power] as f32));
            PieceFromEye { c, from: (from - at_eye) as f32, until: f32::INFINITY, next: 0 }
        };
        let mut entries = vec![PieceFromEye::default(); ENTRIES];
        let mut used = PIECES + 2;
        for (k, piece) in self.pieces.iter().enumerate() {
            let begins = k.saturating_sub(1) as f64;
            entries[k] = match k {
                // Extensions are straight: they begin at the eye where that is beside the curve, for small numbers there.
                0 => entry(piece, [begins, 1.0], at_eye.min(0.0)),
                _ if k == PIECES + 1 => entry(piece, [begins, 1.0], at_eye.max(PIECES as f64)),
                _ if piece.good => entry(piece, [begins, 1.0], begins),
                _ => {
                    let ([a, b], at) = self.cut(begins)?;
                    *entries.get_mut(used)? = entry(&b, [at, begins + 1.0 - at], at);
                    used += 1;
                    let first = entry(&a, [begins, at - begins], begins);
                    PieceFromEye { until: (at - at_eye) as f32, next: used - 1, ..first }
                }
            };
        }
        Some(SplineFromEye {
            right: self.axes[0],
            heading_pieces: self.axes[1] * self.pieces_per_unit,
            normal: self.axes[2],
            curve_axes: self.curve_axes,
            at_eye: at_eye as f32,
            entries: entries.into_boxed_slice().try_into().ok()?,
        })
    }

    /// See [`crate::geometry::displace::Displacer::row`].
    pub(crate) fn row(&self, points: &mut Points<'_>) -> bool {
        each(points, |p| self.point(p))
    }

    #[inline]
    fn point(&self, p: DVec3) -> Option<DVec3> {
        let v = p - self.origin;
        let [right, heading, normal] = self.axes.map(|axis| v.dot(axis));
        let x = heading * self.pieces_per_unit + self.piece_of_origin;
        // NaN goes to the near extension, and stays NaN.
        let (k, from) = if x >= 0.0 {
            let k = (x as usize).min(PIECES);
            (k + 1, k as f64)
        } else {
            (0, 0.0)
        };
        match self.pieces.get(k) {
            Some(piece) if piece.good => {
                let [u, v, nu, nv] = piece.at(x - from);
                let [au, av] = self.curve_axes;
                Some(self.origin + right * self.axes[0] + (u + normal * nu) * au + (v + normal * nv) * av)
            }
            _ => self.bend.apply(p).ok(),
        }
    }
}

/// A spline bend in single precision, for positions relative to the eye: numbers are small where points are near.
#[derive(Debug)]
pub(crate) struct SplineFromEye {
    /// Unit vector that the bend leaves alone.
    pub(crate) right: DVec3,
    /// Pieces along the curve per scene unit.
    pub(crate) heading_pieces: DVec3,
    /// Unit normal of the reference plane.
    pub(crate) normal: DVec3,
    /// Axes of the plane that the curve lies in.
    pub(crate) curve_axes: [DVec3; 2],
    /// Pieces from the near end of the curve to the eye.
    at_eye: f32,
    entries: Box<[PieceFromEye; ENTRIES]>,
}

/// Powers of the position in pieces from `from` on: point of the curve, lifted by the height of the eye and relative to it, and normal.
#[derive(Debug, Clone, Copy, Default)]
struct PieceFromEye {
    c: [[f32; 4]; 4],
    /// Where the piece begins, pieces from the eye.
    from: f32,
    /// Where it ends before the next uniform piece, and the entry that goes on there.
    until: f32,
    next: usize,
}

impl SplineFromEye {
    /// Point (u, v) relative to the eye, and normal (u, v).
    /// * `s`: pieces from the eye.
    #[inline(always)]
    pub(crate) fn at(&self, s: f32) -> [f32; 4] {
        let k = (s + self.at_eye + 1.0).max(0.0).min((PIECES + 1) as f32) as usize;
        // The number of entries is a power of two, and this no check of bounds.
        let entry = |k: usize| &self.entries[k & (ENTRIES - 1)];
        let piece = entry(k);
        let piece = if s >= piece.until { entry(piece.next) } else { piece };
        let (t, [c0, c1, c2, c3]) = (s - piece.from, piece.c);
        std::array::from_fn(|i| c0[i] + t * (c1[i] + t * (c2[i] + t * c3[i])))
    }
}

impl Piece {
    /// The cubic with given ends and slopes.
    fn between(a: Knot, b: Knot) -> Self {
        let c = std::array::from_fn(|i| {
            let (p, q, s, t) = (a.value[i], b.value[i], a.slope[i], b.slope[i]);
            [p, s, 3.0 * (q - p) - 2.0 * s - t, 2.0 * (p - q) + s + t]
        });
        Self { c, good: false }
    }

    #[inline]
    fn at(&self, t: f64) -> [f64; 4] {
        self.c.map(|c| c[0] + t * (c[1] + t * (c[2] + t * c[3])))
    }
}
