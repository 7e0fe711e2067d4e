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
mod tests {
    use super::*;
    use belvedere_core::{Aabb, Pinhole, Projection};
    use belvedere_scene::{BoxLayer, BoxShape, Color, Scene};

    /// A wall 30 m high, 40 m before the eye.
    fn voxels() -> Voxels {
        let wall = BoxShape {
            base: DVec3::new(0.0, 42.0, 0.0),
            size: DVec3::new(200.0, 4.0, 30.0),
            yaw: 0.0,
            color: Color::rgb(1, 2, 3),
        };
        let scene = Scene::default().with_layer("wall", BoxLayer::new(vec![wall]));
        Voxels::new(&scene, &Aabb { min: DVec3::new(-80.0, -10.0, 0.0), max: DVec3::new(80.0, 120.0, 70.0) })
    }

    #[test]
    fn a_staircase_over_a_wall_becomes_a_few_legs_that_keep_their_clearance() {
        let (voxels, eye) = (voxels(), DVec3::new(0.0, 0.0, 5.0));
        // Up at 45 degrees, level, and down again, in small steps.
        let height = |y: f64| if y < 35.0 { 5.0 + y } else { 40.0 - (y - 50.0).max(0.0) };
        let points: Vec<DVec3> = (10..70).map(|y| DVec3::new(0.0, f64::from(y), height(f64::from(y)))).collect();
        let look = DVec3::new(0.0, 1.0, -1.0).normalize();
        let chain = Chain::simplified(eye, &points, look, &voxels, 0.1, 3).expect("a way over the wall");
        assert!((1..=3).contains(&chain.turns(eye)) && chain.is_free(eye, &voxels), "{chain:?}");
        assert!(chain.length(eye) < 1.05 * 98.0, "{}", chain.length(eye));
        let lower = Chain { points: chain.points.iter().map(|p| *p - 15.0 * DVec3::Z).collect(), ..chain.clone() };
        assert!(!lower.is_free(eye, &voxels), "through the wall");
        assert_eq!(Chain::simplified(eye, &points, look, &voxels, 0.1, 0), None, "no turn is allowed");
        let back = -DVec3::Y;
        assert_eq!(Chain::simplified(eye, &points[..5], back, &voxels, 0.0, 3), None, "too far a turn");
    }

    #[test]
    fn turns_come_in_from_nothing_one_after_the_other() {
        let (voxels, eye) = (voxels(), DVec3::new(0.0, 0.0, 5.0));
        let lens = Projection::Perspective { fov_y: 0.5 };
        let pinhole = Pinhole::look_at(eye, DVec3::new(0.0, 35.0, 40.0), DVec3::Z, lens, [64, 36], 1.0, None).unwrap();
        let base = View::straight(pinhole);
        let points = [[0.0, 35.0, 40.0], [0.0, 60.0, 40.0], [0.0, 80.0, 20.0]].map(DVec3::from_array);
        let shape = TurnShape { behind: 50.0, length: 1.0, m: Sharpness::Bend };
        let chain = Chain { points: points.into(), shape, clearance_per_length: 0.0 };
        assert!(chain.is_free(eye, &voxels) && chain.turns(eye) == 2);
        let turns = |entered: f64| chain.view(&base, entered).unwrap().curved_rays().map_or(0, |r| r.turn_count());
        assert_eq!([0.0, 0.5, 1.0, 1.5, 2.0, 9.0].map(turns), [0, 1, 1, 2, 2, 2]);
        // A hardly entered turn hardly moves anything.
        let p = DVec3::new(2.0, 70.0, 30.0);
        let image = |entered: f64| chain.view(&base, entered).unwrap().project(p).unwrap().pixel;
        assert!(image(1.0).distance(image(1.01)) < 0.1 && image(0.0).distance(image(0.01)) < 0.1);
        assert!(image(1.0).distance(image(2.0)) > 5.0);
    }
}
