//! Every reader of the program under mutated files.
//!
//! [`readers::READERS`] lists the readers: each takes bytes as the content of one file, opens it as a user would (through the
//! facade), and draws a small picture of it. [`seeds`] makes valid files for each, [`mutate`] damages them by seed, and
//! [`campaign`] runs many and reports panics, hangs and readers that take too much memory. [`bombs`] are small files that ask for much memory. The fuzz targets in `fuzz/` at the root
//! of the repository call the same functions.

pub mod bombs;
pub mod campaign;
pub mod mutate;
pub mod readers;
pub mod seeds;
pub mod watch;
