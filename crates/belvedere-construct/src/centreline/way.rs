//! The cheapest path through voxels.
//!
//! Source: Dijkstra 1959. A step costs its length over the clearance in it, so that the path keeps to the middle.

use crate::frontier::{Frontier, NEIGHBOURS, step};

/// Voxels that a path may use.
pub(super) struct Cells<'c> {
    /// Voxels along x, y, z.
    pub(super) dims: [usize; 3],
    /// Edges of voxels, scene units.
    pub(super) spacing: [f64; 3],
    /// Distance to the nearest voxel outside, scene units; 0 = outside.
    pub(super) clearance: &'c [f32],
}

impl Cells<'_> {
    /// Numbers of the voxels of the cheapest path, both ends included; `None` if there is no path. Of equally cheap paths always the same.
    ///
    /// A diagonal step needs all voxels beside it that share its faces, so that walls one voxel thick are tight.
    pub(super) fn cheapest(&self, from: usize, to: usize) -> Option<Vec<usize>> {
        let [nx, ny, nz] = self.dims;
        let steps: [[isize; 3]; NEIGHBOURS] = std::array::from_fn(step);
        let lengths = steps.map(|s| (0..3).map(|a| (s[a] as f64 * self.spacing[a]).powi(2)).sum::<f64>().sqrt() as f32);
        let mut frontier = Frontier::new(self.clearance.len());
        let mut came_by = vec![u8::MAX; self.clearance.len()];
        frontier.offer(from, 0.0);
        while let Some((at, cost)) = frontier.take() {
            if at == to {
                break;
            }
            let here = [at % nx, at / nx % ny, at / nx / ny].map(|v| v as isize);
            let offset = |s: [isize; 3]| -> Option<usize> {
                let q: [isize; 3] = std::array::from_fn(|a| here[a] + s[a]);
                let within = q[0] >= 0 && q[1] >= 0 && q[2] >= 0;
                let within = within && q[0] < nx as isize && q[1] < ny as isize && q[2] < nz as isize;
                let next = (q[2] * ny as isize + q[1]) * nx as isize + q[0];
                within.then_some(next as usize).filter(|i| self.clearance[*i] > 0.0)
            };
            for (k, step) in steps.iter().enumerate() {
                let Some(next) = offset(*step) else { continue };
                let open_beside = |axis: usize| {
                    let mut alone = [0; 3];
                    alone[axis] = step[axis];
                    step[axis] == 0 || offset(alone).is_some()
                };
                if !(open_beside(0) && open_beside(1) && open_beside(2)) {
                    continue;
                }
                let price = 2.0 * lengths[k] / (self.clearance[at] + self.clearance[next]);
                if frontier.offer(next, cost + price) {
                    came_by[next] = k as u8;
                }
            }
        }
        if frontier.cost(to) == f32::INFINITY {
            return None;
        }
        let mut way = vec![to];
        let mut at = to as isize;
        while at as usize != from {
            let [x, y, z] = steps[usize::from(came_by[at as usize])];
            at -= (z * ny as isize + y) * nx as isize + x;
            way.push(at as usize);
        }
        way.reverse();
        Some(way)
    }
}
