//! Blocks of ground: displaced, projected, subdivided and clipped.

use crate::geometry::block::{Block, Counts, Geometry, Job, cover_of};
use crate::geometry::grid::{CELL_TRIANGLES, Nodes, ScreenExtent, cell_weights, kept_node};
use crate::geometry::lod::{self, DecimatedHeights};
use crate::geometry::pass::Pass;
use crate::geometry::refine::{Corner, Refiner};
use crate::geometry::select::SelectedBlock;
use crate::raster::cells::{NODES, SIDE};
use crate::screen::{Row, SUB, ScreenVertex};
use belvedere_core::Aabb;
use belvedere_scene::{Heightfield, NodeState};

impl Job<'_> {
    /// A block of ground at its level of detail; `None` if no part of it is on the image.
    /// * `bounds`: bounds of the block.
    pub(crate) fn terrain_block(
        &self,
        pass: &Pass<'_>,
        hf: &Heightfield,
        sparse: &DecimatedHeights,
        (chosen, bounds): (&SelectedBlock, Option<Aabb>),
        thin: bool,
    ) -> Option<Block> {
        let (origin, last) = lod::nodes(hf, chosen.level, chosen.block);
        let step = 1 << chosen.level;
        let mut out = Block {
            bodies: false,
            layer: self.layer,
            passes: pass.plain.numbers(),
            origin,
            cells: [0, 1].map(|axis| (last[axis] - origin[axis]) / step),
            step,
            geometry: Geometry::Soup(Vec::new()),
            seam: chosen.seam,
            soup_base: 0,
            cover: ScreenExtent::EMPTY,
            counts: Counts::default(),
            thin: Vec::new(),
        };
        let judges = !pass.plain.keeps_edges() && (chosen.edges || chosen.judged.contains(&true));
        let careful = thin || judges || !chosen.held.whole || bounds.is_none_or(|b| pass.plain.cuts(&b));
        if !careful && let Some(mut nodes) = self.project_grid(pass, hf, sparse, &out) {
            nodes.close_seams(chosen.seam);
            out.cover = nodes.cover();
            out.counts.drawn = 2 * (out.cells[0] * out.cells[1]) as u64;
            out.geometry = Geometry::Grid(nodes);
        } else {
            self.refine_grid(pass, hf, &mut out, chosen);
        }
        let ScreenExtent { x, y, .. } = out.cover;
        let size = [self.screen.width * SUB, self.screen.height * SUB];
        if x[0] > x[1] || x[1] < 0 || x[0] > size[0] || y[1] < 0 || y[0] > size[1] {
            self.spare.keep(out.geometry);
            return None;
        }
        Some(if thin { self.thin_ground(hf, out) } else { out })
    }

    fn thin_ground(&self, hf: &Heightfield, block: Block) -> Block {
        let Some(sections) = self.sections else { return block };
        let (origin, step) = (block.origin, block.step);
        block.thinned(|parent| {
            let cell = (parent >> 1) as usize;
            CELL_TRIANGLES[(parent & 1) as usize].map(|n| {
                let at = [cell % SIDE + (n & 1), cell / SIDE + (n >> 1)];
                let [col, row] = [0, 1].map(|axis| origin[axis] + step * at[axis]);
                let height = f64::from(hf.heights()[row * hf.cols() + col]);
                sections.parameter(hf.node_xy(col, row).extend(height))
            })
        })
    }

    /// Nodes of the block on the image, if none needs clipping.
    fn project_grid(
        &self,
        pass: &Pass<'_>,
        hf: &Heightfield,
        sparse: &DecimatedHeights,
        block: &Block,
    ) -> Option<Nodes> {
        let ([cols, rows], step) = (block.cells, block.step);
        let mut nodes = self.spare.nodes();
        nodes.reset(block.cells);
        let count = cols + 1;
        let columns = pass.columns(hf, block.origin[0], step, count);
        let mut whole = true;
        // All rows are read first: they lie far apart in memory, and the reads overlap.
        let mut heights = [[0.0; NODES]; NODES];
        for (r, heights) in heights[..=rows].iter_mut().enumerate() {
            columns.heights(hf, sparse, block.origin[1] + step * r, heights);
        }
        for (r, heights) in heights[..=rows].iter().enumerate() {
            let (col, row) = (block.origin[0], block.origin[1] + step * r);
            let first = row * hf.cols() + col;
            let states = hf.states();
            if states.each().is_some_and(|s| s[first..=first + step * cols].contains(&NodeState::Void)) {
                for c in 0..=cols {
                    let at = [col + step * c, row];
                    if hf.node(at[0], at[1]).is_none() {
                        nodes.set(c, r, ScreenVertex::NONE);
                    } else if let Some(image) = pass.ground_node(self.screen, hf, at) {
                        nodes.set(c, r, image);
                    } else {
                        whole = false;
                    }
                }
            } else {
                let part = r * count..(r + 1) * count;
                let (x, y) = (&mut nodes.x[part.clone()], &mut nodes.y[part.clone()]);
                let mut out = Row { x, y, q: &mut nodes.q[part] };
                whole = pass.ground_row(self.screen, hf, &columns, row, &heights[..count], &mut out);
            }
            if !whole {
                self.spare.keep(Geometry::Grid(nodes));
                return None;
            }
        }
        Some(nodes)
    }

    fn refine_grid(&self, pass: &Pass<'_>, hf: &Heightfield, block: &mut Block, chosen: &SelectedBlock) {
        let mut refiner = Refiner::new(&pass.plain, self.screen, self.tolerance_px, self.spare.soup());
        let (cells, seam) = (block.cells, block.seam);
        let [cols, rows] = cells;
        let ([north, east, south, west], judge) = (chosen.judged, !pass.plain.keeps_edges());
        let corners: Vec<Option<Corner>> = (0..(cols + 1) * (rows + 1))
            .map(|i| {
                let kept = kept_node(seam, cells, [i % (cols + 1), i / (cols + 1)]);
                let at = [0, 1].map(|axis| block.origin[axis] + block.step * kept[axis]);
                hf.node(at[0], at[1]).map(|p| refiner.node(p, pass.ground_node(self.screen, hf, at)))
            })
            .collect();
        block.counts.missed = corners.iter().flatten().filter(|c| c.is_missing()).count() as u64;
        for r in 0..rows {
            for c in 0..cols {
                let nw = r * (cols + 1) + c;
                for (k, tri) in CELL_TRIANGLES.iter().enumerate() {
                    let [Some(a), Some(b), Some(d)] = tri.map(|n| corners[nw + (n & 1) + (n >> 1) * (cols + 1)]) else {
                        continue;
                    };
                    // Edges 0-1, 1-2, 2-0 of the triangle: north, east or west, south; the diagonal is the last.
                    let side = |on_side: bool, judged: bool| judge && if on_side { judged } else { chosen.edges };
                    let split = if k == 0 {
                        [side(r == 0, north), side(c + 1 == cols, east), side(false, false)]
                    } else {
                        [side(c == 0, west), side(r + 1 == rows, south), side(false, false)]
                    };
                    let weights = cell_weights(seam, cells, [c, r], k);
                    refiner.triangle([a, b, d], weights, split, ((r * SIDE + c) as u32) << 1 | k as u32);
                }
            }
        }
        block.counts.split = refiner.splits;
        block.counts.drawn = refiner.out.len() as u64;
        block.cover = cover_of(&refiner.out);
        block.geometry = Geometry::Soup(refiner.out);
    }
}
