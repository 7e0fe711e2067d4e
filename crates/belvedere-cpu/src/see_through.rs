//! Solids that something shines through: their samples become a [`Veil`] over the picture of what hides.

use crate::geometry::blocks::Blocks;
use crate::geometry::drawn_solids::DrawnSolids;
use crate::raster::band::{Band, SKY};
use crate::screen::{SUB, Screen};
use crate::shade::{Painted, Samples, Shader};
use belvedere_composite::color::Rgb;
use belvedere_composite::veil::VeilRows;
use belvedere_scene::Scene;
use belvedere_sight::Solids;
use belvedere_sight::sections::{Exposure, Sections};
use std::ops::Range;

/// Weights of colours below this are left out: a 2000th of the steps of a picture.
const LEAST: f32 = 2e-6;

/// A layer that something shines through.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeeThrough {
    /// Index in the scene.
    pub(crate) layer: usize,
    pub(crate) opacity: f32,
}

impl SeeThrough {
    /// Those of a scene that are drawn.
    pub(crate) fn of(scene: &Scene) -> Vec<Self> {
        let drawn = scene.layers.iter().enumerate().filter(|(_, l)| l.kind.is_see_through() && l.kind.opacity() > 0.0);
        drawn.map(|(layer, l)| Self { layer, opacity: l.kind.opacity() }).collect()
    }

    /// The solids of the layer that something shines through.
    pub(crate) fn solids(self, scene: &Scene) -> DrawnSolids<'_> {
        DrawnSolids { scene, solids: Solids::Alone(self.layer) }
    }
}

/// Sections that are drawn sample by sample, the exposures, and the offsets of all their samples.
pub(crate) type Exposed<'a> = (&'a Sections<'a>, &'a Exposure, &'a [[i32; 2]]);

/// Draws the layers into bands of their own, which hold the samples of the band `behind`, of what hides.
pub(crate) fn draw(
    (scene, layers): (&Scene, &[SeeThrough]),
    blocks: &Blocks,
    bands: &mut [Band],
    (ortho, thin): (bool, Option<Exposed<'_>>),
) {
    for (layer, band) in layers.iter().zip(bands) {
        blocks.draw(band, layer.solids(scene));
        if let Some((sections, exposure, offsets)) = thin {
            band.expose(offsets.to_vec());
            blocks.draw_thin(band, ortho, (sections, exposure), layer.solids(scene));
        }
    }
}

/// Composites the samples of layers over those of the band behind.
pub(crate) struct Composer<'c> {
    pub(crate) layers: &'c [SeeThrough],
    pub(crate) behind: &'c Band,
    /// Samples of each layer.
    pub(crate) bands: &'c [Band],
    pub(crate) shader: &'c Shader<'c>,
    pub(crate) screen: &'c Screen,
}

/// Colours that are needed for some pixels, and their weights.
#[derive(Default)]
struct Colors {
    prim: Vec<u32>,
    q: Vec<f32>,
    x: Vec<i32>,
    y: Vec<i32>,
    /// Pixel of the band, and weight of the colour there.
    of: Vec<(usize, f32)>,
    painted: Painted,
}

impl Colors {
    /// Adds to the weight of a surface in a pixel whose colours begin at number `first`; the first sample on it gives the colour.
    fn add(&mut self, first: usize, pixel: usize, (prim, q, at): (u32, f32, [i32; 2]), weight: f32) {
        if let Some(k) = (first..self.prim.len()).find(|k| self.prim[*k] == prim) {
            self.of[k].1 += weight;
            return;
        }
        self.prim.push(prim);
        self.q.push(q);
        self.x.push(at[0]);
        self.y.push(at[1]);
        self.of.push((pixel, weight));
    }

    /// Leaves out colours of the pixel that begins at `first` whose weights came to nothing.
    fn drop_empty(&mut self, first: usize) {
        for k in (first..self.prim.len()).rev().filter(|k| self.of[*k].1.abs() < LEAST).collect::<Vec<_>>() {
            self.prim.remove(k);
            self.q.remove(k);
            self.x.remove(k);
            self.y.remove(k);
            self.of.remove(k);
        }
    }

    fn clear(&mut self) {
        self.prim.clear();
        self.q.clear();
        self.x.clear();
        self.y.clear();
        self.of.clear();
    }
}

impl Composer<'_> {
    /// Fills in the rows of the veil.
    pub(crate) fn compose(&self, veil: &mut VeilRows<'_>) {
        let width = self.behind.width.max(0) as usize;
        let mut colors = Colors::default();
        for y in self.behind.y0..self.behind.y1 {
            let row = (y - self.behind.y0) as usize * width;
            colors.clear();
            for columns in self.columns() {
                for x in columns {
                    self.pixel([x as i32, y], row + x, veil, &mut colors);
                }
            }
            let Colors { prim, q, x, y, of, painted } = &mut colors;
            if prim.is_empty() {
                continue;
            }
            self.shader.paint(Samples { prim, q, x, y }, painted);
            for (k, (pixel, weight)) in of.iter().enumerate() {
                let root = Rgb::from_array(painted.root.each_ref().map(|plane| plane[k]));
                veil.light[*pixel] += *weight * root * root;
            }
        }
    }

    /// Columns in which any layer was drawn.
    fn columns(&self) -> Vec<Range<usize>> {
        let mut drawn: Vec<Range<usize>> = self
            .bands
            .iter()
            .flat_map(|band| band.parts().filter(|part| part.drawn).map(|part| part.columns))
            .collect();
        drawn.sort_by_key(|columns| columns.start);
        let mut joined: Vec<Range<usize>> = Vec::new();
        for columns in drawn {
            match joined.last_mut() {
                Some(last) if columns.start <= last.end => last.end = last.end.max(columns.end),
                _ => joined.push(columns),
            }
        }
        joined
    }

    /// Layers in front of a sample, nearest first: their numbers among the bands, and the index of the sample.
    fn in_front(&self, sample: usize, [x, y]: [i32; 2], out: &mut Vec<(usize, usize)>) -> usize {
        out.clear();
        let i = self.behind.index(sample, x, y);
        let (prim, q) = (self.behind.prim[i], self.behind.q[i]);
        for (k, band) in self.bands.iter().enumerate() {
            // Of equally near surfaces the one with the smaller number is in front, as in a band.
            let here = (band.prim[i], band.q[i]);
            if here.0 != SKY && (here.1 > q || (here.1 == q && here.0 < prim)) {
                out.push((k, i));
            }
        }
        if out.len() > 1 {
            let of = |(k, i): &(usize, usize)| (self.bands[*k].q[*i], self.bands[*k].prim[*i]);
            out.sort_by(|a, b| of(b).0.total_cmp(&of(a).0).then(of(a).1.cmp(&of(b).1)));
        }
        i
    }

    fn pixel(&self, at: [i32; 2], pixel: usize, veil: &mut VeilRows<'_>, colors: &mut Colors) {
        let count = self.behind.offsets.len();
        let (from, n) = if count > 1 { (1, (count - 1) as f32) } else { (0, 1.0) };
        let mut front = Vec::with_capacity(self.bands.len());
        let place = |s: usize| {
            let [ox, oy] = self.behind.offsets[s];
            [at[0] * SUB + ox, at[1] * SUB + oy]
        };
        let i = self.in_front(0, at, &mut front);
        if let Some((k, _)) = front.first() {
            veil.depth[pixel] = self.screen.depth_of(self.bands[*k].q[i]);
        }
        let first = colors.prim.len();
        // The colour of the centre stands for other samples of its surface.
        for (k, i) in &front {
            let band = &self.bands[*k];
            colors.add(first, pixel, (band.prim[*i], band.q[*i], place(0)), 0.0);
        }
        let (mut sum, mut any) = (0.0, !front.is_empty());
        for s in from..count {
            self.in_front(s, at, &mut front);
            let mut through = 1.0;
            for (k, i) in &front {
                let (band, opacity) = (&self.bands[*k], self.layers[*k].opacity);
                colors.add(first, pixel, (band.prim[*i], band.q[*i], place(s)), through * opacity / n);
                through *= 1.0 - opacity;
            }
            any |= !front.is_empty();
            sum += through;
        }
        if !any {
            return;
        }
        let mean = sum / n;
        veil.through[pixel] = mean;
        for s in from..count {
            let i = self.in_front(s, at, &mut front);
            let own = front.iter().fold(1.0, |through, (k, _)| through * (1.0 - self.layers[*k].opacity));
            if own != mean {
                let here = (self.behind.prim[i], self.behind.q[i], place(s));
                colors.add(first, pixel, here, (own - mean) / n);
            }
        }
        colors.drop_empty(first);
    }
}
