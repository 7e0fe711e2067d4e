//! Colours of many samples at a time.

use crate::geometry::block::Geometry;
use crate::geometry::blocks::{CELL_BITS, SOUP};
use crate::raster::band::SKY;
use crate::shade::color::{self, Encoder, LANES, PIXELS, Packed, Rgb};
use crate::shade::ground::batch::Batch;
use crate::shade::{LayerShade, Shader, SurfacePoint};
use crate::simd::{self, Kernel};

/// Samples of the picture: what was hit, its nearness, and the place on the image in fixed-point steps; slices of equal
/// length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Samples<'s> {
    pub(crate) prim: &'s [u32],
    pub(crate) q: &'s [f32],
    pub(crate) x: &'s [i32],
    pub(crate) y: &'s [i32],
}

impl Samples<'_> {
    #[inline(always)]
    pub(crate) fn at(&self, k: usize) -> [i32; 2] {
        [self.x[k], self.y[k]]
    }
}

/// Colours and identities of samples.
#[derive(Debug, Default)]
pub(crate) struct Painted {
    /// Square roots of linear red, green, blue.
    pub(crate) root: [Vec<f32>; 3],
    /// 0 = sky, else 1 + layer.
    pub(crate) id: Vec<u32>,
}

impl Painted {
    fn resize(&mut self, n: usize) {
        self.root.iter_mut().for_each(|plane| plane.resize(n, 0.0));
        self.id.resize(n, 0);
    }

    /// * `color`: linear.
    pub(crate) fn set(&mut self, k: usize, color: Rgb, id: u32) {
        self.set_root(k, color.to_array().map(|v| v.max(0.0).sqrt()), id);
    }

    #[inline(always)]
    fn set_root(&mut self, k: usize, root: [f32; 3], id: u32) {
        for (plane, v) in self.root.iter_mut().zip(root) {
            plane[k] = v;
        }
        self.id[k] = id;
    }

    /// Colours of the samples with these numbers, mostly one after the other.
    #[inline(always)]
    pub(crate) fn set_roots<const N: usize>(&mut self, numbers: &[u32], root: &[[f32; N]; 3], id: u32) {
        let (Some(&first), Some(&last)) = (numbers.first(), numbers.last()) else { return };
        // They rise.
        if (last - first) as usize + 1 == numbers.len() {
            let all = first as usize..=last as usize;
            for (plane, root) in self.root.iter_mut().zip(root) {
                plane[all.clone()].copy_from_slice(&root[..numbers.len()]);
            }
            self.id[all].fill(id);
            return;
        }
        for (i, &k) in numbers.iter().enumerate() {
            self.set_root(k as usize, [root[0][i], root[1][i], root[2][i]], id);
        }
    }

    /// As it is kept to be drawn over.
    pub(crate) fn pack(&self, out: &mut [Packed]) {
        simd::run(Pack { root: self.root.each_ref().map(Vec::as_slice), out });
    }

    /// As it is stored in pictures.
    pub(crate) fn encode(&self, out: &mut [[u8; 3]]) {
        simd::run(Encode { root: self.root.each_ref().map(Vec::as_slice), out });
    }
}

struct Pack<'p> {
    root: [&'p [f32]; 3],
    out: &'p mut [Packed],
}

impl Kernel for Pack<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [red, green, blue] = self.root;
        for (((out, r), g), b) in self.out.iter_mut().zip(red).zip(green).zip(blue) {
            *out = Packed::of_roots([color::sixteen_bits(*r), color::sixteen_bits(*g), color::sixteen_bits(*b)]);
        }
    }
}

struct Encode<'p> {
    root: [&'p [f32]; 3],
    out: &'p mut [[u8; 3]],
}

impl Kernel for Encode<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let encoder = Encoder::new();
        let mut planes = [[0; PIXELS]; 3];
        for (i, out) in self.out.chunks_mut(PIXELS).enumerate() {
            for (plane, root) in planes.iter_mut().zip(self.root) {
                let root = &root[i * PIXELS..][..out.len()];
                for (plane, root) in plane.chunks_mut(LANES).zip(root.chunks(LANES)) {
                    let mut whole = [0.0; LANES];
                    whole[..root.len()].copy_from_slice(root);
                    plane.copy_from_slice(&encoder.encode(root.first_chunk().unwrap_or(&whole)));
                }
            }
            interleave(&planes, out);
        }
    }
}

/// Writes pixels, red first.
#[inline(always)]
pub(crate) fn interleave([red, green, blue]: &[[u8; PIXELS]; 3], out: &mut [[u8; 3]]) {
    for (((out, r), g), b) in out.iter_mut().zip(red).zip(green).zip(blue) {
        *out = [*r, *g, *b];
    }
}

/// How many of the first primitives belong to the block of the first one, or are sky.
#[inline(always)]
fn run_of(first: u32, prims: &[u32]) -> usize {
    const N: usize = 16;
    let block = if first >> CELL_BITS == SKY >> CELL_BITS { u32::MAX } else { u32::MAX << CELL_BITS };
    let mut n = 0;
    for chunk in prims.chunks(N) {
        let other = |p: &u32| (p ^ first) & block;
        if chunk.iter().fold(0, |all, p| all | other(p)) != 0 {
            return n + chunk.iter().take_while(|p| other(p) == 0).count();
        }
        n += chunk.len();
    }
    n
}

struct Paint<'p> {
    shader: &'p Shader<'p>,
    samples: Samples<'p>,
    /// In whose colours; `None` = those of the layer that was drawn.
    colors_of: Option<u32>,
    painted: &'p mut Painted,
}

impl Kernel for Paint<'_> {
    type Output = ();

    /// Runs of samples on one block, or of sky.
    #[inline(always)]
    fn run(self) {
        let Self { shader, samples, colors_of, painted } = self;
        let mut batch = Batch::new();
        let mut from = 0;
        while let Some(&prim) = samples.prim.get(from) {
            let to = from + run_of(prim, &samples.prim[from..]);
            if prim == SKY {
                shader.paint_sky(&samples, [from, to], painted);
            } else if prim & SOUP == 0
                && let Some(block) = shader.blocks.list.get((prim >> CELL_BITS) as usize)
                && let Geometry::Grid(nodes) = &block.geometry
                && let layer = colors_of.unwrap_or(block.layer) as usize
                && let LayerShade::Terrain(_) = shader.layers[layer]
            {
                batch.take(shader, (block, nodes, layer), &samples, [from, to], painted);
            } else {
                (from..to).for_each(|k| shader.paint_one(&samples, (k, colors_of), &mut batch, painted));
            }
            from = to;
        }
        batch.flush(shader, &samples, painted);
    }
}

impl Shader<'_> {
    /// Colours of samples, in their order.
    pub(crate) fn paint(&self, samples: Samples<'_>, painted: &mut Painted) {
        self.paint_as(None, samples, painted);
        self.mix(samples, painted);
    }

    /// Colours of samples in those of a layer that is the same surface.
    pub(super) fn paint_as(&self, colors_of: Option<u32>, samples: Samples<'_>, painted: &mut Painted) {
        painted.resize(samples.prim.len());
        simd::run(Paint { shader: self, samples, colors_of, painted });
    }

    #[inline(always)]
    fn paint_sky(&self, samples: &Samples<'_>, [from, to]: [usize; 2], painted: &mut Painted) {
        let out = painted.root.each_mut().map(|plane| &mut plane[from..to]);
        self.sky.paint(&samples.x[from..to], &samples.y[from..to], out);
        painted.id[from..to].fill(0);
    }

    /// A sample of an explicit triangle.
    #[inline(never)]
    fn paint_one(
        &self,
        samples: &Samples<'_>,
        (k, colors_of): (usize, Option<u32>),
        batch: &mut Batch,
        painted: &mut Painted,
    ) {
        let Some(found) = self.blocks.find(samples.prim[k]) else { return painted.set(k, Rgb::ZERO, 0) };
        let (layer, depth) = (colors_of.unwrap_or(found.block.layer), self.screen.depth_of(samples.q[k]));
        let (hit, footprint) =
            (SurfacePoint::new(&found, self.screen, samples.at(k)), self.screen.footprint(f64::from(depth)));
        let color = match &self.layers[layer as usize] {
            LayerShade::Terrain(_) => return batch.take_odd(layer as usize, self, samples, k, painted),
            LayerShade::Boxes(b, light) => {
                let (shape, world, n) = hit.on_box(&found, b);
                self.box_color(layer as usize, shape, light, n, world, footprint)
            }
            LayerShade::Mesh(m) => {
                m.shade(&found, hit.weights, footprint, &|p, n| self.sun_on(layer as usize, p, n, footprint))
            }
            LayerShade::Molecule(m) => m.shade(&found, hit.weights),
            LayerShade::Other => Rgb::ZERO,
        };
        painted.set(k, self.sky.through_air(color, depth), layer + 1);
    }
}
