//! Errors of documents and of the files that they name.

use belvedere_io::LiftedBy;
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
        /// The key at fault, without those of the tables around it; `None` for the document as a whole.
        key: Option<String>,
        /// The refusal of a file that the document names.
        source: Option<Box<DocumentError>>,
    },
    /// A file that was given as a document and holds something else.
    #[error("{}: is {held}, not {wanted}", path.display())]
    OtherKind {
        /// The file.
        path: PathBuf,
        /// Its format and content.
        held: String,
        /// What was asked for.
        wanted: DocumentKind,
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

/// Kinds of documents.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DocumentKind {
    /// A scene.
    Scene,
    /// Presets.
    Presets,
    /// A list of points or pixels, in words.
    List(String),
}

impl std::fmt::Display for DocumentKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Scene => "a scene document",
            Self::Presets => "a preset document",
            Self::List(words) => words,
        })
    }
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
    /// What lifts it, where a file or the memory is at fault.
    pub fn lifted_by(&self) -> LiftedBy {
        match self {
            Self::Io(error) => error.lifted_by(),
            Self::Scene { source: Some(source), .. } => source.lifted_by(),
            _ => LiftedBy::default(),
        }
    }

    /// The refusal of a name that is no UTF-8.
    pub fn not_utf8(name: &str) -> Self {
        Self::Path { name: name.to_owned(), reason: "is not UTF-8; rename it".into(), root_missing: false }
    }
}
