//! Integration tests of belvedere-construct.

mod bars;
mod measure;
mod reveal;
mod sight;
mod synthetic;
