//! Integration tests of belvedere-construct.

mod measure;
mod reveal;
mod sight;
mod synthetic;
