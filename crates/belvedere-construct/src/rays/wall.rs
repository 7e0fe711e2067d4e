//! The wall of a vessel: the value that parts what a path runs through (the lumen) from what lies around it.
//!
//! 1. The value of the lumen: the median along the path, with its spread.
//! 2. From positions along the path, values on lines at right angles to it, as far as the first edge: where they leave the lumen, and
//!    on until they change no more or turn back.
//! 3. The isovalue: the mean over these edges of the value midway between lumen and wall, weighted by their steepest gradient. A clear
//!    edge counts more than a faint change inside the lumen; the weighting is that of Kittler, Illingworth, Föglein 1985, "Threshold
//!    selection based on a simple image statistic", which gives the middle of an even edge.

use super::path::Path;
use crate::ConstructError;
use belvedere_core::DVec3;
use belvedere_scene::Volume;
use serde::{Deserialize, Serialize};

/// Positions along the path, and directions from each.
const POSITIONS: [f64; 2] = [24.0, 160.0];
const DIRECTIONS: usize = 16;
/// Distance of the values of a line, and of those that a slope is taken over, voxel edges.
const STEP: f64 = 0.5;
const SLOPE_OVER: usize = 4;
/// Difference from the value of the lumen from which on values have left it, multiple of the lumen's spread.
const LEAVES: f64 = 5.0;
/// The least spread, share of the range of values: half a step of a byte.
const LEAST_SPREAD: f64 = 2e-3;
/// Share of its steepest slope below which an edge ends, and greatest distance of the wall beyond that end, voxel edges.
const FLAT: f64 = 0.25;
const BEYOND: f64 = 1.5;
/// Least share of the lines that must meet an edge to the same side.
const LEAST_SHARE: f64 = 0.25;

/// The wall around a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    /// Value that parts lumen and wall.
    pub isovalue: f64,
    /// Value of the lumen: the median along the path.
    pub lumen: f64,
    /// Value of the wall beside it.
    pub wall: f64,
    /// Share of lines from the path that meet it, 0..=1.
    pub share: f64,
}

/// Share of a path that lies inside a volume, 0..=1.
pub fn share_inside(volume: &Volume, points: &[DVec3]) -> f64 {
    let places = places(volume, points);
    let inside = places.iter().filter(|(p, _)| value(volume, *p).is_some()).count();
    inside as f64 / places.len().max(1) as f64
}

/// The wall around a path through a volume, whether the lumen is of greater or of lesser values.
///
/// * `points`: of the path, scene coordinates.
///
/// # Errors
/// [`ConstructError::PathOutside`]; [`ConstructError::NoWall`] where what the path runs through does not differ from what lies around it.
pub fn find_wall(volume: &Volume, points: &[DVec3]) -> Result<Wall, ConstructError> {
    let inside: Vec<_> =
        places(volume, points).into_iter().filter_map(|(p, way)| Some((p, way, value(volume, p)?))).collect();
    let Some(lumen) = median(inside.iter().map(|(_, _, v)| *v)) else {
        return Err(ConstructError::PathOutside);
    };
    let [lo, hi] = volume.range().map(f64::from);
    let deviation = median(inside.iter().map(|(_, _, v)| (v - lumen).abs())).unwrap_or(0.0);
    let spread = (1.4826 * deviation).max(LEAST_SPREAD * (hi - lo));
    let lines = Lines { volume, lumen, leaves: LEAVES * spread };
    let (mut looked, mut edges) = (0, Vec::new());
    for (p, way, _) in inside.iter().filter(|(_, _, v)| (v - lumen).abs() < lines.leaves) {
        let across = way.any_orthonormal_vector();
        for k in 0..DIRECTIONS {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).sin_cos();
            looked += 1;
            edges.extend(lines.edge(*p, cos * across + sin * way.cross(across)));
        }
    }
    let weight = |sign: f64| edges.iter().filter(|e| e.rise * sign > 0.0).map(|e| e.steepest).sum::<f64>();
    let sign = if weight(1.0) >= weight(-1.0) { 1.0 } else { -1.0 };
    edges.retain(|e| e.rise * sign > 0.0);
    let share = edges.len() as f64 / looked.max(1) as f64;
    if !(share >= LEAST_SHARE && hi > lo) {
        return Err(ConstructError::NoWall { lumen, spread, share_percent: 100.0 * share });
    }
    let weights: f64 = edges.iter().map(|e| e.steepest).sum();
    let rise = edges.iter().map(|e| e.steepest * e.rise).sum::<f64>() / weights;
    Ok(Wall { isovalue: lumen + 0.5 * rise, lumen, wall: lumen + rise, share })
}

/// Positions along a path with its direction there.
fn places(volume: &Volume, points: &[DVec3]) -> Vec<(DVec3, DVec3)> {
    let path = Path::new(points);
    if !(path.length() > 0.0) {
        return Vec::new();
    }
    let edge = volume.voxel_edge();
    let count = (path.length() / edge).clamp(POSITIONS[0], POSITIONS[1]).round();
    let place = |k: usize| {
        let s = path.length() * (k as f64 + 0.5) / count;
        (path.at(s), (path.at(s + 2.0 * edge) - path.at(s - 2.0 * edge)).normalize_or(DVec3::Z))
    };
    (0..count as usize).map(place).collect()
}

fn value(volume: &Volume, p: DVec3) -> Option<f64> {
    volume.at(volume.lattice_from_scene(p))
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied()
}

/// The first change of values on a line.
struct Edge {
    /// Change of the values from the lumen to the wall.
    rise: f64,
    /// Its greatest slope, values per step.
    steepest: f64,
}

/// Lines out of a lumen.
struct Lines<'v> {
    volume: &'v Volume,
    lumen: f64,
    /// Difference from the value of the lumen beyond which values have left it.
    leaves: f64,
}

impl Lines<'_> {
    /// The first edge on a line from a position; `None` where there is none inside the volume.
    fn edge(&self, from: DVec3, direction: DVec3) -> Option<Edge> {
        let step = STEP * self.volume.voxel_edge() * direction;
        let raw = |k: usize| value(self.volume, from + k as f64 * step);
        // Off the lumen, evened out over a voxel.
        let off = |k: usize| Some((raw(k.saturating_sub(1))? + raw(k)? + raw(k + 1)?) / 3.0 - self.lumen);
        let mut values = Vec::new();
        let mut first = None;
        let (mut steepest, mut most) = (0.0f64, 0.0f64);
        for k in 0.. {
            values.push(off(k)?);
            if first.is_none() && values[k].abs() > self.leaves {
                // Slopes from within the lumen on belong to the edge.
                first = Some((k.saturating_sub(SLOPE_OVER), values[k].signum()));
            }
            let Some((begin, sign)) = first else { continue };
            let slope = sign * (values[k] - values[k.saturating_sub(SLOPE_OVER).max(begin)]) / SLOPE_OVER as f64;
            steepest = steepest.max(slope);
            most = most.max(sign * values[k]);
            if slope < FLAT * steepest {
                let beyond = (BEYOND / STEP) as usize;
                let farther = (k + 1..=k + beyond).map_while(off).map(|v| sign * v);
                return Some(Edge { rise: sign * farther.fold(most, f64::max), steepest });
            }
        }
        None
    }
}
