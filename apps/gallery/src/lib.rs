//! Pages and figures made with Belvedere: the demo, and the figures of the papers drawn again on open data.

mod chart;
mod demo;
mod html;
mod sheet;
mod terrain;

pub use demo::{DemoScene, SCENES, demo};
pub use terrain::figures as terrain_figures;
