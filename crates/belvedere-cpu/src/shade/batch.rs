//! Samples of one terrain layer, shaded together: each step is a plain loop over short arrays, which compilers turn
//! into vector instructions.

use super::color::Rgb;
use super::lit::{CELL, Lit};
use super::print::Print;
use super::terrain::TerrainShade;
use super::{Painted, Shader};
use crate::blocks::{Block, Found, SIDE};
use crate::grid::CELL_TRIANGLES;
use crate::lens::SUB;
use belvedere_core::DVec2;

/// Samples to a batch.
const LANES: usize = 16;
type Lanes = [f32; LANES];

/// Samples waiting to be shaded.
pub(super) struct Batch {
    len: usize,
    layer: usize,
    /// Where each result goes.
    out: [u32; LANES],
    /// Node that the vertices count from.
    node: [[i32; 2]; LANES],
    /// Vertices relative to the sample, fixed-point steps.
    x: [Lanes; 3],
    y: [Lanes; 3],
    /// Their nearness (1 in parallel projection), and their columns and rows from the node.
    q: [Lanes; 3],
    u: [Lanes; 3],
    v: [Lanes; 3],
    /// Forward distance of the sample.
    depth: Lanes,
    pixel: [[f32; 2]; LANES],
}

/// Where the samples of a batch lie on the ground, and what a pixel covers there.
struct Places {
    /// Columns and rows from the node.
    u: Lanes,
    v: Lanes,
    /// Squared side of the square that a pixel covers, in squares of a cell.
    cells_per_px: Lanes,
}

impl Batch {
    pub(super) fn new() -> Self {
        let zero = [0.0; LANES];
        Self {
            len: 0,
            layer: 0,
            out: [0; LANES],
            node: [[0; 2]; LANES],
            x: [zero; 3],
            y: [zero; 3],
            q: [zero; 3],
            u: [zero; 3],
            v: [zero; 3],
            depth: zero,
            pixel: [[0.0; 2]; LANES],
        }
    }

    /// Takes in a sample of a terrain layer; shades what is there when the batch is full or the layer another one.
    #[inline]
    pub(super) fn push(
        &mut self,
        shader: &Shader<'_>,
        found: &Found<'_>,
        [xs, ys]: [i32; 2],
        depth: f32,
        out: usize,
        painted: &mut [Painted],
    ) {
        let layer = found.block.layer as usize;
        if self.len == LANES || (self.len > 0 && layer != self.layer) {
            self.flush(shader, painted);
        }
        let i = self.len;
        (self.len, self.layer) = (i + 1, layer);
        let Block { origin, step, .. } = *found.block;
        let cell = (found.parent >> 1) as usize;
        self.node[i] = [(origin[0] + step * (cell % SIDE)) as i32, (origin[1] + step * (cell / SIDE)) as i32];
        let nodes = CELL_TRIANGLES[(found.parent & 1) as usize].map(|n| [(n & 1) as f32, (n >> 1) as f32]);
        let step = step as f32;
        for (k, v) in found.v.iter().enumerate() {
            self.x[k][i] = (v.screen.x - xs) as f32;
            self.y[k][i] = (v.screen.y - ys) as f32;
            self.q[k][i] = if shader.lens.ortho { 1.0 } else { v.screen.q };
            let [a, b] = v.weights;
            let along = |d: usize| nodes[0][d] + a * (nodes[1][d] - nodes[0][d]) + b * (nodes[2][d] - nodes[0][d]);
            self.u[k][i] = step * along(0);
            self.v[k][i] = step * along(1);
        }
        self.depth[i] = depth;
        self.pixel[i] = [xs as f32 / SUB as f32, ys as f32 / SUB as f32];
        self.out[i] = out as u32;
    }

    /// Shades what is there.
    pub(super) fn flush(&mut self, shader: &Shader<'_>, painted: &mut [Painted]) {
        if self.len == 0 {
            return;
        }
        let super::LayerShade::Terrain(terrain) = &shader.layers[self.layer] else { return };
        let places = self.places();
        let lods = terrain.lods(shader, &self.depth, &places.cells_per_px);
        let (mut root, mut direct, mut sky) = ([[0.0; LANES]; 3], [0.0; LANES], [0.0; LANES]);
        let making = terrain.making();
        for i in 0..self.len {
            let sum = terrain.lit.sample(self.at(i, &places), lods[i], &making);
            let lit = Lit::of(sum);
            for (root, v) in root.iter_mut().zip(lit.root) {
                root[i] = v;
            }
            (direct[i], sky[i]) = (lit.direct, lit.sky);
        }
        let mut color = terrain.colors(shader, &root, &direct, &sky, &self.depth);
        let mut ids = [self.layer as u32 + 1; LANES];
        if terrain.is_covered(shader) {
            self.cover(shader, terrain, &places, [&root[0], &root[1], &root[2]], &direct, &sky, &mut color, &mut ids);
        }
        for i in 0..self.len {
            let [r, g, b] = &color;
            painted[self.out[i] as usize] = Painted { color: Rgb::new(r[i], g[i], b[i]), id: ids[i] };
        }
        self.len = 0;
    }

    /// Barycentric weights on the image, made those of the ground by nearness.
    fn places(&self) -> Places {
        let mut out = Places { u: [0.0; LANES], v: [0.0; LANES], cells_per_px: [0.0; LANES] };
        let ([x0, x1, x2], [y0, y1, y2], [q0, q1, q2]) = (&self.x, &self.y, &self.q);
        let ([u0, u1, u2], [v0, v1, v2]) = (&self.u, &self.v);
        for i in 0..LANES {
            let w0 = x1[i] * y2[i] - x2[i] * y1[i];
            let w1 = x2[i] * y0[i] - x0[i] * y2[i];
            let w2 = x0[i] * y1[i] - x1[i] * y0[i];
            let inverse = 1.0 / (w0 + w1 + w2);
            let (w0, w1, w2) =
                ((w0 * inverse).max(0.0) * q0[i], (w1 * inverse).max(0.0) * q1[i], (w2 * inverse).max(0.0) * q2[i]);
            let scale = 1.0 / (w0 + w1 + w2);
            out.u[i] = (w0 * u0[i] + w1 * u1[i] + w2 * u2[i]) * scale;
            out.v[i] = (w0 * v0[i] + w1 * v1[i] + w2 * v2[i]) * scale;
            let part = (u1[i] - u0[i]) * (v2[i] - v0[i]) - (u2[i] - u0[i]) * (v1[i] - v0[i]);
            out.cells_per_px[i] = (part * inverse).abs() * (SUB * SUB) as f32;
        }
        out
    }

    /// Column and row of lane `i` on the ground, [`CELL`] steps to a cell.
    #[inline]
    fn at(&self, i: usize, places: &Places) -> [i32; 2] {
        let [c, r] = self.node[i];
        [c * CELL + (places.u[i] * CELL as f32) as i32, r * CELL + (places.v[i] * CELL as f32) as i32]
    }

    /// Columns and rows per pixel to the right and per pixel down at lane `i`.
    fn axes(&self, i: usize, places: &Places) -> [DVec2; 2] {
        let (x, y) = (self.x.map(|v| v[i]), self.y.map(|v| v[i]));
        let (q, u, v) = (self.q.map(|v| v[i]), self.u.map(|v| v[i]), self.v.map(|v| v[i]));
        let next = |k: usize| ((k + 1) % 3, (k + 2) % 3);
        // Weight of vertex k, and how it changes when the sample moves.
        let sum = |of: &dyn Fn(usize) -> f32| -> [f32; 3] {
            let mut sums = [0.0; 3];
            for k in 0..3 {
                let w = of(k) * q[k];
                sums.iter_mut().zip([w, w * u[k], w * v[k]]).for_each(|(s, v)| *s += v);
            }
            sums
        };
        let whole = sum(&|k| x[next(k).0] * y[next(k).1] - x[next(k).1] * y[next(k).0])[0];
        let right = sum(&|k| y[next(k).0] - y[next(k).1]);
        let down = sum(&|k| x[next(k).1] - x[next(k).0]);
        [right, down].map(|[w, wu, wv]| {
            let per_px = SUB as f32 / whole;
            DVec2::new(f64::from((wu - places.u[i] * w) * per_px), f64::from((wv - places.v[i] * w) * per_px))
        })
    }

    /// Lays pictures and areas over the lanes that they cover.
    #[allow(clippy::too_many_arguments)]
    fn cover(
        &self,
        shader: &Shader<'_>,
        terrain: &TerrainShade<'_>,
        places: &Places,
        root: [&Lanes; 3],
        direct: &Lanes,
        sky: &Lanes,
        color: &mut [Lanes; 3],
        ids: &mut [u32; LANES],
    ) {
        let [near, far] = terrain.footprints(shader, &self.depth);
        for i in 0..self.len {
            let [c, r] = self.node[i];
            let g = DVec2::new(f64::from(c) + f64::from(places.u[i]), f64::from(r) + f64::from(places.v[i]));
            let side = places.cells_per_px[i].clamp(near[i], far[i]).sqrt();
            let lit = Lit { root: root.map(|v| v[i]), direct: direct[i], sky: sky[i] };
            let spacing = terrain.hf.spacing();
            let axes = self.axes(i, places).map(|v| v * DVec2::new(spacing.x, -spacing.y));
            let print = Print::new(axes, f64::from(near[i].sqrt()) * terrain.pitch);
            if let Some((c, id)) = terrain.covered(shader, g, f64::from(side), &print, &lit, self.pixel[i]) {
                let c = shader.sky.through_air(c, self.depth[i]);
                color.iter_mut().zip(c.to_array()).for_each(|(lanes, v)| lanes[i] = v);
                if let Some(id) = id {
                    ids[i] = id + 1;
                }
            }
        }
    }
}

impl TerrainShade<'_> {
    /// Squared sides, in cells, of the smallest and the largest square on the ground that a pixel can cover at a depth.
    #[inline]
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

    /// Cells across a pixel that looks straight at the ground: a constant, and that per unit of depth.
    fn cells_per_depth(&self, shader: &Shader<'_>) -> (f32, f32) {
        let per_px = (1.0 / (shader.lens.scale * self.pitch)) as f32;
        if shader.lens.ortho { (per_px, 0.0) } else { (0.0, per_px) }
    }

    /// Levels of averages, 256 steps to a level. The triangle tells slant and bend, the depth keeps it sane.
    fn lods(&self, shader: &Shader<'_>, depth: &Lanes, cells_per_px: &Lanes) -> [u32; LANES] {
        let [near, far] = self.footprints(shader, depth);
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = super::lod(cells_per_px[i].max(near[i]).min(far[i]));
        }
        out
    }

    /// Colours of lit ground through the air.
    fn colors(&self, shader: &Shader<'_>, root: &[Lanes; 3], direct: &Lanes, sky: &Lanes, depth: &Lanes) -> [Lanes; 3] {
        let mut haze = [0.0; LANES];
        for i in 0..LANES {
            haze[i] = shader.sky.haze_at(depth[i]);
        }
        let (warm, cool, air) = (self.light.warm, self.light.cool, shader.sky.haze());
        let mut out = [[0.0; LANES]; 3];
        for (k, out) in out.iter_mut().enumerate() {
            for i in 0..LANES {
                let c = root[k][i] * root[k][i] * (warm[k] * direct[i] + cool[k] * sky[i]);
                out[i] = c + haze[i] * (air[k] - c);
            }
        }
        out
    }
}
