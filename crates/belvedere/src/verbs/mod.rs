//! The verbs of the command line as functions.

pub mod animate;
pub mod check;
pub mod disocclude;
pub mod generalise;
mod in_time;
pub mod info;
mod level_lakes;
pub mod measure;
mod molecule_info;
pub mod pack;
pub mod pick;
pub mod points;
pub mod preset;
pub mod reveal;
pub mod reveal_target;
pub mod target_place;
mod written_rivers;
