//! The smooth pass against dense matrices.

mod hierarchy;
mod support;
mod transform;
