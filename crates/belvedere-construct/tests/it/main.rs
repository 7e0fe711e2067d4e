//! Integration tests of belvedere-construct.

mod bars;
mod centreline;
mod flight;
mod generalise;
mod generalise_coverage;
mod generalise_towns;
mod ground_moves;
mod measure;
mod preview;
mod preview_foreground;
mod probe;
mod reveal;
mod reveal_views;
mod rigid;
mod surfaces;
mod tracking;
mod tracking_molecule;
mod wall;
