//! Spikes: single samples of an elevation model that stand far above or below all their neighbours.
//!
//! Ground that is cleared for a spike would be dug into a funnel around an error of the data. So the solver takes a spike to be as
//! high as the median of its surroundings, and reports it. A summit is not a spike: a tower is several samples wide, and a single
//! high sample of a coarse grid rises no farther over its neighbours than slopes elsewhere in the model do, or than its neighbours
//! differ.

use belvedere_scene::{Heightfield, NodeState};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Least slope of a sample over its surroundings for which it is tested further, rise over run.
const SLOPE: f64 = 0.5;
/// Neighbours that may belong to a spike, too: resampling spreads a sample over up to four nodes.
const SHARED: usize = 3;
/// Least slope of a spike, as a multiple of the slope that 99 of 100 pairs of neighbours in the model stay below: bad models have a
/// spike in every few hundred samples.
const STEEPER: f64 = 5.0;
const STEEP_SHARE: f64 = 0.99;
/// Least height of a spike over its surroundings, as a multiple of their median absolute deviation.
const ROUGHER: f64 = 6.0;

/// A single sample far above or below all its neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spike {
    /// Scene x, y.
    pub at: [f64; 2],
    /// Height in the data.
    pub height_m: f64,
    /// Median height of the nodes two columns or rows away, which the solver uses.
    pub taken_m: f64,
}

/// The terrain with its spikes cut down or filled up to the median of their neighbours, and the spikes, the farthest out first.
pub(crate) fn without_spikes(terrain: &Arc<Heightfield>) -> (Arc<Heightfield>, Vec<Spike>) {
    let (cols, step) = (terrain.cols(), terrain.spacing().min_element());
    let near: Vec<(usize, f64)> = (0..terrain.heights().len())
        .into_par_iter()
        .with_min_len(4096)
        .filter_map(|i| Some((i, apart(terrain, i)?)).filter(|(_, apart)| *apart > SLOPE * step))
        .collect();
    if near.is_empty() {
        return (terrain.clone(), Vec::new());
    }
    let least = STEEPER * usual_slope(terrain) * step;
    let mut found: Vec<(usize, Spike)> = Vec::new();
    for (i, apart) in near {
        if apart > least && apart > ROUGHER * roughness(terrain, i) {
            // Nodes of terrain that is two or three wide have no others.
            if ring(terrain, i).next().is_none() {
                continue;
            }
            let taken_m = median(ring(terrain, i).collect());
            let at = terrain.node_xy(i % cols, i / cols).to_array();
            found.push((i, Spike { at, height_m: f64::from(terrain.heights()[i]), taken_m }));
        }
    }
    if found.is_empty() {
        return (terrain.clone(), Vec::new());
    }
    let mut heights = terrain.heights().to_vec();
    for (i, spike) in &found {
        heights[*i] = spike.taken_m as f32;
    }
    let states = terrain.states().to_vec();
    let smooth = Heightfield::new(terrain.north_west(), terrain.spacing(), cols, terrain.rows(), heights, states);
    let mut spikes: Vec<Spike> = found.into_iter().map(|(_, spike)| spike).collect();
    spikes.sort_by(|a, b| (b.height_m - b.taken_m).abs().total_cmp(&(a.height_m - a.taken_m).abs()));
    // The same grid with other finite heights is valid.
    smooth.map_or_else(|_| (terrain.clone(), Vec::new()), |smooth| (Arc::new(smooth), spikes))
}

/// Heights of the nodes with data up to `reach` columns and rows from a node, without it.
fn around(terrain: &Heightfield, i: usize, reach: isize) -> impl Iterator<Item = f64> + '_ {
    offsets(terrain, i, reach).map(|(.., h)| h)
}

/// Heights of these nodes, with the numbers of columns and rows by which they are away.
fn offsets(terrain: &Heightfield, i: usize, reach: isize) -> impl Iterator<Item = (isize, isize, f64)> + '_ {
    let (cols, rows) = (terrain.cols() as isize, terrain.rows() as isize);
    let (col, row) = (i as isize % cols, i as isize / cols);
    let side = 2 * reach + 1;
    (0..side * side).filter_map(move |k| {
        let (dx, dy) = (k % side - reach, k / side - reach);
        let (x, y) = (col + dx, row + dy);
        let inside = x >= 0 && y >= 0 && x < cols && y < rows && (dx, dy) != (0, 0);
        let j = if inside { (y * cols + x) as usize } else { return None };
        (terrain.states()[j] != NodeState::Void).then(|| (dx, dy, f64::from(terrain.heights()[j])))
    })
}

/// Heights of the nodes with data two columns or rows from a node.
fn ring(terrain: &Heightfield, i: usize) -> impl Iterator<Item = f64> + '_ {
    offsets(terrain, i, 2).filter(|(dx, dy, _)| dx.abs() == 2 || dy.abs() == 2).map(|(.., h)| h)
}

/// Height of a node over its surroundings, or depth below them, metres: relative to all nodes two columns or rows away and to all but
/// three of its neighbours, which may belong to the same sample where a file was resampled. `None` if it lies neither above nor
/// below, or has too few neighbours.
fn apart(terrain: &Heightfield, i: usize) -> Option<f64> {
    if terrain.states()[i] == NodeState::Void {
        return None;
    }
    let h = f64::from(terrain.heights()[i]);
    let (mut count, mut near) = (0, [0.0; 8]);
    for other in around(terrain, i, 1) {
        near[count] = h - other;
        count += 1;
    }
    let near = &mut near[..count];
    near.sort_by(f64::total_cmp);
    let spare = SHARED.min(count.saturating_sub(1));
    let sides = [near.get(spare).copied()?, near.get(count - 1 - spare).map(|d| -d)?];
    if count < 3 || sides.iter().all(|d| *d <= 0.0) {
        return None;
    }
    let farther = ring(terrain, i);
    let sides = farther.fold(sides, |[up, down], other| [up.min(h - other), down.min(other - h)]);
    Some(sides[0].max(sides[1])).filter(|apart| *apart > 0.0)
}

/// Slope between neighbours of a row or a column that all but a hundredth stay below.
fn usual_slope(terrain: &Heightfield) -> f64 {
    let (cols, d, h) = (terrain.cols(), terrain.spacing(), terrain.heights());
    let solid = |i: usize| terrain.states()[i] != NodeState::Void;
    let of = |i: usize| {
        let east = (!(i + 1).is_multiple_of(cols)).then_some((i + 1, d.x));
        let south = (i + cols < h.len()).then_some((i + cols, d.y));
        let pairs = [east, south].into_iter().flatten().filter(move |(j, _)| solid(i) && solid(*j));
        pairs.map(move |(j, d)| (h[j] - h[i]).abs() / d as f32)
    };
    let mut slopes: Vec<f32> = (0..h.len()).flat_map(of).collect();
    if slopes.is_empty() {
        return 0.0;
    }
    // On small terrain a hundredth is only a few slopes: the eight slopes at two spikes must not be the measure.
    let last = slopes.len().saturating_sub(1);
    let k = ((last as f64 * STEEP_SHARE) as usize).min(last.saturating_sub(8));
    f64::from(*slopes.select_nth_unstable_by(k, f32::total_cmp).1)
}

/// Median absolute deviation of the heights around a node, without its own.
fn roughness(terrain: &Heightfield, i: usize) -> f64 {
    let heights: Vec<f64> = around(terrain, i, 2).collect();
    let middle = median(heights.clone());
    median(heights.into_iter().map(|h| (h - middle).abs()).collect())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let k = values.len() / 2;
    if values.len() % 2 == 1 { values[k] } else { 0.5 * (values[k.saturating_sub(1)] + values[k]) }
}

#[cfg(test)]
mod tests;
