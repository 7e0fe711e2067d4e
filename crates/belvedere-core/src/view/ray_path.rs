//! The curved ray of a pixel.

use super::View;
use crate::map::curved_rays::{RayPiece, Shape};
use crate::{Miss, Stage};
use glam::{DVec2, DVec3};

/// The set of world points that a pixel may see, ordered by depth: a curve once stages bend space.
#[derive(Debug, Clone, Copy)]
pub struct RayPath<'a> {
    view: &'a View,
    pixel: DVec2,
}

/// A point of a [`RayPath`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayPoint {
    /// World point, scene coordinates.
    pub point: DVec3,
    /// Depth at which the pixel sees it, scene units.
    pub depth: f64,
    /// Segment of the ray, see [`crate::Displaced::segment`].
    pub segment: u32,
}

impl<'a> RayPath<'a> {
    pub(super) fn new(view: &'a View, pixel: DVec2) -> Self {
        Self { view, pixel }
    }

    /// Pixel whose ray this is.
    pub fn pixel(&self) -> DVec2 {
        self.pixel
    }

    /// World point seen at `depth` (> 0, scene units).
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] where the chain of stages has no inverse, e.g. past a spline's fold limit;
    /// [`Miss::BehindEye`] unless `depth` > 0.
    pub fn at(&self, depth: f64) -> Result<RayPoint, Miss> {
        if !(depth > 0.0) {
            return Err(Miss::BehindEye);
        }
        let p_displaced = self.view.pinhole().unproject(self.pixel, depth);
        if !p_displaced.is_finite() {
            return Err(Miss::OutsideDomain);
        }
        let (point, segment) = self.view.undisplace(p_displaced)?;
        if point.is_finite() { Ok(RayPoint { point, depth, segment }) } else { Err(Miss::OutsideDomain) }
    }

    /// `n` points equidistant in depth from `near` to `far` (the first alone if `n` is 1).
    pub fn samples(&self, near: f64, far: f64, n: usize) -> impl Iterator<Item = Result<RayPoint, Miss>> + '_ {
        let step = if n > 1 { (far - near) / (n - 1) as f64 } else { 0.0 };
        (0..n).map(move |i| self.at(if i + 1 == n && n > 1 { far } else { near + step * i as f64 }))
    }

    /// The ray as straight and bent pieces, from the eye to infinity, as the curved rays bend it; one straight piece without them.
    ///
    /// With other stages these are the pieces in the space that those stages lead to; without, they lie in the world.
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] if the pixel lies so far outside the image that its ray does not pass all turns.
    pub fn pieces(&self) -> Result<Vec<RayPiece>, Miss> {
        let pinhole = self.view.pinhole();
        let (from, per_depth) = pinhole.line(self.pixel);
        if !(from.is_finite() && per_depth.is_finite()) {
            return Err(Miss::OutsideDomain);
        }
        match self.view.stages().last() {
            Some(Stage::CurvedRays(rays)) => return rays.pieces(per_depth),
            Some(Stage::SplitRays(rays)) => return rays.branch_of(from + per_depth).rays.pieces(per_depth),
            _ => {}
        }
        Ok(vec![RayPiece { segment: 0, depth: [0.0, f64::INFINITY], shape: Shape::Line { from, per_depth } }])
    }

    /// Arc length of the ray in the world from depth 0 to `depth`, scene units: exact pieces where curved rays are the only stage,
    /// else by quadrature to about 1e-6 of itself.
    ///
    /// # Errors
    /// [`Miss::BehindEye`] unless `depth` > 0; [`Miss::OutsideDomain`] where the ray has no world point up to that depth.
    pub fn path_length(&self, depth: f64) -> Result<f64, Miss> {
        self.at(depth)?;
        let bent_before = self.view.stages().iter().any(|s| !s.bends_rays());
        if bent_before {
            return self.length_by_chords(depth);
        }
        let pieces = self.pieces()?;
        let length = pieces.iter().filter(|p| p.depth[0] < depth).map(|p| p.length_to(depth)).sum::<f64>();
        if length.is_finite() { Ok(length) } else { Err(Miss::OutsideDomain) }
    }

    /// Speed by central differences of the inverse chain, integrated piece by piece.
    fn length_by_chords(&self, depth: f64) -> Result<f64, Miss> {
        let step = 1e-5 * depth;
        let speed = |d: f64| {
            let d = d.max(2.0 * step);
            match (self.at(d + step), self.at(d - step)) {
                (Ok(ahead), Ok(behind)) => (ahead.point - behind.point).length() / (2.0 * step),
                _ => f64::NAN,
            }
        };
        let panels = 64;
        let width = depth / f64::from(panels);
        let length: f64 = (0..panels).map(|i| boole(&speed, width * f64::from(i), width * f64::from(i + 1))).sum();
        if length.is_finite() { Ok(length) } else { Err(Miss::OutsideDomain) }
    }
}

/// Boole's rule.
fn boole(speed: &dyn Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let at = |t: f64| speed(from + t * (to - from));
    let [f0, f1, f2, f3, f4] = [0.0, 0.25, 0.5, 0.75, 1.0].map(at);
    (to - from) * (7.0 * (f0 + f4) + 32.0 * (f1 + f3) + 12.0 * f2) / 90.0
}
