//! The quadratic program of terrain disocclusion.

mod cases;
mod reference;
mod small;
