//! One document over all viewing angles.

use super::bent::{TILE, bent};
use super::town::from;
use crate::easel::Easel;
use crate::figure_set::Figure;
use anyhow::Result;
use belvedere::core::Stage;
use belvedere::core::presets::PresetDocument;

const SCENE: &str = include_str!("../../../../scenes/town_sections.toml");

pub(super) fn sweep(easel: &Easel<'_>) -> Result<Figure> {
    let town = easel.open(SCENE, TILE)?;
    let document = PresetDocument::builtin("demo-orthographic")?;
    let mut panels = Vec::new();
    for phi in [15.0, 25.0, 34.0, 42.0, 62.0, 80.0] {
        let session = bent(&from(&town, phi, 1000.0)?, &document, 0.0)?;
        let between = session.view().stages().iter().find_map(|s| match s {
            Stage::SplineBend(bend) => Some(bend.resolved().clone()),
            _ => None,
        });
        let note = between.map_or(String::new(), |r| match r.sigma {
            0.0 => format!("preset {}", r.start),
            1.0 => format!("preset {}", r.target),
            sigma => format!("{:.0} % of the way from {} to {}", 100.0 * sigma, r.start, r.target),
        });
        panels.push(easel.panel(&session, &format!("Viewing angle {phi:.0}°"), note)?);
    }
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}
