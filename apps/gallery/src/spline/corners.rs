//! Doubled control points, hard and spread.

use super::bent::{IN_THREE, curve, document, panel};
use super::town::seen;
use crate::easel::Easel;
use crate::figure_set::Figure;
use anyhow::Result;

pub(super) fn hard_and_soft(easel: &Easel<'_>) -> Result<Figure> {
    let town = seen(easel, 35.0, 900.0)?;
    let mut panels = Vec::new();
    for (more, title) in [(&[][..], "Six points, two of them doubled"), (&["1.soften=1"], "The doubled points spread")]
    {
        let document = document("flat-steep-flat", &[&IN_THREE[..], more].concat())?;
        panels.push(panel(easel, &town, &document, 0.0, title)?);
        panels.push(curve(&document, 35.0, title));
    }
    Ok(Figure { panels, columns: 2, seen: Vec::new() })
}
