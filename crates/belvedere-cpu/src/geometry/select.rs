//! Chooses the blocks of the ground to draw, and their levels of detail.

use crate::geometry::locate::{Held, Locator};
use crate::geometry::lod::Tree;
use crate::geometry::part::Part;
use belvedere_core::{Aabb, View};
use belvedere_scene::Heightfield;
use belvedere_sight::pass::{Way, edge_error};
use belvedere_sight::screen::COARSE_PX;

/// A block to draw.
#[derive(Debug, Clone)]
pub(crate) struct SelectedBlock {
    pub(crate) level: usize,
    pub(crate) block: [usize; 2],
    /// Whether drawing the edges of its cells straight may exceed the tolerance.
    pub(crate) edges: bool,
    /// The passes that draw it, in [`Selection::passes`].
    pub(crate) held: Held,
    /// Sides (north, east, south, west) along which the neighbour's edges may be split too.
    pub(crate) judged: [bool; 4],
    /// Sides along which the neighbour is drawn in half the detail.
    pub(crate) seam: [bool; 4],
    /// Pixels per unit of height in the block; infinite where unknown.
    px_per_unit: f64,
    dropped: bool,
}

/// Chosen blocks of the tree; kept between frames so that its memory is reused.
#[derive(Debug, Default)]
pub(crate) struct Selection {
    /// Per block of all levels: [`NOTHING`], [`SPLIT`] or [`FIRST`] plus the index in `list`.
    state: Vec<u32>,
    starts: Vec<usize>,
    cols: Vec<usize>,
    pub(crate) list: Vec<SelectedBlock>,
    pub(crate) passes: Vec<u32>,
}

const NOTHING: u32 = 0;
const SPLIT: u32 = 1;
const FIRST: u32 = 2;

/// Parts of fewer cells along a side are not judged by their quarters.
const FEWEST_CELLS: usize = 8;
/// North, east, south, west.
const AROUND: [[isize; 2]; 4] = [[0, -1], [1, 0], [0, 1], [-1, 0]];

/// Inputs of the choice: the ground, the camera and the permitted errors.
pub(crate) struct DetailSelector<'a> {
    pub(crate) hf: &'a Heightfield,
    pub(crate) tree: &'a Tree,
    pub(crate) view: &'a View,
    pub(crate) locator: &'a Locator<'a>,
    /// Worst error of a bent edge drawn straight, pixels.
    pub(crate) tolerance_px: f64,
    /// Worst error of level of detail, bend included, pixels; 0 draws every cell.
    pub(crate) lod_px: f64,
}

impl DetailSelector<'_> {
    /// Walks the tree from the root down: drops blocks outside the image, stops where the error is small enough, then halves blocks
    /// that are too coarse beside a finer neighbour.
    pub(crate) fn choose(&self, out: &mut Selection) {
        out.clear(self.tree);
        let top = self.tree.levels() - 1;
        let all = self.locator.all(&mut out.passes);
        self.visit(top, [0, 0], &all, self.view.stages().is_empty(), out);
        let mut i = 0;
        while i < out.list.len() {
            if !out.list[i].dropped {
                (0..4).for_each(|side| self.settle(i, side, out));
            }
            i += 1;
        }
        for i in 0..out.list.len() {
            for side in 0..4 {
                let SelectedBlock { level, block, edges, .. } = out.list[i];
                let near = self.neighbour(level, block, side, out).map(|k| (out.list[k].level, out.list[k].edges));
                out.list[i].seam[side] = near.is_some_and(|(n, _)| n > level);
                // Both blocks judge a common edge alike; the edges of a coarser neighbour are straight enough.
                out.list[i].judged[side] = near.map_or(edges, |(n, e)| n == level && (edges || e)) && level == 0;
            }
        }
        out.list.retain(|c| !c.dropped);
    }

    /// * `larger`: passes of the parent block.
    fn visit(&self, level: usize, block: [usize; 2], larger: &Held, mut plain: bool, out: &mut Selection) {
        let Some(bounds) = self.tree.bounds(self.hf, level, block) else { return };
        let held = self.locator.locate(&bounds, larger, &mut out.passes);
        let Some(px_per_unit) = self.locator.px_per_height(&bounds, out.drawn_by(&held), self.is_coarse()) else {
            return;
        };
        let height_px = f64::from(self.tree.span(level, block).error) * px_per_unit;
        // Where records are clipped from each other, all of them must clip the same triangles, so level 0 is drawn.
        let coarse = level > 0 && held.whole && height_px <= self.lod_px && self.lod_px > 0.0;
        let mut bend_px = 0.0;
        // A coarse picture judges the edges of a block only where it may be drawn.
        let judges = coarse || (!plain && (level == 0 || !self.is_coarse()));
        if !self.view.stages().is_empty() && judges {
            let plain_px = self.tolerance_px * (1 << level) as f64;
            let most_px = if coarse { plain_px.max(self.lod_px) } else { plain_px };
            bend_px = f64::INFINITY;
            if held.whole {
                let ways: Vec<Way> = out.ways(&held, self.view).collect();
                bend_px = self.part_error(&Part::of_block(self.hf, level, block), &bounds, &ways, most_px);
            }
            plain |= bend_px <= plain_px;
        }
        if level == 0 || (coarse && height_px + bend_px <= self.lod_px) {
            let edges = level == 0 && !plain;
            out.add(SelectedBlock {
                level,
                block,
                edges,
                held,
                judged: [false; 4],
                seam: [false; 4],
                px_per_unit,
                dropped: false,
            });
            return;
        }
        self.descend(level, block, &held, plain, out);
    }

    fn descend(&self, level: usize, block: [usize; 2], held: &Held, plain: bool, out: &mut Selection) {
        out.set(level, block, SPLIT);
        let [cols, rows] = self.tree.size(level - 1);
        for [i, j] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let child = [2 * block[0] + i, 2 * block[1] + j];
            if child[0] < cols && child[1] < rows {
                self.visit(level - 1, child, held, plain, out);
            }
        }
    }

    /// Whether the picture is a coarse one: less is judged, and only what the image shows of a block that reaches behind the eye.
    fn is_coarse(&self) -> bool {
        self.tolerance_px >= COARSE_PX
    }

    /// [`DetailSelector::cells_error`] of the part as a whole or, where that is too large, of the worst of its quarters: a smooth bend's
    /// error falls with the square of the length, the bound of a box only in proportion to it.
    fn part_error(&self, part: &Part, bounds: &Aabb, ways: &[Way], most_px: f64) -> f64 {
        let whole = self.cells_error(bounds, ways, part.cells(), most_px);
        if whole.is_finite() || self.is_coarse() || part.cells() < FEWEST_CELLS {
            return whole;
        }
        let mut worst = 0.0f64;
        for quarter in part.quarters() {
            let Some(bounds) = quarter.bounds(self.hf, self.tree, bounds) else { continue };
            worst = worst.max(self.part_error(&quarter, &bounds, ways, most_px));
            if worst == f64::INFINITY {
                break;
            }
        }
        worst
    }

    /// Bound on the error in pixels of drawing the edges of cells straight, `n` cells to a side of the box.
    ///
    /// The chord of a curve that turns by a given angle deviates in proportion to its length, so the bound of the box's
    /// long edges, shared out over its cells with a factor 2 in hand, covers the cells' edges. In a coarse picture two diagonals stand for
    /// all edges, and edges without an image do not count.
    /// * `ways`: ways of all passes that draw the box. `most_px`: a larger error decides nothing, and infinity stands for it.
    fn cells_error(&self, bounds: &Aabb, ways: &[Way], n: usize, most_px: f64) -> f64 {
        let c = bounds.corners();
        let all = [(0, 7), (2, 5), (1, 6), (3, 4), (0, 1), (2, 3), (0, 2), (1, 3), (4, 7), (5, 6)];
        let behind = self.is_coarse() && self.locator.reaches_behind(bounds);
        let pairs = if self.is_coarse() && !behind { &all[..2] } else { &all };
        let (mut worst, mut known) = (0.0f64, false);
        for &way in ways {
            for &(a, b) in pairs {
                let error = edge_error(self.view, way, c[a], c[b]).px * 2.0 / n as f64;
                if behind && error == f64::INFINITY {
                    continue;
                }
                if !(error <= most_px) {
                    return f64::INFINITY;
                }
                (worst, known) = (worst.max(error), true);
            }
        }
        if known || !behind { worst } else { f64::INFINITY }
    }

    /// Halves the neighbour beyond a side until it is at most one level coarser and the error of the seam is small enough.
    fn settle(&self, i: usize, side: usize, out: &mut Selection) {
        let SelectedBlock { level, block, px_per_unit, held: Held { whole, .. }, .. } = out.list[i];
        while let Some(k) = self.neighbour(level, block, side, out) {
            let near = out.list[k].clone();
            let span = self.tree.span(level, block);
            let seam_px = f64::from(span.error + span.seam[side]) * px_per_unit;
            if near.level <= level || (near.level == level + 1 && whole && seam_px <= self.lod_px) {
                return;
            }
            out.list[k].dropped = true;
            out.set(near.level, near.block, SPLIT);
            self.halve(near, out);
        }
    }

    /// Replaces a block by its four quarters, except those off the image. Errors do not grow towards finer levels.
    fn halve(&self, parent: SelectedBlock, out: &mut Selection) {
        let level = parent.level - 1;
        let [cols, rows] = self.tree.size(level);
        for [i, j] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let block = [2 * parent.block[0] + i, 2 * parent.block[1] + j];
            if block[0] >= cols || block[1] >= rows {
                continue;
            }
            let Some(bounds) = self.tree.bounds(self.hf, level, block) else { continue };
            let held = self.locator.locate(&bounds, &parent.held, &mut out.passes);
            let px_per_unit = self.locator.px_per_height(&bounds, out.drawn_by(&held), self.is_coarse());
            if let Some(px_per_unit) = px_per_unit {
                out.add(SelectedBlock { level, block, px_per_unit, held, ..parent });
            }
        }
    }

    /// The chosen block of the same level or a coarser one beyond a side.
    fn neighbour(&self, level: usize, block: [usize; 2], side: usize, out: &Selection) -> Option<usize> {
        let [cols, rows] = self.tree.size(level);
        let x = block[0].checked_add_signed(AROUND[side][0]).filter(|x| *x < cols)?;
        let y = block[1].checked_add_signed(AROUND[side][1]).filter(|y| *y < rows)?;
        for up in 0..self.tree.levels() - level {
            match out.get(level + up, [x >> up, y >> up]) {
                NOTHING => {}
                SPLIT => return None,
                k => return Some((k - FIRST) as usize),
            }
        }
        None
    }
}

impl Selection {
    fn clear(&mut self, tree: &Tree) {
        self.list.clear();
        self.starts.clear();
        let mut n = 0;
        for level in 0..tree.levels() {
            self.starts.push(n);
            n += tree.size(level).iter().product::<usize>();
        }
        self.state.clear();
        self.state.resize(n, NOTHING);
        self.cols = (0..tree.levels()).map(|level| tree.size(level)[0]).collect();
    }

    /// Records and segments that draw a block.
    pub(crate) fn held(&self, held: &Held) -> [&[u32]; 2] {
        [&self.passes[held.records.clone()], &self.passes[held.segments.clone()]]
    }

    /// Numbers of the passes that draw a block.
    fn drawn_by(&self, held: &Held) -> impl Iterator<Item = u32> {
        self.held(held).into_iter().flatten().copied()
    }

    /// Ways in which curved rays displace a block, those of records that displace it as one map joined.
    fn ways(&self, held: &Held, view: &View) -> impl Iterator<Item = Way> {
        let [records, segments] = self.held(held);
        let all = records.first().zip(records.last());
        let records = view.records() as u32;
        let joined = all.map(|(&first, &last)| Way::Records([first as usize, last as usize]));
        joined.into_iter().chain(segments.iter().map(move |number| Way::Segment(number - records)))
    }

    fn at(&self, level: usize, [x, y]: [usize; 2]) -> usize {
        self.starts[level] + y * self.cols[level] + x
    }

    fn get(&self, level: usize, block: [usize; 2]) -> u32 {
        self.state[self.at(level, block)]
    }

    fn set(&mut self, level: usize, block: [usize; 2], state: u32) {
        let at = self.at(level, block);
        self.state[at] = state;
    }

    fn add(&mut self, chosen: SelectedBlock) {
        self.set(chosen.level, chosen.block, FIRST + self.list.len() as u32);
        self.list.push(SelectedBlock { dropped: false, ..chosen });
    }
}
