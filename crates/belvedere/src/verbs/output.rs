//! Outputs: never over an input, never over an existing file unasked, never half written.

use crate::BelvedereError;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Fails at once if `path` is one of `inputs`, or exists and `overwrite` is false, or cannot exist. Ask before long work.
///
/// # Errors
/// [`BelvedereError::Output`], [`BelvedereError::Io`].
pub fn check(path: &Path, inputs: &[PathBuf], overwrite: bool) -> Result<(), BelvedereError> {
    if let Ok(real) = path.canonicalize()
        && inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == real))
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
/// [`BelvedereError::Usage`] if a map has keys that are no texts, which no report has.
pub fn json<T: Serialize>(value: &T) -> Result<String, BelvedereError> {
    let text = serde_json::to_string(value)
        .map_err(|e| BelvedereError::Usage(format!("the report cannot be written as JSON: {e}")))?;
    Ok(text + "\n")
}

/// Writes a text in one piece.
///
/// # Errors
/// [`BelvedereError::Io`].
pub fn write_text(path: &Path, text: &str, overwrite: bool) -> Result<(), BelvedereError> {
    Ok(belvedere_io::atomic::write_atomic(path, overwrite, |out| out.write_all(text.as_bytes()))?)
}
