//! The verbs of the command line as functions.

pub mod animate;
pub mod asked;
mod certificate;
pub mod check;
mod city_names;
pub mod disocclude;
mod found_view;
pub mod generalise;
mod in_time;
pub mod info;
mod level_lakes;
pub mod measure;
mod model_layers;
mod molecule_info;
pub mod moved;
pub mod open_files;
pub mod pack;
pub mod points;
pub mod preset;
pub mod reveal;
pub mod schemas;
mod shares;
mod written_ground;
mod written_rivers;

pub use city_names::CitySee;
