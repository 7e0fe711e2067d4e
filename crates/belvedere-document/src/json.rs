//! JSON to [`Node`], keeping lines; refuses duplicate keys and numbers that are not finite.
//!
//! serde_json knows the grammar and hands every value over as the slice of the text it was read from; where the slice
//! starts tells the line.

use super::doc_error::{DocError, shorten};
use super::node::{Entry, Lines, MAX_DEPTH, Node, Value};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

/// Parses a whole JSON document.
pub(crate) fn parse(text: &str) -> Result<Node, DocError> {
    let lines = Lines::new(text);
    let root: &RawValue = serde_json::from_str(text).map_err(|e| syntax_error(&e, text, &lines))?;
    Source { text, lines }.node(root.get(), 1)
}

fn syntax_error(e: &serde_json::Error, text: &str, lines: &Lines) -> DocError {
    let at = lines.start(e.line()).saturating_add(e.column().saturating_sub(1)).min(text.len());
    let is_letter = |b: &u8| b.is_ascii_alphabetic();
    let start = text.as_bytes()[..at].iter().rposition(|b| !is_letter(b)).map_or(0, |i| i + 1);
    let word = |name: &str| text.as_bytes()[start..].starts_with(name.as_bytes());
    if ["NaN", "nan", "Infinity", "inf"].into_iter().any(word) {
        return DocError::at(e.line(), "a number is not finite; give finite numbers");
    }
    DocError::at(e.line(), reason(e))
}

/// What is wrong, without the position that serde_json appends.
fn reason(e: &serde_json::Error) -> String {
    if e.is_eof() {
        return "not valid JSON: it ends too early, a bracket or quote is not closed".into();
    }
    let text = e.to_string().replace("expected ident", "it does not begin like JSON");
    format!("not valid JSON: {}", text.rsplit_once(" at line ").map_or(text.as_str(), |(reason, _)| reason))
}

/// Keys and values of an object in order, duplicates included.
pub(super) struct Pairs<'a>(pub(super) Vec<(String, &'a RawValue)>);

impl<'de> Deserialize<'de> for Pairs<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PairsVisitor;
        impl<'de> Visitor<'de> for PairsVisitor {
            type Value = Pairs<'de>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Pairs<'de>, A::Error> {
                std::iter::from_fn(|| map.next_entry().transpose()).collect::<Result<_, _>>().map(Pairs)
            }
        }
        deserializer.deserialize_map(PairsVisitor)
    }
}

struct Source<'a> {
    text: &'a str,
    lines: Lines,
}

impl<'a> Source<'a> {
    /// `raw` is a slice of the text that holds one valid value.
    fn node(&self, raw: &'a str, depth: usize) -> Result<Node, DocError> {
        let line = self.lines.line(offset(self.text, raw));
        if depth > MAX_DEPTH {
            return Err(DocError::at(line, format!("the document is nested more than {MAX_DEPTH} deep; flatten it")));
        }
        let fail = |e: serde_json::Error| DocError::at(line, reason(&e));
        let value = match raw.as_bytes().first() {
            Some(b'{') => self.table(serde_json::from_str::<Pairs<'a>>(raw).map_err(fail)?, depth)?,
            Some(b'[') => {
                let items: Vec<&'a RawValue> = serde_json::from_str(raw).map_err(fail)?;
                Value::List(items.into_iter().map(|item| self.node(item.get(), depth + 1)).collect::<Result<_, _>>()?)
            }
            Some(b'"') => Value::Text(serde_json::from_str(raw).map_err(fail)?),
            Some(b't' | b'f') => Value::Bool(raw == "true"),
            Some(b'n') => Value::Null,
            _ => match (raw.parse::<i64>(), raw.parse::<f64>()) {
                (Ok(i), _) => Value::Int(i),
                (_, Ok(f)) if f.is_finite() => Value::Float(f),
                _ => {
                    let number = shorten(raw);
                    return Err(DocError::at(
                        line,
                        format!("\"{number}\" is not a finite number; give finite numbers"),
                    ));
                }
            },
        };
        Ok(Node { line, value })
    }

    fn table(&self, pairs: Pairs<'a>, depth: usize) -> Result<Value, DocError> {
        let mut entries: Vec<Entry> = Vec::new();
        let mut seen = std::collections::HashSet::new();
        for (key, raw) in pairs.0 {
            // the key ends before the colon in front of the value, possibly on an earlier line
            let before = self.text[..offset(self.text, raw.get())].trim_end().trim_end_matches(':').trim_end();
            let line = self.lines.line(before.len().saturating_sub(1));
            if !seen.insert(key.clone()) {
                return Err(DocError::at(line, format!("key \"{key}\" is given twice; keep one")));
            }
            entries.push(Entry { line, key, value: self.node(raw.get(), depth + 1)? });
        }
        Ok(Value::Table(entries))
    }
}

/// Where a slice of a text starts, bytes.
pub(super) fn offset(text: &str, slice: &str) -> usize {
    slice.as_ptr().addr() - text.as_ptr().addr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keys_and_mistakes_stand_on_their_lines() {
        let root = parse("{\n \"a\" :\n\n [1,\n 2.5, {\"b\": \"x\\ny\"}],\n\"c\": -0}").unwrap();
        let Value::Table(entries) = &root.value else { panic!() };
        assert_eq!((entries[0].line, entries[0].value.line, entries[1].line), (2, 4, 6));
        let items = entries[0].value.list().unwrap();
        assert_eq!(items.iter().map(|n| n.line).collect::<Vec<_>>(), [4, 5, 5]);
        assert_eq!(entries[1].value.value, Value::Int(0));
        assert_eq!(items[2].get("b").unwrap().value, Value::Text("x\ny".into()));
        for (text, line, words) in [
            ("{\n\"a\": 1\n\"b\": 2}", 3, "not valid JSON: expected `,` or `}`"),
            ("{\"a\":\n[1, NaN]}", 2, "not finite"),
            ("[\nnan]", 2, "not finite"),
            ("[\n1e999]", 2, "\"1e999\" is not a finite number"),
            ("[01]", 1, "not valid JSON: invalid number"),
            ("{\"a\": 1,\n\"a\": 2}", 2, "key \"a\" is given twice"),
            ("[\n\"\\ud800\"]", 2, "not valid JSON"),
            ("[1]\n 2", 2, "not valid JSON: trailing characters"),
            ("{\"a\": \"x", 1, "not valid JSON: it ends too early"),
            ("", 1, "not valid JSON"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.to_string().contains(words), "{text}: {error}");
            assert_eq!(error.line, Some(line), "{text}: {error}");
        }
        for deep in [64, 65, 100_000] {
            let text = "[".repeat(deep) + &"]".repeat(deep);
            assert_eq!(parse(&text).is_ok(), deep == 64, "{deep}");
        }
    }
}
