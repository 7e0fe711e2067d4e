//! A chain of corners that rays are led round, and the camera that does it.

use super::super::turns::{Corner, HAIRPIN, STRAIGHT, TRANSITION, TurnShape, largest, smoothstep, turns};
use super::voxels::Voxels;
use belvedere_core::map::curved_rays::{Model, Sharpness};
use belvedere_core::{CurvedRays, DVec3, Stage, View};

/// Range of the length of transitions, shares of the usual length.
const LENGTHS: [f64; 2] = [1e-3, 1.0];

/// Distance from the last corner to the point that the rays look at, cells.
const AHEAD_CELLS: f64 = 12.0;

/// The corners at which rays turn, and the point that they look at in the end.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    /// The corners, then a point ahead of the last leg; at least two points.
    pub(super) points: Vec<DVec3>,
    pub(super) shape: TurnShape,
    /// Clearance that the path keeps, per unit of its length.
    pub(super) clearance_per_length: f64,
}

impl Chain {
    /// The path `points` (from the first that the eye sees), continued in the direction `look`, with as few corners as its clearance
    /// allows; `None` if it needs no corner, turns by more than `HAIRPIN`, or has more than `most` corners.
    pub(super) fn simplified(
        eye: DVec3,
        points: &[DVec3],
        look: DVec3,
        voxels: &Voxels,
        per_length: f64,
        most: usize,
    ) -> Option<Self> {
        let all: Vec<DVec3> = std::iter::once(eye).chain(points.iter().copied()).collect();
        let last = all.len() - 1;
        let (mut at, mut length, mut kept) = (0, 0.0, Vec::new());
        while at < last {
            let free = |to: &usize| voxels.is_free(all[at], all[*to], length, per_length);
            // Neighbouring cells of the path are free of each other in any case.
            let next = (at + 2..=last).rev().find(free).unwrap_or(at + 1);
            length += all[at].distance(all[next]);
            kept.push(all[next]);
            at = next;
        }
        let behind = kept.first()?.distance(eye);
        let end = *kept.last()?;
        kept.push(end + AHEAD_CELLS * voxels.cell() * look);
        let shape = TurnShape { behind, length: LENGTHS[1], m: Sharpness::Bend };
        let chain = Self { points: kept, shape, clearance_per_length: per_length };
        let corners = chain.corners(eye, f64::INFINITY)?;
        (1..=most).contains(&corners.len()).then_some(chain)
    }

    /// Whether every leg up to the last corner keeps its clearance.
    pub(super) fn is_free(&self, eye: DVec3, voxels: &Voxels) -> bool {
        let (mut at, mut length) = (eye, 0.0);
        self.points.iter().take(self.points.len() - 1).all(|&next| {
            let free = voxels.is_free(at, next, length, self.clearance_per_length);
            (at, length) = (next, length + at.distance(next));
            free
        })
    }

    /// Length of the path from the eye to the last corner, scene units.
    pub(super) fn length(&self, eye: DVec3) -> f64 {
        let from = std::iter::once(&eye).chain(&self.points);
        from.zip(&self.points[..self.points.len() - 1]).map(|(a, b)| a.distance(*b)).sum()
    }

    /// Number of turns; 0 for a path that turns by more than `HAIRPIN`.
    pub(super) fn turns(&self, eye: DVec3) -> usize {
        self.corners(eye, f64::INFINITY).map_or(0, |c| c.len())
    }

    /// The corners seen from an eye; `None` if one turns too far.
    ///
    /// * `entered`: number of turns that have come in, the last of them in part.
    fn corners(&self, eye: DVec3, entered: f64) -> Option<Vec<Corner>> {
        let mut corners: Vec<Corner> = Vec::new();
        let (mut from, mut s) = (eye, 0.0);
        for pair in self.points.windows(2) {
            let edges = [from.distance(pair[0]), pair[0].distance(pair[1])];
            let [before, after] = [pair[0] - from, pair[1] - pair[0]].map(|v| v.normalize_or(DVec3::Y));
            let angle = before.angle_between(after);
            s += edges[0];
            from = pair[0];
            if angle > HAIRPIN || !angle.is_finite() {
                return None;
            }
            if angle > STRAIGHT {
                let entered = smoothstep(entered - corners.len() as f64);
                let half_length = f64::INFINITY;
                corners.push(Corner { s, at: pair[0], before, after, edges, half_length, entered });
            }
        }
        Some(corners)
    }

    /// `base` with rays that follow the path as far as the turns have come in; `None` where there is no such camera.
    ///
    /// * `entered`: number of turns that have come in, the last of them in part; infinite for all.
    pub(super) fn view(&self, base: &View, entered: f64) -> Option<View> {
        let root = base.pinhole();
        let mut corners = self.corners(root.eye, entered)?;
        corners.retain(|c| c.entered > 0.0);
        if corners.is_empty() {
            return Some(base.clone());
        }
        let last = corners.len() - 1;
        for (i, corner) in corners.iter_mut().enumerate() {
            // No other transition needs room on the last leg.
            let after = if i == last { f64::INFINITY } else { corner.edges[1] };
            corner.half_length = TRANSITION * corner.edges[0].min(after);
        }
        let rays = largest(LENGTHS, |share| {
            let shape = TurnShape { length: share * self.shape.length, ..self.shape };
            CurvedRays::new(root, Model::Modified, &turns(root, root.eye, &corners, &shape)?).ok()
        })?;
        let earlier = base.stages().iter().filter(|s| !s.bends_rays()).cloned();
        View::new(root.clone(), earlier.chain([Stage::CurvedRays(rays)]).collect()).ok()
    }
}

#[cfg(test)]
mod tests;
