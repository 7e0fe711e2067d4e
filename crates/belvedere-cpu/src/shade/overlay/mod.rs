//! Areas and drapes over the ground.

pub(crate) mod area;
pub(crate) mod drape;
