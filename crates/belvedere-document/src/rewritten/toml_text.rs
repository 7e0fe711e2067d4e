//! Edits of TOML.

use super::super::node::{Entry, Node, Value};
use super::{of, origins};
use toml_edit::{Array, ArrayOfTables, Decor, DocumentMut, InlineTable, Item, Table, TableLike};

/// The text with the values of `after` where they differ from those of `before`, which the text states.
pub(super) fn rewritten(text: &str, before: &Node, after: &Node) -> Option<String> {
    let (Value::Table(before), Value::Table(after)) = (&before.value, &after.value) else { return None };
    let mut file: DocumentMut = text.parse().ok()?;
    table(file.as_table_mut(), before, after);
    let new = file.to_string();
    // New lines end as the others do.
    Some(if text.contains("\r\n") { new.replace("\r\n", "\n").replace('\n', "\r\n") } else { new })
}

fn table(into: &mut Table, before: &[Entry], after: &[Entry]) {
    entries(into, before, after, false);
    for key in gone(into, before, after) {
        let values: Vec<String> = into.iter().filter(|(_, item)| item.is_value()).map(|(key, _)| key.into()).collect();
        let comments = comments(into, &key);
        into.remove(&key);
        if let Some(comments) = comments {
            keep(into, &values, &key, &comments);
        }
    }
}

/// Changes and adds entries.
///
/// * `inline`: whether tables are written in one line.
fn entries(into: &mut dyn TableLike, before: &[Entry], after: &[Entry], inline: bool) {
    for Entry { key, value, .. } in after {
        let was = of(before, key);
        if was == Some(value) {
            continue;
        }
        let comments = comments(into, key);
        let was_value = into.get(key).is_some_and(Item::is_value);
        match into.get_mut(key) {
            Some(item) => change(item, was, value, inline),
            None => drop(into.insert(key, new(value, inline))),
        }
        // What stood above and beside a value stands above the table that comes in its place.
        if was_value && let Some(table) = into.get_mut(key).and_then(Item::as_table_mut) {
            let comments = comments.map_or_else(String::new, |comments| format!("{comments}\n"));
            table.decor_mut().set_prefix(format!("\n{comments}"));
            if let Some(mut key) = into.key_mut(key) {
                key.leaf_decor_mut().clear();
            }
        }
    }
}

/// The keys that are to go.
fn gone(into: &dyn TableLike, before: &[Entry], after: &[Entry]) -> Vec<String> {
    let keys = before.iter().map(|entry| &entry.key).filter(|key| of(after, key).is_none());
    keys.filter(|key| into.contains_key(key)).cloned().collect()
}

fn change(item: &mut Item, before: Option<&Node>, after: &Node, inline: bool) {
    let was = before.map(|node| &node.value);
    match (&mut *item, was, &after.value) {
        (Item::Table(into), Some(Value::Table(before)), Value::Table(after)) => table(into, before, after),
        (Item::ArrayOfTables(list), Some(Value::List(before)), Value::List(after)) if list.len() == before.len() => {
            tables(list, before, after);
        }
        (Item::Value(text), _, _) => {
            let fresh = new(after, inline);
            match fresh.is_table() && !text.is_inline_table() {
                true => *item = fresh,
                false => value(text, before, after),
            }
        }
        _ => *item = new(after, inline),
    }
}

fn value(into: &mut toml_edit::Value, before: Option<&Node>, after: &Node) {
    match (&mut *into, before.map(|node| &node.value), &after.value) {
        (toml_edit::Value::InlineTable(into), Some(Value::Table(before)), Value::Table(after)) => {
            entries(into, before, after, true);
            gone(into, before, after).iter().for_each(|key| drop(into.remove(key)));
        }
        (toml_edit::Value::Array(list), Some(Value::List(before)), Value::List(after))
            if list.len() == before.len() =>
        {
            array(list, before, after);
        }
        _ => {
            let decor = into.decor().clone();
            *into = in_line(after);
            *into.decor_mut() = decor;
        }
    }
}

fn array(list: &mut Array, before: &[Node], after: &[Node]) {
    let old: Vec<toml_edit::Value> = list.iter().cloned().collect();
    list.clear();
    for (node, from) in after.iter().zip(origins(before, after)) {
        match from.and_then(|i| Some((old.get(i)?, &before[i]))) {
            Some((one, was)) => {
                let mut one = one.clone();
                if was != node {
                    value(&mut one, Some(was), node);
                }
                list.push_formatted(one);
            }
            None => list.push(in_line(node)),
        }
    }
}

fn tables(list: &mut ArrayOfTables, before: &[Node], after: &[Node]) {
    let mut old: Vec<Option<Table>> = std::mem::take(list).into_iter().map(Some).collect();
    let mut places = Vec::new();
    old.iter_mut().flatten().for_each(|table| each_place(table, &mut |place| places.push(*place)));
    let origins = origins(before, after);
    for (node, from) in after.iter().zip(&origins) {
        let was = from.and_then(|i| Some((old.get_mut(i)?.take()?, &before[i])));
        match (was, &node.value) {
            (Some((mut one, Node { value: Value::Table(before), .. })), Value::Table(after)) => {
                table(&mut one, before, after);
                list.push(one);
            }
            (_, Value::Table(entries)) => list.push(table_of(entries)),
            _ => {}
        }
    }
    // Tables are written in the order of their places in the file.
    if !origins.iter().flatten().is_sorted() {
        places.sort_unstable();
        let mut places = places.into_iter();
        list.iter_mut().for_each(|table| each_place(table, &mut |place| *place = places.next().unwrap_or(*place)));
    }
}

/// Calls `each` with the places in the file of a table and the tables in it, in the order in which they are written.
fn each_place(table: &mut Table, each: &mut dyn FnMut(&mut isize)) {
    if let Some(mut place) = table.position() {
        each(&mut place);
        table.set_position(Some(place));
    }
    for (_, item) in table.iter_mut() {
        match item {
            Item::Table(table) => each_place(table, each),
            Item::ArrayOfTables(list) => list.iter_mut().for_each(|table| each_place(table, each)),
            _ => {}
        }
    }
}

/// The comments of an entry; `None` without any.
fn comments(table: &dyn TableLike, key: &str) -> Option<String> {
    let (key, item) = table.get_key_value(key)?;
    let above = text_of(key.leaf_decor().prefix()).lines();
    let beside = item.as_value().map_or("", |value| text_of(value.decor().suffix()));
    let lines: Vec<&str> = above.chain([beside]).map(str::trim).filter(|line| line.starts_with('#')).collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

/// Keeps the comments of an entry that has gone: behind the one before it, else before the one behind it, else in the head of the table.
///
/// * `values`: keys of the values that there were.
fn keep(table: &mut Table, values: &[String], gone: &str, comments: &str) {
    let behind = |decor: &mut Decor| decor.set_suffix(format!("{}\n{comments}", text_of(decor.suffix()).trim_end()));
    let at = values.iter().position(|key| key == gone);
    let before = at.and_then(|at| at.checked_sub(1)).and_then(|at| values.get(at));
    let after = at.and_then(|at| values.get(at + 1));
    if let Some(value) = before.and_then(|key| table.get_mut(key)).and_then(Item::as_value_mut) {
        behind(value.decor_mut());
    } else if let Some(mut key) = after.and_then(|key| table.key_mut(key)) {
        let decor = key.leaf_decor_mut();
        decor.set_prefix(format!("{comments}\n{}", text_of(decor.prefix())));
    } else {
        behind(table.decor_mut());
    }
}

fn text_of(text: Option<&toml_edit::RawString>) -> &str {
    text.and_then(toml_edit::RawString::as_str).unwrap_or_default()
}

fn new(node: &Node, inline: bool) -> Item {
    match &node.value {
        Value::Table(entries) if !inline => Item::Table(table_of(entries)),
        Value::List(items) if !inline && !items.is_empty() => {
            let tables: Option<Vec<&[Entry]>> = items
                .iter()
                .map(|item| match &item.value {
                    Value::Table(entries) => Some(entries.as_slice()),
                    _ => None,
                })
                .collect();
            match tables {
                Some(tables) => Item::ArrayOfTables(tables.into_iter().map(table_of).collect()),
                None => Item::Value(in_line(node)),
            }
        }
        _ => Item::Value(in_line(node)),
    }
}

fn table_of(entries: &[Entry]) -> Table {
    entries.iter().map(|entry| (entry.key.as_str(), new(&entry.value, false))).collect()
}

fn in_line(node: &Node) -> toml_edit::Value {
    match &node.value {
        Value::Bool(value) => (*value).into(),
        Value::Int(value) => (*value).into(),
        Value::Float(value) => (*value).into(),
        Value::Text(value) => value.as_str().into(),
        Value::List(items) => items.iter().map(in_line).collect::<Array>().into(),
        Value::Table(entries) => {
            entries.iter().map(|entry| (entry.key.as_str(), in_line(&entry.value))).collect::<InlineTable>().into()
        }
        // Trees of documents have none.
        Value::Null => "".into(),
    }
}
