//! How a cell of terrain is drawn: two triangles that share the diagonal from its north-west to its south-east corner.

use belvedere_core::DVec2;

/// One of the two triangles of a cell.
///
/// Corners of a cell are given in this order: north-west, north-east, south-west, south-east. Positions in a cell are
/// fractions of it, x towards east and y towards south, 0..=1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellTriangle {
    /// Holds the north-east corner.
    NorthEast,
    /// Holds the south-west corner.
    SouthWest,
}

impl CellTriangle {
    /// The triangle at fractions of a cell; on the diagonal, where both meet, the south-western one.
    #[inline]
    pub fn at(fractions: DVec2) -> Self {
        if fractions.x > fractions.y { Self::NorthEast } else { Self::SouthWest }
    }

    /// Indices of its corners among those of the cell.
    #[inline]
    pub const fn corners(self) -> [usize; 3] {
        match self {
            Self::NorthEast => [0, 1, 3],
            Self::SouthWest => [0, 2, 3],
        }
    }

    /// Weights of its [`CellTriangle::corners`] at fractions of the cell; linear also outside the triangle.
    #[inline]
    pub fn weights(self, fractions: DVec2) -> [f64; 3] {
        let (u, v) = (fractions.x, fractions.y);
        match self {
            Self::NorthEast => [1.0 - u, u - v, v],
            Self::SouthWest => [1.0 - v, v - u, u],
        }
    }

    /// Row-major indices of the nodes around grid coordinates (column, row; clamped into the grid), with their weights.
    ///
    /// * `nodes`: columns and rows, at least 2 each.
    pub fn nodes_around([cols, rows]: [usize; 2], g: DVec2) -> [(usize, f64); 3] {
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n.saturating_sub(2));
        let (col, row) = (index(g.x, cols), index(g.y, rows));
        let fractions = (g - DVec2::new(col as f64, row as f64)).clamp(DVec2::ZERO, DVec2::ONE);
        let (triangle, nw) = (Self::at(fractions), row * cols + col);
        let corner = |k: usize| nw + [0, 1, cols, cols + 1][k];
        let (corners, weights) = (triangle.corners(), triangle.weights(fractions));
        [0, 1, 2].map(|k| (corner(corners[k]), weights[k]))
    }

    /// Height of its plane at fractions of a cell with four corner heights.
    #[inline]
    pub fn height(self, heights: [f64; 4], fractions: DVec2) -> f64 {
        let ([a, b, c], w) = (self.corners(), self.weights(fractions));
        w[0] * heights[a] + w[1] * heights[b] + w[2] * heights[c]
    }

    /// Change of its height per column (x, towards east) and per row (y, towards south).
    #[inline]
    pub fn slope(self, [nw, ne, sw, se]: [f64; 4]) -> DVec2 {
        match self {
            Self::NorthEast => DVec2::new(ne - nw, se - ne),
            Self::SouthWest => DVec2::new(se - sw, sw - nw),
        }
    }

    /// Height of the drawn surface at fractions of a cell; `None` in a triangle one of whose corners is void.
    ///
    /// The diagonal belongs to both triangles: it has a height if one of them has.
    #[inline]
    pub fn surface(corners: [Option<f64>; 4], fractions: DVec2) -> Option<f64> {
        let height = |triangle: Self| {
            let [a, b, c] = triangle.corners().map(|k| corners[k]);
            let w = triangle.weights(fractions);
            Some(w[0] * a? + w[1] * b? + w[2] * c?)
        };
        match Self::at(fractions) {
            Self::SouthWest if fractions.x == fractions.y => {
                height(Self::NorthEast).or_else(|| height(Self::SouthWest))
            }
            triangle => height(triangle),
        }
    }
}
