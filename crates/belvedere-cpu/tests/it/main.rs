//! Tests of the processor renderer against slow, independent references.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod real_data;
mod support;
