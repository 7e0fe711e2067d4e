//! Colour of the ground: light that is fixed to the map, computed node by node in tiles of a mip pyramid and remembered.

pub(crate) mod batch;
pub(crate) mod broad;
mod displaced;
mod edge;
mod finer;
pub(crate) mod lit;
mod made;
mod patch;
mod planes;
mod rows;
pub(crate) mod sample;
mod shadow;
pub(crate) mod surface;
pub(crate) mod terrain;
mod texture;
pub(crate) mod tiles;
mod upsample;
