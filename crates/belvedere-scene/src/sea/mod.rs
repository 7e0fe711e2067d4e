//! The sea of a ground, found from the heights alone, as rings to be drawn as areas.
//!
//! Sea is a connected stretch of ground at one height, see [`Sea::of`]. Land below sea level is no sea: its heights differ.

mod coast;

use crate::{Heightfield, NodeState};
use belvedere_core::DVec2;
use std::collections::{HashSet, VecDeque};

/// Heights that differ by less are the same, metres.
const SAME_M: f32 = 0.01;
/// Fewest nodes of a sea that have sea all around them.
const FEWEST: usize = 100;
/// Least area of a sea, square metres, or, on smaller grounds, least share of the ground.
const LEAST_M2: f64 = 1e6;
const LEAST_SHARE: f64 = 0.05;
/// A shore is at most as high as a node is wide, within these limits, metres.
const SHORE_M: [f64; 2] = [10.0, 100.0];

/// How much higher ground that climbs from a shore is one node further inland: half as much on an even slope.
const FURTHER: f32 = 1.2;

/// The sea of a ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Sea {
    /// Its height, metres.
    pub level_m: f64,
    /// Its area, square metres.
    pub area_m2: f64,
    /// Its coasts: closed rings of scene positions, of which every second one encloses land. They run outside the ground where
    /// the sea reaches its edge.
    pub coasts: Vec<Vec<DVec2>>,
}

impl Sea {
    /// The sea of a ground, if there is any. Sea is every stretch of nodes
    /// * at one height, to a centimetre: 0, or below 0 the lowest height of the ground;
    /// * joined along rows and columns by nodes that have no other height around them, at least 100 of them;
    /// * that reaches the edge of the ground, or voids that do;
    /// * of at least a square kilometre, or a twentieth of the ground;
    /// * with a shore: half the nodes beside it stand less than the spacing of the nodes over it (10 m at least, 100 m at most).
    ///   Level ground with a higher step to the land is a frame of undeclared voids, blended or not.
    pub fn of(ground: &Heightfield) -> Option<Self> {
        let (level_m, nodes) = Self::nodes(ground)?;
        let spacing = ground.spacing();
        let area_m2 = nodes.iter().filter(|sea| **sea).count() as f64 * spacing.x * spacing.y;
        Some(Self { level_m, area_m2, coasts: coast::rings(ground, &nodes, level_m) })
    }

    /// The height of the sea, metres, and which nodes of the ground are sea, row by row.
    pub fn nodes(ground: &Heightfield) -> Option<(f64, Vec<bool>)> {
        let lowest = ground.z_range()[0];
        let levels = [Some(0.0), (lowest < -f64::from(SAME_M)).then_some(lowest)];
        let known = levels.into_iter().flatten().filter(|level| *level >= lowest);
        known.into_iter().find_map(|level| Some((level, nodes_at(ground, level as f32)?)))
    }
}

/// The up to eight neighbours of a node.
fn around(i: usize, [cols, rows]: [usize; 2]) -> impl Iterator<Item = usize> {
    let (c, r) = (i % cols, i / cols);
    let rows = r.saturating_sub(1)..(r + 2).min(rows);
    rows.flat_map(move |r| (c.saturating_sub(1)..(c + 2).min(cols)).map(move |c| r * cols + c)).filter(move |k| *k != i)
}

/// The up to four neighbours of a node in its row and column.
fn beside(i: usize, [cols, rows]: [usize; 2]) -> impl Iterator<Item = usize> {
    let (c, r) = (i % cols, i / cols);
    [(c > 0).then(|| i - 1), (c + 1 < cols).then(|| i + 1), (r > 0).then(|| i - cols), (r + 1 < rows).then(|| i + cols)]
        .into_iter()
        .flatten()
}

/// Flood fill: marks the unmarked nodes that are joined with `first` along rows and columns; returns them as found.
fn flood(first: usize, size: [usize; 2], marked: &mut [bool], belongs: impl Fn(usize) -> bool) -> Vec<usize> {
    let (mut found, mut next) = (Vec::new(), VecDeque::from([first]));
    marked[first] = true;
    while let Some(i) = next.pop_front() {
        found.push(i);
        for k in beside(i, size) {
            if !marked[k] && belongs(k) {
                marked[k] = true;
                next.push_back(k);
            }
        }
    }
    found
}

/// Nodes beside a stretch of nodes, then those beside these, and so on.
fn inland(part: &[usize], size: [usize; 2], is_land: impl Fn(usize) -> bool) -> [Vec<usize>; 3] {
    let mut known: HashSet<usize> = HashSet::new();
    let mut from: Vec<usize> = part.to_vec();
    std::array::from_fn(|_| {
        let beside = from.iter().flat_map(|i| around(*i, size)).filter(|k| is_land(*k) && known.insert(*k));
        from = beside.collect();
        from.clone()
    })
}

fn median(nodes: &[usize], of: impl Fn(usize) -> f32) -> Option<f32> {
    let mut values: Vec<f32> = nodes.iter().map(|i| of(*i)).collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Whether heights from the shore inland are those of a frame of undeclared voids that a change of the lattice has blended with the land: a step
/// up to ground that climbs no further.
fn is_frame(inland: &[Option<f32>], highest: f32) -> bool {
    match inland {
        [_, Some(second), Some(third)] => *second > highest && *third < FURTHER * second,
        _ => false,
    }
}

/// The nodes of the sea at a level.
fn nodes_at(ground: &Heightfield, level: f32) -> Option<Vec<bool>> {
    let size @ [cols, rows] = [ground.cols(), ground.rows()];
    let (heights, states) = (ground.heights(), ground.states());
    let is_void = |i: usize| states[i] == NodeState::Void;
    let level_at = |i: usize| !is_void(i) && (heights[i] - level).abs() <= SAME_M;
    let on_rim =
        |i: usize| i < cols || i >= cols * (rows - 1) || i.is_multiple_of(cols) || (i + 1).is_multiple_of(cols);
    let rim = || (0..heights.len()).filter(|i| on_rim(*i));
    let mut outside = vec![false; heights.len()];
    for i in rim() {
        if is_void(i) && !outside[i] {
            flood(i, size, &mut outside, is_void);
        }
    }
    let at_edge = |i: usize| on_rim(i) || around(i, size).any(|k| outside[k]);
    let solid = |i: usize| level_at(i) && around(i, size).all(|k| level_at(k) || is_void(k));
    let measured = (0..heights.len()).filter(|i| !is_void(*i)).count();
    let cell = ground.spacing().x * ground.spacing().y;
    let highest = (ground.spacing().element_sum() / 2.0).clamp(SHORE_M[0], SHORE_M[1]) as f32;
    let (mut seen, mut sea, mut any) = (vec![false; heights.len()], vec![false; heights.len()], false);
    for first in 0..heights.len() {
        if seen[first] || !solid(first) {
            continue;
        }
        let mut part = flood(first, size, &mut seen, solid);
        if part.len() < FEWEST || !part.iter().any(|i| at_edge(*i)) {
            continue;
        }
        // The nodes between solid ones and the shore.
        let inner = part.len();
        let mut own = vec![false; heights.len()];
        part.iter().for_each(|i| own[*i] = true);
        for n in 0..inner {
            for k in around(part[n], size).filter(|k| level_at(*k)) {
                if !std::mem::replace(&mut own[k], true) {
                    part.push(k);
                }
            }
        }
        let wide = part.len() as f64 * cell >= LEAST_M2 || part.len() as f64 >= LEAST_SHARE * measured as f64;
        let steps = inland(&part, size, |k| !is_void(k) && !level_at(k));
        let medians: Vec<Option<f32>> = steps.iter().map(|step| median(step, |k| heights[k] - level)).collect();
        if !wide || medians[0].is_none_or(|shore| shore > highest) || is_frame(&medians, highest) {
            continue;
        }
        any = true;
        part.iter().for_each(|i| sea[*i] = true);
    }
    any.then_some(sea)
}

#[cfg(test)]
mod tests;
