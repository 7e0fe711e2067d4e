//! Colours of many samples at once.

use crate::geometry::block::Geometry;
use crate::geometry::blocks::{CELL_BITS, SOUP};
use crate::raster::band::SKY;
use crate::shade::ground::batch::Batch;
use crate::shade::{LayerShade, Painted, Samples, Shader, SurfacePoint};
use crate::simd::{self, Kernel};
use belvedere_composite::color::Rgb;

/// Number of leading primitives that belong to the block of the first one, or are sky.
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
    /// Layer whose colours are used; `None`: the layer that was drawn.
    colors_of: Option<u32>,
    painted: &'p mut Painted,
}

impl Kernel for Paint<'_> {
    type Output = ();

    /// Colours the samples, run by run of one block or of sky.
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
        self.fade(samples, painted);
    }

    /// Colours of samples as if they belonged to another layer of the same surface.
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
