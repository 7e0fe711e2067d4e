//! The words of the window in the language of its user.

use std::fmt::Display;

/// The words for `english` in the user's language.
pub(crate) fn tr(english: &'static str) -> &'static str {
    english
}

/// `pattern` with `{0}`, `{1}`, … replaced by the values, so that languages may order them as they like.
pub(crate) fn fill(pattern: &str, values: &[&dyn Display]) -> String {
    let mut out = pattern.to_owned();
    for (i, value) in values.iter().enumerate() {
        out = out.replace(&format!("{{{i}}}"), &value.to_string());
    }
    out
}
