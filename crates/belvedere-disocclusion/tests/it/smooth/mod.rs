//! The smooth pass against dense matrices.

mod cholesky;
mod hierarchy;
mod pass;
mod support;
mod transform;
