//! The displaced ground, and lines of sight over it.

use crate::{Field, GridLine};
use belvedere_core::DVec2;
use belvedere_core::grid::Grid;
use belvedere_scene::CellTriangle;

/// Ground with a vertical displacement: two flat triangles per cell, whose nodes are displaced; or undisplaced.
pub struct DisplacedGround<'a> {
    field: &'a Field,
    /// `None`: nothing is displaced.
    delta: Option<&'a Grid>,
    /// Upper bound of the height, scene units.
    highest: f64,
    table: Option<Table>,
}

/// Tables that lines of sight over one ground share.
struct Table {
    /// Displacement of the nodes.
    moved: Vec<f64>,
    /// Upper bound of the height in each block of [`BLOCK`] x [`BLOCK`] cells.
    highest: Vec<f64>,
    blocks: [usize; 2],
}

/// Cells per side of a block; a line of sight above the block's bound skips it.
const BLOCK: usize = 8;

/// A vertex of a line of sight: grid coordinates and height.
pub type SightVertex = (DVec2, f64);

/// The largest height of the ground over a line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// Height over the line, scene units; any negative number if the ground is below the line everywhere, infinite if there is no line.
    pub over: f64,
    /// Position, grid coordinates; the start of the line where nothing rises over it.
    pub at: DVec2,
}

impl<'a> DisplacedGround<'a> {
    /// Displaced ground.
    ///
    /// * `delta`: displacement upwards, scene units; 0 beside its grid.
    pub fn new(field: &'a Field, delta: &'a Grid) -> Self {
        let highest = field.datum() + field.relief() + delta.range()[1].max(0.0);
        Self { field, delta: Some(delta), highest, table: None }
    }

    /// Undisplaced ground.
    pub fn still(field: &'a Field) -> Self {
        Self { field, delta: None, highest: field.datum() + field.relief(), table: None }
    }

    /// Adds tables that speed up many lines of sight: one pass over the nodes.
    pub fn prepared(mut self) -> Self {
        let [cols, rows] = self.field.nodes();
        let node = |i: usize| self.displacement(DVec2::new((i % cols) as f64, (i / cols) as f64));
        let moved: Vec<f64> = match self.delta {
            Some(_) => (0..cols * rows).map(node).collect(),
            None => Vec::new(),
        };
        let displaced = |i: usize| moved.get(i).copied().unwrap_or(0.0);
        let blocks = [cols, rows].map(|n| (n - 1).div_ceil(BLOCK));
        let height = self.field.heights();
        let top = |b: usize| {
            let [x, y] = [b % blocks[0], b / blocks[0]].map(|k| k * BLOCK);
            let [across, down] = [x..=(x + BLOCK).min(cols - 1), y..=(y + BLOCK).min(rows - 1)];
            let nodes = down.clone().flat_map(|y| across.clone().map(move |x| y * cols + x));
            nodes.map(|i| height[i] + displaced(i)).fold(f64::NEG_INFINITY, f64::max)
        };
        let highest = (0..blocks[0] * blocks[1]).map(top).collect();
        self.table = Some(Table { moved, highest, blocks });
        self
    }

    /// Columns and rows of its nodes.
    pub fn nodes(&self) -> [usize; 2] {
        self.field.nodes()
    }

    fn displacement(&self, g: DVec2) -> f64 {
        self.delta.and_then(|delta| delta.sample(self.field.scene_from_grid(g))).unwrap_or(0.0)
    }

    /// Height at grid coordinates; `None` beside the grid and in holes.
    pub fn height_at(&self, g: DVec2) -> Option<f64> {
        let still = self.field.surface_at(g)?;
        let corner = g.floor().min(DVec2::new((self.field.cols() - 2) as f64, (self.field.rows() - 2) as f64));
        let [col, row] = [corner.x as usize, corner.y as usize];
        Some(still + CellTriangle::at(g - corner).height(self.at_corners([col, row]), g - corner))
    }

    /// Displacement of the corners of a cell: north-west, north-east, south-west, south-east.
    fn at_corners(&self, [col, row]: [usize; 2]) -> [f64; 4] {
        if self.delta.is_none() {
            return [0.0; 4];
        }
        if let Some(table) = &self.table {
            let (cols, nw) = (self.field.cols(), row * self.field.cols() + col);
            return [nw, nw + 1, nw + cols, nw + cols + 1].map(|i| table.moved[i]);
        }
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| self.displacement(DVec2::new((col + x) as f64, (row + y) as f64)))
    }

    /// The largest height of the ground over a line of sight, from the point to the eye.
    ///
    /// * `guard`: ground nearer than this to the point does not count, cells.
    pub fn excess(&self, line: &[SightVertex], guard: f64) -> Excess {
        let [(at, _), _, ..] = *line else { return Excess { over: f64::INFINITY, at: DVec2::ZERO } };
        let mut worst = Excess { over: -1.0, at };
        for pair in line.windows(2) {
            if let Some(from) = beyond(at, guard, pair[0], pair[1]) {
                self.along(from, pair[1], &mut worst);
            }
        }
        worst
    }

    /// Replaces `worst` where a straight part of a line has a larger excess.
    fn along(&self, from: SightVertex, to: SightVertex, worst: &mut Excess) {
        let (line, height) = (GridLine::between(from.0, to.0), (from.1, to.1 - from.1));
        let Some([mut t, last]) = line.over(self.field.nodes(), 0.0) else { return };
        // Steps over the border of a cell in spite of rounding.
        let nudge = 1e-9 * line.dir.abs().max_element().recip().min(1e9);
        while t < last {
            // Above all ground, and rising from here.
            if height.1 >= 0.0 && height.0 + t * height.1 > self.highest {
                break;
            }
            let Some(table) = &self.table else {
                self.in_cells(&line, height, [t, last], nudge, worst);
                break;
            };
            let (block, leave) = line.block(BLOCK as f64, table.blocks, t + nudge);
            let leave = leave.max(t + nudge).min(last);
            let low = height.0 + (t * height.1).min(leave * height.1);
            if table.highest[block[1] * table.blocks[0] + block[0]] - low > worst.over {
                self.in_cells(&line, height, [t, leave], nudge, worst);
            }
            t = if leave > t { leave } else { last };
        }
    }

    /// The same, cell by cell over a part of the line.
    fn in_cells(&self, line: &GridLine, height: (f64, f64), [mut t, last]: [f64; 2], nudge: f64, worst: &mut Excess) {
        let cells = self.field.nodes().map(|n| n - 1);
        while t < last {
            if height.1 >= 0.0 && height.0 + t * height.1 > self.highest {
                break;
            }
            let (cell, leave) = line.block(1.0, cells, t + nudge);
            let leave = leave.max(t + nudge).min(last);
            self.in_cell(line, height, cell, [t, leave], worst);
            t = if leave > t { leave } else { last };
        }
    }

    /// The same over one cell.
    fn in_cell(&self, line: &GridLine, (z, dz): (f64, f64), cell: [usize; 2], part: [f64; 2], worst: &mut Excess) {
        let (cols, corner) = (self.field.cols(), DVec2::new(cell[0] as f64, cell[1] as f64));
        let nw = cell[1] * cols + cell[0];
        let nodes = [nw, nw + 1, nw + cols, nw + cols + 1];
        let mut heights = nodes.map(|i| self.field.heights()[i]);
        let low = (z + part[0] * dz).min(z + part[1] * dz);
        let most = |values: [f64; 4]| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if let Some(delta) = self.delta {
            // Cheaper than the displacement of the corners without a table.
            if self.table.is_none() && most(heights) + delta.range()[1].max(0.0) - low <= worst.over {
                return;
            }
            heights.iter_mut().zip(self.at_corners(cell)).for_each(|(height, moved)| *height += moved);
        }
        if most(heights) - low <= worst.over {
            return;
        }
        for (triangle, [from, to]) in line.by_triangle(cell, part) {
            if to <= from || triangle.corners().iter().any(|&k| self.field.void()[nodes[k]]) {
                continue;
            }
            let slope = triangle.slope(heights);
            // Over a flat triangle the excess is largest at an end.
            for t in [from, to] {
                let at = line.at(t);
                let over = heights[0] + slope.dot(at - corner) - (z + t * dz);
                if over > worst.over {
                    *worst = Excess { over, at };
                }
            }
        }
    }
}

/// The start of the part of a straight line from `a` to `b` that lies beyond `guard` cells of `p`.
fn beyond(p: DVec2, guard: f64, a: SightVertex, b: SightVertex) -> Option<SightVertex> {
    if a.0.distance(p) >= guard {
        return Some(a);
    }
    let (d, f) = (b.0 - a.0, a.0 - p);
    // |f + t d| = guard, the crossing outwards.
    let (aa, bb, cc) = (d.length_squared(), f.dot(d), f.length_squared() - guard * guard);
    let t = (-bb + (bb * bb - aa * cc).max(0.0).sqrt()) / aa;
    (t.is_finite() && t <= 1.0).then(|| (a.0 + t * d, a.1 + t * (b.1 - a.1)))
}
