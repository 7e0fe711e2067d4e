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
        let knots: Option<Vec<Knot>> = (0..=PIECES).map(|k| table.knot(k as f64)).collect();
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
            piece.good = [0.25, 0.5, 0.75].iter().all(|&t| table.is_close(&piece, k as f64 + t, t));
            table.pieces.push(piece);
        }
        table.pieces.push(straight(knots[PIECES]));
        table
    }

    /// The curve at `k` pieces from its near end.
    fn knot(&self, k: f64) -> Option<Knot> {
        let p = self.origin + (k - self.piece_of_origin) * self.piece_length * self.axes[1];
        let flat = |v: DVec3| self.curve_axes.map(|axis| v.dot(axis));
        let place = flat(self.bend.apply(p).ok()? - self.origin);
        let jacobian = self.bend.jacobian(p).ok()?;
        let [along, normal] = [self.axes[1], self.axes[2]].map(|axis| flat(jacobian * axis));
        // The point lies on the plane up to rounding, where lengths along the curve are kept.
        let turn = -self.bend.curve().curvature_at(self.bend.coordinates(p).l) / self.bend.scale() * self.piece_length;
        Some(Knot {
            value: [place[0], place[1], normal[0], normal[1]],
            slope: [along[0] * self.piece_length, along[1] * self.piece_length, turn * along[0], turn * along[1]],
        })
    }

    fn is_close(&self, piece: &Piece, k: f64, t: f64) -> bool {
        let Some(exact) = self.knot(k) else { return false };
        let [u, v, nu, nv] = exact.value;
        let [pu, pv, pnu, pnv] = piece.at(t);
        let limit = PLACE_ERROR * self.bend.scale();
        (DVec2::new(u, v) - DVec2::new(pu, pv)).length() <= limit
            && (DVec2::new(nu, nv) - DVec2::new(pnu, pnv)).length() <= NORMAL_ERROR
    }

    /// The table as seen from the eye; `None` if one of its pieces is not close enough to the curve.
    pub(crate) fn seen_from(&self, eye: DVec3) -> Option<SplineFromEye> {
        if self.pieces.len() != PIECES + 2 || self.pieces.iter().any(|piece| !piece.good) {
            return None;
        }
        let offset = eye - self.origin;
        let [right, heading, normal] = self.axes.map(|axis| axis.dot(offset));
        let at_eye = heading * self.pieces_per_unit + self.piece_of_origin;
        let in_plane = self.curve_axes.map(|axis| axis.dot(right * self.axes[0] - offset));
        let piece = |k: usize| {
            // Extensions are straight: near the eye they begin at the eye, for small numbers there.
            let from = match k {
                0 => at_eye.min(0.0),
                k if k == PIECES + 1 => at_eye.max(PIECES as f64),
                k => (k - 1) as f64,
            };
            let begins = if k == 0 { 0.0 } else { (k - 1) as f64 };
            let c = self.pieces[k].c;
            let moved = |i: usize| {
                let [c0, c1, c2, c3] = c[i];
                [c0 + (from - begins) * c1, c1, c2, c3]
            };
            let [u, v, nu, nv] = std::array::from_fn(moved);
            let lifted = |place: [f64; 4], turned: [f64; 4], at: f64| {
                let [a, b, c, d]: [f64; 4] = std::array::from_fn(|power| place[power] + normal * turned[power]);
                [a + at, b, c, d]
            };
            let rows = [lifted(u, nu, in_plane[0]), lifted(v, nv, in_plane[1]), nu, nv];
            let c = std::array::from_fn(|power| rows.map(|row| row[power] as f32));
            PieceFromEye { c, from: (from - at_eye) as f32 }
        };
        let pieces: Vec<PieceFromEye> = (0..PIECES + 2).map(piece).collect();
        Some(SplineFromEye {
            right: self.axes[0],
            heading_pieces: self.axes[1] * self.pieces_per_unit,
            normal: self.axes[2],
            curve_axes: self.curve_axes,
            at_eye: at_eye as f32,
            pieces: Box::new(pieces.try_into().ok()?),
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
    pieces: Box<[PieceFromEye; PIECES + 2]>,
}

/// Powers of the position in pieces from `from` on: point of the curve, lifted by the height of the eye and relative to it, and normal.
#[derive(Debug, Clone, Copy)]
struct PieceFromEye {
    c: [[f32; 4]; 4],
    /// Where the piece begins, pieces from the eye.
    from: f32,
}

impl SplineFromEye {
    /// Point (u, v) relative to the eye, and normal (u, v).
    /// * `s`: pieces from the eye.
    #[inline(always)]
    pub(crate) fn at(&self, s: f32) -> [f32; 4] {
        let k = (s + self.at_eye + 1.0).max(0.0).min((PIECES + 1) as f32) as usize;
        // The number of pieces is a power of two, and this no check of bounds.
        let piece = &self.pieces[k & (PIECES + 1)];
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
