//! Terrain cells: the ground divided into one piece per significant summit.

mod neighbours;
mod pairs;
mod persistence;
#[cfg(test)]
mod reference;
mod regions;
mod tables;

use super::Field;
use belvedere_core::DVec2;
use neighbours::Neighbours;
use persistence::Persistence;
use rayon::prelude::*;
use regions::Regions;
use tables::Tables;

/// Label of void nodes, which belong to no cell.
pub const NO_CELL: u32 = u32::MAX;

/// Partition of the ground into one cell per significant summit: all nodes from which steepest ascent ends at that summit, or at a
/// lesser summit that is merged into it.
///
/// Cells are numbered by the index of their summit. Nodes are ordered by height and, where heights are equal, by index:
/// there are no plateaus and no ties.
///
/// Source: the partition by mountains of Deng et al. 2011, 2013; by steepest ascent and persistence (Edelsbrunner et al. 2002): ours.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    labels: Vec<u32>,
    summits: Vec<u32>,
    persistence: Vec<f64>,
    tables: Tables,
    neighbours: Neighbours,
}

impl Cells {
    /// * `keep`: cells wanted; fewer if the ground has fewer summits, more if it has more unconnected parts.
    pub fn new(field: &Field, keep: usize) -> Self {
        let regions = Regions::new(field);
        let persistence = Persistence::new(field, &regions);
        let kept = persistence.keep(field, &regions, keep);
        let mut labels = regions.of_node;
        labels
            .par_iter_mut()
            .with_min_len(1 << 14)
            .filter(|l| **l != NO_CELL)
            .for_each(|l| *l = kept.cell_of[*l as usize]);
        let count = kept.summits.len();
        let (tables, neighbours) =
            rayon::join(|| Tables::new(field, &labels, count), || Neighbours::new(field.cols(), &labels, count));
        Self { labels, summits: kept.summits, persistence: kept.persistence, tables, neighbours }
    }

    /// Cells wanted by default: one for 1600 nodes, at least one.
    pub fn default_count(field: &Field) -> usize {
        crate::settings::default_cells(field.heights().len())
    }

    /// Number of cells, at least 1.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.summits.len()
    }

    /// Cell of every node, row-major; [`NO_CELL`] at voids.
    pub fn labels(&self) -> &[u32] {
        &self.labels
    }

    /// Node of each cell's summit, ascending.
    pub fn summits(&self) -> &[u32] {
        &self.summits
    }

    /// Persistence of each summit: its height over the highest saddle that leads to a higher summit, scene units; infinite if no
    /// saddle does.
    pub fn persistence(&self) -> &[f64] {
        &self.persistence
    }

    /// Cells that share edges of the grid with `cell`, ascending, and for each the share of the cell's border (adding up to 1).
    pub fn neighbours(&self, cell: usize) -> (&[u32], &[f64]) {
        self.neighbours.of(cell)
    }

    /// Mean height of a cell over the field's datum, scene units.
    pub fn mean_height(&self, cell: usize) -> f64 {
        self.tables.mean(cell)
    }

    /// Share of a cell's nodes strictly higher than `h` (scene units over the field's datum), and their mean height over the datum;
    /// (0, the greatest height) if no node is higher.
    pub fn higher(&self, cell: usize, h: f64) -> (f64, f64) {
        self.tables.higher(cell, h)
    }

    /// The cell of the node with data that is nearest to a point on the ground, grid coordinates.
    pub(super) fn cell_at(&self, field: &Field, g: DVec2) -> usize {
        let (col, row) = ((g.x as usize).min(field.cols() - 2), (g.y as usize).min(field.rows() - 2));
        let label = |(c, r): (usize, usize)| self.labels[r * field.cols() + c];
        let away = |(c, r): (usize, usize)| (DVec2::new(c as f64, r as f64) - g).length_squared();
        let corners = [(col, row), (col + 1, row), (col, row + 1), (col + 1, row + 1)];
        let solid = corners.into_iter().filter(|corner| label(*corner) != NO_CELL);
        label(solid.min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or((col, row))) as usize
    }

    /// Number of nodes of a cell, at least 1.
    pub fn size(&self, cell: usize) -> usize {
        self.tables.size(cell)
    }
}

#[cfg(test)]
pub(super) mod tests;
