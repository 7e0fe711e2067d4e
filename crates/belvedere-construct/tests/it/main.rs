//! Integration tests of belvedere-construct.

mod bars;
mod flight;
mod measure;
mod reveal;
mod tracking;
