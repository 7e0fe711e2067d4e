//! Squares of the ground, blocks of its tree and smaller, whose cells are judged together.

use crate::geometry::lod::{Tree, nodes};
use crate::raster::cells::SIDE;
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::{Heightfield, NodeState};

/// A square of the ground, cut off at its east and south border.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    /// First and last node.
    from: [usize; 2],
    to: [usize; 2],
    /// Nodes from side to side, before it is cut off: a power of two.
    reach: usize,
    /// Nodes from side to side of a cell.
    step: usize,
}

impl Part {
    /// A block at a level of detail.
    pub(crate) fn of_block(hf: &Heightfield, level: usize, block: [usize; 2]) -> Self {
        let (from, to) = nodes(hf, level, block);
        Self { from, to, reach: SIDE << level, step: 1 << level }
    }

    /// Cells along its longer side.
    pub(crate) fn cells(&self) -> usize {
        let [x, y] = [0, 1].map(|axis| self.to[axis] - self.from[axis]);
        x.max(y).div_ceil(self.step)
    }

    /// Its four quarters, fewer at the border of the ground.
    pub(crate) fn quarters(self) -> impl Iterator<Item = Part> {
        let reach = self.reach / 2;
        [[0, 0], [1, 0], [0, 1], [1, 1]].into_iter().filter_map(move |offset| {
            let from = [0, 1].map(|axis| self.from[axis] + reach * offset[axis]);
            let to = [0, 1].map(|axis| self.to[axis].min(from[axis] + reach));
            (from[0] < self.to[0] && from[1] < self.to[1]).then_some(Part { from, to, reach, ..self })
        })
    }

    /// Bounding box of its ground; `None` where all nodes are voids.
    /// * `around`: bounds of a larger part.
    pub(crate) fn bounds(&self, hf: &Heightfield, tree: &Tree, around: &Aabb) -> Option<Aabb> {
        let level = (self.reach / SIDE).checked_ilog2();
        if let Some(level) = level {
            return tree.bounds(hf, level as usize, self.from.map(|node| node / self.reach));
        }
        let rows =
            || (self.from[1]..=self.to[1]).map(|row| row * hf.cols() + self.from[0]..=row * hf.cols() + self.to[0]);
        let holes = hf.states().each().is_some_and(|s| rows().any(|row| s[row].contains(&NodeState::Void)));
        let mut z = [around.min.z, around.max.z];
        if !holes {
            let heights = rows().flat_map(|row| &hf.heights()[row]);
            z = heights.fold([f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], &h| [lo.min(h), hi.max(h)]).map(f64::from);
        }
        let (nw, se) = (hf.node_xy(self.from[0], self.from[1]), hf.node_xy(self.to[0], self.to[1]));
        Some(Aabb { min: DVec3::new(nw.x, se.y, z[0]), max: DVec3::new(se.x, nw.y, z[1]) })
    }
}
