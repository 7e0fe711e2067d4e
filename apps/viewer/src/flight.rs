//! What the model knows of a flight of the camera.

use belvedere::core::DVec3;
use belvedere::scene_file::CameraDoc;
use belvedere_studio::Flight;

/// A flight under way.
pub(crate) struct Flying {
    pub(crate) flight: Flight,
    /// Time of its first step; `None` before it.
    pub(crate) began: Option<f64>,
    /// The camera as it is written at the end, where it is that of a bookmark.
    pub(crate) end: Option<Box<CameraDoc>>,
}

/// A ring around what was found.
pub(crate) struct Ring {
    pub(crate) point: DVec3,
    /// Time at which it was first drawn; `None` before.
    pub(crate) began: Option<f64>,
}
