//! The cheapest path through voxels.
//!
//! Source: Dijkstra 1959. A step costs its length over the clearance in it, so that the path keeps to the middle.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Voxels that a path may use.
pub(super) struct Cells<'c> {
    /// Voxels along x, y, z.
    pub(super) dims: [usize; 3],
    /// Edges of voxels, scene units.
    pub(super) spacing: [f64; 3],
    /// Distance to the nearest voxel outside, scene units; 0 = outside.
    pub(super) clearance: &'c [f32],
}

/// The 26 steps to neighbours.
fn steps() -> Vec<[i64; 3]> {
    let all = (0..27i64).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]);
    all.filter(|s| *s != [0; 3]).collect()
}

impl Cells<'_> {
    /// Numbers of the voxels of the cheapest path, both ends included; `None` if there is no path. Of equally cheap paths always the same.
    ///
    /// A diagonal step needs all voxels beside it that share its faces, so that walls one voxel thick are tight.
    pub(super) fn cheapest(&self, from: usize, to: usize) -> Option<Vec<usize>> {
        let [nx, ny, nz] = self.dims;
        let steps = steps();
        let lengths: Vec<f32> = steps
            .iter()
            .map(|s| (0..3).map(|a| (s[a] as f64 * self.spacing[a]).powi(2)).sum::<f64>().sqrt() as f32)
            .collect();
        let mut cost = vec![f32::INFINITY; self.clearance.len()];
        let mut came_by = vec![u8::MAX; self.clearance.len()];
        let mut open = BinaryHeap::new();
        cost[from] = 0.0;
        // Costs are not negative: their bits are in the order of the numbers.
        open.push(Reverse((0u32, from)));
        while let Some(Reverse((bits, at))) = open.pop() {
            if at == to {
                break;
            }
            if f32::from_bits(bits) > cost[at] {
                continue;
            }
            let here = [at % nx, at / nx % ny, at / nx / ny].map(|v| v as i64);
            let offset = |s: [i64; 3]| -> Option<usize> {
                let q: [i64; 3] = std::array::from_fn(|a| here[a] + s[a]);
                let within = q[0] >= 0 && q[1] >= 0 && q[2] >= 0;
                let within = within && q[0] < nx as i64 && q[1] < ny as i64 && q[2] < nz as i64;
                let next = (q[2] * ny as i64 + q[1]) * nx as i64 + q[0];
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
                let sum = f32::from_bits(bits) + price;
                if sum < cost[next] {
                    (cost[next], came_by[next]) = (sum, k as u8);
                    open.push(Reverse((sum.to_bits(), next)));
                }
            }
        }
        if cost[to] == f32::INFINITY {
            return None;
        }
        let mut way = vec![to];
        let mut at = to as i64;
        while at as usize != from {
            let [x, y, z] = steps[usize::from(came_by[at as usize])];
            at -= (z * ny as i64 + y) * nx as i64 + x;
            way.push(at as usize);
        }
        way.reverse();
        Some(way)
    }
}
