//! What a loader returns.

use crate::InputFile;
use std::path::PathBuf;

/// A value, the warnings of reading it, and what was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded<T> {
    /// The value.
    pub value: T,
    /// One sentence each: what was odd, measured value, what was done about it.
    pub warnings: Vec<String>,
    /// The files that were read for it, by the same reading.
    pub files: Vec<InputFile>,
}

impl<T> Loaded<T> {
    /// A value without warnings.
    pub fn clean(value: T) -> Self {
        Self::new(value, Vec::new())
    }

    /// A value with warnings.
    pub fn new(value: T, warnings: Vec<String>) -> Self {
        Self { value, warnings, files: Vec::new() }
    }

    /// This, read from another file.
    pub fn with_file(mut self, file: InputFile) -> Self {
        self.files.push(file);
        self
    }

    /// Applies `f` to the value, keeping the rest.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Loaded<U> {
        Loaded { value: f(self.value), warnings: self.warnings, files: self.files }
    }
}

/// A file that could not be read or written. One sentence: file, what is wrong, measured value, limit, what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Os {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The content is not what the format demands.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong, with measured value, limit and remedy.
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
