//! Curved rays: laws, and agreement with references that share no formula with the library.

mod acceptance;
mod bounds;
mod cameras;
mod chains;
mod every_ray;
mod laws;
mod literal;
mod mend;
mod pieces;
mod scene_example;
mod validity;
