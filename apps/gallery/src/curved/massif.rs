//! The valley behind a pass.

use crate::easel::{Easel, bent, straight, turns};
use crate::figure_set::Figure;
use anyhow::{Context, Result};
use belvedere::Session;
use belvedere::construct::{self, MeasureOptions};
use belvedere::core::map::curved_rays::{Model, TurnSpec};
use belvedere::scene::Progress;

const SCENE: &str = include_str!("../../../../scenes/massif_curved_rays.toml");

/// The second viewpoint at several shares of the line from the eye.
pub(super) fn viewpoints(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, [560, 315])?;
    let [turn] = turns(&session)?[..] else { return None.context("the scene has not one turn") };
    let eye = session.view().pinhole().eye;
    let (mut panels, mut seen) = (Vec::new(), Vec::new());
    for share in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
        let spec = TurnSpec { viewpoint: eye.lerp(turn.viewpoint, share), ..turn };
        let session = if share > 0.0 { bent(&session, Model::Modified, &[spec])? } else { straight(&session) };
        let title = if share > 0.0 {
            format!("Second viewpoint {:.0} m up", (spec.viewpoint - eye).z)
        } else {
            "Straight rays".into()
        };
        let visible = visible(&session)?;
        panels.push(easel.panel(
            &session,
            &title,
            format!("{:.0} % of the trail in the picture is visible", 100.0 * visible),
        )?);
        seen.push(visible);
    }
    Ok(Figure { panels, columns: 3, seen, ..Figure::default() })
}

/// Visible share of the trail in the picture.
fn visible(session: &Session) -> Result<f64> {
    let options = MeasureOptions::default();
    let measures = construct::measure(session.scene(), session.view(), None, &options, &Progress::silent())?;
    measures.lines.and_then(|l| l.bent.sight.share).context("the trail lies outside the picture")
}
