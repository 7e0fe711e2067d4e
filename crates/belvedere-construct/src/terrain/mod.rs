//! Terrain that makes way: the ground moves as little as possible so that what must be seen is seen.
//!
//! After Deng et al. 2013 (*Occlusion-free mountain navigation*): a greedy pass and a smooth one; and a quadratic program
//! that guarantees what those two only try.

mod field;
mod settings;

pub use field::{Field, FieldError};
pub use settings::{Detail, SolverMode, TerrainSettings};
