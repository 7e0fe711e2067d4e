//! What messages advise, in a form that can be tried.

/// Options that a message names.
pub(super) fn options(said: &str) -> impl Iterator<Item = String> {
    let words = said.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-' || c == '_'));
    let options = words.filter(|word| word.len() > 3 && word.starts_with("--") && !word.starts_with("---"));
    options.map(str::to_owned).collect::<Vec<_>>().into_iter()
}

/// Values that a message offers in place of the wrong one.
pub(super) fn values(said: &str) -> Vec<String> {
    let mut out = Vec::new();
    if let Some((_, rest)) = said.split_once("did you mean \"") {
        out.extend(rest.split('"').next().map(str::to_owned));
    }
    if let Some((_, rest)) = said.split_once(", such as ") {
        let end = rest.find([' ', ';', '\n']).unwrap_or(rest.len());
        out.push(rest[..end].trim_end_matches([',', '.']).trim_matches('"').to_owned());
    }
    for (words, more) in [("greater than ", 1.0), ("at least ", 0.0)] {
        if said.contains("a whole number of at least 0 was expected") {
            break; // The type alone; the range comes next.
        }
        if let Some(least) = said.split_once(words).and_then(|(_, rest)| number(rest)) {
            out.push(format!("{}", least + more));
        }
    }
    if let Some((_, rest)) = said.split_once("strictly between ") {
        let ends = rest.split_once(" and ").and_then(|(low, high)| Some((number(low)?, number(high)?)));
        out.extend(ends.map(|(low, high)| format!("{}", 0.5 * (low + high))));
    }
    if let Some((before, rest)) = said.split_once("..=") {
        let first = before.rsplit([' ', '[', '(']).next().unwrap_or_default();
        let last = rest.split([' ', ';', ',', ')', '\n']).next().unwrap_or_default();
        out.extend([first, last].map(str::to_owned));
    }
    out
}

/// Keys and the values that a message calls the nearest valid ones.
pub(super) fn nearest(said: &str) -> Option<(String, String)> {
    let (_, rest) = said.split_once("the nearest valid ")?;
    let (key, rest) = rest.split_once(" is ")?;
    let value = rest.split_once(']').map(|(value, _)| format!("{value}]"))?;
    let key = key.rsplit(' ').next()?;
    // Keys within a line are not replaced by the test.
    (!key.contains('.')).then(|| (key.to_owned(), value))
}

/// The number that a text begins with.
fn number(text: &str) -> Option<f64> {
    text.split([' ', ';', ',', ')', ']', '\n']).next()?.parse().ok()
}

/// The ending that a message wants for a file.
pub(super) fn ending(said: &str) -> Option<&str> {
    said.split_once("rename it so that it ends in ")?.1.split_whitespace().next()
}

/// Commands of the program that a message gives, without words that stand for something.
pub(super) fn commands(said: &str) -> Vec<String> {
    let ends = |c: char| matches!(c, ';' | '\n' | ',' | ')' | '`');
    let lines = said.split("belvedere ").skip(1).map(|rest| rest.split(ends).next().unwrap_or_default().trim());
    let is_whole =
        |line: &&str| !line.is_empty() && !line.split(' ').any(|word| word.chars().all(|c| c.is_uppercase()));
    lines.filter(is_whole).map(str::to_owned).collect()
}
