//! Tests of the loaders and writers.

mod atomic;
mod crs;
mod geotiff;
mod png;
