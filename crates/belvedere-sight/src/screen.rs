//! The pinhole prepared for a frame: view space, pixels, clipping planes.

use belvedere_core::{DVec2, DVec3, Pinhole};

/// Vertices farther than this from the image centre are clipped, so that edge functions fit 64-bit integers.
const GUARD_PX: f64 = 131_072.0;

/// Tolerance of bent edges drawn straight from which on a picture is a coarse one, pixels: one that moves. What only shows at rest is then
/// left out of it.
pub const COARSE_PX: f64 = 1.0;

/// Number of planes of [`Screen::clip_distances`].
pub const PLANES: usize = 6;

/// The pinhole in view space: x right, y down, z forward.
#[derive(Debug, Clone)]
pub struct Screen {
    eye: DVec3,
    right: DVec3,
    down: DVec3,
    forward: DVec3,
    /// Pixels per unit across the axis at depth 1, in parallel projection at any depth.
    pub scale: f64,
    /// Pixel of the image centre, half the size of the image.
    pub center: DVec2,
    /// Whether the projection is parallel.
    pub ortho: bool,
    /// Least depth that is drawn, scene units.
    pub near: f64,
    far: f64,
    /// Width of the image, pixels.
    pub width: i32,
    /// Height of the image, pixels.
    pub height: i32,
}

impl Screen {
    /// Prepares a pinhole.
    pub fn new(p: &Pinhole) -> Self {
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
    pub fn view_from(&self, p_displaced: DVec3) -> DVec3 {
        let v = p_displaced - self.eye;
        DVec3::new(v.dot(self.right), v.dot(self.down), v.dot(self.forward))
    }

    /// Pixel of a view-space point with z > 0.
    #[inline]
    pub fn pixel(&self, v: DVec3) -> DVec2 {
        let s = if self.ortho { self.scale } else { self.scale / v.z };
        DVec2::new(self.center.x + v.x * s, self.center.y + v.y * s)
    }

    /// Distance between the points that two neighbouring pixels see at the distance of a point from the eye, scene units.
    pub fn pixel_size(&self, p: DVec3) -> f64 {
        if self.ortho { 1.0 / self.scale } else { p.distance(self.eye) / self.scale }
    }

    /// Depth of a nearness (1 / depth, in parallel projection -depth).
    #[inline]
    pub fn depth_of(&self, q: f32) -> f32 {
        if self.ortho { -q } else { 1.0 / q }
    }

    /// Whether the point can be drawn without clipping.
    #[inline]
    pub fn is_drawable(&self, v: DVec3) -> bool {
        let reach = GUARD_PX / self.scale * if self.ortho { 1.0 } else { v.z };
        // Without short-circuits, so that rows of points are tested together.
        (v.z >= self.near) & (v.z <= self.far) & (v.x.abs() <= reach) & (v.y.abs() <= reach)
    }

    /// Signed distances to near, far and the four guard planes; inside = all >= 0.
    #[inline]
    pub fn clip_distances(&self, v: DVec3) -> [f64; PLANES] {
        let reach = GUARD_PX / self.scale * if self.ortho { 1.0 } else { v.z };
        let far = if self.far.is_finite() { self.far - v.z } else { 1.0 };
        [v.z - self.near, far, reach - v.x, reach + v.x, reach - v.y, reach + v.y]
    }

    /// Bit set of the image borders (and near, far) beyond which the point lies by more than `margin_px`.
    /// A polygon whose points share a bit is not visible.
    #[inline]
    pub fn outcode(&self, v: DVec3, margin_px: f64) -> u8 {
        let z = if self.ortho { 1.0 } else { v.z };
        let (w, h) = ((self.center.x + margin_px) / self.scale * z, (self.center.y + margin_px) / self.scale * z);
        let tests = [v.z < self.near, v.z > self.far, v.x > w, v.x < -w, v.y > h, v.y < -h];
        tests.iter().enumerate().fold(0, |code, (i, &out)| code | (u8::from(out) << i))
    }

    /// [`Screen::outcode`] of a ball around the point: bit set of the image borders beyond which all of it lies.
    #[inline]
    pub fn outcode_around(&self, v: DVec3, radius: f64) -> u8 {
        let slope = if self.ortho { DVec2::ZERO } else { self.center / self.scale };
        let at = if self.ortho { self.center / self.scale } else { slope * v.z };
        let (x, y) = (radius * slope.x.hypot(1.0), radius * slope.y.hypot(1.0));
        let planes = [self.near - v.z - radius, v.z - self.far - radius];
        let sides = [v.x - at.x - x, -v.x - at.x - x, v.y - at.y - y, -v.y - at.y - y];
        planes.into_iter().chain(sides).enumerate().fold(0, |code, (i, off)| code | (u8::from(off > 0.0) << i))
    }

    /// Pixels that a move of one scene unit at depth 1, to any side, changes the image by, at the corners of the picture.
    pub fn scale_at_rim(&self) -> f64 {
        if self.ortho { self.scale } else { self.scale.hypot(self.center.length()) }
    }

    /// Bound on the pixels that an edge fills, in whatever direction from the eye.
    ///
    /// * `length`: of the edge, scene units; `distance`: of the nearer of its ends from the eye.
    pub fn length_px(&self, length: f64, distance: f64) -> f64 {
        let per_unit = if self.ortho { self.scale } else { self.scale / (distance - 0.5 * length).max(self.near) };
        length * per_unit
    }

    /// Scene units across one pixel at `depth`.
    #[inline]
    pub fn footprint(&self, depth: f64) -> f64 {
        if self.ortho { 1.0 / self.scale } else { depth / self.scale }
    }
}
