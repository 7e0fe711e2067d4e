//! Laws and references for the mathematics.

mod spline_figures;
