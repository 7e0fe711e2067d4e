//! A piece of a surface on the image.

use crate::cache::lock;
use crate::geometry::grid::{Nodes, ScreenExtent};
use crate::screen::{Screen, ScreenVertex};
use belvedere_core::Aabb;
use belvedere_scene::Progress;
use belvedere_sight::sections::{Sections, Shown};
use std::sync::Mutex;

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
    /// Numbers of the first and the last pass of the view that draw it.
    pub(crate) passes: [usize; 2],
    /// Whether these are rigid bodies, drawn by the passes of `BodyPasses`.
    pub(crate) bodies: bool,
    /// First column and row (terrain), first box or first triangle (mesh).
    pub(crate) origin: [usize; 2],
    /// Drawn cells of a terrain block.
    pub(crate) cells: [usize; 2],
    /// Cells of the ground along the side of a drawn cell: node (c, r) of the block is node `origin + step * (c, r)` of
    /// the ground. 1 = full detail.
    pub(crate) step: usize,
    pub(crate) geometry: Geometry,
    /// Sides along which every second node is left out, see [`crate::geometry::lod::Span::seam`].
    pub(crate) seam: [bool; 4],
    /// Number of the first soup triangle.
    pub(crate) soup_base: u32,
    /// Part of the image that the block may touch.
    pub(crate) cover: ScreenExtent,
    pub(crate) counts: Counts,
    /// Position along the deformation curve of the corners of each soup triangle, where only some samples are shown; else empty.
    pub(crate) thin: Vec<[f32; 3]>,
}

/// Contribution of a block to [`belvedere_scene::FrameStats`].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) drawn: u64,
    pub(crate) split: u64,
    pub(crate) missed: u64,
}

/// Where a sample hit: a block's parent triangle and the screen triangle drawn for it.
pub(crate) struct DrawnTriangle<'a> {
    pub(crate) block: &'a Block,
    pub(crate) parent: u32,
    pub(crate) v: [SoupVertex; 3],
}

/// Memory of blocks that are no longer needed.
#[derive(Debug, Default)]
pub(crate) struct BufferPool {
    nodes: Mutex<Vec<Nodes>>,
    soup: Mutex<Vec<Vec<SoupTriangle>>>,
}

impl BufferPool {
    pub(crate) fn nodes(&self) -> Nodes {
        lock(&self.nodes).pop().unwrap_or_default()
    }

    pub(crate) fn soup(&self) -> Vec<SoupTriangle> {
        lock(&self.soup).pop().unwrap_or_default()
    }

    pub(crate) fn keep(&self, geometry: Geometry) {
        match geometry {
            Geometry::Grid(nodes) => lock(&self.nodes).push(nodes),
            Geometry::Soup(soup) => lock(&self.soup).push(soup),
        }
    }
}

impl Block {
    /// Numbers of the row or column of cells along the north, east, south and west side where a seam moves nodes, else a number
    /// that no cell has.
    #[inline(always)]
    pub(crate) fn seam_cells(&self) -> [u32; 4] {
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
    pub(crate) fn soup(
        layer: u32,
        passes: [usize; 2],
        first: usize,
        soup: Vec<SoupTriangle>,
        counts: Counts,
    ) -> Option<Self> {
        if soup.is_empty() {
            return None;
        }
        let (cover, geometry) = (cover_of(&soup), Geometry::Soup(soup));
        let (origin, seam) = ([first, 0], [false; 4]);
        let thin = Vec::new();
        let bodies = false;
        Some(Self {
            layer,
            passes,
            bodies,
            origin,
            cells: [0; 2],
            step: 1,
            geometry,
            seam,
            soup_base: 0,
            cover,
            counts,
            thin,
        })
    }
}

impl Block {
    /// The block with its triangles marked to be shown sample by sample.
    /// * `corners`: positions along the deformation curve of the corners of a parent triangle, by its number.
    pub(crate) fn thinned(mut self, corners: impl Fn(u32) -> [f64; 3]) -> Self {
        if let Geometry::Soup(soup) = &self.geometry {
            let thin = soup.iter().map(|t| {
                let [a, b, c] = corners(t.parent);
                let at = |v: SoupVertex| {
                    let [u, w] = v.weights.map(f64::from);
                    (a + u * (b - a) + w * (c - a)) as f32
                };
                t.v.map(at)
            });
            self.thin = thin.collect();
        }
        self
    }
}

/// Parameters common to all blocks of a layer.
pub(crate) struct Job<'a> {
    pub(crate) layer: u32,
    pub(crate) screen: &'a Screen,
    pub(crate) tolerance_px: f64,
    pub(crate) spare: &'a BufferPool,
    pub(crate) sections: Option<&'a Sections<'a>>,
    pub(crate) progress: &'a Progress,
}

impl Job<'_> {
    /// How much of a part of the layer is shown.
    pub(crate) fn shown(&self, bounds: &Aabb) -> Shown {
        self.sections.map_or(Shown::Everything, |s| s.of_part(self.layer as usize, bounds))
    }
}

pub(crate) fn cover_of(soup: &[SoupTriangle]) -> ScreenExtent {
    soup.iter().flat_map(|t| t.v).fold(ScreenExtent::EMPTY, |cover, v| cover.including(v.screen))
}
