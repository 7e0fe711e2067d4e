//! Surfaces as triangles on the image: which blocks are drawn and in how much detail, displaced, projected, subdivided, clipped.

pub(crate) mod block;
pub(crate) mod blocks;
pub(crate) mod box_blocks;
pub(crate) mod drawn_solids;
pub(crate) mod grid;
mod layer_show;
pub(crate) mod locate;
pub(crate) mod lod;
mod mesh_blocks;
pub(crate) mod part;
pub(crate) mod pass;
pub(crate) mod project;
mod refine;
mod select;
mod spline_from_eye;
mod terrain_blocks;
