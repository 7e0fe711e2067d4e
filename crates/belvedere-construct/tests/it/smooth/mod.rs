//! The smooth pass against dense matrices.

mod hierarchy;
mod pass;
mod support;
mod transform;
