//! Goals of a probe: cells and directions from which surfaces are seen that the eye does not see.

use super::chain::Chain;
use super::judge::Unseen;
use super::voxels::Voxels;
use super::ways::Ways;
use belvedere_core::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Blocks along the longest side of the region; one cell of each block is tried.
const BLOCKS: usize = 20;
/// Points that goals are scored by, at most.
const POINTS: usize = 320;
/// Most chains that are returned.
const BEST: usize = 32;
/// Angles of the last turn, degrees, and the number of directions that it is made in.
const TURNS_DEG: [f64; 3] = [25.0, 45.0, 68.0];
const ROUND: u32 = 8;
/// Factor on the worth of a point for later goals after a goal has shown it.
const AGAIN: f64 = 0.6;

/// Field of view of a probe, and limits of its path.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProbeFrustum {
    pub(super) eye: DVec3,
    /// Up direction of the picture.
    pub(super) up: DVec3,
    /// Cosine of half the angle of view.
    pub(super) cosine: f64,
    /// Distance within which a point is seen, scene units.
    pub(super) reach: f64,
    /// Most turns of a path.
    pub(super) turns: usize,
    pub(super) clearance_per_length: f64,
}

/// Greedy choice of paths at whose ends a last turn shows most of `unseen`, for their cost; points that one path shows are worth less
/// for the next.
pub(super) fn best_ways(ways: &Ways<'_>, voxels: &Voxels, unseen: &[Unseen], frustum: &ProbeFrustum) -> Vec<Chain> {
    let longest = voxels.size().into_iter().max().unwrap_or(1);
    let edge = longest.div_ceil(BLOCKS).max(1);
    let mut cheapest: BTreeMap<[usize; 3], usize> = BTreeMap::new();
    for cell in ways.reached() {
        let best = cheapest.entry(voxels.coordinates(cell).map(|v| v / edge)).or_insert(cell);
        if ways.cost(cell) < ways.cost(*best) {
            *best = cell;
        }
    }
    let every = unseen.len().div_ceil(POINTS).max(1);
    let points: Vec<&Unseen> = unseen.iter().step_by(every).collect();
    let cells: Vec<usize> = cheapest.into_values().collect();
    let goals = cells.into_par_iter().flat_map_iter(|cell| {
        let points = &points;
        looks(ways.arrival(cell), frustum.up).map(move |look| Goal::new(cell, look, voxels, points, frustum))
    });
    let mut goals: Vec<Goal> = goals.filter(|g| g.seen != [0; POINTS / 64]).collect();
    let mut worth: Vec<f64> = points.iter().map(|p| p.worth).collect();
    let mut chains = Vec::new();
    while chains.len() < BEST {
        let score = |g: &Goal| g.points().map(|i| worth[i]).sum::<f64>() / (1.0 + ways.cost(g.cell) / frustum.reach);
        let best = (0..goals.len()).max_by(|a, b| score(&goals[*a]).total_cmp(&score(&goals[*b])).then(b.cmp(a)));
        let Some(goal) = best.map(|i| goals.remove(i)) else { break };
        let way = ways.points(goal.cell);
        let per_length = frustum.clearance_per_length;
        if let Some(chain) = Chain::simplified(frustum.eye, &way, goal.look, voxels, per_length, frustum.turns) {
            // The next one should show something else.
            goal.points().for_each(|i| worth[i] *= AGAIN);
            chains.push(chain);
        }
    }
    chains
}

/// Directions of view after a last turn, from the direction in which a path arrives.
fn looks(arrival: DVec3, up: DVec3) -> impl Iterator<Item = DVec3> {
    let right = arrival.cross(up).normalize_or(arrival.any_orthonormal_vector());
    let over = right.cross(arrival);
    (0..ROUND).flat_map(move |k| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(ROUND)).sin_cos();
        let aside = cos * over + sin * right;
        TURNS_DEG.map(|deg| deg.to_radians().cos() * arrival + deg.to_radians().sin() * aside)
    })
}

/// A cell, a direction of view from there, and the points that are seen.
#[derive(Debug, Clone, Copy)]
struct Goal {
    cell: usize,
    look: DVec3,
    /// A bit for every point.
    seen: [u64; POINTS / 64],
}

impl Goal {
    fn new(cell: usize, look: DVec3, voxels: &Voxels, points: &[&Unseen], frustum: &ProbeFrustum) -> Self {
        let at = voxels.center(cell);
        let is_seen = |p: &Unseen| {
            let way = p.at - at;
            let distance = way.length();
            way.dot(look) > frustum.cosine * distance
                && distance < frustum.reach
                && way.dot(p.normal) < 0.0
                && voxels.sees(at, p.at)
        };
        let mut seen = [0; POINTS / 64];
        for (i, _) in points.iter().enumerate().filter(|(_, p)| is_seen(p)) {
            seen[i / 64] |= 1 << (i % 64);
        }
        Self { cell, look, seen }
    }

    /// Numbers of the points that are seen.
    fn points(&self) -> impl Iterator<Item = usize> + '_ {
        (0..POINTS).filter(|i| self.seen[i / 64] >> (i % 64) & 1 == 1)
    }
}
