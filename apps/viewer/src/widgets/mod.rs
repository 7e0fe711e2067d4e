//! Controls of our own: each shows a value and returns what the user wants of it.

pub(crate) mod curve;
pub(crate) mod overhead;
pub(crate) mod ruler;
