//! `figures curved`: the figures of Cui et al. 2010, drawn again on generated scenes.

mod between;
mod canyon;
mod car;
mod crossing;
mod engine;
mod helix;
mod massif;
mod merge;
mod models;
mod street;
mod street_rays;
mod table;
mod town;

pub(crate) use merge::SCENE as MERGE;

use crate::figure_set::{Entry, FigureSet};
use anyhow::Result;
use belvedere::OpenOptions;
use std::path::{Path, PathBuf};

/// In the order of the page.
const FIGURES: [Entry; 17] = [
    Entry {
        name: "street",
        title: "Round the corner",
        says: "Straight rays end at the walls of the street. Bent ones turn at the crossing: the bus, the car and the lorry that wait in \
               side streets come into one continuous picture, and nothing in front of them is cut away.",
        draw: street::corners,
    },
    Entry {
        name: "street_rays",
        title: "The rays of the street corner",
        says: "From outside and from above: straight up to the first plane, bent between the planes, straight again as if they came from \
               the second viewpoint, and so into the side streets.",
        draw: street_rays::rays,
    },
    Entry {
        name: "together",
        title: "Forward and to the right",
        says: "The left half of the rays goes on along the avenue, the right half turns at the crossing: the tram ahead and the car in the \
               side street are in one picture.",
        draw: street::ahead_and_aside,
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
        says: "The second viewpoint may lie anywhere: beside, above, or both. Past something upright, beside is the way.",
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
        says: "Conic arcs, which project in closed form, beside and over the parabolas of the original model, for a turn by a right angle. \
               The difference is drawn twenty times as strong.",
        draw: models::models,
    },
    Entry {
        name: "collapse",
        title: "Planes that collapse",
        says: "The planes of a turn draw together until the rays have a kink.",
        draw: engine::collapse,
    },
    Entry {
        name: "crossing",
        title: "Through the transition",
        says: "A striped mast lies across the transition. Rays with a kink break it, rays without one bend it smoothly.",
        draw: crossing::kink_and_curve,
    },
    Entry {
        name: "car",
        title: "A car in the transition",
        says: "A car stands across the transition. Rays with a kink break its edges, curved ones bend them less and without a corner.",
        draw: car::across,
    },
    Entry {
        name: "between",
        title: "Viewpoints in between",
        says: "Where a ray bends it seems to come from a viewpoint between the eye and the second viewpoint, which moves from the one to \
               the other along the bend.",
        draw: between::viewpoints,
    },
    Entry {
        name: "viewpoints",
        title: "The second viewpoint on its way",
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
        name: "collapse_path",
        title: "A turn that collapses on the way",
        says: "Towards a turn of the river its planes draw together, so that it is gone when it is passed.",
        draw: canyon::collapse,
    },
    Entry {
        name: "turns",
        title: "A camera of four turns",
        says: "The camera that sees a stretch of the river, drawn over the canyon from above.",
        draw: canyon::turns,
    },
    Entry {
        name: "merge",
        title: "Apart, and one again",
        says: "The left and the right half of the rays pass the front helix on their side of it and become one again behind it: the helix \
               behind is seen whole, without a break along the seam.",
        draw: merge::round_both_sides,
    },
    Entry {
        name: "table",
        title: "Times of frames",
        says: "Straight, with a kink and curved, 1280 x 720 pixels, one sample, on this machine's processor; the scenes are generated and \
               most are smaller than the paper's, whose times are those of a graphics card of 2009: ratios can be compared, times cannot.",
        draw: table::times,
    },
];

/// Draws the figures of the curved ray camera into `folder`: sheets, a page and a record. Returns the files.
///
/// * `scale`: factor of the width and height of the pictures, in (0, 1]; measured times are those of such pictures.
///
/// # Errors
/// A file that exists if `overwrite` is false; the errors of drawing a scene.
pub fn figures(folder: &Path, options: &OpenOptions, scale: f64, overwrite: bool) -> Result<Vec<PathBuf>> {
    let set = FigureSet {
        name: "curved",
        title: "Rays that bend",
        intro: "The figures of Cui et al. 2010, <i>A curved ray camera for handling occlusions through continuous multiperspective \
                visualization</i>, on generated scenes; the paper's own models are not public, so what the figures show can be \
                compared, not single pixels. Bent pictures are not to scale and not for navigation.",
        comment: "rays are bent unless a panel says straight; not to scale, not for navigation",
        entries: &FIGURES,
    };
    set.draw(folder, options, scale, overwrite)
}
