//! Mistakes in documents: the line, the keys that lead there, and words that need no knowledge of the program's types.

use crate::DocumentError;
use serde::de::{self, Expected, Unexpected};
use std::path::Path;

/// A mistake in a document: where and what.
#[derive(Debug, Clone, PartialEq)]
pub struct DocError {
    /// Line, 1-based, if known.
    pub line: Option<usize>,
    /// Keys from the outside in, innermost first while the error travels outwards.
    path: Vec<String>,
    /// What is wrong and what to do.
    message: String,
}

impl DocError {
    /// A mistake on a line.
    pub fn at(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), path: Vec::new(), message: message.into() }
    }

    /// A mistake of the whole document.
    pub fn whole(message: impl Into<String>) -> Self {
        Self { line: None, path: Vec::new(), message: message.into() }
    }

    /// The error of the file that holds the document.
    pub fn in_file(&self, path: &Path) -> DocumentError {
        let (path, key) = (Some(path.to_owned()), self.path.first().cloned());
        DocumentError::Scene { path, line: self.line, reason: self.to_string(), key, source: None }
    }

    /// This error one key further out.
    pub fn inside(mut self, key: impl Into<String>) -> Self {
        self.path.push(key.into());
        self
    }

    pub(super) fn or_line(mut self, line: usize) -> Self {
        self.line.get_or_insert(line);
        self
    }
}

impl std::fmt::Display for DocError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.path.is_empty() {
            let path: Vec<&str> = self.path.iter().rev().map(String::as_str).collect();
            write!(f, "{}: ", path.join("."))?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for DocError {}

impl de::Error for DocError {
    fn custom<T: std::fmt::Display>(msg: T) -> Self {
        Self { line: None, path: Vec::new(), message: msg.to_string() }
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::custom(format!("{} was expected, found {}", plain(expected), words(found)))
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::custom(format!("{} was expected, found {}", plain(expected), words(found)))
    }

    fn invalid_length(len: usize, expected: &dyn Expected) -> Self {
        Self::custom(format!("{} was expected, found a list of {len}", plain(expected)))
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::custom(format!("unknown key \"{}\"; {}", shorten(field), suggestion(field, expected)))
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::custom(format!("\"{}\" is not one of the choices; {}", shorten(variant), suggestion(variant, expected)))
    }

    fn missing_field(field: &'static str) -> Self {
        Self::custom(format!("key \"{field}\" is missing; add it"))
    }

    fn duplicate_field(field: &'static str) -> Self {
        Self::custom(format!("key \"{field}\" is given twice; keep one"))
    }
}

/// What was expected, in words that need no knowledge of the program's types.
fn plain(expected: &dyn Expected) -> String {
    let text = expected.to_string();
    match text.as_str() {
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of at least 0".into(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".into(),
        "f32" | "f64" => "a number".into(),
        "a string" => "a text".into(),
        "a boolean" => "true or false".into(),
        other => match other.strip_prefix("an array of length ") {
            Some(length) => format!("a list of {length}"),
            None if other.starts_with("struct ") => "a table".into(),
            None => text.replace(" | ", " or "),
        },
    }
}

fn words(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Bool(b) => format!("{b}"),
        Unexpected::Unsigned(n) => format!("the number {n}"),
        Unexpected::Signed(n) => format!("the number {n}"),
        Unexpected::Float(n) => format!("the number {n}"),
        Unexpected::Str(s) => format!("the text \"{}\"", shorten(s)),
        Unexpected::Seq => "a list".into(),
        Unexpected::Map => "a table".into(),
        Unexpected::Unit => "null".into(),
        other => other.to_string(),
    }
}

/// Names that are listed at most.
const MOST_NAMED: usize = 40;

/// "did you mean ...?" with the nearest of `valid`, or the list of them.
pub fn suggestion(given: &str, valid: &[&str]) -> String {
    let given = given.to_lowercase();
    let best = valid
        .iter()
        .map(|v| (strsim::damerau_levenshtein(&given, v), *v))
        .min_by_key(|(d, _)| *d)
        .filter(|(d, v)| *d <= 1 + v.len().max(given.len()) / 3);
    let begun = valid.iter().find(|v| given.len() >= 3 && v.starts_with(&given)).map(|v| (0, *v));
    let best = best.filter(|(d, _)| *d <= 1).or(begun).or(best);
    match best {
        Some((_, v)) => format!("did you mean \"{v}\"?"),
        None if valid.is_empty() => "none is possible here".into(),
        None if valid.len() > MOST_NAMED => {
            format!("possible: {} and {} more", valid[..MOST_NAMED].join(", "), valid.len() - MOST_NAMED)
        }
        None => format!("possible: {}", valid.join(", ")),
    }
}

/// `text` cut to a length that fits a message.
pub(crate) fn shorten(text: &str) -> String {
    let clean: String = belvedere_core::plain::escaped(text).chars().take(61).collect();
    if clean.chars().count() > 60 { clean.chars().take(57).chain("...".chars()).collect() } else { clean }
}
