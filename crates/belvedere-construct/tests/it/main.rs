//! Integration tests of belvedere-construct.

mod bars;
mod centreline;
mod flight;
mod generalise;
mod generalise_towns;
mod measure;
mod preview;
mod probe;
mod reveal;
mod surfaces;
mod tracking;
