//! Relief with a continuous transition to a map.

use super::bent::{TILE, curve};
use crate::easel::{Easel, straight};
use crate::figure_set::Figure;
use anyhow::{Context, Result};
use belvedere::core::presets::PresetDocument;
use belvedere::core::{Stage, View};
use belvedere::scene_file::{PresetsDoc, StageDoc};
use belvedere::{Session, core::SplineBend};

const SCENE: &str = include_str!("../../../../scenes/canyon_map.toml");

/// Straight, bent, bent and flattened, and the curve.
pub(super) fn sections(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, TILE)?;
    let (document, bend) = spline(&session).context("the scene bends space")?;
    let phi = bend.resolved().phi_deg;
    let mountains = View::new(session.view().pinhole().clone(), vec![Stage::SplineBend(bend)])?;
    let mountains = session.clone().with_view(mountains);
    let triangles = session.scene().terrain().map_or(0, |t| 2 * (t.cols() - 1) * (t.rows() - 1));
    let panels = vec![
        easel.panel(&straight(&session), "Straight", format!("two models of {triangles} triangles on one surface"))?,
        easel.panel(
            &mountains,
            "Degressive",
            "relief in front, the colours of a map on the same heights ahead".into(),
        )?,
        easel.panel(&session, "Relief becomes a map", "heights pass to nothing over the transition".into())?,
        curve(&document, phi, "The curve"),
    ];
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}

/// The spline stage of a session and its presets.
fn spline(session: &Session) -> Option<(PresetDocument, SplineBend)> {
    let document = session.resolved()?.stage.iter().find_map(|stage| match stage {
        StageDoc::SplineBend(doc) => match &doc.presets {
            PresetsDoc::Inline(document) => Some((**document).clone()),
            PresetsDoc::Named(_) => None,
        },
        _ => None,
    });
    let bend = session.view().stages().iter().find_map(|stage| match stage {
        Stage::SplineBend(bend) => Some(bend.clone()),
        _ => None,
    });
    document.zip(bend)
}
