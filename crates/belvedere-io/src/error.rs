//! Errors of reading and writing files.

use crate::budget::Refusal;
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
        /// What lifts it.
        lifted_by: LiftedBy,
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

/// What lifts a fault of a file, for applications that name an option of their own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum LiftedBy {
    /// Another file.
    #[default]
    OtherFile,
    /// More memory.
    Memory,
    /// Keys of its layer, of the scene or of the request.
    Keys(&'static [&'static str]),
}

/// Why a file is refused, before it is said which file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    reason: String,
    lifted_by: LiftedBy,
}

impl Fault {
    /// A fault that keys lift.
    pub(crate) fn lifted_by(reason: impl Into<String>, keys: &'static [&'static str]) -> Self {
        Self { reason: reason.into(), lifted_by: LiftedBy::Keys(keys) }
    }

    /// The same with words before it.
    pub(crate) fn placed(self, place: impl std::fmt::Display) -> Self {
        Self { reason: format!("{place}: {}", self.reason), ..self }
    }

    /// Whether more memory lifts it.
    pub(crate) fn is_of_memory(&self) -> bool {
        self.lifted_by == LiftedBy::Memory
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.reason)
    }
}

impl From<String> for Fault {
    fn from(reason: String) -> Self {
        Self { reason, lifted_by: LiftedBy::default() }
    }
}

impl From<&str> for Fault {
    fn from(reason: &str) -> Self {
        reason.to_owned().into()
    }
}

impl From<Refusal> for Fault {
    fn from(refusal: Refusal) -> Self {
        Self { reason: refusal.to_string(), lifted_by: LiftedBy::Memory }
    }
}

/// A fault of a file as one of another that names it.
impl From<IoError> for Fault {
    fn from(error: IoError) -> Self {
        Self { reason: error.to_string(), lifted_by: error.lifted_by() }
    }
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
    pub fn format(path: impl Into<PathBuf>, fault: impl Into<Fault>) -> Self {
        let Fault { reason, lifted_by } = fault.into();
        Self::Format { path: path.into(), reason, lifted_by }
    }

    /// What lifts it.
    pub fn lifted_by(&self) -> LiftedBy {
        match self {
            Self::Format { lifted_by, .. } => *lifted_by,
            Self::Os { source, .. } if source.kind() == std::io::ErrorKind::OutOfMemory => LiftedBy::Memory,
            _ => LiftedBy::default(),
        }
    }

    /// A [`IoError::Os`].
    pub fn os(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Os { path: path.into(), source }
    }
}
