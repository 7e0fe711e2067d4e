//! The verbs of the command line as functions.

pub mod check;
pub mod output;
pub mod points;
pub mod render;
