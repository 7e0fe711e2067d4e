//! Surfaces cut into blocks: culled, displaced and projected once per frame, ready to rasterise.

use crate::band::Band;
use crate::cache::{GroundCache, lock};
use crate::choose::{Choice, Chooser, Chosen};
use crate::grid::{CELL_TRIANGLES, Cover, NODES, Nodes, cell_weights, kept_node};
use crate::lens::{Lens, SUB, ScreenVertex};
pub(crate) use crate::lod::SIDE;
use crate::lod::{self, Sparse, Tree};
use crate::pass::Pass;
use crate::project::Row;
use crate::refine::{Corner, Refiner};
use belvedere_scene::{Heightfield, LayerKind, NodeState, RenderOptions, Scene};
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// A primitive number with this bit counts soup triangles; without it, cells of grid blocks.
pub(crate) const SOUP: u32 = 1 << 31;
/// Bits of a grid primitive below the block number: 10 of the cell, 1 of the triangle.
pub(crate) const CELL_BITS: u32 = 11;

/// A vertex of a subdivided or clipped triangle: image, and weights of vertices 1 and 2 of the parent triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SoupVertex {
    pub(crate) screen: ScreenVertex,
    pub(crate) weights: [f32; 2],
}

/// Part of a parent triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SoupTriangle {
    pub(crate) v: [SoupVertex; 3],
    /// `2 * (SIDE * r + c) + triangle` of drawn cell (c, r) in a terrain block, `12 * box + triangle` in a block of boxes,
    /// the triangle in a block of a mesh; counted from the block's first.
    pub(crate) parent: u32,
}

#[derive(Debug)]
pub(crate) enum Geometry {
    /// Nodes of the block row by row; every cell without void nodes draws two triangles.
    Grid(Nodes),
    /// Explicit triangles.
    Soup(Vec<SoupTriangle>),
}

/// A piece of a surface layer.
#[derive(Debug)]
pub(crate) struct Block {
    pub(crate) layer: u32,
    /// First column and row (terrain), first box or first triangle (mesh).
    pub(crate) origin: [usize; 2],
    /// Drawn cells of a terrain block.
    pub(crate) cells: [usize; 2],
    /// Cells of the ground along the side of a drawn cell: node (c, r) of the block is node `origin + step * (c, r)` of
    /// the ground. 1 = full detail.
    pub(crate) step: usize,
    pub(crate) geometry: Geometry,
    /// Sides along which every second node is left out, see [`crate::lod::Span::seam`].
    seam: [bool; 4],
    /// Number of the first soup triangle.
    soup_base: u32,
    /// What the block may touch of the image.
    cover: Cover,
    pub(crate) counts: Counts,
}

/// Contribution to [`belvedere_scene::FrameStats`].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) drawn: u64,
    pub(crate) split: u64,
    pub(crate) missed: u64,
}

/// Where a sample hit: a block's parent triangle and the screen triangle drawn for it.
pub(crate) struct Found<'a> {
    pub(crate) block: &'a Block,
    pub(crate) parent: u32,
    pub(crate) v: [SoupVertex; 3],
}

/// All blocks of a frame; kept between frames for its memory.
#[derive(Debug, Default)]
pub(crate) struct Blocks {
    pub(crate) list: Vec<Block>,
    /// Numbers of the blocks, nearest first.
    order: Vec<u32>,
    soups: Vec<(u32, u32)>,
    pub(crate) triangles_in: u64,
    choice: Choice,
    spare: Spare,
}

/// Memory of blocks that are no longer needed.
#[derive(Debug, Default)]
pub(crate) struct Spare {
    nodes: Mutex<Vec<Nodes>>,
    soup: Mutex<Vec<Vec<SoupTriangle>>>,
}

impl Spare {
    fn nodes(&self) -> Nodes {
        lock(&self.nodes).pop().unwrap_or_default()
    }

    pub(crate) fn soup(&self) -> Vec<SoupTriangle> {
        lock(&self.soup).pop().unwrap_or_default()
    }

    fn keep(&self, geometry: Geometry) {
        match geometry {
            Geometry::Grid(nodes) => lock(&self.nodes).push(nodes),
            Geometry::Soup(soup) => lock(&self.soup).push(soup),
        }
    }
}

impl Block {
    /// Numbers of the row or column of cells along the north, east, south and west side if nodes were moved there, else one
    /// that no cell has.
    #[inline(always)]
    pub(crate) fn seam(&self) -> [u32; 4] {
        const NONE: u32 = u32::MAX;
        let last = [(self.cells[0] as u32).wrapping_sub(1), (self.cells[1] as u32).wrapping_sub(1)];
        let [north, east, south, west] = self.seam;
        [
            if north { 0 } else { NONE },
            if east { last[0] } else { NONE },
            if south { last[1] } else { NONE },
            if west { 0 } else { NONE },
        ]
    }

    /// Explicit triangles of the boxes or triangles from number `first` on; `None` if there are none.
    pub(crate) fn soup(layer: u32, first: usize, soup: Vec<SoupTriangle>, counts: Counts) -> Option<Self> {
        if soup.is_empty() {
            return None;
        }
        let (cover, geometry) = (cover_of(&soup), Geometry::Soup(soup));
        let (origin, seam) = ([first, 0], [false; 4]);
        Some(Self { layer, origin, cells: [0; 2], step: 1, geometry, seam, soup_base: 0, cover, counts })
    }
}

impl Blocks {
    /// Displaces, projects, subdivides and clips every surface of the scene.
    pub(crate) fn build(
        &mut self,
        scene: &Scene,
        passes: &[Pass<'_>],
        lens: &Lens,
        options: &RenderOptions,
        detail: &GroundCache<(), Arc<Tree>>,
    ) {
        // A tolerance of zero or less would split without end.
        let tolerance_px = if options.tolerance_px > 0.01 { options.tolerance_px } else { 0.01 };
        self.list.drain(..).for_each(|b| self.spare.keep(b.geometry));
        self.triangles_in = 0;
        for (i, layer) in scene.layers.iter().enumerate() {
            for pass in passes {
                let job = Job { layer: i as u32, pass, lens, tolerance_px, spare: &self.spare };
                match &layer.kind {
                    LayerKind::Terrain(t) => {
                        let hf = &t.heightfield;
                        let tree = detail.get(hf, (), || Arc::new(Tree::new(hf)));
                        let chooser = Chooser { hf, tree: &tree, pass, lens, tolerance_px, lod_px: options.lod_px };
                        chooser.choose(&mut self.choice);
                        let blocks = self.choice.list.par_iter().filter_map(|c| job.terrain_block(hf, &tree.sparse, c));
                        self.list.par_extend(blocks);
                    }
                    LayerKind::Boxes(b) => self.list.extend(job.boxes(b)),
                    LayerKind::Mesh(m) => self.list.extend(job.mesh(&m.mesh)),
                    _ => {}
                }
            }
            self.triangles_in += match &layer.kind {
                LayerKind::Terrain(t) => 2 * ((t.heightfield.cols() - 1) * (t.heightfield.rows() - 1)) as u64,
                LayerKind::Boxes(b) => 12 * b.boxes.len() as u64,
                LayerKind::Mesh(m) => m.mesh.triangles().len() as u64,
                _ => 0,
            };
        }
        self.number();
    }

    /// Numbers the soup triangles and sorts the blocks by nearness.
    fn number(&mut self) {
        let mut base = 0;
        self.soups.clear();
        for (i, block) in self.list.iter_mut().enumerate() {
            block.soup_base = base;
            if let Geometry::Soup(soup) = &block.geometry {
                self.soups.push((base, i as u32));
                base += soup.len() as u32;
            }
        }
        self.order.clear();
        self.order.extend(0..self.list.len() as u32);
        let list = &self.list;
        self.order
            .sort_unstable_by(|&a, &b| list[b as usize].cover.q.total_cmp(&list[a as usize].cover.q).then(a.cmp(&b)));
    }

    /// Draws everything that touches the band and is not hidden, nearest first.
    pub(crate) fn draw(&self, band: &mut Band) {
        for &i in &self.order {
            let block = &self.list[i as usize];
            let [y0, y1] = block.cover.y;
            if y0 >> 8 >= band.y1 || y1 >> 8 < band.y0 || band.hides(block.cover.x, block.cover.q) {
                continue;
            }
            match &block.geometry {
                Geometry::Grid(nodes) => nodes.draw(i << CELL_BITS, band),
                Geometry::Soup(soup) => {
                    for (k, t) in soup.iter().enumerate() {
                        band.draw(t.v.map(|v| v.screen), SOUP | (block.soup_base + k as u32));
                    }
                }
            }
            band.drew(block.cover.x);
        }
    }

    /// Layer of a primitive number (not sky).
    pub(crate) fn layer_of(&self, prim: u32) -> Option<u32> {
        let block = if prim & SOUP == 0 { prim >> CELL_BITS } else { self.soup_block(prim & !SOUP)? };
        self.list.get(block as usize).map(|b| b.layer)
    }

    fn soup_block(&self, n: u32) -> Option<u32> {
        let at = self.soups.partition_point(|&(base, _)| base <= n).checked_sub(1)?;
        Some(self.soups[at].1)
    }

    /// The triangle of a primitive number (not sky).
    pub(crate) fn find(&self, prim: u32) -> Option<Found<'_>> {
        if prim & SOUP != 0 {
            let n = prim & !SOUP;
            let block = self.list.get(self.soup_block(n)? as usize)?;
            let Geometry::Soup(soup) = &block.geometry else { return None };
            let t = soup.get((n - block.soup_base) as usize)?;
            return Some(Found { block, parent: t.parent, v: t.v });
        }
        let block = self.list.get((prim >> CELL_BITS) as usize)?;
        let Geometry::Grid(nodes) = &block.geometry else { return None };
        let parent = prim & ((1 << CELL_BITS) - 1);
        let (cell, triangle) = ((parent >> 1) as usize, (parent & 1) as usize);
        let [c, r] = [cell % SIDE, cell / SIDE];
        let weights = cell_weights(block.seam, block.cells, [c, r], triangle);
        let corners = CELL_TRIANGLES[triangle].map(|n| nodes.at(c + (n & 1), r + (n >> 1)));
        let v = std::array::from_fn(|i| SoupVertex { screen: corners[i], weights: weights[i] });
        Some(Found { block, parent, v })
    }

    /// Sums over all blocks.
    pub(crate) fn counts(&self) -> Counts {
        self.list.iter().fold(Counts::default(), |a, b| Counts {
            drawn: a.drawn + b.counts.drawn,
            split: a.split + b.counts.split,
            missed: a.missed + b.counts.missed,
        })
    }
}

pub(crate) struct Job<'a> {
    pub(crate) layer: u32,
    pub(crate) pass: &'a Pass<'a>,
    pub(crate) lens: &'a Lens,
    pub(crate) tolerance_px: f64,
    pub(crate) spare: &'a Spare,
}

impl Job<'_> {
    fn terrain_block(&self, hf: &Heightfield, sparse: &Sparse, chosen: &Chosen) -> Option<Block> {
        let (origin, last) = lod::nodes(hf, chosen.level, chosen.block);
        let step = 1 << chosen.level;
        let mut out = Block {
            layer: self.layer,
            origin,
            cells: [0, 1].map(|axis| (last[axis] - origin[axis]) / step),
            step,
            geometry: Geometry::Soup(Vec::new()),
            seam: chosen.seam,
            soup_base: 0,
            cover: Cover::EMPTY,
            counts: Counts::default(),
        };
        let careful = chosen.edges || !chosen.whole || chosen.judged.contains(&true);
        if !careful && let Some(mut nodes) = self.project_grid(hf, sparse, &out) {
            nodes.close_seams(chosen.seam);
            out.cover = nodes.cover();
            out.counts.drawn = 2 * (out.cells[0] * out.cells[1]) as u64;
            out.geometry = Geometry::Grid(nodes);
        } else {
            self.refine_grid(hf, &mut out, chosen);
        }
        let Cover { x, y, .. } = out.cover;
        let size = [self.lens.width * SUB, self.lens.height * SUB];
        if x[0] > x[1] || x[1] < 0 || x[0] > size[0] || y[1] < 0 || y[0] > size[1] {
            self.spare.keep(out.geometry);
            return None;
        }
        Some(out)
    }

    /// Nodes of the block on the image, if none needs clipping.
    fn project_grid(&self, hf: &Heightfield, sparse: &Sparse, block: &Block) -> Option<Nodes> {
        let ([cols, rows], step) = (block.cells, block.step);
        let mut nodes = self.spare.nodes();
        nodes.reset(block.cells);
        let count = cols + 1;
        let columns = self.pass.columns(hf, block.origin[0], step, count);
        let mut whole = true;
        // All of them first: rows lie far apart in memory, and none has to wait for another.
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
                    } else if let Some(image) = self.pass.ground_node(self.lens, hf, at) {
                        nodes.set(c, r, image);
                    } else {
                        whole = false;
                    }
                }
            } else {
                let part = r * count..(r + 1) * count;
                let (x, y) = (&mut nodes.x[part.clone()], &mut nodes.y[part.clone()]);
                let mut out = Row { x, y, q: &mut nodes.q[part] };
                whole = self.pass.ground_row(self.lens, hf, &columns, row, &heights[..count], &mut out);
            }
            if !whole {
                self.spare.keep(Geometry::Grid(nodes));
                return None;
            }
        }
        Some(nodes)
    }

    fn refine_grid(&self, hf: &Heightfield, block: &mut Block, chosen: &Chosen) {
        let mut refiner = Refiner::new(self.pass, self.lens, self.tolerance_px, self.spare.soup());
        let (cells, seam) = (block.cells, block.seam);
        let [cols, rows] = cells;
        let corners: Vec<Option<Corner>> = (0..(cols + 1) * (rows + 1))
            .map(|i| {
                let kept = kept_node(seam, cells, [i % (cols + 1), i / (cols + 1)]);
                let at = [0, 1].map(|axis| block.origin[axis] + block.step * kept[axis]);
                hf.node(at[0], at[1]).map(|p| refiner.node(p, self.pass.ground_node(self.lens, hf, at)))
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
                    let [north, east, south, west] = chosen.judged;
                    let side = |on_side: bool, judged: bool| if on_side { judged } else { chosen.edges };
                    let split = if k == 0 {
                        [side(r == 0, north), side(c + 1 == cols, east), chosen.edges]
                    } else {
                        [side(c == 0, west), side(r + 1 == rows, south), chosen.edges]
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

fn cover_of(soup: &[SoupTriangle]) -> Cover {
    soup.iter().flat_map(|t| t.v).fold(Cover::EMPTY, |cover, v| cover.including(v.screen))
}
