//! Outputs: never written over an input, over an existing file only on request, and never left half written.

use crate::BelvedereError;
use crate::scene_file::Document;
use belvedere_io::{fs, split_table};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Returns an error if `path` is one of `inputs`, exists while `overwrite` is false, or cannot be created. Call it before long work.
///
/// # Errors
/// [`BelvedereError::Output`], [`BelvedereError::Io`].
pub fn check(path: &Path, inputs: &[PathBuf], overwrite: bool) -> Result<(), BelvedereError> {
    if let Ok(real) = fs::canonicalize(path)
        && inputs.iter().any(|input| fs::canonicalize(split_table(input).0).is_ok_and(|input| input == real))
    {
        return Err(BelvedereError::Output {
            path: path.to_owned(),
            reason: "is an input of this command and is never written; choose another output".into(),
        });
    }
    Ok(belvedere_io::atomic::check_output(path, overwrite)?)
}

/// `value` as JSON, one line, ending in a newline; numbers round-trip exactly.
///
/// # Errors
/// [`BelvedereError::Text`] if a map has keys that are not strings, which does not occur in reports.
pub fn json<T: Serialize>(value: &T) -> Result<String, BelvedereError> {
    let text =
        serde_json::to_string(value).map_err(|e| BelvedereError::Text { what: "the report", reason: e.to_string() })?;
    Ok(text + "\n")
}

/// Writes a text as a whole or not at all.
///
/// # Errors
/// [`BelvedereError::Io`].
pub fn write_text(path: &Path, text: &str, overwrite: bool) -> Result<(), BelvedereError> {
    Ok(belvedere_io::atomic::write_atomic(path, overwrite, |out| out.write_all(text.as_bytes()))?)
}

/// A document as TOML.
///
/// # Errors
/// [`BelvedereError::Text`], which does not occur for valid documents.
pub fn document_toml(document: &Document) -> Result<String, BelvedereError> {
    toml::to_string(document).map_err(|e| BelvedereError::Text { what: "the document", reason: e.to_string() })
}

/// A document as JSON, indented.
///
/// # Errors
/// As [`document_toml`].
pub fn document_json(document: &Document) -> Result<String, BelvedereError> {
    pretty(document)
}

/// The JSON Schema of scene documents.
///
/// # Errors
/// As [`document_toml`].
pub fn schema_json() -> Result<String, BelvedereError> {
    pretty(&schemars::schema_for!(Document))
}

/// `value` as indented JSON, ending in a newline.
///
/// # Errors
/// As [`json`].
pub fn pretty<T: Serialize>(value: &T) -> Result<String, BelvedereError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| BelvedereError::Text { what: "the document", reason: e.to_string() })?;
    Ok(text + "\n")
}
