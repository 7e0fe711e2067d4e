//! Curved rays: laws, and agreement with references that share no formula with the library.

pub(crate) mod cameras;
mod laws;
mod scene_example;
