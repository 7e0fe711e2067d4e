//! Cells: the settled ground without the ground of streets, and which building belongs to which.

use super::index::{Box2, CellIndex, bounds_of};
use super::settings::GeneraliseSettings;
use super::shapes::{Land, area, by_place, common, filled, grown, union, without_specks};
use belvedere_core::DVec2;
use geo::{Area, BooleanOps, Centroid, ConvexHull, InteriorPoint, MultiPolygon};
use rayon::prelude::*;

/// Largest distance of a neighbour across a street, metres.
const REACH_M: f64 = 30.0;
/// Spacing of the points of an outline from which a neighbour is sought, metres.
const LOOK_EVERY_M: f64 = 2.0;

/// Cells of a level.
#[derive(Debug)]
pub(super) struct Cells {
    /// Ground of every cell, one polygon, and more where small ones joined.
    pub lands: Vec<Land>,
    /// Small cells that joined a neighbour.
    pub merged: usize,
}

/// The ground near buildings, without holes.
pub(super) fn settled(buildings: &[Land], margin: f64) -> Land {
    let near = |land: &Land| grown(&MultiPolygon(vec![land.convex_hull()]), margin);
    filled(union(by_place(buildings.par_iter().map(near).collect())))
}

/// Cells of `extent` that `streets` leave.
pub(super) fn cells(extent: &Land, streets: &Land, settings: &GeneraliseSettings) -> Cells {
    let ground = without_specks(extent.difference(streets));
    let pieces: Vec<Land> = ground.into_iter().map(|p| MultiPolygon(vec![p])).collect();
    let (target, merged) = neighbours_of_small(&pieces, settings.smallest_cell_m2);
    let mut lands: Vec<Land> = vec![MultiPolygon(Vec::new()); pieces.len()];
    for (piece, cell) in pieces.into_iter().zip(&target) {
        lands[*cell].0.extend(piece);
    }
    lands.retain(|land| !land.0.is_empty());
    Cells { lands, merged }
}

/// For every piece the piece that it joins, and the number of pieces that joined another. The smallest piece goes first; a piece that
/// has grown large enough stays.
fn neighbours_of_small(pieces: &[Land], smallest: f64) -> (Vec<usize>, usize) {
    let index = CellIndex::new(pieces);
    let mut areas: Vec<f64> = pieces.iter().map(area).collect();
    let mut small: Vec<usize> = (0..pieces.len()).filter(|i| areas[*i] < smallest).collect();
    small.sort_by(|a, b| areas[*a].total_cmp(&areas[*b]).then(a.cmp(b)));
    let faced: Vec<Option<usize>> = small.par_iter().map(|i| faced_most(&index, &pieces[*i], *i)).collect();
    let mut target: Vec<usize> = (0..pieces.len()).collect();
    let mut merged = 0;
    for (piece, faced) in small.into_iter().zip(faced) {
        let Some(mut cell) = faced else { continue };
        while target[cell] != cell {
            cell = target[cell];
        }
        if areas[piece] < smallest && cell != piece {
            areas[cell] += areas[piece];
            target[piece] = cell;
            merged += 1;
        }
    }
    let roots = (0..target.len())
        .map(|mut i| {
            while target[i] != i {
                i = target[i];
            }
            i
        })
        .collect();
    (roots, merged)
}

/// The other piece that is nearest, across a street, for most points of the outline.
fn faced_most(index: &CellIndex<'_>, piece: &Land, own: usize) -> Option<usize> {
    let mut votes: Vec<(usize, f64)> = Vec::new();
    for line in piece.iter().flat_map(|p| p.exterior().lines()) {
        let (a, b) = (DVec2::new(line.start.x, line.start.y), DVec2::new(line.end.x, line.end.y));
        let parts = (a.distance(b) / LOOK_EVERY_M).ceil().max(1.0);
        for part in 0..parts as usize {
            let at = a.lerp(b, (part as f64 + 0.5) / parts);
            let Some(cell) = index.nearest(at, REACH_M, Some(own)) else { continue };
            match votes.iter_mut().find(|(c, _)| *c == cell) {
                Some((_, length)) => *length += a.distance(b) / parts,
                None => votes.push((cell, a.distance(b) / parts)),
            }
        }
    }
    votes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(cell, _)| cell)
}

/// The cell of every building: the one that holds most of its footprint, or the nearest. `None` only where there is no cell.
pub(super) fn assign(cells: &[Land], buildings: &[Land]) -> Vec<Option<usize>> {
    let index = CellIndex::new(cells);
    buildings.par_iter().map(|land| cell_of(&index, cells, land)).collect()
}

fn cell_of(index: &CellIndex<'_>, cells: &[Land], building: &Land) -> Option<usize> {
    let bounds: Box2 = bounds_of(building)?;
    let middle = building.centroid().map_or(0.5 * (bounds[0] + bounds[1]), |c| DVec2::new(c.x(), c.y()));
    let crossing = index.cells_near(bounds);
    if crossing.is_empty()
        && let Some(cell) = index.cell_at(middle)
    {
        return Some(cell);
    }
    let overlaps = crossing.iter().map(|cell| (area(&common(&cells[*cell], building)), *cell));
    let most = overlaps.filter(|(overlap, _)| *overlap > 0.0).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    most.map(|(_, cell)| cell)
        .or_else(|| index.nearest(middle, 2.0 * REACH_M, None))
        .or_else(|| nearest_of_all(cells, middle))
}

fn nearest_of_all(cells: &[Land], p: DVec2) -> Option<usize> {
    let away = |land: &Land| bounds_of(land).map_or(f64::MAX, |[low, high]| p.distance(p.clamp(low, high)));
    (0..cells.len()).min_by(|a, b| away(&cells[*a]).total_cmp(&away(&cells[*b])))
}

/// The coarse cell of every building, which is that of its fine cell.
pub(super) fn assign_by_cells(
    coarse: &[Land],
    fine: &[Land],
    of_fine: &[Option<usize>],
    buildings: &[Land],
) -> Vec<Option<usize>> {
    let index = CellIndex::new(coarse);
    let inside = |land: &Land| {
        let largest = land.iter().max_by(|a, b| a.unsigned_area().total_cmp(&b.unsigned_area()))?;
        let point = largest.interior_point()?;
        index.cell_at(DVec2::new(point.x(), point.y()))
    };
    let parents: Vec<Option<usize>> = fine.par_iter().map(inside).collect();
    let of = |(building, fine): (&Land, &Option<usize>)| {
        fine.and_then(|fine| parents[fine]).or_else(|| cell_of(&index, coarse, building))
    };
    buildings.par_iter().zip(of_fine).map(of).collect()
}
