//! From triangles on the image to pixels: bands of rows, and the nearest primitive at every sample.

pub(crate) mod band;
pub(crate) mod cells;
pub(crate) mod thin;
pub(crate) mod triangle;
