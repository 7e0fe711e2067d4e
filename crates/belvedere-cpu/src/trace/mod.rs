//! First hits of curved rays on the surfaces themselves, without subdivision.

pub(crate) mod beam;
pub(crate) mod curve;
mod meshes;
mod root;
mod row;
pub(crate) mod same_surface;
mod tracer;

pub(crate) use tracer::{Part, deepest};
pub use tracer::{RayHit, Tracer};
