//! Stylisation, alone and together.

use super::bent::{IN_THREE, document, panel};
use super::town::{seen, shaded};
use crate::easel::Easel;
use crate::figure_set::Figure;
use anyhow::Result;
use belvedere::scene::Stylisation;

pub(super) fn side_by_side(easel: &Easel<'_>) -> Result<Figure> {
    let towns = [seen(easel, 40.0, 700.0)?, shaded(easel, 40.0, 700.0)?];
    let document = document("progressive", &IN_THREE)?;
    let mut panels = Vec::new();
    for (title, town, edges, unsharp) in [
        ("Plain", 0, 0.0, 0.0),
        ("Ambient occlusion", 1, 0.0, 0.0),
        ("Dark edges", 0, 0.7, 0.0),
        ("Depth unsharp masking", 0, 0.0, 5.0),
        ("Edges and masking", 0, 0.7, 4.0),
        ("All three", 1, 0.7, 4.0),
    ] {
        let session = towns[town].clone().with_stylisation(Stylisation { edges, unsharp });
        panels.push(panel(easel, &session, &document, 0.0, title)?);
    }
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}
