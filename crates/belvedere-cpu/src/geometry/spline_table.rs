//! A spline bend as a table along the curve.

use crate::points::{Points, each};
use belvedere_core::map::spline::SplineBend;
use belvedere_core::{DVec2, DVec3, SpaceMap};

/// Pieces of the curve between its ends.
const PIECES: usize = 512;
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
