//! What is laid over the ground: areas and pictures.

pub(crate) mod area;
pub(crate) mod drape;
