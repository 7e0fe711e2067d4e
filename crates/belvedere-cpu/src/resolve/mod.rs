//! Colours pixels from the samples of a band.

pub(crate) mod relief;

use crate::raster::band::{Band, Part, SKY};
use crate::screen::{SUB, Screen};
use crate::shade::pixel_center::PixelCenters;
use crate::shade::{Painted, Sample, Samples, Shader};
use crate::simd::{self, Kernel};
use belvedere_composite::color::Packed;
use std::ops::Range;

/// Rows of the picture that a band fills.
pub(crate) struct Rows<'a, 'c> {
    pub(crate) color: &'a mut Colors<'c>,
    pub(crate) depth: &'a mut [f32],
    pub(crate) id: &'a mut [u32],
    pub(crate) world: Option<&'a mut [[f64; 3]]>,
    /// Exact points and depths at pixel centres, if they are asked for.
    pub(crate) centers: Option<&'a PixelCenters<'a>>,
}

/// Target of the colours.
pub(crate) enum Colors<'a> {
    /// Linear colours that marks may still be drawn over.
    Open(&'a mut [Packed]),
    /// Finished colours in sRGB.
    Stored(&'a mut [[u8; 3]]),
}

/// Two samples farther apart than this share of their depth are coloured separately.
const SAME_SURFACE: f32 = 0.02;

/// Colours the band's pixels.
pub(crate) fn resolve(band: &Band, shader: &Shader<'_>, screen: &Screen, rows: &mut Rows<'_, '_>) {
    let width = band.width.max(0) as usize;
    let [ox, oy] = band.offsets[0];
    let x: Vec<i32> = (0..band.width).map(|x| x * SUB + ox).collect();
    let mut y = vec![0; width];
    let mut brushes = RowColors::default();
    for row in band.y0..band.y1 {
        y.fill(row * SUB + oy);
        let first = (row - band.y0) as usize * width;
        for Part { columns, drawn } in band.parts() {
            let out = first + columns.start..first + columns.end;
            let at = (&x[columns.clone()], &y[columns.clone()]);
            match &mut *rows.color {
                Colors::Stored(color) if !drawn => {
                    // World points of the sky are NaN from the start.
                    rows.depth[out.clone()].fill(f32::INFINITY);
                    rows.id[out.clone()].fill(0);
                    shader.sky.store([at.0[0], at.1[0]], &mut color[out]);
                }
                _ => brushes.paint(band, shader, screen, (columns, row), at, rows, out),
            }
        }
    }
}

/// Reusable buffers for colouring a row.
#[derive(Default)]
struct RowColors {
    painted: Painted,
    edges: Edges,
}

impl RowColors {
    /// Colours some columns of a row.
    /// * `at`: fixed-point positions of the samples at the pixel centres; `out`: range of the pixels in the band.
    #[allow(clippy::too_many_arguments, reason = "what is seen, where, by whom, and where it goes")]
    fn paint(
        &mut self,
        band: &Band,
        shader: &Shader<'_>,
        screen: &Screen,
        (columns, row): (Range<usize>, i32),
        (x, y): (&[i32], &[i32]),
        rows: &mut Rows<'_, '_>,
        out: Range<usize>,
    ) {
        let Self { painted, edges } = self;
        let from = band.index(0, columns.start as i32, row);
        let (prim, q) = (&band.prim[from..][..columns.len()], &band.q[from..][..columns.len()]);
        simd::run(Depths { ortho: screen.ortho, q, prim, out: &mut rows.depth[out.clone()] });
        shader.paint(Samples { prim, q, x, y }, painted);
        rows.id[out.clone()].copy_from_slice(&painted.id);
        if rows.world.is_some() || rows.centers.is_some() {
            for (out, x) in out.clone().zip(columns.clone()) {
                place(band, shader, rows, out, [x as i32, row]);
            }
        }
        if band.offsets.len() > 1 {
            edges.mix(band, shader, (columns, row), painted);
        }
        match &mut *rows.color {
            Colors::Open(color) => painted.pack(&mut color[out]),
            Colors::Stored(color) => painted.encode(&mut color[out]),
        }
    }
}

struct Depths<'d> {
    ortho: bool,
    q: &'d [f32],
    prim: &'d [u32],
    out: &'d mut [f32],
}

impl Kernel for Depths<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for ((depth, q), prim) in self.out.iter_mut().zip(self.q).zip(self.prim) {
            let here = if self.ortho { -*q } else { 1.0 / *q };
            *depth = if *prim == SKY { f32::INFINITY } else { here };
        }
    }
}

/// Writes the world point seen at a pixel centre, and its depth where exact depths are asked for.
fn place(band: &Band, shader: &Shader<'_>, rows: &mut Rows<'_, '_>, out: usize, [x, y]: [i32; 2]) {
    let centre = sample(band, 0, x, y);
    let mut world = shader.world(centre);
    if let Some(centers) = rows.centers
        && let Some((place, depth)) = shader.exact_point(centers, centre.prim, world, x, y)
    {
        (world, rows.depth[out]) = (place, depth);
    }
    if let Some(places) = &mut rows.world {
        places[out] = world.to_array();
    }
}

/// Pixels whose samples see several surfaces, collected row by row and shaded together.
#[derive(Default)]
struct Edges {
    /// Samples apart from the centres, see [`Samples`].
    prim: Vec<u32>,
    q: Vec<f32>,
    x: Vec<i32>,
    y: Vec<i32>,
    painted: Painted,
    /// Not 0 for pixels that may see several surfaces.
    uneven: Vec<u32>,
    /// Number of the pixel among those painted, coverage samples that share the colour of its centre, and number of its first own sample.
    pixels: Vec<(usize, u32, usize)>,
    /// Number of coverage samples that share the colour of each sample.
    shares: Vec<u32>,
}

impl Edges {
    /// Replaces the colours of pixels whose samples see several surfaces by the mean over the samples; samples on one surface share
    /// the colour of the first of them.
    /// * `columns`, `y`: the pixels that were painted.
    fn mix(&mut self, band: &Band, shader: &Shader<'_>, (columns, y): (Range<usize>, i32), painted: &mut Painted) {
        let Self { prim, q, x, y: ys, shares, pixels, .. } = self;
        [prim, shares].into_iter().for_each(Vec::clear);
        [x, ys].into_iter().for_each(Vec::clear);
        q.clear();
        pixels.clear();
        self.uneven.clear();
        self.uneven.resize(columns.len(), 0);
        simd::run(Unevenness { band, first: columns.start, y, terrain: shader.only_terrain(), out: &mut self.uneven });
        for i in 0..self.uneven.len() {
            let x = (columns.start + i) as i32;
            if self.uneven[i] != 0 && (shader.only_terrain() || !is_even(band, shader, x, y)) {
                self.take(band, shader, [x, y], i);
            }
        }
        if self.pixels.is_empty() {
            return;
        }
        shader.paint(Samples { prim: &self.prim, q: &self.q, x: &self.x, y: &self.y }, &mut self.painted);
        let n = (band.offsets.len() - 1) as f32;
        for (i, &(pixel, centre, first)) in self.pixels.iter().enumerate() {
            let last = self.pixels.get(i + 1).map_or(self.prim.len(), |p| p.2);
            for (root, from) in painted.root.iter_mut().zip(&self.painted.root) {
                let root = &mut root[pixel];
                let others = from[first..last].iter().zip(&self.shares[first..last]);
                let sum = others.fold(*root * *root * centre as f32, |sum, (c, share)| sum + c * c * *share as f32);
                *root = (sum / n).sqrt();
            }
        }
    }

    /// * `pixel`: its number among those painted.
    fn take(&mut self, band: &Band, shader: &Shader<'_>, [x, y]: [i32; 2], pixel: usize) {
        let seen = |s: usize| {
            let i = band.index(s, x, y);
            (band.prim[i], band.q[i])
        };
        let (middle, first) = (seen(0), self.prim.len());
        let mut centre = 0;
        for s in 1..band.offsets.len() {
            let here = seen(s);
            let is_here = |k: &usize| is_same(shader, (self.prim[*k], self.q[*k]), here);
            if is_same(shader, middle, here) {
                centre += 1;
            } else if let Some(k) = (first..self.prim.len()).find(is_here) {
                self.shares[k] += 1;
            } else {
                let Sample { prim, at } = sample(band, s, x, y);
                self.prim.push(prim);
                self.q.push(here.1);
                self.x.push(at[0]);
                self.y.push(at[1]);
                self.shares.push(1);
            }
        }
        self.pixels.push((pixel, centre, first));
    }
}

/// Finds the pixels of a row, from column `first` on, that may see several surfaces.
struct Unevenness<'u> {
    band: &'u Band,
    first: usize,
    y: i32,
    /// Whether a single terrain is the only surface, so that colours change smoothly.
    terrain: bool,
    out: &'u mut [u32],
}

impl Kernel for Unevenness<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let (band, width) = (self.band, self.out.len());
        let row = |s: usize| {
            let first = band.index(s, self.first as i32, self.y);
            (&band.prim[first..][..width], &band.q[first..][..width])
        };
        let (prims, qs) = row(0);
        for s in 1..band.offsets.len() {
            let (prim, q) = row(s);
            for x in 0..width {
                let solid = (prims[x] != SKY) & (prim[x] != SKY) & self.terrain;
                let same = (prims[x] == prim[x]) | (solid & is_near(qs[x], q[x]));
                self.out[x] |= if same { 0 } else { 1 };
            }
        }
    }
}

/// Whether all samples of a pixel lie on one surface.
fn is_even(band: &Band, shader: &Shader<'_>, x: i32, y: i32) -> bool {
    let i = band.index(0, x, y);
    let centre = (band.prim[i], band.q[i]);
    (1..band.offsets.len()).all(|s| {
        let k = band.index(s, x, y);
        is_same(shader, centre, (band.prim[k], band.q[k]))
    })
}

/// Whether two samples, given by primitive and nearness, may share a colour.
#[inline(always)]
fn is_same(shader: &Shader<'_>, a: (u32, f32), b: (u32, f32)) -> bool {
    a.0 == b.0 || (a.0 != SKY && b.0 != SKY && is_near(a.1, b.1) && shader.is_terrain(a.0, b.0))
}

/// Whether the depths of two samples are about equal; relative differences of depth and of nearness are the same.
#[inline(always)]
fn is_near(a: f32, b: f32) -> bool {
    (a - b).abs() <= SAME_SURFACE * a.abs().min(b.abs())
}

#[inline]
fn sample(band: &Band, s: usize, x: i32, y: i32) -> Sample {
    let [ox, oy] = band.offsets[s];
    Sample { prim: band.prim[band.index(s, x, y)], at: [x * SUB + ox, y * SUB + oy] }
}
