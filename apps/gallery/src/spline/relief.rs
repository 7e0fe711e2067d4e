//! Changes of relief, and a chain of all stages.

use super::bent::TILE;
use crate::easel::{Easel, straight};
use crate::figure_set::Figure;
use anyhow::Result;
use belvedere::core::View;

const PANORAMA: &str = include_str!("../../../../scenes/massif_panorama.toml");
const OBLIQUE: &str = include_str!("../../../../scenes/massif_plan_oblique.toml");
const ALL: &str = include_str!("../../../../scenes/massif_all_stages.toml");

/// A panorama and a map, before and after.
pub(super) fn changes(easel: &Easel<'_>) -> Result<Figure> {
    let mut panels = Vec::new();
    for (scene, before, after, note) in [
        (
            PANORAMA,
            "Straight",
            "Exaggerated, on a curved horizon",
            "and bent by a progressive preset; large forms are levelled by half",
        ),
        (
            OBLIQUE,
            "From above",
            "Plan oblique relief",
            "heights are moved away from the viewer by 0.8 times themselves",
        ),
    ] {
        let session = easel.open(scene, TILE)?;
        panels.push(easel.panel(&straight(&session), before, String::new())?);
        panels.push(easel.panel(&session, after, note.into())?);
    }
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}

/// Stage by stage.
pub(super) fn chain(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(ALL, TILE)?;
    let stages = session.view().stages();
    let mut panels = vec![easel.panel(&straight(&session), "Straight", "what lies behind ridges is dashed".into())?];
    let titles = ["The ground makes way", "and relief is exaggerated", "and space is bent", "and rays turn"];
    for (k, title) in titles.iter().enumerate().take(stages.len()) {
        let view = View::new(session.view().pinhole().clone(), stages[..=k].to_vec())?;
        panels.push(easel.panel(&session.clone().with_view(view), title, stages[k].name().replace('_', " "))?);
    }
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}
