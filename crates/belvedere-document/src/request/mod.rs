//! Requests of verbs as data: each option is written once, as a field with its help.
//!
//! A field of a request is the key of its JSON form, the option of the command line (feature `clap`), an argument in Python, and a line of
//! the schema. Doors add only what is theirs, such as names of outputs.

mod animate;
#[cfg(feature = "clap")]
mod args;
mod disocclude;
mod drawing;
mod ground;
mod line_class;
mod look;
mod molecule;
mod options;
mod others;
mod panorama;
mod paper;
mod render;
mod reveal;
mod straighten;
#[cfg_attr(not(feature = "clap"), allow(dead_code, unreachable_pub))]
mod value;

pub use crate::renderer::RendererName;
pub use animate::Animate;
#[cfg(feature = "clap")]
pub use args::one_of;
pub use disocclude::{Disocclude, Robust, WrittenGrid};
pub use drawing::Drawing;
pub use ground::{OfData, Stated, StatedRaster};
pub use line_class::class_of_file;
pub use look::{Air, Furnishing, FurnitureItems, Look};
pub use molecule::Molecules;
pub use options::{Request, WITH_REQUEST, given_of, options, read, schema};
pub use others::{Export, Generalise, Measure};
pub use panorama::Panorama;
pub use paper::Paper;
pub use render::{AuxBuffer, AuxFormat, Outside, Render};
pub use reveal::{Reveal, Technique};
pub use straighten::{Straighten, StraightenedLine};
pub use value::EXAGGERATION;

/// Parsers of values of options that requests and doors have in common.
#[cfg(feature = "clap")]
pub mod parse {
    pub use super::value::{number, samples, size, spacing, with_height};
}
