//! Tests of belvedere-scene against independent references.

mod ground;
mod line_colors;
mod looks;
mod shapes;
