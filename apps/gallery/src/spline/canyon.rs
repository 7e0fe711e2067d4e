//! Relief that passes into a map.

use super::bent::{TILE, bent, curve};
use crate::easel::{Easel, straight};
use crate::figure_set::Figure;
use anyhow::{Context, Result};
use belvedere::core::Stage;
use belvedere::core::presets::PresetDocument;

const SCENE: &str = r##"format = 1
crs = "local"

[representations]
relief = ["relief"]
map = ["map"]

[[layer]]
id = "relief"
kind = "terrain"
source = "builtin:canyon?seed=7"

[[layer]]
id = "map"
kind = "terrain"
source = "builtin:canyon?seed=7"
style = { relief = "none" }

[[layer]]
id = "river"
kind = "line"
source = "builtin:canyon?seed=7"
style = { color = "#2f6f9f", width_px = 3 }

[overlay]
grid = true

[camera]
eye = [0.0, -5200.0, 3600.0]
look_at = [0.0, 0.0, 0.0]
fov_y_deg = 45.0
"##;

/// Straight, bent, and the curve.
pub(super) fn sections(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(SCENE, TILE)?;
    let operations =
        ["1.phi=33", "1.split=1", "1.tag.1=0.62", "1.width.1=0.12", "1.section.1=relief", "1.section.2=map"];
    let document: PresetDocument = super::bent::document("degressive", &operations)?;
    let height = session.scene().terrain().map_or(0.0, |t| t.z_range()[0]);
    let whole = bent(&session, &document, height)?;
    let phi = whole.view().stages().iter().find_map(|s| match s {
        Stage::SplineBend(bend) => Some(bend.resolved().phi_deg),
        _ => None,
    });
    let (before, map) = SCENE.split_once("[[layer]]\nid = \"map\"").context("the scene has a map")?;
    let (_, after) = map.split_once("[[layer]]").context("the map is followed by the river")?;
    let relief = format!("{before}[[layer]]{after}").replace("map = [\"map\"]\n", "");
    let panels = vec![
        easel.panel(&straight(&easel.open(&relief, TILE)?), "Straight", "shaded relief".into())?,
        easel.panel(&whole, "Degressive", "shaded relief in front, a map of what lies ahead".into())?,
        curve(&document, phi.context("the view is bent")?, "The curve"),
    ];
    Ok(Figure { panels, columns: 3, seen: Vec::new() })
}
