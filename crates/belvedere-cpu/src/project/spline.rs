//! A spline bend in single precision, measured from the eye.

use super::cameras::{Camera, Form, Image, Images, Perspective};
use crate::spline_table::{PIECES, SplineTable};
use crate::vector::nearest;
use belvedere_core::Pinhole;
use belvedere_core::map::spline::SplineBend;

/// A piece of the curve.
#[derive(Debug, Clone, Copy)]
struct Piece {
    /// `c[0] + c[1] t + c[2] t^2 + c[3] t^3`: place in the plane of the curve from the eye at the height of the eye, and what a
    /// unit of height adds.
    c: [[f32; 4]; 4],
    /// Where the piece begins, from the eye along the heading.
    start: f32,
    good: bool,
}

/// Places along the curve, on it and over it.
#[derive(Debug)]
pub(super) struct Spline {
    /// To the right, along the heading and up, from the eye.
    axes: [Form; 3],
    pieces_per_unit: f32,
    /// Pieces from the near end of the curve to the eye.
    eye: f32,
    pieces: Vec<Piece>,
    /// View space from what lies to the right and along both axes of the plane of the curve.
    view: [[f32; 3]; 3],
}

impl Spline {
    /// `None` for a curve without a table.
    pub(super) fn new(bend: &SplineBend, p: &Pinhole) -> Option<Self> {
        let table = SplineTable::new(bend);
        let from_origin = p.eye - table.origin;
        let [right, heading, normal] = table.axes;
        let plane = table.curve_axes;
        let (ahead, above) = (from_origin.dot(heading), from_origin.dot(normal));
        let beside = plane.map(|axis| from_origin.dot(axis));
        let piece = |(k, piece): (usize, &crate::spline_table::Piece)| {
            // The straight extensions begin at the ends of the curve.
            let from = k.clamp(1, PIECES + 1) as f64 - 1.0;
            let [u, v, nu, nv] = piece.c;
            let over = |place: [f64; 4], normal: [f64; 4], eye: f64| {
                let at_eye: [f64; 4] = std::array::from_fn(|i| place[i] + above * normal[i]);
                [at_eye[0] - eye, at_eye[1], at_eye[2], at_eye[3]]
            };
            let curves = [over(u, nu, beside[0]), over(v, nv, beside[1]), nu, nv];
            Piece {
                c: std::array::from_fn(|power| curves.map(|c| c[power] as f32)),
                start: ((from - table.piece_of_origin) * table.piece_length - ahead) as f32,
                good: piece.good,
            }
        };
        let pieces: Vec<Piece> = table.pieces.iter().enumerate().map(piece).collect();
        let view =
            [p.right, p.down, p.forward].map(|axis| [right, plane[0], plane[1]].map(|along| axis.dot(along) as f32));
        (pieces.len() == PIECES + 2).then(|| Self {
            axes: [right, heading, normal].map(|axis| Form::new(axis, 0.0)),
            pieces_per_unit: table.pieces_per_unit as f32,
            eye: (ahead * table.pieces_per_unit + table.piece_of_origin) as f32,
            pieces,
            view,
        })
    }
}

/// A camera that looks along a spline.
pub(super) struct Splined<'p, 'a> {
    pub(super) straight: Perspective<'p, 'a>,
    pub(super) spline: &'p Spline,
    /// What all nodes of the row share.
    rows: [f32; 3],
    ortho: bool,
}

impl<'p, 'a> Splined<'p, 'a> {
    #[inline(always)]
    pub(super) fn new(straight: Perspective<'p, 'a>, spline: &'p Spline, y: f32, ortho: bool) -> Self {
        Self { straight, spline, rows: spline.axes.map(|f| f.row(y)), ortho }
    }

    #[inline(always)]
    fn photograph(&self, v: [f32; 3]) -> Image {
        let scale = self.straight.projector.scale;
        if self.ortho {
            return self.straight.photograph(v, scale, -v[2]);
        }
        let q = 1.0 / v[2];
        self.straight.photograph(v, scale * q, q)
    }
}

impl Camera for Splined<'_, '_> {
    #[inline(always)]
    fn images<const N: usize>(&self, xs: &[f32; N], zs: &[f32; N]) -> Images<N> {
        const LAST: f32 = PIECES as f32 + 0.4;
        let [right, heading, normal] = &self.spline.axes;
        let (mut across, mut along, mut up, mut piece) = ([0.0; N], [0.0; N], [0.0; N], [0; N]);
        for i in 0..N {
            across[i] = right.at(self.rows[0], xs[i], zs[i]);
            along[i] = heading.at(self.rows[1], xs[i], zs[i]);
            up[i] = normal.at(self.rows[2], xs[i], zs[i]);
            let x = along[i] * self.spline.pieces_per_unit + self.spline.eye;
            let x = if x > -0.9 { x } else { -0.9 };
            // On the end of a piece, either of the two will do.
            piece[i] = nearest((if x < LAST { x } else { LAST }) - 0.5) + 1;
        }
        let (mut place, mut bad) = ([[0.0f32; 4]; N], [0; N]);
        for i in 0..N {
            let Piece { c, start, good } = &self.spline.pieces[(piece[i] as usize).min(PIECES + 1)];
            let t = (along[i] - start) * self.spline.pieces_per_unit;
            for k in 0..4 {
                place[i][k] = c[0][k] + t * (c[1][k] + t * (c[2][k] + t * c[3][k]));
            }
            bad[i] = u32::from(!good);
        }
        let (mut over, mut out) = ([[0.0; N]; 2], Images::default());
        for i in 0..N {
            over[0][i] = place[i][0] + up[i] * place[i][2];
            over[1][i] = place[i][1] + up[i] * place[i][3];
        }
        let [right, down, forward] = self.spline.view;
        for i in 0..N {
            let (r, u, v) = (across[i], over[0][i], over[1][i]);
            let x = (r * right[0] + u * right[1]) + v * right[2];
            let y = (r * down[0] + u * down[1]) + v * down[2];
            let z = (r * forward[0] + u * forward[1]) + v * forward[2];
            let (x, y, q, missed) = self.photograph([x, y, z]);
            (out.x[i], out.y[i], out.q[i], out.missed[i]) = (x, y, q, missed | bad[i]);
        }
        out
    }
}
