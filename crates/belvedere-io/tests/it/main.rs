//! Tests of the loaders and writers.

mod crs;
