//! Integration tests of belvedere-construct.

mod bars;
mod centreline;
mod flight;
mod measure;
mod preview;
mod reveal;
mod surfaces;
mod tracking;
