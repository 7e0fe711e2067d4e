//! Vertices on the image: fixed-point pixels and nearness.

use belvedere_core::DVec3;
use belvedere_sight::pass::Points;
pub(crate) use belvedere_sight::screen::{PLANES, Screen};

/// Fixed-point steps per pixel.
pub(crate) const SUB: i32 = 256;

/// A vertex on the image: fixed-point pixel and nearness (larger = nearer, linear on the image).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScreenVertex {
    pub(crate) x: i32,
    pub(crate) y: i32,
    /// `1 / depth` in perspective, `-depth` in parallel projection.
    pub(crate) q: f32,
}

impl ScreenVertex {
    /// A vertex without image.
    pub(crate) const NONE: Self = Self { x: i32::MIN, y: i32::MIN, q: 0.0 };

    pub(crate) fn is_none(self) -> bool {
        self.x == i32::MIN
    }
}

/// Images of a row of nodes: fixed-point pixels and nearness, slices of equal length.
#[derive(Debug)]
pub(crate) struct Row<'r> {
    pub(crate) x: &'r mut [i32],
    pub(crate) y: &'r mut [i32],
    pub(crate) q: &'r mut [f32],
}

/// Makes vertices of view-space points.
pub(crate) trait Snap {
    /// Image of a view-space point that passed all clipping planes.
    fn snap(&self, v: DVec3) -> ScreenVertex;
    /// Images of displaced points; `false` if one of them needs clipping.
    fn snap_row(&self, p: &Points<'_>, out: &mut Row<'_>) -> bool;
}

impl Snap for Screen {
    #[inline]
    fn snap(&self, v: DVec3) -> ScreenVertex {
        let (s, q) = if self.ortho { (self.scale, -v.z) } else { (self.scale / v.z, 1.0 / v.z) };
        ScreenVertex { x: fixed(self.center.x + v.x * s), y: fixed(self.center.y + v.y * s), q: q as f32 }
    }

    fn snap_row(&self, p: &Points<'_>, out: &mut Row<'_>) -> bool {
        let mut whole = true;
        for i in 0..p.x.len() {
            let v = self.view_from(DVec3::new(p.x[i], p.y[i], p.z[i]));
            whole &= self.is_drawable(v);
            let image = self.snap(v);
            (out.x[i], out.y[i], out.q[i]) = (image.x, image.y, image.q);
        }
        whole
    }
}

/// Nearest 1/256 pixel. Adding 1.5 * 2^52 leaves the rounded integer in the low bits of the mantissa.
#[inline]
fn fixed(px: f64) -> i32 {
    (px * f64::from(SUB) + 6_755_399_441_055_744.0).to_bits() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_rounds_to_the_nearest_step() {
        for px in [0.0, 0.5, 1.0 / 256.0, -3.25, 1279.998, -131_072.0, 131_071.999] {
            assert_eq!(f64::from(fixed(px)), (px * 256.0f64).round(), "{px}");
        }
    }
}
