//! The verbs of the command line as functions.

pub mod animate;
pub mod appearance;
pub mod asked;
pub mod check;
mod city_views;
pub mod disocclude;
pub mod drafts;
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
mod refit;
pub mod reveal;
mod reveal_files;
pub mod reveal_target;
pub mod schemas;
mod shares;
mod target_bend;
pub mod target_drafts;
mod target_names;
mod target_request;
mod target_scene;
pub(crate) mod target_views;
mod view_request;
mod written_ground;
mod written_rivers;

pub use target_names::CitySee;
pub use target_scene::hold_a_city;
