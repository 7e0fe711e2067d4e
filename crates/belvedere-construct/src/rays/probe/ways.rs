//! Cheapest paths through free cells, from cells that the eye sees to those that it does not.
//!
//! Source: Dijkstra 1959, on cells that know in which direction the path to them arrives, so that turning has a price.

use super::voxels::Voxels;
use crate::frontier::{Frontier, NEIGHBOURS, step};
use belvedere_core::DVec3;
use belvedere_scene::{Cancelled, Progress};

/// A step turns from the one before by at most this angle, cosine: 60 degrees.
const LEAST_COSINE: f64 = 0.499;
/// Marks cells that are reached straight from the eye.
const FROM_EYE: u8 = u8::MAX;
/// Marks cells that no path reaches.
const UNREACHED: u8 = u8::MAX - 1;

/// Cost of paths beside their length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Price {
    /// Clearance needed for a unit of length from the eye.
    pub(super) clearance_per_length: f64,
    /// Length that a turn of a radian costs, scene units.
    pub(super) per_radian: f64,
    /// Clearance at which a unit of length costs twice as much, scene units.
    pub(super) tight: f64,
    /// Greatest length of a path, scene units.
    pub(super) longest: f64,
}

/// The cheapest path to every cell that can be reached.
pub(super) struct Ways<'a> {
    voxels: &'a Voxels,
    eye: DVec3,
    frontier: Frontier,
    length: Vec<f32>,
    /// Number of the direction of arrival.
    arrival: Vec<u8>,
}

impl<'a> Ways<'a> {
    /// Finds the cheapest paths that begin with a straight line from `eye` to one of the cells `seen`.
    ///
    /// Of all paths to a cell only the cheapest is continued, though a dearer one might turn less in the next step.
    pub(super) fn new(
        voxels: &'a Voxels,
        eye: DVec3,
        seen: &[usize],
        price: &Price,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let cells = voxels.len();
        let (frontier, length) = (Frontier::new(cells), vec![f32::INFINITY; cells]);
        let mut ways = Self { voxels, eye, frontier, length, arrival: vec![UNREACHED; cells] };
        for &cell in seen {
            let length = voxels.center(cell).distance(eye);
            let room = voxels.clearance(cell);
            if room > 0.0 && room >= price.clearance_per_length * length && length <= price.longest {
                let cost = length as f32;
                ways.frontier.offer(cell, cost);
                (ways.length[cell], ways.arrival[cell]) = (cost, FROM_EYE);
            }
        }
        let units: [DVec3; NEIGHBOURS] = std::array::from_fn(|d| unit(step(d)));
        let mut done = 0usize;
        while let Some((cell, cost)) = ways.frontier.take() {
            done += 1;
            if done.is_multiple_of(1 << 14) {
                progress.tick("looking for ways round what hides", done as f64 / cells as f64)?;
            }
            let arrival = ways.arrival(cell);
            for (direction, u) in units.iter().enumerate() {
                let cosine = u.dot(arrival);
                if cosine > LEAST_COSINE {
                    let turned = price.per_radian * cosine.min(1.0).acos();
                    ways.step(cell, direction, f64::from(cost) + turned, price);
                }
            }
        }
        Ok(ways)
    }

    /// Tries a step from a cell, the path to which costs `cost`.
    fn step(&mut self, from: usize, direction: usize, cost: f64, price: &Price) {
        let by = step(direction);
        let Some(cell) = self.voxels.neighbour(from, by) else { return };
        let way = self.voxels.cell() * DVec3::from_array(by.map(|v| v as f64)).length();
        let (length, room) = (f64::from(self.length[from]) + way, self.voxels.clearance(cell));
        if room <= 0.0 || room < price.clearance_per_length * length || length > price.longest {
            return;
        }
        if self.frontier.offer(cell, (cost + way * (1.0 + price.tight / room)) as f32) {
            (self.length[cell], self.arrival[cell]) = (length as f32, direction as u8);
        }
    }

    /// Cells that paths lead to.
    pub(super) fn reached(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.arrival.len()).filter(|i| self.arrival[*i] != UNREACHED)
    }

    /// Cost of the cheapest path to a cell.
    pub(super) fn cost(&self, cell: usize) -> f64 {
        f64::from(self.frontier.cost(cell))
    }

    /// Unit direction in which the cheapest path arrives at a cell.
    pub(super) fn arrival(&self, cell: usize) -> DVec3 {
        match self.arrival[cell] {
            FROM_EYE | UNREACHED => (self.voxels.center(cell) - self.eye).normalize_or(DVec3::Y),
            direction => unit(step(usize::from(direction))),
        }
    }

    /// Middles of the cells of the cheapest path, from the last that the eye sees straight.
    pub(super) fn points(&self, end: usize) -> Vec<DVec3> {
        let mut points = vec![self.voxels.center(end)];
        let mut at = end;
        while !matches!(self.arrival[at], FROM_EYE | UNREACHED) {
            let back = step(usize::from(self.arrival[at])).map(|v| -v);
            let Some(cell) = self.voxels.neighbour(at, back) else { break };
            points.push(self.voxels.center(cell));
            at = cell;
        }
        points.reverse();
        points
    }
}

fn unit(step: [isize; 3]) -> DVec3 {
    DVec3::from_array(step.map(|v| v as f64)).normalize()
}

#[cfg(test)]
mod tests;
