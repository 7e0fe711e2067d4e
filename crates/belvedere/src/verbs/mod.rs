//! The verbs of the command line as functions.

pub mod animate;
pub mod bench;
mod bench_flight;
mod bench_smooth;
mod buffers;
pub mod check;
pub mod demo;
pub mod disocclude;
pub mod figures;
mod html;
pub mod info;
pub mod measure;
pub mod output;
pub mod pick;
pub mod points;
pub mod render;
pub mod reveal;
