//! Loaders and writers, one file per format: bytes in, [`Loaded`] values and warnings out.

mod error;

pub use error::{IoError, Loaded};
