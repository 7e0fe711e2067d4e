//! From triangles on the image to pixels: bands of rows, the nearest primitive at every sample, and what a pixel makes of its samples.

pub(crate) mod band;
pub(crate) mod cells;
pub(crate) mod pixel_center;
pub(crate) mod relief;
pub(crate) mod resolve;
pub(crate) mod thin;
pub(crate) mod triangle;
