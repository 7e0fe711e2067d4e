//! The pinhole prepared for a frame: view space, fixed-point pixels, clipping planes.

use crate::points::Points;
use belvedere_core::{DVec2, DVec3, Pinhole};

/// Fixed-point steps per pixel.
pub(crate) const SUB: i32 = 256;

/// Vertices farther than this from the image centre are clipped, so that edge functions fit 64-bit integers.
const GUARD_PX: f64 = 131_072.0;

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

/// Number of planes of [`Screen::clip_distances`].
pub(crate) const PLANES: usize = 6;

/// Images of a row of nodes: fixed-point pixels and nearness, slices of equal length.
#[derive(Debug)]
pub(crate) struct Row<'r> {
    pub(crate) x: &'r mut [i32],
    pub(crate) y: &'r mut [i32],
    pub(crate) q: &'r mut [f32],
}

/// The pinhole in view space: x right, y down, z forward.
#[derive(Debug, Clone)]
pub(crate) struct Screen {
    eye: DVec3,
    right: DVec3,
    down: DVec3,
    forward: DVec3,
    pub(crate) scale: f64,
    pub(crate) center: DVec2,
    pub(crate) ortho: bool,
    pub(crate) near: f64,
    far: f64,
    pub(crate) width: i32,
    pub(crate) height: i32,
}

impl Screen {
    pub(crate) fn new(p: &Pinhole) -> Self {
        Self {
            eye: p.eye,
            right: p.right,
            down: p.down,
            forward: p.forward,
            scale: p.scale_px(),
            center: p.center_px(),
            ortho: p.is_orthographic(),
            near: p.near,
            far: p.far.unwrap_or(f64::INFINITY),
            width: p.image[0] as i32,
            height: p.image[1] as i32,
        }
    }

    /// Displaced point to view space.
    #[inline]
    pub(crate) fn view_from(&self, p_displaced: DVec3) -> DVec3 {
        let v = p_displaced - self.eye;
        DVec3::new(v.dot(self.right), v.dot(self.down), v.dot(self.forward))
    }

    /// Pixel of a view-space point with z > 0.
    #[inline]
    pub(crate) fn pixel(&self, v: DVec3) -> DVec2 {
        let s = if self.ortho { self.scale } else { self.scale / v.z };
        DVec2::new(self.center.x + v.x * s, self.center.y + v.y * s)
    }

    #[inline]
    pub(crate) fn depth_of(&self, q: f32) -> f32 {
        if self.ortho { -q } else { 1.0 / q }
    }

    /// Image of a view-space point that passed all clipping planes.
    #[inline]
    pub(crate) fn snap(&self, v: DVec3) -> ScreenVertex {
        let (s, q) = if self.ortho { (self.scale, -v.z) } else { (self.scale / v.z, 1.0 / v.z) };
        ScreenVertex { x: fixed(self.center.x + v.x * s), y: fixed(self.center.y + v.y * s), q: q as f32 }
    }

    /// Images of displaced points; `false` if one of them needs clipping.
    pub(crate) fn snap_row(&self, p: &Points<'_>, out: &mut Row<'_>) -> bool {
        let mut whole = true;
        for i in 0..p.x.len() {
            let v = self.view_from(DVec3::new(p.x[i], p.y[i], p.z[i]));
            whole &= self.is_drawable(v);
            let image = self.snap(v);
            (out.x[i], out.y[i], out.q[i]) = (image.x, image.y, image.q);
        }
        whole
    }

    /// Whether the point can be snapped without clipping.
    #[inline]
    pub(crate) fn is_drawable(&self, v: DVec3) -> bool {
        let reach = GUARD_PX / self.scale * if self.ortho { 1.0 } else { v.z };
        // Without short-circuits, so that rows of points are tested together.
        (v.z >= self.near) & (v.z <= self.far) & (v.x.abs() <= reach) & (v.y.abs() <= reach)
    }

    /// Signed distances to near, far and the four guard planes; inside = all >= 0.
    pub(crate) fn clip_distances(&self, v: DVec3) -> [f64; PLANES] {
        let reach = GUARD_PX / self.scale * if self.ortho { 1.0 } else { v.z };
        let far = if self.far.is_finite() { self.far - v.z } else { 1.0 };
        [v.z - self.near, far, reach - v.x, reach + v.x, reach - v.y, reach + v.y]
    }

    /// Bit set of the image borders (and near, far) beyond which the point lies by more than `margin_px`.
    /// A polygon whose points share a bit is not visible.
    pub(crate) fn outcode(&self, v: DVec3, margin_px: f64) -> u8 {
        let z = if self.ortho { 1.0 } else { v.z };
        let (w, h) = ((self.center.x + margin_px) / self.scale * z, (self.center.y + margin_px) / self.scale * z);
        let tests = [v.z < self.near, v.z > self.far, v.x > w, v.x < -w, v.y > h, v.y < -h];
        tests.iter().enumerate().fold(0, |code, (i, &out)| code | (u8::from(out) << i))
    }

    /// Scene units across one pixel at `depth`.
    pub(crate) fn footprint(&self, depth: f64) -> f64 {
        if self.ortho { 1.0 / self.scale } else { depth / self.scale }
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
