//! Errors of documents and of the files that they name.

use std::path::PathBuf;

/// A document that cannot be read, or that names a file which it may not use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// A mistake in a scene, preset or other text document.
    #[error("{}{}{reason}", path.as_ref().map(|p| p.display().to_string()).unwrap_or_default(), at_line(path.is_some(), *line))]
    Scene {
        /// The document; `None` for one that was made in memory.
        path: Option<PathBuf>,
        /// Line of the mistake, 1-based.
        line: Option<usize>,
        /// What is wrong: the measured value, the limit, and what to do.
        reason: String,
        /// The refusal of a file that the document names.
        source: Option<Box<DocumentError>>,
    },
    /// A file name that a scene may not use.
    #[error("path \"{name}\" {reason}")]
    Path {
        /// The name as given.
        name: String,
        /// Why it is refused and what to do.
        reason: String,
        /// Whether another allowed folder can lift the refusal.
        root_missing: bool,
    },
    /// A palette that is neither built in nor a file.
    #[error("{0}")]
    Palette(String),
    /// A file that cannot be read.
    #[error(transparent)]
    Io(#[from] belvedere_io::IoError),
}

/// `:12: ` after the name of a document; empty for a document without a name.
fn at_line(named: bool, line: Option<usize>) -> String {
    match (named, line) {
        (true, Some(line)) => format!(":{line}: "),
        (true, None) => ": ".into(),
        (false, _) => String::new(),
    }
}

impl DocumentError {
    /// The refusal of a name that is no UTF-8.
    pub fn not_utf8(name: &str) -> Self {
        Self::Path { name: name.to_owned(), reason: "is not UTF-8; rename it".into(), root_missing: false }
    }
}
