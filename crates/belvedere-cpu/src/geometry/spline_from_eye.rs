//! A spline bend in single precision.

use belvedere_core::DVec3;
use belvedere_sight::pass::{PIECES, SplineTable, TableCubic};

/// Entries of the table: pieces, and second parts of pieces that are cut.
const ENTRIES: usize = 1024;

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
    /// The table as seen from the eye; `None` if one of its pieces is not close enough to the curve.
    pub(crate) fn new(table: &SplineTable<'_>, eye: DVec3) -> Option<Self> {
        let cubics = table.cubics()?;
        let offset = eye - table.origin();
        let [right, heading, normal] = table.axes().map(|axis| axis.dot(offset));
        let at_eye = heading * table.pieces_per_unit() + table.piece_of_origin();
        let in_plane = table.curve_axes().map(|axis| axis.dot(right * table.axes()[0] - offset));
        // A cubic in powers of the position from `from` on, in pieces.
        let entry = |cubic: &TableCubic, from: f64| {
            let TableCubic { begins, length, .. } = *cubic;
            let [u, v, nu, nv] = cubic.c.map(|[a, b, c, d]| {
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
        for (k, (first, second)) in cubics.iter().enumerate() {
            let from = match k {
                // Extensions are straight: they begin at the eye where that is beside the curve, for small numbers there.
                0 => at_eye.min(0.0),
                _ if k == PIECES + 1 => at_eye.max(PIECES as f64),
                _ => first.begins,
            };
            entries[k] = entry(first, from);
            if let Some(second) = second {
                *entries.get_mut(used)? = entry(second, second.begins);
                used += 1;
                entries[k] = PieceFromEye { until: (second.begins - at_eye) as f32, next: used - 1, ..entries[k] };
            }
        }
        Some(Self {
            right: table.axes()[0],
            heading_pieces: table.axes()[1] * table.pieces_per_unit(),
            normal: table.axes()[2],
            curve_axes: table.curve_axes(),
            at_eye: at_eye as f32,
            entries: entries.into_boxed_slice().try_into().ok()?,
        })
    }

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
