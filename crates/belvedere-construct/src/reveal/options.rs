//! Options of the search for a view and a bend.

use belvedere_core::{Pinhole, View};

/// Height of the picture in which views and bends are chosen, pixels, whatever size it is drawn in: pixels never decide where the eye stands.
pub const REFERENCE_HEIGHT_PX: u32 = 720;

/// Goals and limits of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RevealOptions {
    /// Picture size, pixels; used when no view is given.
    pub image: [u32; 2],
    /// Width over height of the picture where its pixels are those of a sheet, and rounded; `None`: as `image` has it.
    pub aspect: Option<f64>,
    /// Widest vertical field of view to try, radians; used when no view is given.
    pub fov_y: f64,
    /// Earth's radius (scene units) if the ground is to fall away with the distance; used when no view is given.
    pub earth_radius: Option<f64>,
    /// Visible share of the whole features to reach, 0..=1.
    pub goal_share: f64,
    /// The bent picture is to show at least this many times the share of the straight one.
    pub goal_gain: f64,
    /// Samples of the features that each candidate is judged by.
    pub samples_per_try: usize,
}

impl Default for RevealOptions {
    fn default() -> Self {
        Self {
            image: [1280, 720],
            aspect: None,
            fov_y: 55f64.to_radians(),
            earth_radius: None,
            goal_share: 0.75,
            goal_gain: 1.5,
            samples_per_try: 220,
        }
    }
}

impl RevealOptions {
    /// Size of the picture in which a view is chosen: of the same shape, [`REFERENCE_HEIGHT_PX`] high.
    pub(super) fn reference(&self) -> [u32; 2] {
        let [width, height] = self.image.map(f64::from);
        reference(self.aspect.unwrap_or(width / height.max(1.0)))
    }
}

/// The reference size of a shape.
fn reference(aspect: f64) -> [u32; 2] {
    let width = (aspect * f64::from(REFERENCE_HEIGHT_PX)).round();
    [width.clamp(1.0, f64::from(u16::MAX)) as u32, REFERENCE_HEIGHT_PX]
}

/// The view in a picture of the reference size.
pub(super) fn at_reference(view: &View) -> View {
    let [width, height] = view.pinhole().image.map(f64::from);
    sized(view, reference(width / height.max(1.0)))
}

/// The view in a picture of another size. No stage of a view that is chosen depends on pixels.
pub(super) fn sized(view: &View, image: [u32; 2]) -> View {
    let pinhole = Pinhole { image, ..view.pinhole().clone() };
    View::new(pinhole, view.stages().to_vec()).unwrap_or_else(|_| view.clone())
}
