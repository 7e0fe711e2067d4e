//! Blocks: what stands for the buildings of a cell.

use super::settings::GeneraliseSettings;
use super::shapes::{Land, area, closed, common, grown, shrunk, simplified, union, without_specks};
use geo::{Area, BooleanOps, MultiPolygon};

/// What a cell is drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CellKind {
    /// Hardly built: no block.
    Green,
    /// Built here and there: the block follows the buildings.
    Sparse,
    /// Built: the block follows the cell.
    Built,
    /// All its buildings are landmarks: no block.
    Landmarks,
}

/// What a cell becomes by the share of it that is built.
pub(super) fn kind(coverage: f64, ordinary: usize, settings: &GeneraliseSettings) -> CellKind {
    if coverage < settings.green_below {
        CellKind::Green
    } else if ordinary == 0 {
        CellKind::Landmarks
    } else if coverage < settings.sparse_below {
        CellKind::Sparse
    } else {
        CellKind::Built
    }
}

/// Footprint of the block of a cell: inside the cell, clear of the landmarks, never empty where there are buildings in the cell.
pub(super) fn footprint(
    cell: &Land,
    kind: CellKind,
    ordinary: &[&Land],
    landmarks: &[&Land],
    settings: &GeneraliseSettings,
) -> Land {
    let cell = main_pieces(cell, settings.smallest_cell_m2);
    let standing = |lands: &[&Land]| union(lands.iter().map(|l| (*l).clone()).collect());
    // Narrow cells keep what distance from the street they can.
    let insets = [settings.inset_m, 0.5 * settings.inset_m, 0.0];
    let shapes = insets.iter().map(|inset| {
        let free = shrunk(&cell, *inset);
        let free = if landmarks.is_empty() {
            free
        } else {
            without_specks(free.difference(&grown(&standing(landmarks), settings.inset_m)))
        };
        match kind {
            CellKind::Sparse => common(&closed(&standing(ordinary), settings.closing_m), &free),
            _ => free,
        }
    });
    let least = 0.25 * ordinary.iter().map(|l| area(l)).sum::<f64>();
    let mut best: Land = MultiPolygon(Vec::new());
    for (shape, inset) in shapes.zip(insets) {
        let shape = without_slivers(shape);
        if area(&shape) > area(&best) {
            best = common(&simplified(&shape, settings.simplify_m.min(inset)), &cell);
        }
        if area(&best) >= least && !best.0.is_empty() {
            break;
        }
    }
    best
}

/// The pieces of a cell that are large enough for themselves, or all if none is.
fn main_pieces(cell: &Land, smallest: f64) -> Land {
    let large: Vec<_> = cell.iter().filter(|p| p.unsigned_area() >= smallest).cloned().collect();
    if large.is_empty() { cell.clone() } else { MultiPolygon(large) }
}

/// Pieces of at least 10 m^2, or the largest.
fn without_slivers(land: Land) -> Land {
    const SLIVER_M2: f64 = 10.0;
    let areas: Vec<f64> = land.iter().map(|p| p.unsigned_area()).collect();
    let most = areas.iter().copied().fold(0.0, f64::max);
    let kept = land.into_iter().zip(areas).filter(|(_, area)| *area >= SLIVER_M2.min(most)).map(|(p, _)| p);
    MultiPolygon(kept.collect())
}
