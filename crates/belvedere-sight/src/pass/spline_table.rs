//! A spline bend as a table along the curve.

use crate::pass::points::{Points, each};
use belvedere_core::map::spline::SplineBend;
use belvedere_core::{DVec2, DVec3, SpaceMap};

/// Pieces of the curve between its ends; with its two extensions a power of two.
pub const PIECES: usize = 510;
/// Largest accepted error of a point on the curve, curve units, and of a unit normal. The eye is about one curve unit away
/// from the curve, so both stay far below 0.01 pixel.
const PLACE_ERROR: f64 = 1e-7;
const NORMAL_ERROR: f64 = 1e-6;
/// Halvings that find where the curvature of a piece has a kink.
const HALVINGS: usize = 16;
/// Places of a piece where its error is judged, shares of its length.
const JUDGED: [f64; 3] = [0.25, 0.5, 0.75];
/// Cubic pieces of equal length along the curve for its point and its normal, ours; pieces whose error is too large (at
/// corners of the curve) fall back on the stage itself.
#[derive(Debug)]
pub struct SplineTable<'a> {
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

/// A cubic of the table.
#[derive(Debug, Clone, Copy)]
pub struct TableCubic {
    /// `c[0] + c[1] t + c[2] t^2 + c[3] t^3`, t = 0..1: point (u, v) relative to the pivot in scene units, normal (u, v).
    pub c: [[f64; 4]; 4],
    /// Where it begins, pieces from the near end of the curve.
    pub begins: f64,
    /// How long it is, pieces.
    pub length: f64,
}

/// Point and normal with their derivatives by pieces.
#[derive(Clone, Copy)]
struct Knot {
    value: [f64; 4],
    slope: [f64; 4],
}

impl<'a> SplineTable<'a> {
    /// Tabulates a bend.
    pub fn new(bend: &'a SplineBend) -> Self {
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

    /// Cubics that are close to the curve everywhere: those of the pieces, each cut in two where its curvature has a kink; `None` if that is
    /// not enough for one of them. The first and the last are the straight extensions.
    pub fn cubics(&self) -> Option<Vec<(TableCubic, Option<TableCubic>)>> {
        if self.pieces.len() != PIECES + 2 {
            return None;
        }
        let cubic = |piece: &Piece, [begins, length]: [f64; 2]| TableCubic { c: piece.c, begins, length };
        let of = |(k, piece): (usize, &Piece)| {
            let begins = k.saturating_sub(1) as f64;
            if piece.good {
                return Some((cubic(piece, [begins, 1.0]), None));
            }
            let ([a, b], at) = self.cut(begins)?;
            Some((cubic(&a, [begins, at - begins]), Some(cubic(&b, [at, begins + 1.0 - at]))))
        };
        self.pieces.iter().enumerate().map(of).collect()
    }

    /// Pivot: the origin of the curve's plane.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Right, heading and normal of the reference plane, unit vectors.
    pub fn axes(&self) -> [DVec3; 3] {
        self.axes
    }

    /// Axes of the plane that the curve lies in.
    pub fn curve_axes(&self) -> [DVec3; 2] {
        self.curve_axes
    }

    /// Pieces per scene unit along the curve.
    pub fn pieces_per_unit(&self) -> f64 {
        self.pieces_per_unit
    }

    /// Pieces from the near end of the curve to its origin.
    pub fn piece_of_origin(&self) -> f64 {
        self.piece_of_origin
    }

    /// Displaces points in place; `false` if one of them has no image.
    pub(super) fn row(&self, points: &mut Points<'_>) -> bool {
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
