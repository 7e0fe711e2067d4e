//! Pages and figures made with Belvedere: the demo, the figures of the papers drawn again on open data, and those of
//! docs/algorithms.

mod algorithms;
mod chart;
mod chart_canvas;
mod compare;
mod curved;
mod demo;
mod easel;
mod figure_set;
mod guide;
mod html;
mod sheet;
mod spline;
mod terrain;

pub use algorithms::figures as algorithm_figures;
pub use compare::figures as compare_figures;
pub use curved::figures as curved_figures;
pub use demo::{DemoScene, SCENES, demo};
pub use guide::figures as guide_figures;
pub use spline::figures as spline_figures;
pub use terrain::figures as terrain_figures;
