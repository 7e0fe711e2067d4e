//! Errors of measures and constructors.

use belvedere_core::{PinholeError, ViewError};
use belvedere_scene::{Cancelled, RenderError};

/// A measure or a constructor that could not do its work. A goal not reached is a result, not an error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConstructError {
    /// Cancelled through [`belvedere_scene::Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The renderer failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The renderer answered with buffers of another size.
    #[error("renderer {renderer} returned {got} depth values for a picture of {expected} pixels; use another renderer")]
    FrameSize {
        /// Name of the renderer.
        renderer: &'static str,
        /// Values returned.
        got: usize,
        /// Pixels of the picture.
        expected: usize,
    },
    /// No layer of the scene must be seen.
    #[error("none of the {layers} layers has must_see = true; mark the features that the picture is made for")]
    NothingToSee {
        /// Layers of the scene.
        layers: usize,
    },
    /// The layers that must be seen hold no usable point.
    #[error("the layers to be seen ({layers}) hold no point on the terrain; check their coordinates and CRS")]
    NoSamples {
        /// Ids of the layers.
        layers: String,
    },
    /// The scene has no terrain.
    #[error("the scene has no terrain layer; reveal needs one")]
    NoTerrain,
    /// The eye is under ground.
    #[error("the eye lies {below_m:.1} m under ground; raise it by at least {raise_m:.1} m")]
    EyeUnderGround {
        /// Depth under ground, metres.
        below_m: f64,
        /// Smallest useful raise, metres.
        raise_m: f64,
    },
    /// The features are not in the picture.
    #[error(
        "{in_frame_share:.0} % of the features lie in the picture, at least {needed:.0} % needed; turn the camera towards them or give no view"
    )]
    OutOfFrame {
        /// Percentage in the picture.
        in_frame_share: f64,
        /// Percentage needed.
        needed: f64,
    },
    /// No usable eye was found.
    #[error("none of {tried} eyes around the features gives a usable picture; give a view (eye and look_at)")]
    NoView {
        /// Eyes tried.
        tried: usize,
    },
    /// No eye around a target in a city stands free.
    #[error("no eye around the target is free of buildings; give eye and look")]
    NoRoom,
    /// A pinhole could not be made.
    #[error(transparent)]
    Pinhole(#[from] PinholeError),
    /// Stages could not be chained.
    #[error(transparent)]
    View(#[from] ViewError),
    /// Curved rays that are not possible.
    #[error(transparent)]
    Rays(#[from] belvedere_core::map::curved_rays::CurvedRaysError),
    /// A parameter of a constructor out of its range.
    #[error("{name} is {value}, it must {must}")]
    Parameter {
        /// Name, as scene files write it.
        name: &'static str,
        /// The value.
        value: f64,
        /// Condition that it must meet.
        must: &'static str,
    },
    /// A point of a centreline is not in the voxels that it may use.
    #[error(
        "{name} = [{}, {}, {}] has {}, and no voxel of {} to {} lies within {reach} of it; move the point or change values",
        point[0], point[1], point[2],
        value.map_or_else(|| "no value, it lies outside the volume".to_owned(), |v| format!("the value {v}")),
        values[0], values[1]
    )]
    PointOutside {
        /// Name of the point.
        name: &'static str,
        /// The point, scene coordinates.
        point: [f64; 3],
        /// Value there.
        value: Option<f64>,
        /// Range of values.
        values: [f64; 2],
        /// Radius of the search around the point, scene units.
        reach: f64,
    },
    /// The two points of a centreline are in voxels that are not connected.
    #[error(
        "the points are not connected by voxels of {} to {}: the {voxels} voxels that hang together with `from` come within {distance:.1} of `to`, at [{:.1}, {:.1}, {:.1}]; widen values or move a point",
        values[0], values[1], nearest[0], nearest[1], nearest[2]
    )]
    NotConnected {
        /// Range of values.
        values: [f64; 2],
        /// Voxels connected with the first point.
        voxels: usize,
        /// Distance of the nearest of them from the second point, scene units.
        distance: f64,
        /// That voxel, scene coordinates.
        nearest: [f64; 3],
    },
    /// The connected voxels fill too large a box.
    #[error("the voxels around `from` fill a box of {voxels} voxels, at most {most} are searched; narrow values")]
    TooManyVoxels {
        /// Voxels of the box.
        voxels: usize,
        /// Most that are possible.
        most: usize,
    },
    /// A path has no point in the volume whose wall is to be found.
    #[error("the path has no point inside the volume; lead it through the vessel, or name another transfer function")]
    PathOutside,
    /// The values along a path do not differ from those around it.
    #[error(
        "no wall lies around the path: it runs through values of {lumen:.1} with a spread of {spread:.1}, and {share_percent:.0} % of the lines across it meet a clear edge, at least 25 % needed; lead it through the vessel, or name another transfer function"
    )]
    NoWall {
        /// Median value along the path.
        lumen: f64,
        /// Spread of the values along the path.
        spread: f64,
        /// Percentage of lines that meet an edge.
        share_percent: f64,
    },
    /// A spline could not be resolved.
    #[error(transparent)]
    Spline(#[from] belvedere_core::map::spline::SplineError),
}
