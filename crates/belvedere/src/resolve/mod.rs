//! From a document to a scene and a view.

mod boxes;
pub(crate) mod builtin;
mod camera;
pub(crate) mod delta;
mod dem;
mod drape;
pub(crate) mod ground;
mod layers;
mod light;
mod loader;
mod mesh;
mod rays;
pub(crate) mod stages;
pub(crate) mod terrain;
pub(crate) mod validate;
pub(crate) mod vectors;
pub(crate) mod view;

pub(crate) use layers::{LayerRequest, fill_surfaces, load};
