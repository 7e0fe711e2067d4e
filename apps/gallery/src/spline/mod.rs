//! `figures spline`: the figures of Pasewaldt et al. 2011, drawn again on generated scenes.

mod angles;
mod arc_length;
mod bent;
mod canyon;
mod corners;
mod frames;
mod relief;
mod strip;
mod styles;
mod town;

use crate::figure_set::{Entry, FigureSet};
use anyhow::Result;
use belvedere::OpenOptions;
use std::path::{Path, PathBuf};

/// In the order of the page.
const FIGURES: [Entry; 10] = [
    Entry {
        name: "town",
        title: "Progressive, degressive and hybrid views of a town",
        says: "Each view has three styling sections, near to far: the houses as they are, blocks between all streets, blocks between main \
               streets. Landmarks stay. The levels of abstraction are made from the same map of the town.",
        draw: town::views,
    },
    Entry {
        name: "canyon",
        title: "Relief and map of a canyon",
        says: "A steep far end reads as a map: there the shaded relief passes into flat tints with a grid, and its heights into a plane. Two \
               representations of one surface, mixed by weight; the ground pictures are made from heights and the river's own line. The curve \
               that does it, with the eye, its field of view and the tag point, is drawn in a corner and beside.",
        draw: canyon::sections,
    },
    Entry {
        name: "corners",
        title: "Hard transitions between three planes",
        says: "Control points that are doubled make nearly plane parts with short bends between them. Houses fold where the bend is sharper \
               than they are high; spread points bend five times as gently, and rigid houses keep their shape.",
        draw: corners::hard_and_soft,
    },
    Entry {
        name: "styles",
        title: "Stylisation",
        says: "Light that houses keep from each other, dark edges where depth and faces break, and shade behind what stands out, alone and \
               together.",
        draw: styles::side_by_side,
    },
    Entry {
        name: "angles",
        title: "From panorama to map",
        says: "One document over all viewing angles: a degressive view, a progressive one, and a map in parallel projection; what lies between \
               is interpolated, representations fade.",
        draw: angles::sweep,
    },
    Entry {
        name: "relief",
        title: "Relief as panorama makers draw it",
        says: "Heights exaggerated towards the background, a curved horizon, and plan oblique relief: a stage of its own before any bend.",
        draw: relief::changes,
    },
    Entry {
        name: "strip",
        title: "A winding road, straightened",
        says: "The ground follows the road in plan while that is unrolled, as in panoramas along a road; then space is bent. Lengths along the road and \
               distances from it stay. Below, the plan on the way.",
        draw: strip::unrolled,
    },
    Entry {
        name: "arc_length",
        title: "Arc length from a table",
        says: "What a table of samples of the curve gets wrong, against the number of samples. Pictures are drawn without a table: our arc \
               length is right to 1e-14 of its length.",
        draw: arc_length::against_samples,
    },
    Entry {
        name: "frames",
        title: "Frames at the paper's combinations of levels",
        says: "Generated towns with about as many triangles as the models that the paper measures, every frame drawn whole on the processor of \
               this machine, by thresholds, in one pass, 1600 x 1200, four samples. Wall time of five frames; the paper's of 477 437 faces (1 219 884 \
               vertices), 364 500 (380 689) and 720 587 (1 443 895) on a GeForce GTX 285.",
        draw: frames::table,
    },
    Entry {
        name: "chain",
        title: "All techniques at once",
        says: "The ground makes way for the routes, relief is exaggerated, space is bent by a preset, and rays turn behind the pass: four maps \
               in one chain, and the promise of visibility holds behind all of them.",
        draw: relief::chain,
    },
];

/// Draws the figures of multi-perspective views into `folder`: sheets, a page and a record. Returns the files.
///
/// * `scale`: factor of the width and height of the pictures, in (0, 1]; measured times are those of such pictures.
///
/// # Errors
/// A file that exists if `overwrite` is false; the errors of drawing a scene.
pub fn figures(folder: &Path, options: &OpenOptions, scale: f64, overwrite: bool) -> Result<Vec<PathBuf>> {
    let set = FigureSet {
        name: "spline",
        title: "Space on a curve",
        intro: "The figures of Pasewaldt, Trapp and Döllner 2011, <i>Multiscale visualization of 3D geovirtual environments using \
                view-dependent multi-perspective views</i>, on generated scenes; the paper's own models and control points are not public. Ground \
                pictures are drawn from the scenes' own vectors and land cover. Bent pictures are not to scale and not for navigation.",
        comment: "space is bent unless a panel says straight; not to scale, not for navigation",
        entries: &FIGURES,
    };
    set.draw(folder, options, scale, overwrite)
}
