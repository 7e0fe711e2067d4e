//! `figures guide`: the pictures of docs/guide.

use crate::easel::{Easel, straight};
use crate::figure_set::{Entry, Figure, FigureSet};
use anyhow::Result;
use belvedere::{CameraPicture, OpenOptions};
use std::path::{Path, PathBuf};

const TILE: [u32; 2] = [512, 288];
const STREET: &str = include_str!("../../../scenes/street_split.toml");
const MASSIF: &str = include_str!("../../../scenes/massif_terrain.toml");
const TOWN: &str = include_str!("../../../scenes/town.toml");

const SET: FigureSet<'_> = FigureSet {
    name: "guide",
    title: "Pictures of the guide",
    intro: "One scene for each technique, straight and bent.",
    comment: "straight | bent",
    entries: &[
        Entry {
            name: "curved_rays",
            title: "Curved rays",
            says: "Rays turn round two corners, and the camera from above.",
            draw: curved_rays,
        },
        Entry {
            name: "merge",
            title: "Apart, and one again",
            says: "Rays part before what hides, pass it on both sides, and become one again behind it.",
            draw: merge,
        },
        Entry {
            name: "terrain",
            title: "Terrain disocclusion",
            says: "The ground makes way for a trail.",
            draw: terrain,
        },
        Entry { name: "spline", title: "Multi-perspective views", says: "A town bent along a spline.", draw: spline },
    ],
};

/// Draws the pictures of the guide into `folder`, which is created if necessary. Returns the files.
///
/// # Errors
/// A file that exists if `overwrite` is false; the errors of drawing a scene.
pub fn figures(folder: &Path, options: &OpenOptions, overwrite: bool) -> Result<Vec<PathBuf>> {
    SET.draw(folder, options, 1.0, overwrite)
}

fn curved_rays(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(STREET, [640, 400])?;
    let panels = vec![
        easel.panel(&straight(&session), "Straight", "houses hide the side streets".into())?,
        easel.panel(&session, "Bent", "rays part, and each half turns round its corner".into())?,
        easel.camera(&session, CameraPicture::Overhead, "The camera from above", "rays, planes, viewpoints".into())?,
    ];
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}

fn merge(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(crate::curved::MERGE, [480, 300])?;
    let panels = vec![
        easel.panel(&straight(&session), "Straight", "the front helix hides the one behind".into())?,
        easel.panel(&session, "Round both sides", "rays part, and are one again behind it".into())?,
        easel.camera(&session, CameraPicture::Overhead, "The camera from above", "rays, planes, viewpoints".into())?,
    ];
    Ok(Figure { panels, columns: 3, ..Figure::default() })
}

fn terrain(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(MASSIF, TILE)?;
    let panels = vec![
        easel.panel(&straight(&session), "Straight", "what lies behind ridges is dashed".into())?,
        easel.panel(&session, "The ground makes way", "as little as it can".into())?,
    ];
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}

fn spline(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(TOWN, TILE)?;
    let panels = vec![
        easel.panel(&straight(&session), "Straight", String::new())?,
        easel.panel(&session, "Progressive", "steep in the foreground, flat towards the horizon".into())?,
    ];
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}
