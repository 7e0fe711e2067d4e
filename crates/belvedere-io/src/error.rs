//! Errors of reading and writing files.

use std::path::PathBuf;

/// A file that could not be read or written. One sentence: file, what is wrong, measured value, limit, what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system refused.
    #[error("{}: {}", path.display(), said(source))]
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

/// An error of the operating system in words that need no knowledge of it.
pub fn said(error: &std::io::Error) -> String {
    use std::io::ErrorKind;
    match error.kind() {
        // Errors of our own, as of archives, have texts of their own.
        _ if error.get_ref().is_some() => error.to_string(),
        ErrorKind::NotFound => "there is no such file; check the name".into(),
        ErrorKind::IsADirectory => "is a folder; give a file".into(),
        ErrorKind::NotADirectory => "a part of the path is a file where a folder is needed; check the name".into(),
        ErrorKind::AlreadyExists => "there is a file of this name; give a folder".into(),
        ErrorKind::PermissionDenied => "access is denied; change its permissions, or choose another place".into(),
        ErrorKind::StorageFull => "the disk is full; free some space, or choose another place".into(),
        _ => {
            let text = error.to_string();
            text.split_once(" (os error").map_or(text.as_str(), |(text, _)| text).to_owned()
        }
    }
}

/// Why a text is not valid JSON.
pub fn json_fault(error: &serde_json::Error) -> String {
    if error.is_eof() {
        return format!("it ends too early, on line {}: a bracket or quote is not closed", error.line().max(1));
    }
    error.to_string()
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
