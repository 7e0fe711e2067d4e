//! `measure`: what a scene's picture shows of what must be seen.

use crate::{BelvedereError, RendererChoice, Session};
pub use belvedere_construct::MeasureOptions;
use belvedere_construct::Measures;
use belvedere_construct::measure::{FeatureMeasure, Visibility};
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
    /// Who drew the depth buffers.
    pub renderer: &'static str,
    /// Report of the solver of terrain disocclusion; `None` if it did not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub terrain: Option<TerrainReport>,
    /// The share of what must be seen that is seen in the picture, 0..=1: by the judge of terrain disocclusion where that judged all its
    /// points and nothing but the ground hides, else by line of sight; of lines by length, areas by area, surfaces, and points by number the least. `None` if nothing
    /// of it is in the picture.
    pub visible: Option<f64>,
    /// The figures.
    #[serde(flatten)]
    pub measures: Measures,
    /// What was odd when the scene was opened.
    pub scene_warnings: Vec<String>,
}

/// Two ways to judge one picture of ground differ by so much at most.
const ONE_FIGURE: f64 = 0.005;

/// Visible share straight and bent: one figure for each picture, see [`MeasureReport::visible`].
pub(super) fn shares(measures: &Measures, terrain: Option<&TerrainReport>) -> [Option<f64>; 2] {
    let kinds = [&measures.lines, &measures.areas, &measures.points, &measures.surfaces];
    let least = |of: fn(&FeatureMeasure) -> &Visibility| {
        kinds.into_iter().flatten().filter_map(|kind| of(kind).sight.share).min_by(f64::total_cmp)
    };
    let [straight, bent] = [least(|m| &m.straight), least(|m| &m.bent)];
    let judged = terrain.filter(|t| t.judged_every == 1).map(|t| t.metrics.visible_dense);
    // The judge knows the ground alone: where something else hides, or a surface must be seen, lines of sight find less.
    let bent = bent.map(|share| judged.filter(|judged| (judged - share).abs() <= ONE_FIGURE).unwrap_or(share));
    [straight, bent]
}

/// Visible share of every feature that must be seen, straight and bent, by line of sight and by depth buffer drawn by `renderer`.
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
    /// [`measure`] by the session's renderer, without progress.
    ///
    /// # Errors
    /// Those of [`measure`].
    pub fn measure(&self, options: &MeasureOptions) -> Result<MeasureReport, BelvedereError> {
        measure(self, options, RendererChoice::default(), &Progress::silent())
    }
}
