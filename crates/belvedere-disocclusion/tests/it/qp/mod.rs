//! The quadratic program of terrain disocclusion.

mod bars;
mod bent;
mod cases;
mod proof;
mod reference;
mod small;
