//! Integration tests of belvedere-disocclusion.

mod coarse;
mod coming;
mod fallbacks;
mod live;
mod qp;
mod smooth;
mod smoothing;
mod trends;
mod viewpoint;
