//! Tests of belvedere-scene against independent references.

mod ground;
mod looks;
mod shapes;
