//! What a renderer tells of the surfaces it has drawn.

use crate::depths::Depths;
use belvedere_core::{Aabb, DVec2, DVec3, EdgeError};
use belvedere_sight::screen::Screen;

/// One drawing of the scene: where it places points. Views draw each image of every point once, by one pass per record of their rays
/// and, where the records leave something out, by one per segment; most views need one pass.
pub trait Pass: std::fmt::Debug + Sync {
    /// Displaced position of a point, scene units; `None` where it has no image.
    fn displace(&self, p: DVec3) -> Option<DVec3>;
    /// Signed distances that must be positive for the point to belong to this pass; infinite in a pass that draws everything.
    fn margins(&self, p: DVec3) -> [f64; 2];
    /// Bound on the distance of the displaced edge from the straight line between its displaced ends, see
    /// [`belvedere_core::View::edge_error`].
    fn edge_error(&self, a: DVec3, b: DVec3) -> EdgeError;
    /// Whether nothing is displaced.
    fn is_straight(&self) -> bool;
    /// Whether the records leave out part of a box that this pass, of a segment, may show.
    fn fills_in(&self, screen: &Screen, bounds: &Aabb) -> bool;
}

/// Rays through the surfaces themselves. Few pictures need all of them, so they are best prepared on first use.
pub trait Sight: Sync {
    /// Depth of the first surface on the ray of a pixel, scene units, infinite where the ray meets none; `None` where rays would take too
    /// much memory, and depths alone decide what is hidden.
    fn first_depth(&self, pixel: DVec2) -> Option<f64>;
}

/// Surfaces of a picture, drawn.
#[derive(Clone, Copy)]
pub struct Drawn<'a> {
    /// All passes of the view, the first ones of its records.
    pub passes: &'a [&'a dyn Pass],
    /// The pinhole of the picture.
    pub screen: &'a Screen,
    /// Largest error of a bent line by straight pieces, pixels.
    pub tolerance_px: f64,
    /// Depths of the surfaces at the pixel centres.
    pub depth: Depths<'a>,
    /// Rays of the picture.
    pub sight: &'a dyn Sight,
}

impl std::fmt::Debug for Drawn<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Drawn")
            .field("passes", &self.passes.len())
            .field("screen", &self.screen)
            .finish_non_exhaustive()
    }
}
