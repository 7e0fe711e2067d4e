//! Georeferenced pictures on terrain, filtered.

use crate::shade::footprint::Footprint;
use belvedere_composite::color::{Rgb, encode, linear};
use belvedere_core::DVec2;
use belvedere_scene::Drape;
use glam::Vec4;

/// Most samples for one pixel; longer footprints are averaged over wider squares.
const MOST_SAMPLES: usize = 16;

/// A drape with its averages: sRGB colours, premultiplied while filtering.
#[derive(Debug)]
pub(crate) struct DrapeMap {
    levels: Vec<(usize, usize, Vec<[u8; 4]>)>,
    pixel_from_scene: [f64; 6],
    /// Drape pixels per scene unit.
    density: f64,
}

impl DrapeMap {
    /// `None` for a picture without pixels or with a wrong number of them.
    pub(crate) fn new(drape: &Drape) -> Option<Self> {
        let (mut w, mut h) = (drape.width, drape.height);
        if w == 0 || h == 0 || drape.pixels.len() != w * h || drape.pixel_from_scene.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut levels = vec![(w, h, drape.pixels.clone())];
        while w.max(h) > 1 && levels.len() < 12 {
            let (nw, nh) = (w.div_ceil(2), h.div_ceil(2));
            let (_, _, from) = &levels[levels.len() - 1];
            let pixels = (0..nw * nh).map(|i| average(from, w, h, 2 * (i % nw), 2 * (i / nw))).collect();
            levels.push((nw, nh, pixels));
            (w, h) = (nw, nh);
        }
        let a = drape.pixel_from_scene;
        Some(Self { levels, pixel_from_scene: a, density: (a[0] * a[4] - a[1] * a[3]).abs().sqrt() })
    }

    /// Whether it was made from this picture.
    pub(crate) fn is_of(&self, drape: &Drape) -> bool {
        let made = self
            .levels
            .first()
            .is_some_and(|(w, h, pixels)| (*w, *h) == (drape.width, drape.height) && *pixels == drape.pixels);
        made && self.pixel_from_scene == drape.pixel_from_scene
    }

    /// Linear colour and alpha around a scene position, averaged over what a pixel covers there: samples along the
    /// longer side, each averaged over the shorter one.
    pub(crate) fn at(&self, xy: DVec2, print: &Footprint) -> (Rgb, f32) {
        let (n, side) = print.samples(MOST_SAMPLES);
        let sum: Vec4 = (0..n)
            .map(|i| {
                let p = xy + print.major * ((i as f64 + 0.5) / n as f64 - 0.5);
                let (c, a) = self.square(p.x, p.y, side);
                (c * a).extend(a)
            })
            .sum();
        if sum.w <= 0.0 { (Rgb::ZERO, 0.0) } else { (Rgb::from(sum.truncate() / sum.w), sum.w / n as f32) }
    }

    /// Linear colour and alpha averaged over a square of side `footprint` scene units.
    fn square(&self, x: f64, y: f64, footprint: f64) -> (Rgb, f32) {
        let a = self.pixel_from_scene;
        let (u, v) = (a[0] * x + a[1] * y + a[2], a[3] * x + a[4] * y + a[5]);
        let (w, h, _) = &self.levels[0];
        if !(u >= 0.0 && v >= 0.0 && u <= *w as f64 && v <= *h as f64) {
            return (Rgb::ZERO, 0.0);
        }
        let lod = ((footprint * self.density).max(1.0).log2() as f32).min((self.levels.len() - 1) as f32);
        let k = lod as usize;
        let mut c = self.bilinear(k, u, v);
        let share = lod - k as f32;
        if share > 1e-3 && k + 1 < self.levels.len() {
            c += share * (self.bilinear(k + 1, u, v) - c);
        }
        if c.w <= 0.0 { (Rgb::ZERO, 0.0) } else { (Rgb::from(c.truncate() / c.w), c.w) }
    }

    /// Premultiplied.
    fn bilinear(&self, k: usize, u: f64, v: f64) -> Vec4 {
        let (w, h, pixels) = &self.levels[k];
        let step = 1.0 / (1u64 << k) as f64;
        let (x, y) = ((u * step - 0.5).clamp(0.0, (*w - 1) as f64), (v * step - 0.5).clamp(0.0, (*h - 1) as f64));
        let (i, j) = (x as usize, y as usize);
        let (i1, j1) = ((i + 1).min(w - 1), (j + 1).min(h - 1));
        let (s, t) = ((x - i as f64) as f32, (y - j as f64) as f32);
        let at = |i: usize, j: usize| premultiplied(pixels[j * w + i]);
        let (a, b) = (at(i, j).lerp(at(i1, j), s), at(i, j1).lerp(at(i1, j1), s));
        a.lerp(b, t)
    }
}

fn premultiplied([r, g, b, a]: [u8; 4]) -> Vec4 {
    let alpha = f32::from(a) / 255.0;
    (linear([r, g, b]) * alpha).extend(alpha)
}

fn average(from: &[[u8; 4]], w: usize, h: usize, x: usize, y: usize) -> [u8; 4] {
    let mut sum = Vec4::ZERO;
    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        sum += premultiplied(from[(y + j).min(h - 1) * w + (x + i).min(w - 1)]);
    }
    if sum.w <= 0.0 {
        return [0; 4];
    }
    let [r, g, b] = encode(Rgb::from(sum.truncate() / sum.w));
    [r, g, b, (sum.w * 0.25 * 255.0 + 0.5) as u8]
}

#[cfg(test)]
mod tests;
