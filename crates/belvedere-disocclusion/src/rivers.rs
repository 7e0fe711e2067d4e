//! Rivers that do not run uphill: the displaced ground along a line rises downstream by no more than the elevation model does there.
//!
//! The points along a river, downstream, have heights h. Its *bed* is their running minimum, so h - bed is the noise of the elevation
//! model: the height of a point over the lowest one upstream. Where bed + u does not rise downstream, the displaced ground h + u lies
//! over the lowest displaced point upstream by at most that noise. This condition is linear in the displacement u, and u = 0 meets
//! it.

use crate::points::mesh_crossings;
use belvedere_core::DVec2;
use belvedere_scene::{CellTriangle, Scene};
use serde::Serialize;

/// Height by which a displaced river may rise downstream more than the elevation model does, metres.
pub const RIVER_TOLERANCE_M: f64 = 0.05;
/// Rises up to this height are left when displacements of nodes are corrected, metres.
const SAME: f64 = 1e-4;
/// Most passes along one river that change nodes, and most rounds of all rivers.
const PASSES: usize = 200;
const ROUNDS: usize = 500;
/// Weights below this are rounding.
const NONE: f64 = 1e-9;
/// Share of a river whose heights stand for one of its ends.
const END_SHARE: f64 = 0.1;

/// A river is not a line layer of the scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("rivers: \"{id}\" is no line layer of the scene; line layers are: {}", if lines.is_empty() { "none".into() } else { lines.join(", ") })]
pub struct RiverError {
    /// Id that was given.
    pub id: String,
    /// Ids of the line layers.
    pub lines: Vec<String>,
}

/// The line of a river.
#[derive(Debug, Clone, PartialEq)]
pub struct RiverLine {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Its name; empty if it has none.
    pub name: String,
    /// Points along it, scene x, y or grid coordinates, in either direction.
    pub points: Vec<DVec2>,
}

impl RiverLine {
    /// The lines of the layers `ids`.
    ///
    /// # Errors
    /// [`RiverError`] if one of them is not a line layer of the scene.
    pub fn of(scene: &Scene, ids: &[String]) -> Result<Vec<Self>, RiverError> {
        let mut out = Vec::new();
        for id in ids {
            let known = || scene.layers.iter().filter(|l| l.kind.lines().is_some()).map(|l| l.id.clone());
            let wrong = || RiverError { id: id.clone(), lines: known().collect() };
            let (layer, found) = scene.layers.iter().enumerate().find(|(_, l)| l.id == *id).ok_or_else(wrong)?;
            let Some(lines) = found.kind.lines() else { return Err(wrong()) };
            out.extend(lines.features.iter().enumerate().map(|(feature, line)| Self {
                layer,
                feature,
                name: line.name.clone(),
                points: line.points.iter().map(|p| p.truncate()).filter(|p| p.is_finite()).collect(),
            }));
        }
        Ok(out)
    }

    /// The line with each point moved to other coordinates; points without such coordinates are left out.
    pub fn mapped(&self, to: impl Fn(DVec2) -> Option<DVec2>) -> Self {
        Self { points: self.points.iter().filter_map(|p| to(*p)).collect(), ..self.clone() }
    }
}

/// A river on the displaced ground.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RiverReport {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Its name; empty if it has none.
    pub name: String,
    /// Largest height of a point over one upstream of it on the elevation model, metres: its noise.
    pub rise_before_m: f64,
    /// The largest such height on the displaced ground, metres.
    pub rise_after_m: f64,
    /// Largest height by which a point rises over those upstream more than on the elevation model, metres; 0 but for rounding.
    pub excess_m: f64,
}

/// A point on a river.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    /// Grid coordinates.
    pub(crate) grid: DVec2,
    /// Height of the undisplaced ground.
    height: f64,
    /// Lowest height from the spring to here.
    pub(crate) bed: f64,
    nodes: [u32; 4],
    weights: [f64; 4],
}

impl Place {
    /// The nodes that displace it.
    fn entries(&self) -> impl Iterator<Item = usize> + use<> {
        let Self { nodes, weights, .. } = *self;
        (0..4).filter(move |k| weights[*k] > NONE).map(move |k| nodes[k] as usize)
    }

    fn moved(&self, u: &[f64]) -> f64 {
        (0..4).map(|k| self.weights[k] * u[self.nodes[k] as usize]).sum()
    }
}

/// A river on a grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct River {
    layer: usize,
    feature: usize,
    name: String,
    /// Points in order downstream: its ends, its turns, and wherever it crosses the mesh; between them the ground is straight.
    places: Vec<Place>,
}

/// Rivers on a grid of heights, row-major.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rivers {
    rivers: Vec<River>,
}

impl Rivers {
    /// * `lines`: in grid coordinates (column, row);
    /// * `height`: of a node, metres; `None` where there is no data. Parts of rivers there are left out.
    pub fn new(
        lines: impl IntoIterator<Item = RiverLine>,
        [cols, rows]: [usize; 2],
        height: impl Fn(usize) -> Option<f64>,
    ) -> Self {
        let river = |line: RiverLine| {
            let at = |g: DVec2| place(g, [cols, rows], &height);
            let mut places: Vec<Place> = stations(&line.points, [cols, rows]).into_iter().filter_map(at).collect();
            if runs_up(&places) {
                places.reverse();
            }
            let mut bed = f64::INFINITY;
            for place in &mut places {
                bed = bed.min(place.height);
                place.bed = bed;
            }
            let RiverLine { layer, feature, name, .. } = line;
            River { layer, feature, name, places }
        };
        let rivers = if cols < 2 || rows < 2 { Vec::new() } else { lines.into_iter().map(river).collect::<Vec<_>>() };
        Self { rivers: rivers.into_iter().filter(|river| river.places.len() > 1).collect() }
    }

    /// Whether no river lies on the grid.
    pub fn is_empty(&self) -> bool {
        self.rivers.is_empty()
    }

    pub(crate) fn all(&self) -> &[River] {
        &self.rivers
    }

    /// Nodes of the grid cells that the rivers run through; a node may occur more than once.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.rivers.iter().flat_map(|river| &river.places).flat_map(|place| place.nodes)
    }

    /// Lowers nodes of a displacement until no river rises downstream by more than on the undisplaced ground; a river that does not
    /// rise more keeps its displacement. Returns whether that was reached.
    ///
    /// * `together`: lowers nodes that move together with lowered ones, and returns whether it changed any.
    pub fn settle(&self, u: &mut [f64], mut together: impl FnMut(&mut [f64]) -> bool) -> bool {
        for _ in 0..ROUNDS {
            let mut sank = false;
            for river in &self.rivers {
                sank |= river.sink(u);
            }
            let followed = together(u);
            if !sank && !followed {
                return true;
            }
        }
        false
    }

    /// Raises nodes of a displacement so that no river by itself rises downstream; appends those that it raised.
    pub(crate) fn raise(&self, u: &mut [f64], raised: &mut Vec<usize>) {
        for river in &self.rivers {
            for _ in 0..PASSES {
                let before = raised.len();
                river.raise(u, raised);
                if raised.len() == before {
                    break;
                }
            }
        }
    }

    /// Report of every river.
    ///
    /// * `u`: displacement of every node.
    pub fn report(&self, u: &[f64]) -> Vec<RiverReport> {
        self.rivers.iter().map(|river| river.report(u)).collect()
    }
}

impl River {
    /// The points, downstream.
    pub(crate) fn places(&self) -> impl Iterator<Item = &Place> {
        self.places.iter()
    }

    /// Lowers nodes in order downstream; steps back where this also lowers points just upstream. Returns whether any node changed.
    fn sink(&self, u: &mut [f64]) -> bool {
        let places = &self.places;
        let mut lowest = vec![f64::INFINITY; places.len() + 1];
        let (mut k, mut changes) = (0, 0);
        while k < places.len() {
            let place = &places[k];
            let most = lowest[k] - place.bed;
            if place.moved(u) > most + SAME && changes < PASSES * places.len() {
                place.entries().for_each(|n| u[n] = u[n].min(most));
                changes += 1;
                let shares = |other: &Place| other.nodes.iter().any(|n| place.nodes.contains(n));
                while k > 0 && shares(&places[k - 1]) {
                    k -= 1;
                }
                continue;
            }
            lowest[k + 1] = lowest[k].min(place.bed + place.moved(u));
            k += 1;
        }
        changes > 0
    }

    fn raise(&self, u: &mut [f64], raised: &mut Vec<usize>) {
        let mut highest = f64::NEG_INFINITY;
        for place in self.places.iter().rev() {
            let least = highest - place.bed;
            if place.moved(u) < least - SAME {
                for n in place.entries() {
                    if u[n] < least {
                        u[n] = least;
                        raised.push(n);
                    }
                }
            }
            highest = highest.max(place.bed + place.moved(u));
        }
    }

    fn report(&self, u: &[f64]) -> RiverReport {
        let [mut before, mut after, mut excess] = [0.0f64; 3];
        let mut lowest = f64::INFINITY;
        for place in &self.places {
            let height = place.height + place.moved(u);
            lowest = lowest.min(height);
            let [rise, noise] = [height - lowest, place.height - place.bed];
            before = before.max(noise);
            after = after.max(rise);
            excess = excess.max(rise - noise);
        }
        RiverReport {
            layer: self.layer,
            feature: self.feature,
            name: self.name.clone(),
            rise_before_m: before,
            rise_after_m: after,
            excess_m: excess,
        }
    }
}

/// Positions at which a line begins, ends, turns and crosses the mesh, grid coordinates.
fn stations(points: &[DVec2], [cols, rows]: [usize; 2]) -> Vec<DVec2> {
    let last = DVec2::new((cols - 1) as f64, (rows - 1) as f64);
    let mut out: Vec<DVec2> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let step = pair[1] - pair[0];
        // Far beyond the grid there is no mesh to cross.
        let near = |p: DVec2| p.cmpge(-DVec2::ONE).all() && p.cmple(last + 1.0).all();
        let crossings = mesh_crossings(pair[0], step).filter(|share| near(pair[0] + *share * step));
        let mut shares: Vec<f64> = crossings.chain([1.0]).collect();
        shares.sort_by(f64::total_cmp);
        out.extend(shares.into_iter().map(|share| pair[0] + share * step));
    }
    out
}

/// The point of a river at a position; `None` beside the grid and where there is no data. Its bed is set later.
fn place(g: DVec2, [cols, rows]: [usize; 2], height: impl Fn(usize) -> Option<f64>) -> Option<Place> {
    let last = DVec2::new((cols - 1) as f64, (rows - 1) as f64);
    if !(g.cmpge(DVec2::ZERO).all() && g.cmple(last).all()) {
        return None;
    }
    let (col, row) = ((g.x as usize).min(cols - 2), (g.y as usize).min(rows - 2));
    let nw = row * cols + col;
    let nodes = [nw, nw + 1, nw + cols, nw + cols + 1];
    let inside = g - DVec2::new(col as f64, row as f64);
    let height = CellTriangle::surface(nodes.map(height), inside)?;
    let mut weights = [0.0; 4];
    let triangle = CellTriangle::at(inside);
    triangle.corners().into_iter().zip(triangle.weights(inside)).for_each(|(corner, weight)| weights[corner] = weight);
    Some(Place { grid: g, height, bed: height, nodes: nodes.map(|n| n as u32), weights })
}

/// Whether the last part of a river lies higher than its first part.
fn runs_up(places: &[Place]) -> bool {
    let end = ((places.len() as f64 * END_SHARE) as usize).max(1);
    let middle = |part: &[Place]| {
        let mut heights: Vec<f64> = part.iter().map(|p| p.height).collect();
        heights.sort_by(f64::total_cmp);
        heights.get(heights.len() / 2).copied().unwrap_or(0.0)
    };
    !places.is_empty() && middle(&places[places.len() - end..]) > middle(&places[..end])
}
