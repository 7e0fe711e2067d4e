//! Texts in the sources of the application: those that `tr` and `later` pass to the tables, and those on controls that they do not.

use std::path::{Path, PathBuf};

/// A text of the sources.
pub(crate) struct Literal {
    pub(crate) text: String,
    pub(crate) file: String,
    pub(crate) line: usize,
}

/// Name and text of each source file, without its unit tests.
pub(crate) fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut folders, mut files) = (vec![root.clone()], Vec::<PathBuf>::new());
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).expect("folder").flatten().map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") && !path.ends_with("tests.rs") {
                files.push(path);
            }
        }
    }
    files.sort();
    let read = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).expect("source");
        let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default().to_owned();
        (format!("src/{}", path.strip_prefix(&root).expect("inside").display()).replace('\\', "/"), code)
    };
    files.iter().map(read).collect()
}

/// Calls whose texts are shown, when they come first among the arguments.
const SHOWS: [&str; 14] = [
    ".label(",
    ".button(",
    ".small_button(",
    ".weak(",
    ".strong(",
    ".heading(",
    ".on_hover_text(",
    ".on_disabled_hover_text(",
    ".menu_button(",
    "ComboBox::from_label(",
    "CollapsingHeader::new(",
    "Window::new(",
    "Button::new(",
    ".tell(",
];

/// The texts within calls of `tr` and `later`.
pub(crate) fn translated(file: &str, code: &str) -> Vec<Literal> {
    within(file, code, |before| {
        ["tr(", "later("].iter().any(|call| {
            let start = before.strip_suffix(call);
            start.is_some_and(|start| !start.ends_with(|c: char| c.is_alphanumeric() || c == '_'))
        })
    })
}

/// Texts with words that stand directly in a call that shows them.
pub(crate) fn untranslated(file: &str, code: &str) -> Vec<Literal> {
    let mut found = Vec::new();
    for call in SHOWS {
        for (at, _) in code.match_indices(call) {
            let argument = code[at + call.len()..].trim_start();
            let argument = argument.strip_prefix("format!(").unwrap_or(argument);
            let Some(rest) = argument.strip_prefix('"') else { continue };
            let text = unescaped(rest).0;
            let mut plain = String::new();
            let mut depth = 0;
            for c in text.chars() {
                depth += i32::from(c == '{') - i32::from(c == '}');
                if depth == 0 {
                    plain.push(c);
                }
            }
            if plain.chars().filter(|c| c.is_alphabetic()).count() > 2 {
                found.push(Literal { text, file: file.into(), line: code[..at].matches('\n').count() + 1 });
            }
        }
    }
    found
}

/// The string literals inside the parentheses that open where `opens` says so of the code before them.
fn within(file: &str, code: &str, opens: impl Fn(&str) -> bool) -> Vec<Literal> {
    let (mut found, mut at, mut depth, mut inside) = (Vec::new(), 0, 0usize, Vec::new());
    while let Some(c) = code[at..].chars().next() {
        let rest = &code[at..];
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
            continue;
        }
        if c == '\'' {
            at += character(rest);
            continue;
        }
        at += c.len_utf8();
        match c {
            '"' => {
                let line = code[..at].matches('\n').count() + 1;
                let (text, length) = unescaped(&code[at..]);
                at += length;
                if !inside.is_empty() {
                    found.push(Literal { text, file: file.into(), line });
                }
            }
            '(' => {
                depth += 1;
                if opens(&code[..at]) {
                    inside.push(depth);
                }
            }
            ')' => {
                inside.retain(|opened| *opened < depth);
                depth = depth.saturating_sub(1);
            }
            _ => {}
        }
    }
    found
}

/// Length of a character literal, or of the quote of a lifetime.
fn character(rest: &str) -> usize {
    let mut chars = rest.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), _) => rest[3..].find('\'').map_or(1, |end| end + 4),
        (Some(_), Some((end, '\''))) => end + 1,
        _ => 1,
    }
}

/// The text of a string literal after its opening quote, and the length with its closing quote.
fn unescaped(rest: &str) -> (String, usize) {
    let mut text = String::new();
    let mut chars = rest.char_indices().peekable();
    while let Some((at, c)) = chars.next() {
        match c {
            '"' => return (text, at + 1),
            '\\' => match chars.next() {
                // A line that goes on: the white space before its rest does not count.
                Some((_, '\n')) => while chars.next_if(|(_, c)| c.is_whitespace()).is_some() {},
                Some((_, 'n')) => text.push('\n'),
                Some((_, 't')) => text.push('\t'),
                Some((_, 'u')) => {
                    let digits: String = chars.by_ref().map(|(_, c)| c).skip(1).take_while(|c| *c != '}').collect();
                    text.extend(u32::from_str_radix(&digits, 16).ok().and_then(char::from_u32));
                }
                Some((_, other)) => text.push(other),
                None => {}
            },
            c => text.push(c),
        }
    }
    (text, rest.len())
}

#[test]
fn texts_are_found_whatever_stands_between() {
    let code = "a(tr(\"one\"), 'x', '\"'); // tr(\"comment\")\nlater(if is { \"two \\\n     lines\" } else { \"three\" });\n\
        str(\"no\"); fill(tr(\"{0} \\\"q\\\" \\u{e9}\"), &[&\"no\"]); ui.label(\"words\"); ui.label(tr(\"fine\")); ui.button(\"E {x}\");";
    let all: Vec<String> = translated("f", code).into_iter().map(|literal| literal.text).collect();
    assert_eq!(all, ["one", "two lines", "three", "{0} \"q\" é", "fine"]);
    let bare: Vec<String> = untranslated("f", code).into_iter().map(|literal| literal.text).collect();
    assert_eq!(bare, ["words"]);
}
