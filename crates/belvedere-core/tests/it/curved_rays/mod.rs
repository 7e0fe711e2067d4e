//! Curved rays: laws, and agreement with references that share no formula with the library.

mod cameras;
mod laws;
mod scene_example;
