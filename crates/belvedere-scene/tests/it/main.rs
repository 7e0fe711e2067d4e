//! Tests of the scene crate.

mod builtin;
mod route;
