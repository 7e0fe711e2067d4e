//! Errors of reading and writing files.

use std::path::PathBuf;

/// A file that could not be read or written. One sentence: file, what is wrong, measured value, limit, what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Os {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The content is not what the format demands.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The fault, with measured value, limit and remedy.
        reason: String,
    },
    /// An output exists and may not be replaced.
    #[error("{}: exists already and may not be replaced", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] belvedere_scene::Cancelled),
}

impl IoError {
    /// A [`IoError::Format`].
    pub fn format(path: impl Into<PathBuf>, reason: impl Into<String>) -> Self {
        Self::Format { path: path.into(), reason: reason.into() }
    }

    /// A [`IoError::Os`].
    pub fn os(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Os { path: path.into(), source }
    }
}
