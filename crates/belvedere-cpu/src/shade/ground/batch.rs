//! Samples of one terrain layer, shaded together: each step is a plain loop over short arrays, which compilers turn
//! into vector instructions.

use crate::geometry::block::Block;
use crate::geometry::grid::Nodes;
use crate::raster::cells::SIDE;
use crate::screen::SUB;
use crate::shade::footprint::Footprint;
use crate::shade::ground::lit::Colors;
use crate::shade::ground::sample::GroundSample;
use crate::shade::ground::terrain::TerrainShade;
use crate::shade::ground::tiles::CELL;
use crate::shade::{LayerShade, Painted, Samples, Shader, lod, pixel_of};
use crate::simd::{IntLanes, LANES, Lanes, nearest};
use belvedere_core::DVec2;

const _: () = assert!(LANES == u32::BITS as usize, "a bit per sample");

/// Samples that wait to be shaded, each in one half of a cell of the ground.
pub(crate) struct Batch {
    len: usize,
    layer: usize,
    /// Index of each result.
    out: [u32; LANES],
    /// Nearness of the sample.
    near: Lanes,
    /// Position of the sample, and the vertices of its triangle (north-west, south-east, and the one between), fixed-point steps.
    at: [IntLanes; 2],
    x: [IntLanes; 3],
    y: [IntLanes; 3],
    q: [Lanes; 3],
    /// The north-west node, the side of the cell, and 1 in the half of the south-west node, else 0.
    node: [IntLanes; 2],
    step: Lanes,
    lower: IntLanes,
    /// Number of lanes whose sample lies on another triangle.
    odd: usize,
    odd_lanes: [(usize, OffGridPoint); LANES],
}

/// Position of a sample that does not lie in half a cell.
#[derive(Clone, Copy, Default)]
struct OffGridPoint {
    node: [i32; 2],
    at: [f32; 2],
    cells_per_px: f32,
}

/// Positions of the samples of a batch on the ground.
struct SamplePositions {
    /// Columns and rows from the node.
    u: Lanes,
    v: Lanes,
    /// Area that a pixel covers, in cells.
    cells_per_px: Lanes,
    /// Forward distance.
    depth: Lanes,
}

impl Batch {
    pub(crate) fn new() -> Self {
        let (zero, none) = ([0.0; LANES], [0; LANES]);
        Self {
            len: 0,
            layer: 0,
            out: [0; LANES],
            near: zero,
            at: [none; 2],
            x: [none; 3],
            y: [none; 3],
            q: [zero; 3],
            node: [none; 2],
            step: zero,
            lower: none,
            odd: 0,
            odd_lanes: [(0, OffGridPoint::default()); LANES],
        }
    }

    /// Adds the samples `from..to` of a block to the batch, in the colours of a layer; flushes whenever the batch is full.
    #[inline(always)]
    pub(crate) fn take(
        &mut self,
        shader: &Shader<'_>,
        (block, nodes, layer): (&Block, &Nodes, usize),
        samples: &Samples<'_>,
        [from, to]: [usize; 2],
        painted: &mut Painted,
    ) {
        self.turn_to(layer, shader, samples, painted);
        let mut from = from;
        while from < to {
            if self.len == LANES {
                self.flush(shader, samples, painted);
            }
            let n = (LANES - self.len).min(to - from);
            let plain = self.take_plain((block, nodes), samples, from, n);
            from += plain;
            if plain < n {
                self.push_odd(shader, samples, from);
                from += 1;
            }
        }
    }

    /// Adds at most `n` samples, up to the first one that does not lie in half a cell; returns their number.
    #[inline(always)]
    fn take_plain(&mut self, (block, nodes): (&Block, &Nodes), samples: &Samples<'_>, from: usize, n: usize) -> usize {
        let (stride, step) = (block.cells[0] as u32 + 1, block.step as i32);
        let origin = block.origin.map(|n| n as i32);
        let mut prims = [0; LANES];
        prims[..n].copy_from_slice(&samples.prim[from..from + n]);
        let count = nodes.x.len().min(nodes.y.len()).min(nodes.q.len());
        let (mut nw, mut between) = ([0u32; LANES], [0u32; LANES]);
        let (mut columns, mut rows, mut lower) = ([0; LANES], [0; LANES], [0; LANES]);
        let (mut odd, [north, east, south, west]) = (0u32, block.seam_cells());
        for i in 0..LANES {
            let cell = (prims[i] >> 1) & (SIDE * SIDE - 1) as u32;
            let (c, r) = (cell % SIDE as u32, cell / SIDE as u32);
            lower[i] = (prims[i] & 1) as i32;
            nw[i] = r * stride + c;
            between[i] = nw[i] + if lower[i] == 0 { 1 } else { stride };
            (columns[i], rows[i]) = (origin[0] + step * c as i32, origin[1] + step * r as i32);
            let beyond = (nw[i] + stride + 1) as usize >= count;
            let is_odd = (c == west) | (c == east) | (r == north) | (r == south) | beyond;
            odd |= if is_odd { 1 << i } else { 0 };
        }
        let n = n.min(odd.trailing_zeros() as usize);
        let (nx, ny, nq) = (&nodes.x[..count], &nodes.y[..count], &nodes.q[..count]);
        let lanes = self.len..self.len + n;
        for (j, i) in lanes.clone().enumerate() {
            let at = [nw[j] as usize, (nw[j] + stride + 1) as usize, between[j] as usize];
            for v in 0..3 {
                (self.x[v][i], self.y[v][i], self.q[v][i]) = (nx[at[v]], ny[at[v]], nq[at[v]]);
            }
            self.out[i] = (from + j) as u32;
        }
        self.near[lanes.clone()].copy_from_slice(&samples.q[from..from + n]);
        self.at[0][lanes.clone()].copy_from_slice(&samples.x[from..from + n]);
        self.at[1][lanes.clone()].copy_from_slice(&samples.y[from..from + n]);
        self.node[0][lanes.clone()].copy_from_slice(&columns[..n]);
        self.node[1][lanes.clone()].copy_from_slice(&rows[..n]);
        self.lower[lanes.clone()].copy_from_slice(&lower[..n]);
        self.step[lanes].fill(step as f32);
        self.len += n;
        n
    }

    /// Adds a sample of any triangle of ground.
    pub(crate) fn take_odd(
        &mut self,
        layer: usize,
        shader: &Shader<'_>,
        samples: &Samples<'_>,
        k: usize,
        painted: &mut Painted,
    ) {
        self.turn_to(layer, shader, samples, painted);
        if self.len == LANES {
            self.flush(shader, samples, painted);
        }
        self.push_odd(shader, samples, k);
    }

    #[inline(always)]
    fn turn_to(&mut self, layer: usize, shader: &Shader<'_>, samples: &Samples<'_>, painted: &mut Painted) {
        if layer != self.layer {
            self.flush(shader, samples, painted);
            self.layer = layer;
        }
    }

    #[cold]
    #[inline(never)]
    fn push_odd(&mut self, shader: &Shader<'_>, samples: &Samples<'_>, k: usize) {
        let Some(found) = shader.blocks.find(samples.prim[k]) else { return };
        let spot = GroundSample::new(&found, shader.screen, samples.at(k));
        let (at, cells_per_px) = (spot.at.map(|v| v as f32), spot.cells_per_px() as f32);
        self.odd_lanes[self.odd] = (self.len, OffGridPoint { node: GroundSample::node(&found), at, cells_per_px });
        self.odd += 1;
        self.out[self.len] = k as u32;
        self.near[self.len] = samples.q[k];
        self.len += 1;
    }

    /// Shades the samples of the batch and empties it.
    #[inline(always)]
    pub(crate) fn flush(&mut self, shader: &Shader<'_>, samples: &Samples<'_>, painted: &mut Painted) {
        if self.len > 0
            && let LayerShade::Terrain(terrain) = &shader.layers[self.layer]
        {
            self.shade(shader, terrain, samples, painted);
        }
        (self.len, self.odd) = (0, 0);
    }

    #[inline(always)]
    fn shade(&mut self, shader: &Shader<'_>, terrain: &TerrainShade<'_>, samples: &Samples<'_>, painted: &mut Painted) {
        let positions = self.positions(shader);
        let lods = terrain.lods(shader, &positions.depth, &positions.cells_per_px);
        let at = self.fixed(&positions, terrain);
        let inputs = terrain.inputs();
        let colors = terrain.lit.colors_of(&at, &lods, self.len, &inputs);
        let color = terrain.colors(shader, &colors, &lods, &positions.depth);
        painted.set_roots(&self.out[..self.len], &color, self.layer as u32 + 1);
        if terrain.is_covered(shader) {
            self.cover(shader, terrain, &positions, &at, samples, painted);
        }
    }

    /// Positions of the samples on the ground.
    #[inline(always)]
    fn positions(&mut self, shader: &Shader<'_>) -> SamplePositions {
        let zero = [0.0; LANES];
        let mut out = SamplePositions { u: zero, v: zero, cells_per_px: zero, depth: zero };
        for i in 0..LANES {
            out.depth[i] = shader.screen.depth_of(self.near[i]);
        }
        if shader.screen.ortho {
            self.q = [[1.0; LANES]; 3];
        }
        self.weigh(&mut out);
        for &(lane, odd) in &self.odd_lanes[..self.odd] {
            (self.node[0][lane], self.node[1][lane]) = (odd.node[0], odd.node[1]);
            (out.u[lane], out.v[lane], out.cells_per_px[lane]) = (odd.at[0], odd.at[1], odd.cells_per_px);
        }
        out
    }

    /// Barycentric weights on the image, corrected for perspective by nearness.
    #[inline(always)]
    fn weigh(&self, out: &mut SamplePositions) {
        let Self { at: [xs, ys], x: [x0, x1, x2], y: [y0, y1, y2], q: [q0, q1, q2], step, lower, .. } = self;
        for i in 0..LANES {
            let x = [(x0[i] - xs[i]) as f32, (x1[i] - xs[i]) as f32, (x2[i] - xs[i]) as f32];
            let y = [(y0[i] - ys[i]) as f32, (y1[i] - ys[i]) as f32, (y2[i] - ys[i]) as f32];
            let (w0, w1, w2) = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]);
            let inverse = 1.0 / (w0 + w1 + w2);
            let (w0, w1, w2) =
                (positive(w0 * inverse) * q0[i], positive(w1 * inverse) * q1[i], positive(w2 * inverse) * q2[i]);
            let scale = step[i] / (w0 + w1 + w2);
            // The vertex between shares one coordinate with each end of the diagonal.
            let (most, least) = ((w1 + w2) * scale, w1 * scale);
            out.u[i] = if lower[i] == 0 { most } else { least };
            out.v[i] = if lower[i] == 0 { least } else { most };
            out.cells_per_px[i] = (step[i] * step[i] * inverse).abs() * (SUB * SUB) as f32;
        }
    }

    /// Columns and rows on the ground, [`CELL`] steps to a cell.
    #[inline(always)]
    fn fixed(&self, positions: &SamplePositions, terrain: &TerrainShade<'_>) -> [IntLanes; 2] {
        let [mut columns, mut rows] = [[0; LANES]; 2];
        let last = [terrain.hf.cols(), terrain.hf.rows()].map(|n| (n - 1) as i32 * CELL);
        for i in 0..LANES {
            let (c, r) = (self.node[0][i] * CELL, self.node[1][i] * CELL);
            columns[i] = c.wrapping_add(nearest(positions.u[i] * CELL as f32)).clamp(0, last[0]);
            rows[i] = r.wrapping_add(nearest(positions.v[i] * CELL as f32)).clamp(0, last[1]);
        }
        [columns, rows]
    }

    /// Draws drapes, areas and cast shadows over the lanes that they cover.
    /// * `at`: see [`Batch::fixed`].
    #[inline(never)]
    fn cover(
        &self,
        shader: &Shader<'_>,
        terrain: &TerrainShade<'_>,
        positions: &SamplePositions,
        at: &[IntLanes; 2],
        samples: &Samples<'_>,
        painted: &mut Painted,
    ) {
        let [near, far] = terrain.footprints(shader, &positions.depth);
        let inputs = terrain.inputs();
        for (i, &k) in self.out[..self.len].iter().enumerate() {
            let k = k as usize;
            let [c, r] = [0, 1].map(|axis| f64::from(self.node[axis][i]));
            let g = DVec2::new(c + f64::from(positions.u[i]), r + f64::from(positions.v[i]));
            let square = positions.cells_per_px[i].max(near[i]).min(far[i]);
            let lod = terrain.lod(square, longest(square, near[i]));
            let ground = || terrain.lit.sample([at[0][i], at[1][i]], lod, &inputs);
            let print = || {
                let axes = shader
                    .blocks
                    .find(samples.prim[k])
                    .map(|f| GroundSample::new(&f, shader.screen, samples.at(k)).axes());
                let spacing = terrain.hf.spacing() * DVec2::new(1.0, -1.0);
                let axes = axes.map_or([DVec2::NAN; 2], |axes| axes.map(|v| v * spacing));
                Footprint::new(axes, f64::from(near[i].sqrt()) * terrain.pitch)
            };
            let side = f64::from(square.sqrt());
            if let Some((c, id)) = terrain.covered(shader, g, side, print, ground, pixel_of(samples.at(k))) {
                let c = shader.sky.through_air(c, positions.depth[i]);
                painted.set(k, c, id.unwrap_or(self.layer as u32) + 1);
            }
        }
    }
}

/// Longer side of a pixel on the ground, cells, from its area and that of one which faces the ground.
#[inline(always)]
fn longest(square: f32, facing: f32) -> f32 {
    square / if facing > 1e-12 { facing.sqrt() } else { 1e-6 }
}

#[inline(always)]
fn positive(v: f32) -> f32 {
    if v > 0.0 { v } else { 0.0 }
}

impl TerrainShade<'_> {
    /// Areas, in cells, of the smallest and the largest square on the ground that a pixel can cover at a depth.
    #[inline(always)]
    fn footprints(&self, shader: &Shader<'_>, depth: &Lanes) -> [Lanes; 2] {
        let (mut near, mut far) = ([0.0; LANES], [0.0; LANES]);
        let (constant, per_depth) = self.cells_per_depth(shader);
        for i in 0..LANES {
            let side = constant + per_depth * depth[i];
            near[i] = side * side;
            far[i] = 36.0 * near[i];
        }
        [near, far]
    }

    /// Cells across a pixel that faces the ground: a constant, and a factor of depth.
    fn cells_per_depth(&self, shader: &Shader<'_>) -> (f32, f32) {
        let per_px = (1.0 / (shader.screen.scale * self.pitch)) as f32;
        if shader.screen.ortho { (per_px, 0.0) } else { (0.0, per_px) }
    }

    /// Levels, 256 steps to a level: from the slant and bend of the triangle, limited by the depth.
    #[inline(always)]
    fn lods(&self, shader: &Shader<'_>, depth: &Lanes, cells_per_px: &Lanes) -> [u32; LANES] {
        let [near, far] = self.footprints(shader, depth);
        let mut out = [0; LANES];
        for i in 0..LANES {
            let square = cells_per_px[i].max(near[i]).min(far[i]);
            out[i] = self.lod(square, longest(square, near[i]));
        }
        out
    }

    /// Level for a pixel that covers `square` cells and is `longest` cells long, 256 steps to a level, 0 = the finest. Between the nodes
    /// the longer side decides, since made detail that is too fine along it would shimmer.
    #[inline(always)]
    pub(super) fn lod(&self, square: f32, longest: f32) -> u32 {
        let finer = self.lit.finer();
        let per_cell = (1u32 << (2 * finer)) as f32;
        let (by_square, by_length) = (lod(square * per_cell), lod(0.25 * longest * longest * per_cell));
        let most = finer << 8;
        let by_length = if by_length < most { by_length } else { most };
        if by_square > by_length { by_square } else { by_length }
    }

    /// Square roots of the lit colours, with haze.
    #[inline(always)]
    fn colors(&self, shader: &Shader<'_>, colors: &Colors, lods: &[u32; LANES], depth: &Lanes) -> [Lanes; 3] {
        let air = shader.sky.haze();
        let mut out = [[0.0; LANES]; 3];
        for i in 0..LANES {
            let haze = shader.sky.haze_at(depth[i]);
            let root = colors.between(i, (lods[i] & 255) as i32 as f32 * (1.0 / 256.0));
            for k in 0..3 {
                let c = root[k] * root[k];
                out[k][i] = (c + haze * (air[k] - c)).sqrt();
            }
        }
        out
    }
}

#[cfg(test)]
mod tests;
