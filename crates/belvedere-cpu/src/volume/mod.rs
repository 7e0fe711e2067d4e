//! Volume rendering: straight or bent rays are followed through the voxels from the eye to the first surface, and the light that they
//! gather is composited over it.
//!
//! 1. [`ray`]: within the [`spans`] of the picture that may show the volume, the ray of a pixel becomes segments inside the box of the
//!    volume, cubics by arc length: [`clip`] computes them ([`arc`] the bent ones), [`sheaf`] interpolates them between such rays.
//! 2. [`march`]: samples at equal distances along them, front to back, of many rays side by side ([`packet`]); [`bricks`] tell where
//!    nothing can be seen, [`table`] gives colour and opacity, [`sampler`] interpolates many samples at once.
//! 3. [`compose`]: over the surfaces by depth, and into depth, id and place where more than half of the light is absorbed; [`smooth`]
//!    follows more rays at the [`edges`].
//!
//! [`reference`] does the same in 64 bits, one sample after the other: the exact renderer uses it, and the fast method is tested against it.
//! Source: Cui et al. 2010, section on volumes; equal steps, opacity by length and skipping are ours or common.

mod arc;
mod bricks;
mod clip;
mod compose;
mod cubic;
mod cursor;
mod edges;
mod gather;
mod light;
mod march;
mod packet;
mod pick;
mod prepared;
mod ray;
mod reference;
mod sampler;
mod sheaf;
mod smooth;
mod spans;
mod table;
#[cfg(test)]
mod tests;

pub(crate) use compose::compose;
pub(crate) use gather::Way;
pub use pick::VolumeTracer;

use belvedere_core::{DVec2, DVec3};
use glam::Vec3A;

/// Absorbed share of light at which a ray ends.
const ENOUGH: f32 = 0.99;
/// Absorbed share of light at which a pixel shows the volume rather than the surface behind.
const HALF: f32 = 0.5;

/// Light that a ray gathers in a volume.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Gathered {
    /// Linear light, weighted by its share.
    pub(crate) color: Vec3A,
    /// Absorbed share of light, 0..=1.
    pub(crate) alpha: f32,
    /// Depth at which the ray enters, scene units.
    pub(crate) enters: f64,
    /// Depth and world point where half of the light is absorbed.
    pub(crate) half: Option<(f64, DVec3)>,
    /// Samples taken.
    pub(crate) samples: u32,
}

impl Gathered {
    /// Its light over that of what lies behind.
    pub(crate) fn over(&self, behind: Vec3A) -> Vec3A {
        self.color + behind * (1.0 - self.alpha)
    }
}

/// Place of the samples of a pixel's ray within their steps, 0..=1: scattered from pixel to pixel, since samples in the middles of all steps
/// draw contours of their own on surfaces that are steeper than a step. Source: Jimenez 2014, interleaved gradient noise.
fn place_in_step(pixel: DVec2) -> f64 {
    let at = pixel.floor();
    let noise = (52.982_918_9 * (0.067_110_56 * at.x + 0.005_837_15 * at.y).fract()).fract();
    // The three rays of a pixel at an edge share the step among them.
    let thirds = (3.0 * (pixel - at)).floor();
    (noise + 0.5 + (thirds.x + thirds.y - 2.0) / 3.0).rem_euclid(1.0)
}

/// Share of a step, 0..=1, after which half of the light is left; light decays exponentially along the step.
///
/// * `before`: light left where the step begins, above a half. `alpha`: what the step absorbs, 0..=1.
fn half_within(before: f32, alpha: f32) -> f64 {
    (f64::from(HALF / before).ln() / (-f64::from(alpha)).ln_1p()).clamp(0.0, 1.0)
}
