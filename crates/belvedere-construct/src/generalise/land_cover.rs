//! Land cover without overlaps, so that each point of the ground is drawn once.

use super::shapes::{Land, by_place, land_of, polygons_of, union, without_specks};
use belvedere_core::DVec2;
use belvedere_scene::city::{CityArea, LandCover, Polygon};
use geo::{BooleanOps, Rect};
use rayon::prelude::*;
use std::collections::HashMap;

/// Kinds of land cover, from the topmost down.
const FROM_ABOVE: [LandCover; 6] =
    [LandCover::Road, LandCover::Rail, LandCover::Water, LandCover::Forest, LandCover::Green, LandCover::Other];
/// Quarterings of the ground.
const TILINGS: u32 = 4;
/// Vertices nearer to an edge than this lie on it, metres.
const ON_EDGE_M: f64 = 1e-4;

/// Pieces of ground that neither overlap nor leave gaps; along a common border they have the same vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LandCoverMap {
    /// At most one for each kind, without names.
    pub areas: Vec<CityArea>,
    /// The rest of the ground.
    pub bare: Vec<Polygon>,
}

/// Lays land cover side by side: streets cut through railways, those through water, woods, green, the rest, in this order.
///
/// * `extent`: least and largest corner of the ground, metres; what lies outside is cut off.
pub fn land_cover(areas: &[CityArea], extent: [DVec2; 2]) -> LandCoverMap {
    let [low, high] = extent;
    let mut bare = land_of(&[Polygon {
        outer: vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)],
        holes: Vec::new(),
    }]);
    let mut pieces: Vec<(Option<LandCover>, Land)> = Vec::new();
    for kind in FROM_ABOVE {
        let of_kind = areas.iter().filter(|a| a.cover == kind).map(|a| land_of(&a.polygons)).collect();
        let of_kind = union(by_place(of_kind));
        if !of_kind.0.is_empty() {
            pieces.push((Some(kind), without_specks(of_kind.intersection(&bare))));
            bare = without_specks(bare.difference(&of_kind));
        }
    }
    pieces.push((None, bare));
    let mut pieces: Vec<_> =
        pieces.into_par_iter().map(|(kind, land)| (kind, polygons_of(&tiled(land, extent, TILINGS)))).collect();
    share_vertices(pieces.iter_mut().flat_map(|(_, polygons)| polygons).collect());
    let bare = pieces.pop().map(|(_, polygons)| polygons).unwrap_or_default();
    let area = |(kind, polygons): (Option<LandCover>, Vec<Polygon>)| {
        Some(CityArea { name: String::new(), cover: kind?, polygons }).filter(|a| !a.polygons.is_empty())
    };
    LandCoverMap { areas: pieces.into_iter().filter_map(area).collect(), bare }
}

/// The land cut along the lines that halve `extent`, then its quarters, and so on: slivers across a whole city are slow to draw.
fn tiled(land: Land, [low, high]: [DVec2; 2], times: u32) -> Land {
    if times == 0 || land.0.is_empty() {
        return land;
    }
    let size = 0.5 * (high - low);
    let quarter = |i: u32| {
        let low = low + size * DVec2::new(f64::from(i % 2), f64::from(i / 2));
        let tile = Rect::new((low.x, low.y), (low.x + size.x, low.y + size.y)).to_polygon();
        let part = without_specks(land.intersection(&tile));
        tiled(part, [low, low + size], times - 1).0
    };
    geo::MultiPolygon((0..4u32).into_par_iter().flat_map_iter(quarter).collect())
}

/// Gives every edge the vertices of others that lie on it: pieces that share only a part of an edge gape when they are bent.
fn share_vertices(mut polygons: Vec<&mut Polygon>) {
    const SIDE_M: f64 = 16.0;
    let square = |p: DVec2| (p / SIDE_M).floor().to_array().map(|v| v as i64);
    let mut vertices: HashMap<_, Vec<DVec2>> = HashMap::new();
    for p in polygons.iter().flat_map(|p| std::iter::once(&p.outer).chain(&p.holes)).flatten() {
        vertices.entry(square(*p)).or_default().push(*p);
    }
    let mut on_edge: Vec<(f64, DVec2)> = Vec::new();
    for ring in polygons.iter_mut().flat_map(|p| std::iter::once(&mut p.outer).chain(&mut p.holes)) {
        let mut out = Vec::with_capacity(ring.len());
        for (k, &a) in ring.iter().enumerate() {
            let b = ring[(k + 1) % ring.len()];
            out.push(a);
            let (along, length) = ((b - a).normalize_or_zero(), a.distance(b));
            on_edge.clear();
            let [from, to] = [square(a.min(b) - ON_EDGE_M), square(a.max(b) + ON_EDGE_M)];
            for x in from[0]..=to[0] {
                // The squares of a row that the edge passes.
                let [left, right] = [x as f64 * SIDE_M, (x + 1) as f64 * SIDE_M]
                    .map(|at| if along.x.abs() < 1e-12 { None } else { Some(a.y + (at - a.x) / along.x * along.y) });
                let (low, high) = match (left, right) {
                    (Some(l), Some(r)) => (l.min(r).max(a.y.min(b.y)), l.max(r).min(a.y.max(b.y))),
                    _ => (a.y.min(b.y), a.y.max(b.y)),
                };
                let [low, high] = [low - ON_EDGE_M, high + ON_EDGE_M].map(|y| (y / SIDE_M).floor() as i64);
                for p in (low..=high).filter_map(|y| vertices.get(&[x, y])).flatten() {
                    let (t, off) = (along.dot(*p - a), along.perp_dot(*p - a).abs());
                    if t > ON_EDGE_M && t < length - ON_EDGE_M && off < ON_EDGE_M {
                        on_edge.push((t, *p));
                    }
                }
            }
            on_edge.sort_by(|p, q| p.0.total_cmp(&q.0));
            on_edge.dedup_by(|q, p| q.0 - p.0 < ON_EDGE_M);
            out.extend(on_edge.iter().map(|(_, p)| *p));
        }
        *ring = out;
    }
}

#[cfg(test)]
mod tests;
