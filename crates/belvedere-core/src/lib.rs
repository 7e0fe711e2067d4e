//! The mathematics of bent pictures: an image is a pinhole photograph of a gently displaced world.
//!
//! A [`View`] is a [`Pinhole`] behind a chain of displacements ([`Stage`]s). Each stage is a
//! [`SpaceMap`]: it moves every point of space, smoothly and invertibly, so that what would be
//! hidden is not. Projection, rays, pictures, picking and measures are all written once, against
//! the chain.
//!
//! Everything is `f64`, in scene coordinates (right-handed, Z up, X east, Y north, metres unless
//! the scene says otherwise). Pixels have their origin at the outer corner of the top-left pixel.

pub mod bounds;
pub mod bspline;
pub mod camera;
pub mod conic;
pub mod deformation;
pub mod grid;
pub mod map;
mod miss;
pub mod plain;
pub mod polygon;
pub mod presets;
pub mod quantile;
pub mod random;
pub mod sections;
pub mod view;
mod warning;

pub use bounds::Aabb;
pub use camera::{ImageBox, Navigation, Pinhole, PinholeBuilder, PinholeError, Projection};
pub use glam::{DMat3, DQuat, DVec2, DVec3};
pub use map::curved_rays::{CurvedRays, CurvedRaysError};
pub use map::earth::EarthCurvature;
pub use map::ground_moves::GroundMoves;
pub use map::rigid::RigidMotion;
pub use map::spline::SplineBend;
pub use map::split_rays::SplitRays;
pub use map::straighten::{Strip, Tube};
pub use map::terrain::TerrainDisocclusion;
pub use map::{Displaced, SpaceMap, Stage};
pub use miss::Miss;
pub use view::{EdgeError, EdgePoint, Edges, Projected, RayPath, RayPoint, View, ViewError};
pub use warning::{Warning, WarningKind};
