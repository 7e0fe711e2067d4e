//! Colours of layers that are one surface, mixed by the weights of their representations.

use crate::raster::band::SKY;
use crate::shade::{Painted, Sample, Samples, Shader};
use belvedere_composite::color::Rgb;
use belvedere_core::DVec3;

/// Colour of a sample of several layers: the sum of their colours by share, and the layer of the greatest share.
#[derive(Debug, Clone, Copy)]
struct Mixture {
    color: Rgb,
    id: u32,
    most: f32,
}

impl Mixture {
    const NONE: Self = Self { color: Rgb::ZERO, id: 0, most: -1.0 };

    fn add(&mut self, share: f32, color: Rgb, id: u32) {
        self.color += share * color;
        if share > self.most {
            (self.id, self.most) = (id, share);
        }
    }
}

impl Shader<'_> {
    /// Mixes the colours of layers that are one surface into those of the layer that was drawn for all of them.
    pub(super) fn mix(&self, samples: Samples<'_>, painted: &mut Painted) {
        let Some(sections) = self.sections.as_ref().filter(|s| s.has_one_surface()) else { return };
        for first in (0..self.layers.len()).filter(|layer| !sections.mixed_on(*layer).is_empty()) {
            let layers = sections.mixed_on(first);
            let is_on =
                |k: &usize| samples.prim[*k] != SKY && self.blocks.layer_of(samples.prim[*k]) == Some(first as u32);
            let on: Vec<usize> = (0..samples.prim.len()).filter(is_on).collect();
            let shares: Vec<Vec<f32>> = on
                .iter()
                .map(|&k| {
                    let place = self.world(Sample { prim: samples.prim[k], at: samples.at(k) });
                    sections.mixture(first, place).map(|share| share as f32).collect()
                })
                .collect();
            let mut mixed = vec![Mixture::NONE; on.len()];
            for (number, &layer) in layers.iter().enumerate() {
                let shown: Vec<usize> = (0..on.len()).filter(|i| shares[*i][number] > 0.0).collect();
                let pick = |of: &[u32]| shown.iter().map(|i| of[on[*i]]).collect::<Vec<_>>();
                let place = |of: &[i32]| shown.iter().map(|i| of[on[*i]]).collect::<Vec<_>>();
                let (prim, x, y) = (pick(samples.prim), place(samples.x), place(samples.y));
                let q: Vec<f32> = shown.iter().map(|i| samples.q[on[*i]]).collect();
                let mut own = Painted::default();
                self.paint_as(Some(layer as u32), Samples { prim: &prim, q: &q, x: &x, y: &y }, &mut own);
                for (j, &i) in shown.iter().enumerate() {
                    let root = own.root.each_ref().map(|plane| plane[j]);
                    mixed[i].add(shares[i][number], Rgb::from_array(root.map(|v| v * v)), own.id[j]);
                }
            }
            for (&k, mixture) in on.iter().zip(&mixed) {
                painted.set(k, mixture.color, mixture.id);
            }
        }
    }

    /// Colour and identity that `color` gives for the layers of the surface of a layer, mixed at a place.
    pub(super) fn mixed_at(&self, layer: usize, p: DVec3, color: impl Fn(usize) -> (Rgb, u32)) -> (Rgb, u32) {
        let Some(sections) = self.sections.as_ref().filter(|s| !s.mixed_on(layer).is_empty()) else {
            return color(layer);
        };
        let mut mixed = Mixture::NONE;
        for (&other, share) in sections.mixed_on(layer).iter().zip(sections.mixture(layer, p)) {
            if share > 0.0 {
                let (color, id) = color(other);
                mixed.add(share as f32, color, id);
            }
        }
        (mixed.color, mixed.id)
    }
}
