//! Cheapest paths through voxels: the search that centrelines and ways round what hides share.
//!
//! Source: Dijkstra 1959.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Neighbours of a voxel.
pub(crate) const NEIGHBOURS: usize = 26;

/// Voxels along x, y, z from one to its neighbour of a number below [`NEIGHBOURS`].
pub(crate) fn step(neighbour: usize) -> [isize; 3] {
    // 13 would be no step at all.
    let k = (neighbour + usize::from(neighbour >= 13)) as isize;
    [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]
}

/// Least known cost of every voxel, and the voxels whose neighbours are not tested yet.
pub(crate) struct Frontier {
    cost: Vec<f32>,
    open: BinaryHeap<Reverse<(u32, usize)>>,
}

impl Frontier {
    /// No voxel has a cost yet.
    pub(crate) fn new(voxels: usize) -> Self {
        Self { cost: vec![f32::INFINITY; voxels], open: BinaryHeap::new() }
    }

    /// Lowers the cost of a voxel to `cost`, which is not negative, and returns true if it was higher.
    pub(crate) fn offer(&mut self, voxel: usize, cost: f32) -> bool {
        let lower = cost < self.cost[voxel];
        if lower {
            self.cost[voxel] = cost;
            // Costs are not negative: their bits are in the order of the numbers.
            self.open.push(Reverse((cost.to_bits(), voxel)));
        }
        lower
    }

    /// Takes the cheapest voxel whose neighbours are not tested yet, of equals the first, with its cost.
    pub(crate) fn take(&mut self) -> Option<(usize, f32)> {
        loop {
            let Reverse((bits, voxel)) = self.open.pop()?;
            let cost = f32::from_bits(bits);
            // Else the voxel was taken at a lower cost.
            if cost <= self.cost[voxel] {
                return Some((voxel, cost));
            }
        }
    }

    /// Least known cost of a voxel; infinite if no path leads to it.
    pub(crate) fn cost(&self, voxel: usize) -> f32 {
        self.cost[voxel]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_are_taken_once_in_the_order_of_their_least_costs() {
        let mut frontier = Frontier::new(4);
        for (voxel, cost, lower) in [(2, 5.0, true), (0, 3.0, true), (2, 1.0, true), (2, 4.0, false), (3, 3.0, true)] {
            assert_eq!(frontier.offer(voxel, cost), lower, "{voxel} {cost}");
        }
        let order: Vec<_> = std::iter::from_fn(|| frontier.take()).collect();
        assert_eq!(order, [(2, 1.0), (0, 3.0), (3, 3.0)]);
        assert_eq!(frontier.cost(1), f32::INFINITY);
    }

    #[test]
    fn steps_lead_to_all_neighbours() {
        let mut steps: Vec<[isize; 3]> = (0..NEIGHBOURS).map(step).collect();
        steps.sort_unstable();
        steps.dedup();
        assert!(steps.len() == 26 && !steps.contains(&[0; 3]));
    }
}
