//! The quadratic program of terrain disocclusion.

mod bars;
mod bent;
mod cases;
mod reference;
mod rescue;
mod small;
