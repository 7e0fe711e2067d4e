//! A straight line over a grid, seen from above.

use crate::clip_segment;
use belvedere_core::DVec2;
use belvedere_scene::CellTriangle;

/// The segment `start + t * dir`, 0 <= t <= 1, in grid coordinates (x = column, y = row).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridLine {
    /// Where it starts.
    pub start: DVec2,
    /// From there to its end.
    pub dir: DVec2,
}

impl GridLine {
    /// The segment from `a` to `b`.
    pub fn between(a: DVec2, b: DVec2) -> Self {
        Self { start: a, dir: b - a }
    }

    /// The point at a parameter.
    #[inline]
    pub fn at(&self, t: f64) -> DVec2 {
        self.start + t * self.dir
    }

    /// The parameters of its part over a grid of `nodes` (columns, rows), or at most `margin` cells beside it; `None` if
    /// it has no such part, or is not finite.
    pub fn over(&self, nodes: [usize; 2], margin: f64) -> Option<[f64; 2]> {
        if !(self.start.is_finite() && self.dir.is_finite()) {
            return None;
        }
        let high = nodes.map(|n| (n - 1) as f64 + margin);
        let part = clip_segment(self.start.to_array(), self.dir.to_array(), [[-margin; 2], high]);
        (part[0] <= part[1]).then_some(part)
    }

    /// The block (column, row) at parameter `t`, of `size` blocks of `side` cells each, and the parameter at which the line
    /// leaves it. The outermost blocks reach on beside the grid.
    #[inline]
    pub fn block(&self, side: f64, size: [usize; 2], t: f64) -> ([usize; 2], f64) {
        let at = self.at(t) / side;
        let index = |x: f64, n: usize| (x.max(0.0) as usize).min(n - 1);
        let block = [index(at.x, size[0]), index(at.y, size[1])];
        let exit = |axis: usize| {
            let (p, d, i) = (self.start[axis], self.dir[axis], block[axis]);
            if d > 0.0 && i + 1 < size[axis] {
                ((i + 1) as f64 * side - p) / d
            } else if d < 0.0 && i > 0 {
                (i as f64 * side - p) / d
            } else {
                f64::INFINITY
            }
        };
        (block, exit(0).min(exit(1)))
    }

    /// Cuts a part of the line over one cell where it crosses the cell's diagonal: the triangle under each half, which may
    /// be empty, with its parameters.
    #[inline]
    pub fn by_triangle(&self, cell: [usize; 2], [t0, t1]: [f64; 2]) -> [(CellTriangle, [f64; 2]); 2] {
        let start = self.start - DVec2::new(cell[0] as f64, cell[1] as f64);
        let across = self.dir.x - self.dir.y;
        let cut = if across == 0.0 { t1 } else { ((start.y - start.x) / across).clamp(t0, t1) };
        [[t0, cut], [cut, t1]].map(|part| (CellTriangle::at(start + 0.5 * (part[0] + part[1]) * self.dir), part))
    }
}
