//! The words of the window in the language of its user: English in the sources, other languages in tables beside them.

mod heard;

pub(crate) use heard::heard;

use std::cell::Cell;
use std::collections::HashMap;
use std::fmt::Display;
use std::sync::OnceLock;

/// Languages with a table: tag, own name, table.
pub(crate) const LANGUAGES: [(&str, &str, &str); 2] =
    [("de", "Deutsch", include_str!("../languages/de.toml")), ("fr", "Français", include_str!("../languages/fr.toml"))];

thread_local! {
    /// Number of the language that this thread's window speaks; `None`: English.
    static SPOKEN: Cell<Option<usize>> = const { Cell::new(None) };
}

/// Lets [`tr`] on this thread speak the language of a tag such as `de`, `fr-CA` or `de_AT.UTF-8`; English if it has no table.
pub(crate) fn speak(tag: &str) {
    let primary = tag.split(['-', '_', '.', '@']).next().unwrap_or_default().to_ascii_lowercase();
    SPOKEN.set(LANGUAGES.iter().position(|(tag, ..)| *tag == primary));
}

/// The language of the system or the browser as a tag; empty if it states none.
pub(crate) fn of_system() -> String {
    #[cfg(target_family = "wasm")]
    let tag = web_sys::window().and_then(|window| window.navigator().language());
    #[cfg(not(target_family = "wasm"))]
    let tag = ["LC_ALL", "LC_MESSAGES", "LANG"]
        .iter()
        .find_map(|name| std::env::var(name).ok().filter(|tag| !tag.is_empty()));
    tag.unwrap_or_default()
}

/// The words for `english` in the user's language; English where the table lacks them.
///
/// Only for the thread of the window: others ask for the words before they start.
pub(crate) fn tr(english: &'static str) -> &'static str {
    translated(english).unwrap_or(english)
}

/// Marks words as to be translated where they are shown, by [`tr`], since constants cannot be.
pub(crate) const fn later(english: &'static str) -> &'static str {
    english
}

/// The words of the table; `None` in English and where it lacks them.
fn translated(english: &str) -> Option<&'static str> {
    static TABLES: [OnceLock<HashMap<String, String>>; LANGUAGES.len()] = [const { OnceLock::new() }; LANGUAGES.len()];
    let number = SPOKEN.get()?;
    // A broken table leaves the window in English; a test reads all tables.
    let table = TABLES[number].get_or_init(|| toml::from_str(LANGUAGES[number].2).unwrap_or_default());
    table.get(english).map(String::as_str)
}

/// `pattern` with `{0}`, `{1}`, … replaced by the values, so that languages may order them as they like.
pub(crate) fn fill(pattern: &str, values: &[&dyn Display]) -> String {
    let mut out = String::with_capacity(pattern.len() + 16 * values.len());
    let mut rest = pattern;
    while let Some(at) = rest.find('{') {
        let (before, after) = rest.split_at(at);
        out += before;
        let place =
            after[1..].split_once('}').and_then(|(n, behind)| Some((values.get(n.parse::<usize>().ok()?)?, behind)));
        match place {
            Some((value, behind)) => {
                out += &value.to_string();
                rest = behind;
            }
            None => {
                out.push('{');
                rest = &after[1..];
            }
        }
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_where_the_language_wants_them_and_braces_in_values_stay() {
        assert_eq!(fill("{1} of {0}", &[&"a", &"{0}"]), "{0} of a");
        assert_eq!(fill("{2} {x} {", &[&1]), "{2} {x} {");
    }

    #[test]
    fn tags_of_systems_choose_a_table() {
        for (tag, save) in [("de_CH.UTF-8", "Speichern"), ("fr-CA", "Enregistrer"), ("C.UTF-8", "Save"), ("", "Save")] {
            speak(tag);
            assert_eq!(tr("Save"), save, "{tag}");
        }
        speak("de");
        assert_eq!(heard("renamed way to path"), "way in path umbenannt");
        assert_eq!(heard("removed way, and more"), "way entfernt und mehr");
        assert_eq!(heard("error: no such file"), "error: no such file");
        speak("");
    }
}
