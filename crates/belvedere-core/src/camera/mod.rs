//! Cameras: the pinhole, the view (pinhole behind a chain of stages) and the rays of its pixels.

mod builder;
mod edges;
mod navigate;
mod pinhole;
mod ray_path;
mod rigid;
mod view;

pub use builder::PinholeBuilder;
pub use edges::{EdgePoint, Edges};
pub use navigate::Navigation;
pub use pinhole::{Pinhole, PinholeError, Projection};
pub use ray_path::{RayPath, RayPoint};
pub use view::{ImageBox, View, ViewError};

use glam::DVec2;

/// Image of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projected {
    /// Pixel coordinates: (0, 0) is the outer corner of the top-left pixel, x right, y down. May lie outside the image.
    pub pixel: DVec2,
    /// Forward distance of the displaced point along the optical axis, > 0, scene units.
    pub depth: f64,
    /// Segment of the ray that sees the point, see [`crate::Displaced::segment`].
    pub segment: u32,
    /// Whether a stage folded over at the point.
    pub folded: bool,
}
