//! Heights between the nodes of a grid.

use glam::DVec2;

/// A grid of heights (NaN = void, infinite = no source covers it), row-major, bilinear between its nodes.
#[derive(Clone, Copy)]
pub(super) struct Bilinear<'a> {
    heights: &'a [f32],
    cols: usize,
    /// First column and row of the last cell.
    last_cell: [usize; 2],
    /// Last node.
    last: DVec2,
    margin: f64,
}

impl<'a> Bilinear<'a> {
    /// * `margin`: distance outside the grid, cells, up to which the height at its border is taken.
    pub(super) fn new(heights: &'a [f32], [cols, rows]: [usize; 2], margin: f64) -> Self {
        let last = DVec2::new((cols - 1) as f64, (rows - 1) as f64);
        Self { heights, cols, last_cell: [cols - 2, rows - 2], last, margin }
    }

    /// Height at a fractional node. If one of the four nodes around it has none: NaN, or infinite if the nearest is covered by no source.
    /// Infinite beyond the margin.
    #[inline(always)]
    pub(super) fn at(&self, index: DVec2) -> f32 {
        let (margin, last) = (self.margin, self.last);
        let inside =
            index.x >= -margin && index.y >= -margin && index.x <= last.x + margin && index.y <= last.y + margin;
        if !inside {
            return f32::INFINITY; // NaN indices too
        }
        let (i, u, v) = self.cell(index);
        let (top, bottom) = (&self.heights[i..i + 2], &self.heights[i + self.cols..i + self.cols + 2]);
        let upper = top[0] + (top[1] - top[0]) * u;
        let lower = bottom[0] + (bottom[1] - bottom[0]) * u;
        let height = upper + (lower - upper) * v;
        if height.is_finite() {
            return height;
        }
        let nearest = if v >= 0.5 { bottom } else { top }[usize::from(u >= 0.5)];
        if nearest.is_infinite() { f32::INFINITY } else { f32::NAN }
    }

    /// Smallest and largest of the four heights around a fractional node.
    #[inline(always)]
    pub(super) fn range_around(&self, index: DVec2) -> [f32; 2] {
        let (i, _, _) = self.cell(index);
        let (top, bottom) = (&self.heights[i..i + 2], &self.heights[i + self.cols..i + self.cols + 2]);
        let low = top[0].min(top[1]).min(bottom[0].min(bottom[1]));
        [low, top[0].max(top[1]).max(bottom[0].max(bottom[1])).max(low)]
    }

    /// Index of the first of the four nodes around a fractional node, clamped to the grid, and the fractions.
    #[inline(always)]
    fn cell(&self, index: DVec2) -> (usize, f32, f32) {
        let (x, y) = (index.x.clamp(0.0, self.last.x), index.y.clamp(0.0, self.last.y));
        // 32 bits are enough for a column or row, and converted faster than 64.
        let (c, r) = ((x as u32).min(self.last_cell[0] as u32), (y as u32).min(self.last_cell[1] as u32));
        (r as usize * self.cols + c as usize, (x - f64::from(c)) as f32, (y - f64::from(r)) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOLE: f32 = f32::NAN;
    const NOTHING: f32 = f32::INFINITY;

    #[test]
    fn heights_between_nodes_at_the_border_and_beside_holes() {
        let heights = [0.0, 10.0, 20.0, 40.0, 50.0, HOLE, 80.0, 90.0, NOTHING];
        let grid = Bilinear::new(&heights, [3, 3], 0.25);
        let at = |x: f64, y: f64| grid.at(DVec2::new(x, y));
        assert_eq!([at(0.0, 0.0), at(0.5, 0.0), at(0.0, 0.5), at(0.5, 0.5)], [0.0, 5.0, 20.0, 25.0]);
        assert_eq!([at(-0.2, 0.0), at(0.0, 2.2), at(0.5, 2.0)], [0.0, 80.0, 85.0], "within the margin");
        for (x, y) in [(-0.3, 0.0), (0.0, -0.3), (2.3, 0.0), (0.0, 2.3), (f64::NAN, 1.0), (1.0, f64::NAN)] {
            assert_eq!(at(x, y), NOTHING, "{x}, {y} lies outside");
        }
        assert!(at(1.9, 0.9).is_nan() && at(1.2, 0.2).is_nan(), "beside a hole");
        assert_eq!(at(1.9, 1.9), NOTHING, "nothing covers the nearest node");
        assert_eq!(grid.range_around(DVec2::new(0.5, 1.5)), [40.0, 90.0]);
    }
}
