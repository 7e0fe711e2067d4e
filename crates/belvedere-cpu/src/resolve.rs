//! From samples to pixels.

use crate::lens::{Lens, SUB};
use crate::polish::Polish;
use crate::raster::{Band, SKY};
use crate::shade::color::Packed;
use crate::shade::{Painted, Sample, Shader};

/// Rows of the picture that a band fills.
pub(crate) struct Rows<'a> {
    pub(crate) color: &'a mut [Packed],
    pub(crate) depth: &'a mut [f32],
    pub(crate) id: &'a mut [u32],
    pub(crate) world: Option<&'a mut [[f64; 3]]>,
    /// Makes depth and place exact, if asked for.
    pub(crate) polish: Option<&'a Polish<'a>>,
}

/// Two samples farther apart than this share of their depth are coloured separately.
const SAME_SURFACE: f32 = 0.02;

/// Colours the band's pixels.
pub(crate) fn resolve(band: &Band, shader: &Shader<'_>, lens: &Lens, rows: &mut Rows<'_>) {
    let width = band.width.max(0) as usize;
    let mut painted = vec![Painted::default(); width];
    let mut edges = Edges::default();
    for y in band.y0..band.y1 {
        let first = band.index(0, 0, y);
        let out = (y - band.y0) as usize * width;
        for ((depth, q), prim) in rows.depth[out..].iter_mut().zip(&band.q[first..][..width]).zip(&band.prim[first..]) {
            *depth = if *prim == SKY { f32::INFINITY } else { lens.depth_of(*q) };
        }
        shader.paint((0..band.width).map(|x| sample(band, 0, x, y)), &mut painted);
        for (id, p) in rows.id[out..].iter_mut().zip(&painted) {
            *id = p.id;
        }
        if rows.world.is_some() || rows.polish.is_some() {
            for x in 0..width {
                place(band, shader, rows, out + x, [x as i32, y]);
            }
        }
        if band.offsets.len() > 1 {
            edges.mix(band, shader, y, &mut painted);
        }
        for (color, p) in rows.color[out..].iter_mut().zip(&painted) {
            *color = Packed::new(p.color);
        }
    }
}

/// Place, and depth where that is to be exact, of what a pixel's centre sees.
fn place(band: &Band, shader: &Shader<'_>, rows: &mut Rows<'_>, out: usize, [x, y]: [i32; 2]) {
    let centre = sample(band, 0, x, y);
    let mut world = shader.world(centre);
    if let Some(polish) = rows.polish
        && let Some((place, depth)) = shader.exact_place(polish, centre.prim, world, x, y)
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
    samples: Vec<Sample>,
    painted: Vec<Painted>,
    /// Pixel, share of its centre, and number of its first sample in `samples`.
    pixels: Vec<(u32, u32, usize)>,
    /// Coverage samples of each of `samples`.
    shares: Vec<u32>,
}

impl Edges {
    /// Replaces the colours of pixels by the mean of their coverage samples, where these see more than one surface;
    /// samples on one surface share the colour of the first of them.
    fn mix(&mut self, band: &Band, shader: &Shader<'_>, y: i32, painted: &mut [Painted]) {
        self.samples.clear();
        self.shares.clear();
        self.pixels.clear();
        for x in 0..band.width {
            if !is_even(band, shader, x, y) {
                self.take(band, shader, x, y);
            }
        }
        self.painted.clear();
        self.painted.resize(self.samples.len(), Painted::default());
        shader.paint(self.samples.iter().copied(), &mut self.painted);
        let n = (band.offsets.len() - 1) as f32;
        for (i, &(x, centre, first)) in self.pixels.iter().enumerate() {
            let last = self.pixels.get(i + 1).map_or(self.samples.len(), |p| p.2);
            let color = &mut painted[x as usize].color;
            let mut sum = *color * centre as f32;
            for (p, share) in self.painted[first..last].iter().zip(&self.shares[first..last]) {
                sum += p.color * *share as f32;
            }
            *color = sum / n;
        }
    }

    fn take(&mut self, band: &Band, shader: &Shader<'_>, x: i32, y: i32) {
        let (middle, first) = (sample(band, 0, x, y), self.samples.len());
        let mut centre = 0;
        for s in 1..band.offsets.len() {
            let here = sample(band, s, x, y);
            if is_same(shader, &middle, &here) {
                centre += 1;
            } else if let Some(k) = self.samples[first..].iter().position(|other| is_same(shader, other, &here)) {
                self.shares[first + k] += 1;
            } else {
                self.samples.push(here);
                self.shares.push(1);
            }
        }
        self.pixels.push((x as u32, centre, first));
    }
}

/// Whether all samples of a pixel lie on one surface: a quick test for nearly all pixels.
fn is_even(band: &Band, shader: &Shader<'_>, x: i32, y: i32) -> bool {
    let i = band.index(0, x, y);
    let (prim, q) = (band.prim[i], band.q[i]);
    (1..band.offsets.len()).all(|s| {
        let k = band.index(s, x, y);
        band.prim[k] == prim
            || (prim != SKY && band.prim[k] != SKY && is_near(q, band.q[k]) && shader.is_terrain(prim, band.prim[k]))
    })
}

fn is_same(shader: &Shader<'_>, a: &Sample, b: &Sample) -> bool {
    a.prim == b.prim || (a.prim != SKY && b.prim != SKY && is_near(a.q, b.q) && shader.is_terrain(a.prim, b.prim))
}

/// Whether two samples are about equally far away: shares of depth and of nearness are the same thing.
#[inline]
fn is_near(a: f32, b: f32) -> bool {
    (a - b).abs() <= SAME_SURFACE * a.abs().min(b.abs())
}

#[inline]
fn sample(band: &Band, s: usize, x: i32, y: i32) -> Sample {
    let i = band.index(s, x, y);
    let [ox, oy] = band.offsets[s];
    Sample { prim: band.prim[i], q: band.q[i], at: [x * SUB + ox, y * SUB + oy] }
}
