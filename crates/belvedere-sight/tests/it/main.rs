//! Tests of belvedere-sight.

mod bodies;
mod displaced;
mod near;
mod obstacles;
