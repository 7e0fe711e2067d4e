//! Samples and their colours.

use crate::simd::{self, Kernel};
use belvedere_composite::color::{self, Encoder, LANES, PIXELS, Packed, Rgb};

/// Samples of the picture: primitive, nearness, and fixed-point position on the image; slices of equal length.
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
    pub(super) fn resize(&mut self, n: usize) {
        self.root.iter_mut().for_each(|plane| plane.resize(n, 0.0));
        self.id.resize(n, 0);
    }

    /// * `color`: linear.
    pub(crate) fn set(&mut self, k: usize, color: Rgb, id: u32) {
        self.set_root(k, color.to_array().map(|v| v.max(0.0).sqrt()), id);
    }

    #[inline(always)]
    pub(super) fn set_root(&mut self, k: usize, root: [f32; 3], id: u32) {
        for (plane, v) in self.root.iter_mut().zip(root) {
            plane[k] = v;
        }
        self.id[k] = id;
    }

    /// Sets the colours of the samples with these numbers, most of them consecutive.
    #[inline(always)]
    pub(crate) fn set_roots<const N: usize>(&mut self, numbers: &[u32], root: &[[f32; N]; 3], id: u32) {
        let (Some(&first), Some(&last)) = (numbers.first(), numbers.last()) else { return };
        // The numbers rise.
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

    /// Packs the colours for further drawing.
    pub(crate) fn pack(&self, out: &mut [Packed]) {
        simd::run(Pack { root: self.root.each_ref().map(Vec::as_slice), out });
    }

    /// Encodes the colours as sRGB.
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
        let encoder = Encoder::default();
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
