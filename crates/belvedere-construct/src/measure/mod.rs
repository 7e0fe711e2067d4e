//! What a picture shows: visible share of every feature of interest, straight and bent, by two independent methods;
//! and how much the bend displaces, distorts and folds.

pub(crate) mod bend;
mod buffer;
mod report;

pub use bend::BendMeasure;
pub use report::{Clearance, FeatureMeasure, Measures, MethodShare, Visibility};

use crate::ConstructError;
use crate::samples::{Sample, SampledFeature, default_spacing, sample_features};
use belvedere_core::{Camera, DVec2, DVec3, View};
use belvedere_scene::{Light, Progress, Renderer, Scene};
use belvedere_sight::{Obstacles, SightOptions};
use rayon::prelude::*;

/// How to measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasureOptions {
    /// Largest distance between samples of a line, scene units; `None` = half the grid spacing of the terrain.
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

/// Where a view shows one sample, and whether.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Judged {
    pub(crate) pixel: DVec2,
    pub(crate) depth: f64,
    pub(crate) in_frame: bool,
    pub(crate) folded: bool,
    /// The sample after all stages, scene coordinates.
    pub(crate) displaced: Option<DVec3>,
    /// By line of sight; `None` outside the frame.
    pub(crate) clearance: Option<f64>,
    /// By the depth buffer; `None` outside the frame or without a renderer.
    pub(crate) in_buffer: Option<buffer::Buffered>,
}

impl Judged {
    pub(crate) const UNSEEN: Self = Self {
        pixel: DVec2::ZERO,
        depth: 0.0,
        in_frame: false,
        folded: false,
        displaced: None,
        clearance: None,
        in_buffer: None,
    };

    /// Seen by line of sight.
    pub(crate) fn visible(&self) -> bool {
        self.clearance.is_some_and(|c| c >= 0.0)
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
    if scene.must_see().next().is_none() {
        return Err(ConstructError::NothingToSee { layers: scene.layers.len() });
    }
    let features = sample_features(scene, options.spacing_m.unwrap_or_else(|| default_spacing(scene)).max(1e-6));
    let obstacles = Obstacles::new(scene);
    let sight = sight_options(scene, options);
    let straight_view = view.straightened();
    progress.tick("lines of sight, straight", 0.0)?;
    let mut straight = judge_all(&obstacles, &straight_view, &features, &sight);
    progress.tick("lines of sight, bent", 0.2)?;
    let mut bent = if view.is_bent() { judge_all(&obstacles, view, &features, &sight) } else { straight.clone() };
    if let Some(renderer) = renderer {
        progress.tick("pictures for the depth test", 0.6)?;
        let light = Light::default();
        let job = buffer::Job { scene, renderer, light: &light, scale: options.buffer_scale, progress };
        job.judge(&straight_view, &features, &mut straight)?;
        if view.is_bent() {
            job.judge(view, &features, &mut bent)?;
        } else {
            bent.clone_from(&straight);
        }
    }
    progress.tick("distortion and folds", 0.9)?;
    let bend = bend::measure_bend(&obstacles, scene, view, &straight_view, &features);
    let warnings = warnings(&obstacles, view, &features);
    Ok(report::summarise(&features, &straight, &bent, options.near_miss_m, bend, warnings))
}

pub(crate) fn sight_options(scene: &Scene, options: &MeasureOptions) -> SightOptions {
    let cell = scene.terrain().map_or(0.0, |hf| hf.spacing().max_element());
    SightOptions { chord_m: options.chord_m, cap_m: options.cap_m, guard_m: options.guard_m.unwrap_or(1.5 * cell) }
}

/// Judges every sample by line of sight, in parallel.
pub(crate) fn judge_all(
    obstacles: &Obstacles<'_>,
    view: &View,
    features: &[SampledFeature],
    sight: &SightOptions,
) -> Vec<Vec<Judged>> {
    features.iter().map(|f| f.samples.par_iter().map(|s| judge(obstacles, view, s, sight)).collect()).collect()
}

pub(crate) fn judge(obstacles: &Obstacles<'_>, view: &View, sample: &Sample, sight: &SightOptions) -> Judged {
    let Ok(image) = view.project(sample.p_world) else { return Judged::UNSEEN };
    let displaced = view.displace(sample.p_world).ok().map(|d| d.point);
    let pinhole = view.pinhole();
    let in_range = image.depth >= pinhole.near && pinhole.far.is_none_or(|far| image.depth <= far);
    let in_frame = in_range && pinhole.contains(image.pixel);
    let clearance = in_frame.then(|| {
        if image.folded {
            // Orientation is reversed there: the picture shows the ground from below.
            -sight.cap_m.max(f64::MIN_POSITIVE)
        } else {
            obstacles.clearance(view, (sample.p_world, sample.lift), (image.pixel, image.depth), sight)
        }
    });
    Judged {
        pixel: image.pixel,
        depth: image.depth,
        in_frame,
        folded: image.folded,
        displaced,
        clearance,
        in_buffer: None,
    }
}

fn warnings(obstacles: &Obstacles<'_>, view: &View, features: &[SampledFeature]) -> Vec<String> {
    let mut out = Vec::new();
    if let Some(height) = obstacles.above_ground(view.pinhole().eye)
        && height < 0.0
    {
        out.push(format!("the eye lies {:.1} m under ground; nothing can be seen from there", -height));
    }
    for f in features.iter().filter(|f| f.samples.is_empty()) {
        out.push(format!("feature {} of layer {} has no point to judge", f.feature, f.layer_id));
    }
    out
}
