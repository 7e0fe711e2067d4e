//! The grid of a file: its samples in the plane of the scene.

use super::super::Field;
use belvedere_core::DVec2;

/// A chord between two positions leaves what lies between them by less than this in plan, cells.
const BOW_CELLS: f64 = 0.01;
/// Chords are halved at most this often.
const HALVINGS: u32 = 12;

/// A map of positions in plan; `None` outside its domain.
pub type PlanMap<'a> = &'a (dyn Fn(DVec2) -> Option<DVec2> + Sync);

/// The samples of a file, in its own coordinate system, and how a program cuts the cells between them.
#[derive(Clone, Copy)]
pub struct SampleGrid<'a> {
    /// Columns and rows, at least 2 each.
    pub nodes: [usize; 2],
    /// Distance between columns and between rows, about, scene units, > 0: parts of features are weighed by it.
    pub spacing: DVec2,
    /// From scene x, y to column and row of the samples, the first at 0.
    pub index_from_scene: PlanMap<'a>,
    /// From column and row to scene x, y.
    pub scene_from_index: PlanMap<'a>,
    /// Whether cells are cut from north-east to south-west instead of from north-west to south-east.
    pub other_diagonal: bool,
}

impl SampleGrid<'_> {
    /// The same samples with the cells cut otherwise.
    pub fn cut_otherwise(self) -> Self {
        Self { other_diagonal: !self.other_diagonal, ..self }
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.nodes[0] * self.nodes[1]
    }

    /// Index in the file of the `i`-th sample here: from east to west the cells of a grid have the other diagonal.
    pub(super) fn sample(&self, i: usize) -> usize {
        let cols = self.nodes[0];
        if self.other_diagonal { i / cols * cols + cols - 1 - i % cols } else { i }
    }

    fn turned(&self, index: DVec2) -> DVec2 {
        if self.other_diagonal { DVec2::new((self.nodes[0] - 1) as f64 - index.x, index.y) } else { index }
    }

    /// Column and row of scene x, y.
    pub(super) fn index(&self, p: DVec2) -> Option<DVec2> {
        (self.index_from_scene)(p).map(|index| self.turned(index))
    }

    /// Scene x, y of a column and row.
    pub(super) fn scene(&self, index: DVec2) -> Option<DVec2> {
        (self.scene_from_index)(self.turned(index))
    }

    /// A chain of scene positions in the coordinates of `field`, with as many further positions as its straight pieces need.
    pub(super) fn image_of(&self, field: &Field, line: &[DVec2]) -> Vec<DVec2> {
        let mut out: Vec<DVec2> = Vec::new();
        let mut last = None;
        for &p in line {
            let Some(index) = self.index(p) else {
                last = None;
                continue;
            };
            if let Some(from) = last {
                self.halve(from, (p, index), 0, &mut |_, index| out.push(field.scene_from_grid(index)));
            }
            out.push(field.scene_from_grid(index));
            last = Some((p, index));
        }
        out
    }

    /// Visits positions between two, in their order, until chords between them keep to [`BOW_CELLS`].
    pub(super) fn halve(
        &self,
        a: (DVec2, DVec2),
        b: (DVec2, DVec2),
        halvings: u32,
        visit: &mut dyn FnMut(DVec2, DVec2),
    ) {
        let middle = 0.5 * (a.0 + b.0);
        let Some(index) = self.index(middle).filter(|_| halvings < HALVINGS) else { return };
        if index.distance(0.5 * (a.1 + b.1)) > BOW_CELLS {
            self.halve(a, (middle, index), halvings + 1, visit);
            visit(middle, index);
            self.halve((middle, index), b, halvings + 1, visit);
        }
    }
}
