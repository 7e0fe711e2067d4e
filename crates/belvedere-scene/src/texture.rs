//! Pictures on meshes.

use crate::Color;
use glam::Vec2;
use std::sync::Arc;

/// Continuation of a picture beyond its edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The picture is repeated.
    #[default]
    Repeat,
    /// The pixels at its edge are continued.
    Clamp,
    /// The picture is mirrored.
    Mirror,
}

/// A picture that is laid on triangles, with a mip pyramid.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    levels: Vec<Level>,
    wrap: [Wrap; 2],
}

/// A picture half as large as the one before.
#[derive(Debug, Clone, PartialEq)]
struct Level {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 4]>,
}

/// Pictures, and their positions on the triangles of a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Texturing {
    /// Pictures.
    pub textures: Vec<Arc<Texture>>,
    /// Number of the picture of each triangle; [`Texturing::NONE`] = none.
    pub of_triangle: Vec<u32>,
    /// Position in the picture of each corner of each triangle: (0, 0) is its top left corner, (1, 1) its bottom right.
    pub corners: Vec<[Vec2; 3]>,
}

impl Texturing {
    /// The number of no picture.
    pub const NONE: u32 = u32::MAX;

    /// The picture of a triangle and its corners there.
    pub(crate) fn of(&self, triangle: usize) -> Option<(&Texture, &[Vec2; 3])> {
        let texture = self.textures.get(*self.of_triangle.get(triangle)? as usize)?;
        Some((texture, self.corners.get(triangle)?))
    }
}

impl Texture {
    /// A picture of `width` x `height` pixels, row 0 at the top, sRGB with straight alpha; `None` if it is empty or the numbers do not fit.
    pub fn new(width: usize, height: usize, pixels: Vec<[u8; 4]>, wrap: [Wrap; 2]) -> Option<Self> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(pixels.len()) {
            return None;
        }
        let mut levels = vec![Level { width, height, pixels }];
        while let Some(coarser) = levels.last().and_then(Level::halved) {
            levels.push(coarser);
        }
        Some(Self { levels, wrap })
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.levels[0].width, self.levels[0].height]
    }

    /// Colour at `place`, (0, 0) top left to (1, 1), of a square of `pixels` pixels along its side: nearest mip level, bilinear.
    pub fn at(&self, place: Vec2, pixels: f32) -> Color {
        let wanted = pixels.max(1.0).log2().round() as usize;
        let level = &self.levels[wanted.min(self.levels.len() - 1)];
        let x = place.x * level.width as f32 - 0.5;
        let y = place.y * level.height as f32 - 0.5;
        if !(x.is_finite() && y.is_finite()) {
            let [r, g, b, a] = level.pixels[0];
            return Color { r, g, b, a };
        }
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let column = |k: i64| wrapped((x.floor() as i64).saturating_add(k), level.width, self.wrap[0]);
        let row = |k: i64| wrapped((y.floor() as i64).saturating_add(k), level.height, self.wrap[1]);
        let pixel = |i: i64, k: i64| level.pixels[row(k) * level.width + column(i)].map(f32::from);
        let [p, q, r, s] = [pixel(0, 0), pixel(1, 0), pixel(0, 1), pixel(1, 1)];
        let mix = |c: usize| {
            let (top, bottom) = (p[c] + fx * (q[c] - p[c]), r[c] + fx * (s[c] - r[c]));
            (top + fy * (bottom - top)).round() as u8
        };
        Color { r: mix(0), g: mix(1), b: mix(2), a: mix(3) }
    }
}

impl Level {
    /// Means of two by two pixels; `None` of a single one.
    fn halved(&self) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let at = |x: usize, y: usize| self.pixels[y.min(self.height - 1) * self.width + x.min(self.width - 1)];
        let mean = |x: usize, y: usize| {
            let four = [at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)];
            // The mean is that of linear light, whose square roots the codes are, about.
            std::array::from_fn(|c| {
                let sum: u32 = four.iter().map(|p| u32::from(p[c]) * u32::from(p[c])).sum();
                (f64::from(sum) / 4.0).sqrt().round() as u8
            })
        };
        let pixels = (0..width * height).map(|i| mean(i % width, i / width)).collect();
        Some(Self { width, height, pixels })
    }
}

fn wrapped(i: i64, n: usize, wrap: Wrap) -> usize {
    let n = n as i64;
    (match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let k = i.rem_euclid(2 * n);
            if k < n { k } else { 2 * n - 1 - k }
        }
    }) as usize
}

#[cfg(test)]
mod tests;
