//! Doubled control points, hard and spread, and houses that keep their shape where the ground folds.

use super::bent::{IN_THREE, TILE, curve, document, panel};
use super::town::seen;
use crate::easel::Easel;
use crate::figure_set::Figure;
use crate::sheet::Panel;
use anyhow::Result;
use belvedere::scene_file::parse;
use std::path::Path;

const NEAR: &str = include_str!("../../../../scenes/town_rigid.toml");

pub(super) fn hard_and_soft(easel: &Easel<'_>) -> Result<Figure> {
    let town = seen(easel, 35.0, 900.0)?;
    let mut panels = Vec::new();
    for (more, title) in [(&[][..], "Six points, two of them doubled"), (&["1.soften=1"], "The doubled points spread")]
    {
        let document = document("flat-steep-flat", &[&IN_THREE[..], more].concat())?;
        panels.push(panel(easel, &town, &document, 0.0, title)?);
        panels.push(curve(&document, 35.0, title));
    }
    for (rigid, title, note) in [
        (false, "Near by, houses fold", "seen from 130 m, space folds 12 m over the ground; walls bow and lean"),
        (true, "Each house a rigid body", "carried and turned with the ground under its foot, however tall it is"),
    ] {
        panels.push(near(easel, rigid, title, note)?);
    }
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}

/// A close view of the town, with its houses rigid or not.
fn near(easel: &Easel<'_>, rigid: bool, title: &str, note: &str) -> Result<Panel> {
    let mut document = parse(Path::new("figure.toml"), NEAR)?.document;
    for layer in &mut document.layer {
        *layer = layer.with_rigid(rigid);
    }
    let session = easel.open(&belvedere::output::document_toml(&document)?, TILE)?;
    easel.panel(&session, title, note.into())
}
