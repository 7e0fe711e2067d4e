//! `figures curved`: the figures of Cui et al. 2010, drawn again on generated scenes.

mod canyon;
mod crossing;
mod engine;
mod helix;
mod massif;
mod street;

use crate::figure_set::{Entry, FigureSet};
use anyhow::Result;
use belvedere::OpenOptions;
use std::path::{Path, PathBuf};

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

/// Draws the figures of the curved ray camera into `folder`: sheets, a page and a record. Returns the files.
///
/// # Errors
/// A file that exists if `overwrite` is false; those of drawing a scene.
pub fn figures(folder: &Path, options: &OpenOptions, overwrite: bool) -> Result<Vec<PathBuf>> {
    let set = FigureSet {
        name: "curved",
        title: "Rays that bend",
        intro: "The figures of Cui et al. 2010, <i>A curved ray camera for handling occlusions through continuous multiperspective \
                visualization</i>, on generated scenes; the paper's own models are not public, so what the figures show can be \
                compared, not single pixels. Bent pictures are not to scale and not for navigation.",
        comment: "rays are bent unless a panel says straight; not to scale, not for navigation",
        entries: &FIGURES,
    };
    set.draw(folder, options, overwrite)
}
