//! From a document to a scene and a view.

mod areas;
mod boxes;
pub(crate) mod builtin;
mod camera;
mod centreline;
mod city;
pub(crate) mod constructor;
pub(crate) mod delta;
mod dem;
pub(crate) mod ground;
mod layers;
mod light;
mod loader;
mod mesh;
mod molecule;
pub(crate) mod motion;
mod path;
pub(crate) mod rays;
mod relief;
pub(crate) mod representations;
mod sea;
pub(crate) mod stages;
mod strip;
pub(crate) mod terrain;
mod transfer;
pub(crate) mod validate;
pub(crate) mod vectors;
pub(crate) mod view;
pub(crate) mod volume;
pub(crate) mod wall;

pub(crate) use areas::{fill_surfaces, restyle};
pub(crate) use layers::{LayerRequest, load};
pub(crate) use strip::StripReport;
