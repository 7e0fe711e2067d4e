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

/// A massif with furniture, bent.
const MAP: &str = r##"
format = 1
title = "A massif, its road and lake"
crs = "local"
[camera]
eye = [0.0, -9500.0, 5200.0]
look_at = [0.0, -800.0, 900.0]
image = [640, 420]
[overlay]
mark = false
[furniture]
title = true
legend = true
compass = true
scale = true
date = "Generated ground"
[[layer]]
kind = "terrain"
id = "heights"
source = "builtin:massif?seed=7&size=513"
style = { palette = "clear", contours = true, edge = "block" }
[[layer]]
kind = "line"
id = "road"
route = { seed = 7 }
must_see = true
style = { color = "#f2b134", width_px = 3.5, casing = "#7a5200" }
[[layer]]
kind = "area"
id = "lake"
source = "builtin:massif?seed=7&size=513"
style = { color = "#4a85a8", outline = "#2a5878", water = true }
[[stage]]
kind = "spline_bend"
presets = "progressive"
"##;

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
        Entry {
            name: "furniture",
            title: "What makes a picture a map",
            says: "Title, legend, compass and local scale belong to their places, straight and bent.",
            draw: furniture,
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

fn furniture(easel: &Easel<'_>) -> Result<Figure> {
    let session = easel.open(MAP, [640, 420])?;
    let panels = vec![
        easel.panel(&straight(&session), "Straight", "one scale bar would nearly do".into())?,
        easel.panel(&session, "Bent", "each bar and the rose are true where they lie".into())?,
    ];
    Ok(Figure { panels, columns: 2, ..Figure::default() })
}
