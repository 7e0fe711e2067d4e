//! Tests of the built-in scenes.

mod builtin;
mod route;
mod town;
