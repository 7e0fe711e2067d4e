//! `measure`: what a scene's picture shows of what must be seen.

use crate::{BelvedereError, RendererChoice, Session};
pub use belvedere_construct::MeasureOptions;
use belvedere_construct::Measures;
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
    /// The figures.
    #[serde(flatten)]
    pub measures: Measures,
    /// What was odd when the scene was opened.
    pub scene_warnings: Vec<String>,
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
