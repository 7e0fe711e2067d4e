//! Files that were given as documents and hold something else.

use crate::{DocumentError, DocumentKind};
use belvedere_io::formats;
use std::io::Read;
use std::path::Path;

/// First bytes that tell a format.
const HEAD: u64 = 64 << 10;

/// The error of a document, or that its file is of another kind.
pub fn explained(path: &Path, wanted: DocumentKind, error: DocumentError) -> DocumentError {
    match error {
        DocumentError::Scene { .. } => instead(path, wanted).unwrap_or(error),
        _ => error,
    }
}

/// That a file is of another kind than a wanted document, if its name or its first bytes tell so.
pub fn instead(path: &Path, wanted: DocumentKind) -> Option<DocumentError> {
    Some(DocumentError::OtherKind { path: path.to_owned(), held: held(path)?, wanted })
}

/// Format and content of a file that is no document, in words.
fn held(path: &Path) -> Option<String> {
    let mut head = Vec::new();
    belvedere_io::fs::File::open(path).ok()?.take(HEAD).read_to_end(&mut head).ok()?;
    let document = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml") || e.eq_ignore_ascii_case("json"));
    // Texts that look like documents are judged as documents.
    if document && !matches!(head.first(), Some(b'<' | b'{')) && std::str::from_utf8(&head).is_ok() {
        return None;
    }
    let by_name = || formats::of_name(path).filter(|_| !document);
    let format = formats::of_content(&head).or_else(|| formats::readable_content(&head)).or_else(by_name)?;
    Some(format!("{} ({})", format.name, format.holds))
}
