//! A straight line over a grid, seen from above.

use crate::clip_segment;
use belvedere_core::DVec2;
use belvedere_scene::CellTriangle;

/// The segment `start + t * dir`, 0 <= t <= 1, in grid coordinates (x = column, y = row).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridLine {
    /// Start, grid coordinates.
    pub start: DVec2,
    /// Vector from start to end, cells.
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
    /// leaves it, which is greater than `t`. The outermost blocks extend beyond the grid.
    #[inline]
    pub fn block(&self, side: f64, size: [usize; 2], t: f64) -> ([usize; 2], f64) {
        let at = self.at(t) / side;
        let index = |x: f64, n: usize| (x.max(0.0) as usize).min(n - 1);
        let mut block = [index(at.x, size[0]), index(at.y, size[1])];
        let exit = |axis: usize, i: usize| {
            let (p, d) = (self.start[axis], self.dir[axis]);
            if d > 0.0 && i + 1 < size[axis] {
                ((i + 1) as f64 * side - p) / d
            } else if d < 0.0 && i > 0 {
                (i as f64 * side - p) / d
            } else {
                f64::INFINITY
            }
        };
        let mut exits = [exit(0, block[0]), exit(1, block[1])];
        for axis in [0, 1] {
            // On a border, up to rounding, the line counts as in the block that it enters.
            if exits[axis] <= t {
                block[axis] = if self.dir[axis] > 0.0 { block[axis] + 1 } else { block[axis] - 1 };
                exits[axis] = exit(axis, block[axis]);
            }
        }
        (block, exits[0].min(exits[1]))
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

    /// Visits the crossings of a part of the line with a family of edges of the triangles over a grid of `nodes` (columns,
    /// rows): parameter, point and edge.
    ///
    /// * `slack`: distance beyond the ends of the part, cells, within which grid lines still count.
    #[inline]
    pub fn crossings(
        &self,
        nodes: [usize; 2],
        family: EdgeFamily,
        [from, to]: [f64; 2],
        slack: f64,
        mut visit: impl FnMut(f64, DVec2, Edge),
    ) {
        let (start, dir) = (family.coordinate(self.start), family.coordinate(self.dir));
        if dir == 0.0 {
            return;
        }
        let [a, b] = [from, to].map(|t| family.coordinate(self.at(t)));
        let (mut k, last) = (-floor(slack - a.min(b)), floor(a.max(b) + slack));
        while k <= last {
            let t = (k - start) / dir;
            let mut at = self.at(t);
            match family {
                EdgeFamily::Columns => at.x = k,
                EdgeFamily::Rows => at.y = k,
                EdgeFamily::Diagonals => {}
            }
            if let Some(edge) = Edge::crossed(nodes, family, k, at) {
                visit(t, at, edge);
            }
            k += 1.0;
        }
    }
}

/// Edges of triangles that lie on parallel lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeFamily {
    /// On lines x = k.
    Columns,
    /// On lines y = k.
    Rows,
    /// On lines x - y = k.
    Diagonals,
}

impl EdgeFamily {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Columns, Self::Rows, Self::Diagonals];

    /// The coordinate that is a whole number on the lines of the family.
    #[inline]
    pub fn coordinate(self, p: DVec2) -> f64 {
        match self {
            Self::Columns => p.x,
            Self::Rows => p.y,
            Self::Diagonals => p.x - p.y,
        }
    }
}

/// A point on an edge between two nodes of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// The northern or western end, row-major.
    pub first: usize,
    /// The other end.
    pub second: usize,
    /// Share of the other end, 0..=1.
    pub weight: f64,
}

impl Edge {
    /// The edge at a point of line `k` of a family; the nearest one on the line if the point lies beside the grid. `None` on
    /// diagonals without edges, those of the north-east and south-west corners.
    #[inline]
    pub fn crossed(nodes: [usize; 2], family: EdgeFamily, k: f64, at: DVec2) -> Option<Self> {
        let last = nodes.map(|n| (n - 1) as f64);
        // The coordinate that runs along the edges, and where the first and the last of them begin.
        let (along, first, end) = match family {
            EdgeFamily::Columns => (at.y, 0.0, last[1] - 1.0),
            EdgeFamily::Rows => (at.x, 0.0, last[0] - 1.0),
            EdgeFamily::Diagonals => (at.x, k.max(0.0), last[0].min(last[1] + k) - 1.0),
        };
        if first > end {
            return None;
        }
        let start = floor(along).clamp(first, end);
        let (col, row, step) = match family {
            EdgeFamily::Columns => (k.clamp(0.0, last[0]), start, nodes[0]),
            EdgeFamily::Rows => (start, k.clamp(0.0, last[1]), 1),
            EdgeFamily::Diagonals => (start, start - k, nodes[0] + 1),
        };
        let first = row as usize * nodes[0] + col as usize;
        Some(Self { first, second: first + step, weight: (along - start).clamp(0.0, 1.0) })
    }

    /// Value there of a field given at the nodes.
    #[inline]
    pub fn of(&self, values: &[f64]) -> f64 {
        let [a, b] = [self.first, self.second].map(|n| values[n]);
        a + self.weight * (b - a)
    }
}

/// Largest whole number up to `x`, for coordinates: `f64::floor` is a slower call on processors without that instruction.
#[inline]
pub fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_hardly_leave_a_border_walk_from_block_to_block() {
        for drift in [-1e-15, 1e-15, -1e-300, 0.0] {
            for dir in [DVec2::new(drift, 5.0), DVec2::new(5.0, drift), DVec2::new(drift, -5.0)] {
                let line = GridLine { start: DVec2::splat(7.0), dir };
                let (mut t, mut steps) = (0.0, 0);
                while t <= 1.0 {
                    let (block, exit) = line.block(1.0, [16, 16], t + 1e-10);
                    assert!(exit > t && block.into_iter().all(|i| (1..=12).contains(&i)), "{line:?}: {block:?} at {t}");
                    (t, steps) = (exit, steps + 1);
                }
                assert!(steps <= 7, "{line:?}: {steps} blocks");
            }
        }
    }
}
