//! Pages and figures made with Belvedere: the demo, the figures of the papers drawn again on open data, and those of
//! docs/algorithms.

mod algorithms;
mod chart;
mod compare;
mod curved;
mod demo;
mod html;
mod sheet;
mod terrain;

pub use algorithms::figures as algorithm_figures;
pub use compare::figures as compare_figures;
pub use curved::figures as curved_figures;
pub use demo::{DemoScene, SCENES, demo};
pub use terrain::figures as terrain_figures;
