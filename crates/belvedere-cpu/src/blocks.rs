//! Surfaces cut into blocks: culled, displaced and projected once per frame, ready to rasterise.

use crate::displace::Points;
use crate::lens::{Lens, Pass, SUB, ScreenVertex};
use crate::raster::Band;
use crate::refine::{Corner, Refiner};
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::{BoxLayer, Heightfield, LayerKind, NodeState, Scene};
use rayon::prelude::*;

/// Cells along a side of a terrain block.
pub(crate) const SIDE: usize = 32;
/// Boxes to a block.
const BOXES: usize = 64;
/// A primitive number with this bit counts soup triangles; without it, cells of grid blocks.
const SOUP: u32 = 1 << 31;
/// Bits of a grid primitive below the block number: 10 of the cell, 1 of the triangle.
const CELL_BITS: u32 = 11;

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
    Grid(Vec<ScreenVertex>),
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
    /// Number of the first soup triangle.
    soup_base: u32,
    /// Rows of the image that the block may touch.
    rows: [i32; 2],
    /// Smallest and largest y of each row of nodes of a grid, fixed point.
    spans: Vec<[i32; 2]>,
    pub(crate) counts: Counts,
}

/// Contribution to [`belvedere_scene::FrameStats`].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) drawn: u64,
    pub(crate) split: u64,
    pub(crate) missed: u64,
}

/// The node numbers (bit 0 east, bit 1 south) of the two triangles of a cell, split north-west to south-east.
pub(crate) const CELL_TRIANGLES: [[usize; 3]; 2] = [[0, 1, 3], [0, 2, 3]];

/// Corner numbers (see [`belvedere_scene::BoxShape::corners`]) of the twelve triangles of a box, two per face.
pub(crate) const BOX_TRIANGLES: [[usize; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// Where a sample hit: a block's parent triangle and the screen triangle drawn for it.
pub(crate) struct Found<'a> {
    pub(crate) block: &'a Block,
    pub(crate) parent: u32,
    pub(crate) v: [SoupVertex; 3],
}

/// All blocks of a frame.
#[derive(Debug, Default)]
pub(crate) struct Blocks {
    pub(crate) list: Vec<Block>,
    soups: Vec<(u32, u32)>,
    pub(crate) triangles_in: u64,
}

impl Block {
    /// Explicit triangles of the boxes or triangles from number `first` on; `None` if there are none.
    pub(crate) fn soup(layer: u32, first: usize, soup: Vec<SoupTriangle>, counts: Counts) -> Option<Self> {
        let rows = rows_of(&soup)?;
        let geometry = Geometry::Soup(soup);
        let (origin, spans) = ([first, 0], Vec::new());
        Some(Self { layer, origin, cells: [0; 2], step: 1, geometry, soup_base: 0, rows, spans, counts })
    }
}

impl Blocks {
    /// Displaces, projects, subdivides and clips every surface of the scene.
    pub(crate) fn build(scene: &Scene, passes: &[Pass<'_>], lens: &Lens, tolerance_px: f64) -> Self {
        let mut out = Self::default();
        for (i, layer) in scene.layers.iter().enumerate() {
            for pass in passes {
                let job = Job { layer: i as u32, pass, lens, tolerance_px };
                match &layer.kind {
                    LayerKind::Terrain(t) => out.list.extend(job.terrain(&t.heightfield)),
                    LayerKind::Boxes(b) => out.list.extend(job.boxes(b)),
                    LayerKind::Mesh(m) => out.list.extend(job.mesh(&m.mesh)),
                    _ => {}
                }
            }
            out.triangles_in += match &layer.kind {
                LayerKind::Terrain(t) => 2 * ((t.heightfield.cols() - 1) * (t.heightfield.rows() - 1)) as u64,
                LayerKind::Boxes(b) => 12 * b.boxes.len() as u64,
                LayerKind::Mesh(m) => m.mesh.triangles().len() as u64,
                _ => 0,
            };
        }
        let mut base = 0;
        for (i, block) in out.list.iter_mut().enumerate() {
            block.soup_base = base;
            if let Geometry::Soup(soup) = &block.geometry {
                out.soups.push((base, i as u32));
                base += soup.len() as u32;
            }
        }
        out
    }

    /// Draws everything that touches the band, in the order of the layers.
    pub(crate) fn draw(&self, band: &mut Band) {
        for (i, block) in self.list.iter().enumerate() {
            if block.rows[0] < band.y1 && block.rows[1] >= band.y0 {
                match &block.geometry {
                    Geometry::Grid(nodes) => {
                        draw_grid(block.cells, nodes, &block.spans, (i as u32) << CELL_BITS, band);
                    }
                    Geometry::Soup(soup) => {
                        for (k, t) in soup.iter().enumerate() {
                            band.draw(t.v.map(|v| v.screen), SOUP | (block.soup_base + k as u32));
                        }
                    }
                }
            }
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
        let cell = (parent >> 1) as usize;
        let stride = block.cells[0] + 1;
        let nw = cell / SIDE * stride + cell % SIDE;
        let corner = |k: usize| nodes.get(nw + (k & 1) + (k >> 1) * stride).copied();
        let weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let mut v = [SoupVertex { screen: ScreenVertex::NONE, weights: [0.0; 2] }; 3];
        for (i, k) in CELL_TRIANGLES[(parent & 1) as usize].into_iter().enumerate() {
            v[i] = SoupVertex { screen: corner(k)?, weights: weights[i] };
        }
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

fn draw_grid([cols, rows]: [usize; 2], nodes: &[ScreenVertex], spans: &[[i32; 2]], first_prim: u32, band: &mut Band) {
    let stride = cols + 1;
    let (top, bottom) = (band.y0 * SUB, band.y1 * SUB);
    for r in 0..rows {
        if spans[r][0].min(spans[r + 1][0]) >= bottom || spans[r][1].max(spans[r + 1][1]) < top {
            continue;
        }
        let north = &nodes[r * stride..][..stride];
        let south = &nodes[(r + 1) * stride..][..stride];
        for (c, (n, s)) in north.windows(2).zip(south.windows(2)).enumerate() {
            let v = [n[0], n[1], s[0], s[1]];
            let x = [v[0].x.min(v[1].x).min(v[2].x.min(v[3].x)), v[0].x.max(v[1].x).max(v[2].x.max(v[3].x))];
            let y = [v[0].y.min(v[1].y).min(v[2].y.min(v[3].y)), v[0].y.max(v[1].y).max(v[2].y.max(v[3].y))];
            let prim = first_prim | ((r * SIDE + c) as u32) << 1;
            if x[0] != i32::MIN {
                if !band.misses(x, y) {
                    band.draw([v[0], v[1], v[3]], prim);
                    band.draw([v[0], v[2], v[3]], prim | 1);
                }
                continue;
            }
            for (k, t) in CELL_TRIANGLES.iter().enumerate() {
                let tri = t.map(|i| v[i]);
                if !tri.iter().any(|v| v.is_none()) {
                    band.draw(tri, prim | k as u32);
                }
            }
        }
    }
}

pub(crate) struct Job<'a> {
    pub(crate) layer: u32,
    pub(crate) pass: &'a Pass<'a>,
    pub(crate) lens: &'a Lens,
    pub(crate) tolerance_px: f64,
}

/// What is known of a terrain block before its nodes are displaced.
#[derive(Clone, Copy, PartialEq)]
enum Need {
    /// Outside the image.
    Nothing,
    /// Straight cell edges are good enough.
    Plain,
    /// Cell edges must be looked at one by one.
    Edges,
}

impl Job<'_> {
    fn terrain(&self, hf: &Heightfield) -> Vec<Block> {
        let (nx, ny) = ((hf.cols() - 1).div_ceil(SIDE), (hf.rows() - 1).div_ceil(SIDE));
        let needs: Vec<Need> = (0..nx * ny).into_par_iter().map(|i| self.need(hf, [i % nx, i / nx])).collect();
        let edges = |x: usize, y: usize| x < nx && y < ny && needs[y * nx + x] == Need::Edges;
        (0..nx * ny)
            .into_par_iter()
            .filter(|&i| needs[i] != Need::Nothing)
            .filter_map(|i| {
                let (x, y) = (i % nx, i / nx);
                // An edge between two blocks is judged alike by both.
                let around = [(x, y.wrapping_sub(1)), (x + 1, y), (x, y + 1), (x.wrapping_sub(1), y)];
                let judged = Judged { inside: edges(x, y), border: around.map(|(x, y)| edges(x, y)) };
                self.terrain_block(hf, [x, y], judged)
            })
            .collect()
    }

    fn need(&self, hf: &Heightfield, block: [usize; 2]) -> Need {
        let (origin, cells) = extent(hf, block);
        let mut z = [f32::INFINITY, f32::NEG_INFINITY];
        for r in origin[1]..=origin[1] + cells[1] {
            let row = r * hf.cols() + origin[0];
            for i in row..=row + cells[0] {
                if hf.states()[i] != NodeState::Void {
                    z = [z[0].min(hf.heights()[i]), z[1].max(hf.heights()[i])];
                }
            }
        }
        if z[0] > z[1] {
            return Need::Nothing;
        }
        let (nw, se) = (hf.node_xy(origin[0], origin[1]), hf.node_xy(origin[0] + cells[0], origin[1] + cells[1]));
        let bounds =
            Aabb { min: DVec3::new(nw.x, se.y, f64::from(z[0])), max: DVec3::new(se.x, nw.y, f64::from(z[1])) };
        if self.pass.leaves_out(self.lens, &bounds) {
            return Need::Nothing;
        }
        if self.bends_cells(&bounds, cells[0].max(cells[1])) { Need::Edges } else { Need::Plain }
    }

    /// Whether an edge of a cell of a block of `n` cells may need splitting.
    ///
    /// The chord of a curve that turns by a given angle deviates in proportion to its length, so the bound of the block's
    /// long edges, shared out over its cells with a factor 2 in hand, covers the cells' edges.
    fn bends_cells(&self, bounds: &Aabb, n: usize) -> bool {
        if self.pass.is_straight() {
            return false;
        }
        let c = bounds.corners();
        let pairs = [(0, 7), (1, 6), (2, 5), (3, 4), (0, 1), (2, 3), (0, 2), (1, 3), (4, 7), (5, 6)];
        let worst = pairs.iter().map(|&(a, b)| self.pass.edge_error_px(c[a], c[b])).fold(0.0, f64::max);
        !(worst * 2.0 / n as f64 <= self.tolerance_px)
    }

    fn terrain_block(&self, hf: &Heightfield, block: [usize; 2], judged: Judged) -> Option<Block> {
        let (origin, cells) = extent(hf, block);
        let mut out = Block {
            layer: self.layer,
            origin,
            cells,
            step: 1,
            geometry: Geometry::Soup(Vec::new()),
            soup_base: 0,
            rows: [0, -1],
            spans: Vec::new(),
            counts: Counts::default(),
        };
        let careful = judged.inside || judged.border.contains(&true);
        if !careful && let Some(nodes) = self.project_grid(hf, &mut out) {
            let on = nodes.iter().filter(|v| !v.is_none());
            let x = on.clone().fold([i32::MAX, i32::MIN], |x, v| [x[0].min(v.x), x[1].max(v.x)]);
            let y = on.fold([i32::MAX, i32::MIN], |y, v| [y[0].min(v.y), y[1].max(v.y)]);
            if x[0] > x[1] || x[1] < 0 || x[0] > self.lens.width * SUB || y[1] < 0 || y[0] > self.lens.height * SUB {
                return None;
            }
            out.rows = [y[0] >> 8, y[1] >> 8];
            out.spans = nodes.chunks(cells[0] + 1).map(span_of).collect();
            out.counts.drawn = 2 * (cells[0] * cells[1]) as u64;
            out.geometry = Geometry::Grid(nodes);
            return Some(out);
        }
        self.refine_grid(hf, &mut out, judged);
        let Geometry::Soup(soup) = &out.geometry else { return None };
        out.rows = rows_of(soup)?;
        out.counts.drawn = soup.len() as u64;
        Some(out)
    }

    /// Nodes of the block on the image, if none needs clipping.
    fn project_grid(&self, hf: &Heightfield, block: &mut Block) -> Option<Vec<ScreenVertex>> {
        let ([c0, r0], [cols, rows]) = (block.origin, block.cells);
        let mut nodes = Vec::with_capacity((cols + 1) * (rows + 1));
        let [mut x, mut y, mut z] = [[0.0f64; SIDE + 1]; 3];
        let n = cols + 1;
        for r in r0..=r0 + rows {
            let first = r * hf.cols() + c0;
            let (heights, states) = (&hf.heights()[first..first + n], hf.states());
            if (first..first + n).any(|i| states[i] == NodeState::Void) {
                for c in c0..=c0 + cols {
                    nodes.push(match hf.node(c, r) {
                        Some(p) => self.project(p)?,
                        None => ScreenVertex::NONE,
                    });
                }
                continue;
            }
            for i in 0..n {
                let xy = hf.node_xy(c0 + i, r);
                (x[i], y[i], z[i]) = (xy.x, xy.y, f64::from(heights[i]));
            }
            let held = self.pass.is_only()
                || (0..n).all(|i| self.pass.margins(DVec3::new(x[i], y[i], z[i])).iter().all(|m| *m > 0.0));
            let mut points = Points { x: &mut x[..n], y: &mut y[..n], z: &mut z[..n] };
            if !held || !self.pass.displace_row(&mut points) || !self.lens.snap_row(&points, &mut nodes) {
                return None;
            }
        }
        Some(nodes)
    }

    /// A node on the image that needs no clipping.
    fn project(&self, p: DVec3) -> Option<ScreenVertex> {
        let v = self.lens.view_from(self.pass.displace(p)?);
        let whole = self.lens.is_drawable(v) && self.pass.margins(p).iter().all(|m| *m > 0.0);
        whole.then(|| self.lens.snap(v))
    }

    fn refine_grid(&self, hf: &Heightfield, block: &mut Block, judged: Judged) {
        let mut refiner = Refiner::new(self.pass, self.lens, self.tolerance_px);
        let ([c0, r0], [cols, rows]) = (block.origin, block.cells);
        let corners: Vec<Option<Corner>> = (0..(cols + 1) * (rows + 1))
            .map(|i| hf.node(c0 + i % (cols + 1), r0 + i / (cols + 1)).map(|p| refiner.corner(p)))
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
                    let [north, east, south, west] = judged.border;
                    let border = if k == 0 {
                        [north && r == 0, east && c + 1 == cols, false]
                    } else {
                        [west && c == 0, south && r + 1 == rows, false]
                    };
                    let split = border.map(|b| b || judged.inside);
                    refiner.triangle([a, b, d], split, ((r * SIDE + c) as u32) << 1 | k as u32);
                }
            }
        }
        block.counts.split = refiner.splits;
        block.geometry = Geometry::Soup(refiner.out);
    }

    fn boxes(&self, layer: &BoxLayer) -> Vec<Block> {
        (0..layer.boxes.len().div_ceil(BOXES))
            .into_par_iter()
            .filter_map(|i| {
                let boxes = &layer.boxes[i * BOXES..layer.boxes.len().min((i + 1) * BOXES)];
                let bounds = Aabb::of(boxes.iter().flat_map(|b| b.corners()));
                if self.pass.leaves_out(self.lens, &bounds) {
                    return None;
                }
                let mut refiner = Refiner::new(self.pass, self.lens, self.tolerance_px);
                let judge = !self.pass.is_straight();
                let mut missed = 0;
                for (k, shape) in boxes.iter().enumerate() {
                    let corners = shape.corners().map(|p| refiner.corner(p));
                    missed += corners.iter().filter(|c| c.is_missing()).count() as u64;
                    for (t, tri) in BOX_TRIANGLES.iter().enumerate() {
                        refiner.triangle(tri.map(|n| corners[n]), [judge; 3], (12 * k + t) as u32);
                    }
                }
                let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
                Block::soup(self.layer, i * BOXES, refiner.out, counts)
            })
            .collect()
    }
}

/// Which edges of a block may be split.
#[derive(Debug, Clone, Copy)]
struct Judged {
    inside: bool,
    /// North, east, south, west.
    border: [bool; 4],
}

fn extent(hf: &Heightfield, block: [usize; 2]) -> ([usize; 2], [usize; 2]) {
    let origin = [block[0] * SIDE, block[1] * SIDE];
    (origin, [SIDE.min(hf.cols() - 1 - origin[0]), SIDE.min(hf.rows() - 1 - origin[1])])
}

/// Smallest and largest y of the nodes that there are.
fn span_of(nodes: &[ScreenVertex]) -> [i32; 2] {
    let on = nodes.iter().filter(|v| !v.is_none());
    on.fold([i32::MAX, i32::MIN], |y, v| [y[0].min(v.y), y[1].max(v.y)])
}

fn rows_of(soup: &[SoupTriangle]) -> Option<[i32; 2]> {
    let y = soup.iter().flat_map(|t| t.v).map(|v| v.screen.y);
    Some([y.clone().min()? >> 8, y.max()? >> 8])
}
