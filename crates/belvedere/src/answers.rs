//! Answers of verbs as JSON: one shape on standard output and in report files. Their schemas are in [`crate::verbs::schemas`].

use crate::{BelvedereError, output};
use belvedere_core::Warning;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// What stands in an answer: anything that serialises as a JSON object.
pub trait Content: Serialize {}

impl<T: Serialize> Content for T {}

/// Answer of a verb.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Answer<T> {
    /// The verb.
    pub verb: &'static str,
    /// Files that were written: as the user named them on standard output, by their bare names in a file. The program's answer in a
    /// file names itself.
    pub outputs: Vec<String>,
    /// Its content.
    #[serde(flatten)]
    pub content: T,
}

/// Content that has no warnings of its own, with warnings.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct Warned<T> {
    /// The content.
    #[serde(flatten)]
    pub content: T,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// Content of a verb that writes files and answers nothing else.
#[derive(Debug, Clone, Default, JsonSchema, Serialize)]
pub struct Written {
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// The answer of a verb as one line of JSON.
///
/// # Errors
/// [`BelvedereError::Text`], which does not occur.
pub fn line(verb: &'static str, outputs: &[PathBuf], content: &impl Content) -> Result<String, BelvedereError> {
    let outputs = outputs.iter().map(|path| path.display().to_string()).collect();
    output::json(&Answer { verb, outputs, content })
}

/// The answer of a verb as a file holds it: indented, with bare names of files.
///
/// # Errors
/// As [`line()`].
pub fn in_file(verb: &'static str, outputs: &[PathBuf], content: &impl Content) -> Result<String, BelvedereError> {
    output::pretty(&Answer { verb, outputs: bare(outputs), content })
}

/// The same on one line, for answers that may be long.
///
/// # Errors
/// As [`line()`].
pub fn line_in_file(verb: &'static str, outputs: &[PathBuf], content: &impl Content) -> Result<String, BelvedereError> {
    output::json(&Answer { verb, outputs: bare(outputs), content })
}

fn bare(outputs: &[PathBuf]) -> Vec<String> {
    outputs.iter().map(|path| path.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect()
}
