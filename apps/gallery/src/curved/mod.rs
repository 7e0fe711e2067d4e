//! `figures curved`: the figures of Cui et al. 2010, drawn again on generated scenes.

mod canyon;
mod crossing;
pub(crate) mod easel;
mod engine;
mod helix;
mod massif;
mod page;
mod street;

use crate::sheet::{self, Panel};
use anyhow::{Context, Result};
use belvedere::OpenOptions;
use belvedere::output::{self, pretty};
use easel::Easel;
use page::FigureRecord;
use std::path::{Path, PathBuf};

/// A figure: panels of one size in rows.
struct Figure {
    panels: Vec<Panel>,
    columns: usize,
    /// How much of what matters each panel shows, in the unit of its note; empty where that is not the point.
    seen: Vec<f64>,
}

/// A figure that can be drawn.
struct Entry {
    /// The file is `curved_NAME.png`.
    name: &'static str,
    title: &'static str,
    /// What is seen, for the page.
    says: &'static str,
    draw: fn(&Easel<'_>) -> Result<Figure>,
}

/// In the order of the page.
const FIGURES: [Entry; 11] = [
    Entry {
        name: "street",
        title: "Round the corner",
        says: "Straight rays end at the walls of the street. Bent ones turn at the crossing: the bus, the van and the lorry that wait in \
               side streets come into one continuous picture, and nothing in front of them is cut away.",
        draw: street::corners,
    },
    Entry {
        name: "street_rays",
        title: "The rays of the street corner",
        says: "From outside and from above: straight up to the first plane, bent between the planes, straight again as if they came from \
               the second viewpoint.",
        draw: street::rays,
    },
    Entry {
        name: "helix",
        title: "Behind the double helix",
        says: "The box marks two base pairs of the helix behind. The rays pass the front helix and turn behind it.",
        draw: helix::behind,
    },
    Entry {
        name: "bends",
        title: "Which way to bend",
        says: "The second viewpoint may lie anywhere: beside, above, or both.",
        draw: helix::directions,
    },
    Entry {
        name: "engine",
        title: "Into the machined block",
        says: "A volume seen along rays that are bent more and more: the valve in the chamber rises over the front wall.",
        draw: engine::curvature,
    },
    Entry {
        name: "models",
        title: "Modified and original rays",
        says: "Conic arcs, which project in closed form, beside the parabolas of the original model, for a turn by a right angle. The difference \
               is drawn twenty times as strong.",
        draw: street::models,
    },
    Entry {
        name: "collapse",
        title: "Planes that collapse",
        says: "The planes of a turn draw together until the rays have a kink: a preview folds a turn away like this before it leaves the path.",
        draw: engine::collapse,
    },
    Entry {
        name: "crossing",
        title: "Through the transition",
        says: "A striped mast lies across the transition. Rays with a kink break it, rays without one bend it smoothly.",
        draw: crossing::kink_and_curve,
    },
    Entry {
        name: "viewpoints",
        title: "Intermediate viewpoints",
        says: "The second viewpoint moves from the eye to its place, and the valley behind the pass opens; the foreground stays.",
        draw: massif::viewpoints,
    },
    Entry {
        name: "preview",
        title: "The river ahead",
        says: "A preview follows the river round its bends: markers are 500 m apart, and with every picture more of them come into sight.",
        draw: canyon::preview,
    },
    Entry {
        name: "turns",
        title: "A camera of four turns",
        says: "The camera that sees a stretch of the river, drawn over the canyon from above.",
        draw: canyon::turns,
    },
];

/// Draws the figures of the curved ray camera into `folder`, which is made if need be: `curved_NAME.png`, `curved.json` with what
/// stands under the panels, and `curved.html`. Returns the files.
///
/// # Errors
/// A file that exists if `overwrite` is false; those of drawing a scene.
pub fn figures(folder: &Path, options: &OpenOptions, overwrite: bool) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let picture = |entry: &Entry| format!("curved_{}.png", entry.name);
    let (page, record) = (folder.join("curved.html"), folder.join("curved.json"));
    for path in FIGURES.iter().map(|e| folder.join(picture(e))).chain([page.clone(), record.clone()]) {
        output::check(&path, &[], overwrite)?;
    }
    let easel = Easel::new(options);
    let (mut written, mut records) = (Vec::new(), Vec::new());
    for (k, entry) in FIGURES.iter().enumerate() {
        options.progress.tick("figures of curved rays", k as f64 / FIGURES.len() as f64)?;
        let figure = (entry.draw)(&easel)?;
        let path = folder.join(picture(entry));
        sheet::write(&path, sheet::sheet(&figure.panels, figure.columns), NOTE, overwrite)?;
        records.push(FigureRecord::new(entry, picture(entry), &figure));
        written.push(path);
    }
    output::write_text(&record, &pretty(&records)?, overwrite)?;
    output::write_text(&page, &page::page(&records), overwrite)?;
    written.extend([record, page]);
    Ok(written)
}

/// Goes with every picture.
const NOTE: &str = "rays are bent unless a panel says straight; not to scale, not for navigation";
