//! Integration tests of belvedere-construct.

mod measure;
mod sight;
mod synthetic;
