//! First hits of curved rays on the surfaces themselves, without subdivision: the judge of what is seen where.

mod beam;
mod curve;
mod meshes;
mod root;
mod row;
mod same_surface;
mod tracer;

pub use beam::RowRays;
pub use curve::{Curve, Span, Split};
pub use row::Row;
pub use same_surface::same_surface;
pub use tracer::{Part, RayHit, Tracer, deepest};
