//! The file system that everything is read from and written to: the system's own, or in a browser files in memory, by the same names.
//! Paths lead into archives, too: see `packed`.

#[cfg(not(target_family = "wasm"))]
use std::fs as plain;

#[cfg(target_family = "wasm")]
use memory as plain;

#[cfg(target_family = "wasm")]
pub use memory::{remove_file, write};

pub use beside::shelf;
pub(crate) use beside::{beside, percent_decoded, read_sidecar, sidecar, spellings};
pub use packed::{File, Metadata, canonicalize, metadata, read, read_to_string, symlink_metadata};
pub(crate) use packed::{archive_of, names_in, unpacked_size};

mod beside;
mod bounded;
#[cfg(any(test, target_family = "wasm"))]
#[cfg_attr(not(target_family = "wasm"), allow(dead_code, unreachable_pub))]
mod memory;
mod packed;
mod regular;
