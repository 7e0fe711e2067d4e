//! Integration tests of belvedere-disocclusion.

mod coarse;

mod entering;
mod fallbacks;
mod lakes;
mod likeness;
mod live;
mod memory;
mod one_judge;
mod price;
mod qp;
mod rivers;
mod smooth;
mod smoothing;
mod time_limit;
mod trends;
mod viewpoint;
mod written;
