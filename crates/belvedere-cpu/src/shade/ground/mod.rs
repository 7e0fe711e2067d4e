//! Colour of the ground: light that is fixed to the map, computed node by node in tiles of a mip pyramid and remembered.

pub(crate) mod batch;
mod displaced;
mod edge;
pub(crate) mod grain;
pub(crate) mod lit;
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
