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
//! [`reference`] does the same in 64 bits, one sample after the other ([`belvedere_sight::volume`]): the exact renderer uses it, and the fast
//! method is tested against it.
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

use belvedere_core::DVec3;
use glam::Vec3A;

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
