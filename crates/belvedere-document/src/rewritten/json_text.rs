//! Edits of JSON.

use super::super::json::{Pairs, offset};
use super::super::node::{Entry, Node, Value};
use super::{of, origins};
use serde_json::value::RawValue;

/// The text with the values of `after` where they differ from those of `before`, which the text states.
pub(super) fn rewritten(text: &str, before: &Node, after: &Node) -> Option<String> {
    let raw: &RawValue = serde_json::from_str(text).ok()?;
    let (head, tail) = (&text[..offset(text, raw.get())], &text[offset(text, raw.get()) + raw.get().len()..]);
    Some(format!("{head}{}{tail}", value(raw.get(), Some(before), after, "\n")))
}

/// One value of an object or an array in the text.
struct Part<'a> {
    /// The text before the value: its key, and the white space around.
    head: &'a str,
    value: &'a str,
    /// White space before the comma.
    tail: &'a str,
}

/// * `line`: a line break and the white space before the keys of the object in which the value is.
fn value(raw: &str, before: Option<&Node>, after: &Node, line: &str) -> String {
    if before == Some(after) {
        return raw.to_owned();
    }
    let edited = match (before.map(|node| &node.value), &after.value) {
        (Some(Value::Table(before)), Value::Table(after)) => object(raw, before, after, line),
        (Some(Value::List(before)), Value::List(after)) => array(raw, before, after, line),
        _ => None,
    };
    edited.unwrap_or_else(|| text_of(after, line))
}

fn object(raw: &str, before: &[Entry], after: &[Entry], line: &str) -> Option<String> {
    let Pairs(pairs) = serde_json::from_str(raw).ok()?;
    let (parts, end) = parts(raw, pairs.iter().map(|(_, value)| value.get()))?;
    let line = parts.last().map_or_else(|| format!("{line}  "), |part| space(part.head));
    let mut new = Vec::new();
    for ((key, _), part) in pairs.iter().zip(&parts) {
        let (was, is) = (of(before, key), of(after, key));
        match is {
            Some(is) => new.push(format!("{}{}{}", part.head, value(part.value, was, is, &line), part.tail)),
            None if was.is_some() => {}
            None => new.push(format!("{}{}{}", part.head, part.value, part.tail)),
        }
    }
    let is_new = |entry: &&Entry| {
        !pairs.iter().any(|(key, _)| *key == entry.key) && of(before, &entry.key) != Some(&entry.value)
    };
    for Entry { key, value, .. } in after.iter().filter(is_new) {
        new.push(format!("{line}{}: {}", serde_json::to_string(key).ok()?, text_of(value, &line)));
    }
    Some(format!("{{{}{end}}}", new.join(",")))
}

fn array(raw: &str, before: &[Node], after: &[Node], line: &str) -> Option<String> {
    let items: Vec<&RawValue> = serde_json::from_str(raw).ok()?;
    if items.len() != before.len() || items.is_empty() || after.is_empty() {
        return None;
    }
    let (parts, end) = parts(raw, items.iter().map(|item| item.get()))?;
    let heads = [space(parts[0].head), space(parts[parts.len() - 1].head)];
    let line = if heads[1].contains('\n') { heads[1].as_str() } else { line };
    let mut new = Vec::new();
    for (i, (node, from)) in after.iter().zip(origins(before, after)).enumerate() {
        // The first element has the white space of the first, the others that of the last.
        let head = if from == Some(i) { parts[i].head } else { heads[usize::from(i > 0)].as_str() };
        new.push(match from {
            Some(from) => format!("{head}{}", value(parts[from].value, Some(&before[from]), node, line)),
            None => format!("{head}{}", text_of(node, line)),
        });
    }
    Some(format!("[{}{end}]", new.join(",")))
}

/// The values of an object or an array with what stands around them, and the white space before the last bracket.
fn parts<'a>(raw: &'a str, values: impl Iterator<Item = &'a str>) -> Option<(Vec<Part<'a>>, &'a str)> {
    let mut parts: Vec<Part<'a>> = Vec::new();
    let mut at = 1;
    for value in values {
        if let Some(last) = parts.last_mut() {
            let comma = at + raw.get(at..)?.find(',')?;
            last.tail = raw.get(at..comma)?;
            at = comma + 1;
        }
        let start = offset(raw, value);
        parts.push(Part { head: raw.get(at..start)?, value, tail: "" });
        at = start + value.len();
    }
    Some((parts, raw.get(at..raw.len() - 1)?))
}

/// The white space at the beginning of a text.
fn space(text: &str) -> String {
    text[..text.len() - text.trim_start().len()].to_owned()
}

/// A value as a text of its own; numbers and texts stand in one line.
fn text_of(node: &Node, line: &str) -> String {
    let deeper = if line.contains('\n') { format!("{line}  ") } else { String::from(" ") };
    let is_plain = |node: &Node| !matches!(node.value, Value::Table(_) | Value::List(_));
    match &node.value {
        Value::List(items) if items.iter().all(is_plain) => {
            format!("[{}]", items.iter().map(|item| text_of(item, line)).collect::<Vec<_>>().join(", "))
        }
        Value::List(items) => {
            let items: Vec<String> = items.iter().map(|item| format!("{deeper}{}", text_of(item, &deeper))).collect();
            format!("[{}{}]", items.join(","), if line.contains('\n') { line } else { " " })
        }
        Value::Table(entries) => {
            let one = |entry: &Entry| {
                format!("{deeper}{}: {}", serde_json::Value::from(entry.key.as_str()), text_of(&entry.value, &deeper))
            };
            let entries: Vec<String> = entries.iter().map(one).collect();
            format!("{{{}{}}}", entries.join(","), if line.contains('\n') { line } else { " " })
        }
        Value::Text(text) => serde_json::Value::from(text.as_str()).to_string(),
        Value::Float(value) => serde_json::Value::from(*value).to_string(),
        Value::Int(value) => value.to_string(),
        Value::Bool(value) => value.to_string(),
        Value::Null => "null".into(),
    }
}
