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
mod tests {
    use super::*;

    /// Black and white squares of one pixel, one scene unit each.
    fn board(side: usize) -> DrapeMap {
        let pixel = |i: usize| if (i % side + i / side).is_multiple_of(2) { [255u8; 4] } else { [0, 0, 0, 255] };
        let pixels = (0..side * side).map(pixel).collect();
        let a = [1.0, 0.0, 0.0, 0.0, -1.0, side as f64];
        DrapeMap::new(&Drape { pixels, width: side, height: side, pixel_from_scene: a }).unwrap()
    }

    #[test]
    fn a_checkerboard_seen_at_a_grazing_angle_is_its_mean() {
        let board = board(256);
        for (width, length) in [(2.0, 2.0), (2.0, 9.0), (2.5, 24.0), (4.0, 90.0), (2.0, 48.0)] {
            for i in 0..60 {
                let along = DVec2::from_angle(f64::from(i) * 0.37);
                let print = Footprint::new([along * length, along.perp() * width], width);
                let (c, a) = board.at(DVec2::new(128.0 + 0.31 * f64::from(i % 9), 120.0 + 0.17 * f64::from(i)), &print);
                assert!((c - Rgb::splat(0.5)).abs().max_element() < 0.02 && a == 1.0, "{width} x {length}, {i}: {c}");
            }
        }
        // Up close it is sharp.
        let print = Footprint::new([DVec2::X * 0.1, DVec2::Y * 0.1], 0.1);
        assert!(
            board.at(DVec2::new(100.5, 155.5), &print).0.x < 0.01
                || board.at(DVec2::new(101.5, 155.5), &print).0.x < 0.01
        );
        assert!(board.at(DVec2::new(-40.0, 10.0), &print).1 == 0.0, "nothing outside");
    }

    #[test]
    fn stripes_along_the_line_of_sight_stay_sharp_at_a_grazing_angle() {
        let side = 128;
        let pixel = |i: usize| if (i % side / 4).is_multiple_of(2) { [255u8; 4] } else { [0, 0, 0, 255] };
        let a = [1.0, 0.0, 0.0, 0.0, -1.0, side as f64];
        let pixels = (0..side * side).map(pixel).collect();
        let stripes = DrapeMap::new(&Drape { pixels, width: side, height: side, pixel_from_scene: a }).unwrap();
        let print = Footprint::new([DVec2::X * 1.0, DVec2::Y * 14.0], 1.0);
        let at = |x: f64| stripes.at(DVec2::new(x, 64.0), &print).0.x;
        assert!(at(66.0) > 0.95 && at(70.0) < 0.05, "{} {}", at(66.0), at(70.0));
    }
}
