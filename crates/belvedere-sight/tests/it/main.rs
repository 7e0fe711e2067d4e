//! Tests of belvedere-sight.

mod near;
mod obstacles;
