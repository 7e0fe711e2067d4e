//! A document as a tree that remembers the line of every value, whatever its syntax.

use super::doc_error::{DocError, shorten};

/// Deepest nesting of a document.
pub(crate) const MAX_DEPTH: usize = 64;
/// Most values in a document.
pub(crate) const MAX_NODES: usize = 1_000_000;

/// A value and the line it starts on.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Line, 1-based.
    pub line: usize,
    /// The value.
    pub value: Value,
}

/// What a node holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Nothing.
    Null,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// A text.
    Text(String),
    /// Values in order.
    List(Vec<Node>),
    /// Keys and their values.
    Table(Vec<Entry>),
}

/// One key of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Line of the key, 1-based.
    pub line: usize,
    /// The key.
    pub key: String,
    /// Its value.
    pub value: Node,
}

impl Node {
    /// Value of `key`, if this is a table that has it.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|e| e.key == key).map(|e| &e.value),
            _ => None,
        }
    }

    /// Elements, if this is a list.
    pub fn list(&self) -> Option<&[Node]> {
        match &self.value {
            Value::List(items) => Some(items),
            _ => None,
        }
    }

    /// This table without `key`.
    pub fn without(&self, key: &str) -> Node {
        let value = match &self.value {
            Value::Table(entries) => Value::Table(entries.iter().filter(|e| e.key != key).cloned().collect()),
            other => other.clone(),
        };
        Node { line: self.line, value }
    }

    /// Line of the deepest existing node along `path` (`["layer", "0", "style"]`).
    pub fn line_of(&self, path: &[&str]) -> usize {
        let Some((first, rest)) = path.split_first() else { return self.line };
        match &self.value {
            Value::Table(entries) => entries
                .iter()
                .find(|e| e.key == *first)
                .map_or(self.line, |e| if rest.is_empty() { e.line } else { e.value.line_of(rest) }),
            Value::List(items) => {
                first.parse::<usize>().ok().and_then(|i| items.get(i)).map_or(self.line, |n| n.line_of(rest))
            }
            _ => self.line,
        }
    }

    /// What the node is, in words.
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Null => "null".into(),
            Value::Bool(b) => format!("{b}"),
            Value::Int(i) => format!("the number {i}"),
            Value::Float(f) => format!("the number {f}"),
            Value::Text(t) => format!("the text \"{}\"", shorten(t)),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".into(),
        }
    }

    /// Checks depth and number of values.
    pub fn check_limits(&self) -> Result<(), DocError> {
        let mut stack = vec![(self, 1usize)];
        let mut count = 0usize;
        while let Some((node, depth)) = stack.pop() {
            count += 1;
            if depth > MAX_DEPTH {
                return Err(DocError::at(
                    node.line,
                    format!("the document is nested more than {MAX_DEPTH} deep; flatten it"),
                ));
            }
            if count > MAX_NODES {
                return Err(DocError::at(
                    node.line,
                    format!("the document has more than {MAX_NODES} values; move bulk data into files of their own"),
                ));
            }
            match &node.value {
                Value::List(items) => stack.extend(items.iter().map(|n| (n, depth + 1))),
                Value::Table(entries) => stack.extend(entries.iter().map(|e| (&e.value, depth + 1))),
                _ => {}
            }
        }
        Ok(())
    }
}

/// Byte offsets of line starts.
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    pub(crate) fn new(text: &str) -> Self {
        Self(
            std::iter::once(0)
                .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1))
                .collect(),
        )
    }

    /// Line of a byte, 1-based.
    pub(crate) fn line(&self, offset: usize) -> usize {
        self.0.partition_point(|&start| start <= offset).max(1)
    }

    /// First byte of a line, 1-based.
    pub(crate) fn start(&self, line: usize) -> usize {
        self.0.get(line.max(1) - 1).copied().unwrap_or(usize::MAX)
    }
}
