//! Options of the search for a view and a bend.

/// Goals and limits of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RevealOptions {
    /// Picture size, pixels; used when no view is given.
    pub image: [u32; 2],
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
            fov_y: 45f64.to_radians(),
            earth_radius: None,
            goal_share: 0.75,
            goal_gain: 1.5,
            samples_per_try: 220,
        }
    }
}
