//! The file system that everything is read from and written to: the system's own, or in a browser files in memory, by the same names.

#[cfg(not(target_family = "wasm"))]
pub use std::fs::{File, canonicalize, metadata, read, read_to_string, symlink_metadata};

#[cfg(target_family = "wasm")]
pub use memory::{File, Metadata, canonicalize, metadata, read, read_to_string, remove_file, symlink_metadata, write};

#[cfg(any(test, target_family = "wasm"))]
#[cfg_attr(not(target_family = "wasm"), allow(dead_code, unreachable_pub))]
mod memory;
