//! Laws and references for the mathematics.

mod curved_rays;
mod eased;
mod ground_moves;
mod preset_angles;
mod preset_edit;
mod preset_sweeps;
mod presets;
mod relief;
mod rigid;
mod spline_bend;
mod spline_bounds;
mod spline_curve;
mod spline_figures;
mod split_rays;
mod strip;
mod terrain;
mod tube;
mod unroll;
mod views;
