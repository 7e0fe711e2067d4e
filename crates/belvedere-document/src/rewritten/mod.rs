//! The text of a scene file with other values: comments, order and whatever was not edited stay, byte for byte.

mod json_text;
mod toml_text;

use super::Document;
use super::node::{Entry, Node, Value};

/// Whether the text of a scene file is JSON.
pub fn is_json(text: &str) -> bool {
    super::plain(text).trim_start().starts_with('{')
}

/// The text of a scene file that states `wanted`, with as little changed as that needs; `None` if the text is no scene file, or if no such text
/// was found.
pub fn rewritten(text: &str, wanted: &Document) -> Option<String> {
    let plain = super::plain(text);
    let stated = |text: &str| super::parse("scene".as_ref(), text).ok().map(|source| source.document);
    let present = stated(plain)?;
    let (before, after) = (tree(&present)?, tree(wanted)?);
    let new = match is_json(plain) {
        true => json_text::rewritten(plain, &before, &after)?,
        false => toml_text::rewritten(plain, &before, &after)?,
    };
    let mark = &text[..text.len() - plain.len()];
    (stated(&new)? == *wanted).then(|| format!("{mark}{new}"))
}

/// A document as a tree in the order of its keys.
fn tree(document: &Document) -> Option<Node> {
    let mut root = super::json::parse(&serde_json::to_string(document).ok()?).ok()?;
    drop_null(&mut root);
    Some(root)
}

/// Keys that state nothing are left out.
fn drop_null(node: &mut Node) {
    match &mut node.value {
        Value::List(items) => items.iter_mut().for_each(drop_null),
        Value::Table(entries) => {
            entries.retain(|entry| entry.value.value != Value::Null);
            entries.iter_mut().for_each(|entry| drop_null(&mut entry.value));
        }
        _ => {}
    }
}

/// The value of a key.
fn of<'n>(entries: &'n [Entry], key: &str) -> Option<&'n Node> {
    entries.iter().find(|entry| entry.key == key).map(|entry| &entry.value)
}

/// For each element of a list after an edit the one that it was before; `None` for a new one.
fn origins(before: &[Node], after: &[Node]) -> Vec<Option<usize>> {
    let is_table = |node: &Node| matches!(node.value, Value::Table(_));
    if before.len() == after.len() && !after.iter().all(is_table) {
        return (0..after.len()).map(Some).collect();
    }
    let mut from = vec![None; after.len()];
    let mut claim = |same: &dyn Fn(usize, usize) -> bool| {
        for i in 0..after.len() {
            if from[i].is_none() {
                from[i] = (0..before.len()).find(|&j| !from.contains(&Some(j)) && same(j, i));
            }
        }
    };
    claim(&|j, i| before[j] == after[i]);
    for key in ["id", "name", "kind"] {
        claim(&|j, i| after[i].get(key).is_some_and(|name| before[j].get(key) == Some(name)));
    }
    if before.len() == after.len() {
        claim(&|j, i| j == i);
    }
    from
}

#[cfg(test)]
mod tests;
