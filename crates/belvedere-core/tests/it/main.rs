//! Laws and references for the mathematics.

mod curved_rays;
mod spline_figures;
mod views;
