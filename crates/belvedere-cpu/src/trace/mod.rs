//! First hits of curved rays on the surfaces themselves, without subdivision.

pub(crate) mod beam;
mod curve;
mod meshes;
mod root;
mod row;
mod tracer;

pub(crate) use tracer::Part;
pub use tracer::{RayHit, Tracer};
