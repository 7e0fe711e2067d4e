//! What a renderer tells of the surfaces it has drawn.

use crate::depths::Depths;
use belvedere_core::DVec2;
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::Screen;

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
    pub passes: &'a [&'a Pass<'a>],
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
