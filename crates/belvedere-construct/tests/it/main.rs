//! Integration tests of belvedere-construct.

mod bars;
mod flight;
mod live;
mod measure;
mod qp;
mod reveal;
mod sight;
mod smooth;
mod synthetic;
mod trends;
mod viewpoint;
