//! Integration tests of belvedere-construct.

mod bars;
mod coarse;
mod coming;
mod fallbacks;
mod flight;
mod live;
mod measure;
mod qp;
mod reveal;
mod sight;
mod smooth;
mod smoothing;
mod synthetic;
mod trends;
mod viewpoint;
