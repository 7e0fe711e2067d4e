//! TOML to [`Node`], keeping lines.

use super::DocError;
use super::node::{Entry, Lines, Node, Value};
use toml::de::{DeTable, DeValue};

/// Parses a whole TOML document.
pub(crate) fn parse(text: &str) -> Result<Node, DocError> {
    let lines = Lines::new(text);
    let table = DeTable::parse(text).map_err(|e| {
        let line = e.span().map_or(1, |s| lines.line(s.start));
        let said = e.message().trim().replace('\n', "; ");
        let key = e.span().and_then(|span| text.get(span)).map(super::doc_error::shorten).unwrap_or_default();
        match said.as_str() {
            "duplicate key" => DocError::at(line, format!("key \"{key}\" is given twice; keep one")),
            _ => DocError::at(line, format!("not valid TOML: {said}")),
        }
    })?;
    Ok(Node { line: 1, value: table_value(table.into_inner(), &lines, 1)? })
}

fn table_value(table: DeTable<'_>, lines: &Lines, depth: usize) -> Result<Value, DocError> {
    let mut entries = Vec::new();
    for (key, value) in table {
        let line = lines.line(key.span().start);
        let span = value.span().start;
        let mut node = node(value.into_inner(), lines, span, depth + 1)?;
        // Tables made by headers or dotted keys start where their key stands.
        node.line = node.line.max(line);
        entries.push(Entry { line, key: key.into_inner().into_owned(), value: node });
    }
    entries.sort_by_key(|e| e.line);
    Ok(Value::Table(entries))
}

fn node(value: DeValue<'_>, lines: &Lines, offset: usize, depth: usize) -> Result<Node, DocError> {
    let line = lines.line(offset);
    if depth > super::node::MAX_DEPTH {
        let most = super::node::MAX_DEPTH;
        return Err(DocError::at(line, format!("the document is nested more than {most} deep; flatten it")));
    }
    let value = match value {
        DeValue::String(s) => Value::Text(s.into_owned()),
        DeValue::Boolean(b) => Value::Bool(b),
        DeValue::Integer(i) => Value::Int(
            i64::from_str_radix(i.as_str(), i.radix())
                .map_err(|_| DocError::at(line, format!("whole number {i} does not fit 64 bits; use a smaller one")))?,
        ),
        DeValue::Float(f) => {
            let value: f64 = f.as_str().parse().unwrap_or(f64::NAN);
            if !value.is_finite() {
                return Err(DocError::at(line, format!("{} is not a finite number; give finite numbers", f.as_str())));
            }
            Value::Float(value)
        }
        DeValue::Datetime(d) => Value::Text(d.to_string()),
        DeValue::Array(items) => Value::List(
            items
                .into_iter()
                .map(|item| {
                    let at = item.span().start;
                    node(item.into_inner(), lines, at, depth + 1)
                })
                .collect::<Result<_, _>>()?,
        ),
        DeValue::Table(table) => table_value(table, lines, depth)?,
    };
    Ok(Node { line, value })
}
