//! `measure`: visibility of the required features in a scene's picture.

use crate::{BelvedereError, RendererChoice, Session};
pub use belvedere_construct::MeasureOptions;
use belvedere_construct::Measures;
use belvedere_construct::measure::{FeatureMeasure, Visibility};
use belvedere_core::Warning;
use belvedere_disocclusion::TerrainReport;
use belvedere_scene::Progress;
use serde::Serialize;

/// Answer of [`measure`].
#[derive(Debug, Clone, Serialize)]
pub struct MeasureReport {
    /// The scene file.
    pub scene: String,
    /// Coordinate system.
    pub crs: String,
    /// Stages in order of application.
    pub stages: Vec<&'static str>,
    /// Renderer of the depth buffers.
    pub renderer: &'static str,
    /// Report of the solver of terrain disocclusion; `None` if it did not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub terrain: Option<TerrainReport>,
    /// Visible share of the required features in the picture, 0..=1: by the judge of terrain disocclusion where it judged all its points
    /// and only the ground hides, else by lines of sight. The least of the shares of lines (by length), areas (by area), surfaces, and points
    /// (by number). `None` if no part of them is in the picture.
    pub visible: Option<f64>,
    /// The measures.
    #[serde(flatten)]
    pub measures: Measures,
    /// Warnings of opening the scene.
    pub scene_warnings: Vec<Warning>,
}

/// Largest difference between two measures of one picture of ground for which the judge's figure is reported.
const ONE_FIGURE: f64 = 0.005;

/// Visible shares straight and bent: one figure for each picture, see [`MeasureReport::visible`].
pub(super) fn shares(measures: &Measures, terrain: Option<&TerrainReport>) -> [Option<f64>; 2] {
    let kinds = [&measures.lines, &measures.areas, &measures.points, &measures.surfaces];
    let least = |of: fn(&FeatureMeasure) -> &Visibility| {
        kinds.into_iter().flatten().filter_map(|kind| of(kind).sight.share).min_by(f64::total_cmp)
    };
    let [straight, bent] = [least(|m| &m.straight), least(|m| &m.bent)];
    let judged = terrain.filter(|t| t.judged_every == 1).map(|t| t.metrics.visible_dense);
    // The judge knows the ground alone: where other layers hide, or a surface is required, lines of sight give less.
    let bent = bent.map(|share| judged.filter(|judged| (judged - share).abs() <= ONE_FIGURE).unwrap_or(share));
    [straight, bent]
}

/// Visible share of every required feature, straight and bent, by lines of sight and by depth buffers drawn by `renderer`.
///
/// # Errors
/// [`BelvedereError::Construct`] if nothing must be seen, [`BelvedereError::UnderGround`].
pub fn measure(
    session: &Session,
    options: &MeasureOptions,
    renderer: RendererChoice,
    progress: &Progress,
) -> Result<MeasureReport, BelvedereError> {
    session.check_drawable()?;
    let renderer = renderer.of(session);
    let measures = belvedere_construct::measure(session.scene(), session.view(), Some(renderer), options, progress)?;
    Ok(MeasureReport {
        scene: session.name(),
        crs: session.scene().crs.to_string(),
        stages: session.stage_names(),
        renderer: renderer.name(),
        visible: shares(&measures, session.terrain_report())[1],
        terrain: session.terrain_report().cloned(),
        measures,
        scene_warnings: session.warnings(),
    })
}

impl Session {
    /// [`measure`] with the session's renderer, without progress.
    ///
    /// # Errors
    /// Those of [`measure`].
    pub fn measure(&self, options: &MeasureOptions) -> Result<MeasureReport, BelvedereError> {
        measure(self, options, RendererChoice::default(), &Progress::silent())
    }
}
