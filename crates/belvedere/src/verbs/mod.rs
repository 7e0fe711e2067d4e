//! The verbs of the command line as functions.

pub mod animate;
mod buffers;
pub mod check;
pub mod disocclude;
pub mod info;
pub mod measure;
pub mod output;
pub mod pick;
pub mod points;
pub mod render;
pub mod reveal;
