//! Names of input files.

use std::path::{Path, PathBuf};

/// A path as text.
pub(crate) fn as_text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// Refuses files that do not exist.
pub(crate) fn exist(files: &[PathBuf]) -> anyhow::Result<()> {
    for file in files {
        let is_there = belvedere::io::split_table(file).0.exists();
        anyhow::ensure!(is_there, "{}: there is no such file; check the name", file.display());
    }
    Ok(())
}
