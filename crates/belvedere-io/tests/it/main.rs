//! Tests of the loaders and writers.

mod atomic;
mod crs;
mod png;
