//! Light of the solids that something shines through, kept apart from the picture behind them until lines and points are drawn.
//!
//! Of every layer the nearest surface of each sample counts, in front of the surfaces that hide: with `a_k` the opacities of the layers
//! before a sample, nearest first, and `c_k` their colours, the sample has the light `sum_k t_k a_k c_k` and lets the share
//! `t = prod_k (1 - a_k)` of what is behind through, `t_k` being the product of those before `k`. Both are means over the samples of a
//! pixel; what the product of two means misses, where a pixel has borders both before and behind, is part of the light.
//! Source: the over operator of Porter and Duff 1984, per sample.

use crate::color::{Packed, Rgb};
use crate::marks::Marks;
use belvedere_sight::screen::Screen;

/// The light of a picture's see-through solids, pixel by pixel.
#[derive(Debug, Default)]
pub struct Veil {
    /// Their linear light.
    pub light: Vec<Rgb>,
    /// Share of what is behind that is seen, 0..=1.
    pub through: Vec<f32>,
    /// Depths of the nearest of them at the pixel centres, scene units; infinite where there is none.
    pub depth: Vec<f32>,
}

/// Rows of a [`Veil`].
#[derive(Debug)]
pub struct VeilRows<'a> {
    /// As [`Veil::light`].
    pub light: &'a mut [Rgb],
    /// As [`Veil::through`].
    pub through: &'a mut [f32],
    /// As [`Veil::depth`].
    pub depth: &'a mut [f32],
}

impl Veil {
    /// Bytes per pixel.
    pub const BYTES: u64 = 16 + 4 + 4;

    /// A veil of `pixels` pixels that lets everything through.
    pub fn clear(pixels: usize) -> Self {
        Self { light: vec![Rgb::ZERO; pixels], through: vec![1.0; pixels], depth: vec![f32::INFINITY; pixels] }
    }

    /// Rows of `chunk` pixels each, from the top.
    pub fn bands(&mut self, chunk: usize) -> Vec<Option<VeilRows<'_>>> {
        let Self { light, through, depth } = self;
        let parts = light.chunks_mut(chunk).zip(through.chunks_mut(chunk)).zip(depth.chunks_mut(chunk));
        parts.map(|((light, through), depth)| Some(VeilRows { light, through, depth })).collect()
    }

    /// Depths of the nearest surfaces, see-through ones included.
    pub fn nearest(&self, depth: &[f32]) -> Vec<f32> {
        self.depth.iter().zip(depth).map(|(a, b)| a.min(*b)).collect()
    }
}

/// A veil and the marks in front of it.
#[derive(Debug, Clone, Copy)]
pub struct Veiled<'a> {
    /// The veil.
    pub veil: &'a Veil,
    /// Number of its first row.
    pub first: usize,
    /// Marks of which those parts count that no surface hides, see-through ones included.
    pub front: &'a Marks,
}

impl Veiled<'_> {
    /// Lays the veil over the rows of a band, `y0` the first of them; visible marks in front of it stay.
    pub(crate) fn lay(&self, y0: i32, screen: &Screen, color: &mut [Packed]) {
        let first = (y0 as usize - self.first) * screen.width as usize;
        let rows = first..first + color.len();
        let Veil { light, through, .. } = self.veil;
        let (light, through) = (&light[rows.clone()], &through[rows]);
        let is_clear = |i: usize| through[i] >= 1.0 && light[i] == Rgb::ZERO;
        if (0..color.len()).all(is_clear) {
            return;
        }
        let front = self.front.visible_cover(y0, screen, color.len());
        for (i, color) in color.iter_mut().enumerate().filter(|(i, _)| !is_clear(*i)) {
            let cover = front.get(i).copied().unwrap_or(0.0);
            let behind = through[i] + (1.0 - through[i]) * cover;
            *color = Packed::new(behind * color.rgb() + (1.0 - cover) * light[i]);
        }
    }
}
