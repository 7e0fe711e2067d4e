//! `measure`: visibility of the required features in a scene's picture.

use super::shares::shares;
use crate::guard::guarded;
use crate::picture::{LookScore, PictureOptions};
use crate::scene_file::request::Measure;
use crate::{BelvedereError, RendererName, Session};
pub use belvedere_construct::MeasureOptions;
use belvedere_construct::Measures;
use belvedere_core::Warning;
use belvedere_disocclusion::TerrainReport;
use belvedere_scene::Progress;
use schemars::JsonSchema;
use serde::Serialize;

/// Answer of [`measure`].
#[derive(Debug, Clone, JsonSchema, Serialize)]
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
    /// Visible share of the whole required features, 0..=1: by the judge of terrain disocclusion where it judged all its points and only the
    /// ground hides, else by lines of sight. The least of the shares of lines (by length), areas (by area), surfaces, and points (by number);
    /// what lies outside the picture is not visible. `None` without any of them.
    pub visible: Option<f64>,
    /// Share of the whole required features inside the picture, likewise.
    pub in_frame: Option<f64>,
    /// The same for the picture without bends, by lines of sight.
    pub visible_straight: Option<f64>,
    /// As `visible`: the picture as it is.
    pub visible_bent: Option<f64>,
    /// Share of the whole required features inside the picture without bends.
    pub in_frame_straight: Option<f64>,
    /// As `in_frame`.
    pub in_frame_bent: Option<f64>,
    /// The measures, with all warnings, those of opening the scene included.
    #[serde(flatten)]
    pub measures: Measures,
    /// Score of the look of the picture, if it was asked for and the picture shows terrain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<LookScore>,
    /// Warnings of opening the scene.
    pub scene_warnings: Vec<Warning>,
}

/// Visible share of every required feature, straight and bent, by lines of sight and by depth buffers; and the look of the picture, if asked
/// for.
///
/// # Errors
/// [`BelvedereError::Construct`] if nothing must be seen, [`BelvedereError::UnderGround`].
pub fn measure(session: &Session, asked: &Measure, progress: &Progress) -> Result<MeasureReport, BelvedereError> {
    guarded(|| {
        let options = MeasureOptions { spacing_m: asked.spacing, ..MeasureOptions::default() };
        let report = measured(session, &options, &asked.renderer, progress)?;
        if !asked.picture {
            return Ok(report);
        }
        let drawn = PictureOptions {
            renderer: asked.renderer.clone(),
            progress: progress.clone(),
            ..PictureOptions::default()
        };
        Ok(MeasureReport { look: session.render(&drawn)?.look(), ..report })
    })
}

fn measured(
    session: &Session,
    options: &MeasureOptions,
    renderer: &RendererName,
    progress: &Progress,
) -> Result<MeasureReport, BelvedereError> {
    session.check_drawable()?;
    let renderer = session.renderer(renderer)?;
    let mut measures =
        belvedere_construct::measure(session.scene(), session.view(), Some(&*renderer), options, progress)?;
    let shares = shares(&measures, session.terrain_report());
    let scene_warnings = session.warnings();
    measures.warnings.splice(..0, scene_warnings.iter().cloned());
    Ok(MeasureReport {
        scene: session.name(),
        crs: session.scene().crs.to_string(),
        stages: session.stage_names(),
        renderer: renderer.name(),
        visible: shares.map(|[_, bent]| bent.visible),
        in_frame: shares.map(|[_, bent]| bent.in_frame),
        visible_straight: shares.map(|[straight, _]| straight.visible),
        visible_bent: shares.map(|[_, bent]| bent.visible),
        in_frame_straight: shares.map(|[straight, _]| straight.in_frame),
        in_frame_bent: shares.map(|[_, bent]| bent.in_frame),
        terrain: session.terrain_report().cloned(),
        measures,
        look: None,
        scene_warnings,
    })
}

impl Session {
    /// [`measure`] with the session's renderer, without progress.
    ///
    /// # Errors
    /// Those of [`measure`].
    pub fn measure(&self, options: &MeasureOptions) -> Result<MeasureReport, BelvedereError> {
        guarded(|| measured(self, options, &RendererName::AUTO, &Progress::silent()))
    }
}
