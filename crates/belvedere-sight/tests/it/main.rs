//! Tests of belvedere-sight.

mod obstacles;
