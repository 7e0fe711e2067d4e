//! What a picture shows: visible share of every feature of interest, straight and bent, by two independent methods;
//! and how much the bend displaces, distorts and folds.

pub(crate) mod bend;
mod buffer;
mod displaced;
mod hidden;
mod image;
mod path;
mod pinpoint;
mod report;
mod shares;
mod surface;

pub use bend::BendMeasure;
pub use hidden::{HiddenReason, HiddenRun, hidden};
pub use path::length_seen;
pub use report::{Clearance, FeatureMeasure, Measures, MethodShare, Visibility};
pub use shares::{Shares, percent};

use crate::ConstructError;
use crate::sample::SampledFeature;
use crate::samples::{judged_samples, sample_features};
use belvedere_core::View;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Light, Progress, Renderer, Scene};
use belvedere_sight::{Obstacles, SightOptions};
use image::Sight;

/// Options of the measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasureOptions {
    /// Largest distance between samples of a line, scene units; `None` = an eighth of the grid spacing of the terrain, see
    /// [`crate::judged_samples`].
    pub spacing_m: Option<f64>,
    /// Samples whose sight line passes nearer than this to the edge of what hides them are left out of the comparison
    /// of the two methods, scene units.
    pub near_miss_m: f64,
    /// Clearances are followed up to this, scene units.
    pub cap_m: f64,
    /// See [`SightOptions::guard_m`]; `None` = 1.5 grid cells.
    pub guard_m: Option<f64>,
    /// See [`SightOptions::chord_m`].
    pub chord_m: f64,
    /// The picture for the depth test is drawn this many times larger, 1..=8, so that its pixels resolve the ground;
    /// `None` = a quarter of a grid cell per pixel, at most 3 times and 8 million pixels.
    pub buffer_scale: Option<u32>,
}

impl Default for MeasureOptions {
    fn default() -> Self {
        Self { spacing_m: None, near_miss_m: 2.0, cap_m: 50.0, guard_m: None, chord_m: 0.05, buffer_scale: None }
    }
}

/// Measures what `view` shows of the layers that must be seen, and what the same camera shows without its bends.
///
/// Method (a) follows the curved ray of every sample through the undisplaced terrain and boxes. Method (b), if a
/// `renderer` is given, draws both pictures and compares depths; it shares no code with (a) but the samples.
///
/// # Errors
/// [`ConstructError::NothingToSee`], [`ConstructError::Render`], [`ConstructError::FrameSize`], [`ConstructError::Cancelled`].
pub fn measure(
    scene: &Scene,
    view: &View,
    renderer: Option<&dyn Renderer>,
    options: &MeasureOptions,
    progress: &Progress,
) -> Result<Measures, ConstructError> {
    measure_and_hidden(scene, view, renderer, options, progress).map(|(measures, _)| measures)
}

/// As [`measure`], with the parts that `view` hides, as [`hidden`] lists them.
///
/// # Errors
/// Those of [`measure`].
pub fn measure_and_hidden(
    scene: &Scene,
    view: &View,
    renderer: Option<&dyn Renderer>,
    options: &MeasureOptions,
    progress: &Progress,
) -> Result<(Measures, Vec<HiddenRun>), ConstructError> {
    if scene.must_see().next().is_none() {
        return Err(ConstructError::NothingToSee { layers: scene.layers.len() });
    }
    let features = samples(scene, options);
    let options_of_sight = sight_options(scene, options);
    let straight_view = view.straightened();
    let sight = Sight::new(scene, &straight_view);
    progress.tick("lines of sight, straight", 0.0)?;
    let mut straight = image::all(&sight, &straight_view, &features, &options_of_sight);
    progress.tick("lines of sight, bent", 0.2)?;
    let mut bent = if view.is_bent() {
        image::all(&Sight::new(scene, view), view, &features, &options_of_sight)
    } else {
        straight.clone()
    };
    if let Some(renderer) = renderer {
        progress.tick("pictures for the depth test", 0.6)?;
        let light = Light::default();
        let job = buffer::Job { scene, renderer, light: &light, scale: options.buffer_scale, progress };
        job.test(&straight_view, &features, &mut straight)?;
        if view.is_bent() {
            job.test(view, &features, &mut bent)?;
        } else {
            bent.clone_from(&straight);
        }
    }
    progress.tick("distortion and folds", 0.9)?;
    let bend = bend::measure_bend(&sight.obstacles, scene, view, &straight_view, &features);
    let warnings = warnings(&sight.obstacles, view, &features);
    let hidden = hidden::all(&features, &bent);
    let of_layer = |k: usize, amount| features.iter().any(|f| f.layer == k && f.amount == amount);
    let beyond = |amount| {
        let layers = scene.layers.iter().enumerate().filter(|(k, _)| of_layer(*k, amount));
        layers.map(|(_, layer)| layer.kind.beyond()).sum()
    };
    Ok((report::summarise((&features, &beyond), &straight, &bent, options.near_miss_m, bend, warnings), hidden))
}

/// Samples by which shares are judged.
pub(crate) fn samples(scene: &Scene, options: &MeasureOptions) -> Vec<SampledFeature> {
    match options.spacing_m {
        Some(spacing) => sample_features(scene, spacing.max(1e-6)),
        None => judged_samples(scene),
    }
}

pub(crate) fn sight_options(scene: &Scene, options: &MeasureOptions) -> SightOptions {
    let cell = scene.terrain().map_or(0.0, |hf| hf.spacing().max_element());
    SightOptions { chord_m: options.chord_m, cap_m: options.cap_m, guard_m: options.guard_m.unwrap_or(1.5 * cell) }
}

fn warnings(obstacles: &Obstacles<'_>, view: &View, features: &[SampledFeature]) -> Vec<Warning> {
    let mut out = Vec::new();
    if let Some(height) = obstacles.above_ground(view.pinhole().eye)
        && height < 0.0
    {
        let text = format!("the eye lies {:.1} m under ground; nothing can be seen from there", -height);
        out.push(Warning::new(WarningKind::Hidden, text).about("camera").with("depth_m", -height));
    }
    for f in features.iter().filter(|f| f.samples.is_empty()) {
        let text = format!("feature {} of layer {} has no point to judge", f.feature, f.layer_id);
        out.push(Warning::new(WarningKind::Ignored, text).about(f.layer_id.clone()).with("feature", f.feature as f64));
    }
    out
}
