//! A river in a canyon, previewed.

use crate::easel::Easel;
use crate::figure_set::Figure;
use anyhow::{Context, Result};
use belvedere::construct::{self, MeasureOptions};
use belvedere::scene::Progress;
use belvedere::{CameraPicture, Session};

const SCENE: &str = include_str!("../../../../scenes/canyon_preview.toml");
/// What the scene says about the preview, metres.
const LENGTH: &str = "preview_m = 4000.0";

/// The scene with another length of preview, metres.
fn ahead(easel: &Easel<'_>, length: f64, image: [u32; 2]) -> Result<Session> {
    anyhow::ensure!(SCENE.contains(LENGTH), "the canyon's scene does not say {LENGTH}");
    easel.open(&SCENE.replace(LENGTH, &format!("preview_m = {length:.1}")), image)
}

/// What is said of a preview, and metres of the river that it shows.
fn note(session: &Session) -> Result<(String, f64)> {
    let turns = session.view().curved_rays().context("the preview bends no rays")?.turn_count();
    let options = MeasureOptions::default();
    let measures = construct::measure(session.scene(), session.view(), None, &options, &Progress::silent())?;
    let seen = measures.lines.context("the scene has no river")?.bent.sight.visible;
    Ok((format!("{turns} turns; {seen:.0} m of the river in sight"), seen))
}

/// Further and further round the bends.
pub(super) fn preview(easel: &Easel<'_>) -> Result<Figure> {
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for length in [600.0, 1500.0, 2500.0, 4000.0] {
        let session = ahead(easel, length, [640, 360])?;
        let (note, metres) = note(&session)?;
        panels.push(easel.panel(&session, &format!("{length:.0} m ahead"), note)?);
        seen.push(metres);
    }
    Ok(Figure { panels, columns: 2, seen })
}

/// Picture and rays of one camera.
pub(super) fn turns(easel: &Easel<'_>) -> Result<Figure> {
    let session = ahead(easel, 1500.0, [1000, 750])?;
    let panels = vec![
        easel.panel(&session, "What it sees", note(&session)?.0)?,
        easel.camera(
            &session,
            CameraPicture::Overhead,
            "The camera from above",
            "rays, planes and viewpoints".into(),
        )?,
    ];
    Ok(Figure { panels, columns: 2, seen: Vec::new() })
}
