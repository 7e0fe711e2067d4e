//! Serde over [`Node`]: every error knows its line and the path of keys that leads to it.

use super::node::{Entry, Node, Value, shorten};
use serde::de::{
    self, DeserializeSeed, Deserializer, Expected, IntoDeserializer, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;

/// A mistake in a document: where and what.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DocError {
    /// Line, 1-based, if known.
    pub(crate) line: Option<usize>,
    /// Keys from the outside in, innermost first while the error travels outwards.
    path: Vec<String>,
    /// What is wrong and what to do.
    message: String,
}

impl DocError {
    /// A mistake on a line.
    pub(crate) fn at(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), path: Vec::new(), message: message.into() }
    }

    /// This error one key further out.
    pub(crate) fn inside(mut self, key: impl Into<String>) -> Self {
        self.path.push(key.into());
        self
    }

    fn or_line(mut self, line: usize) -> Self {
        self.line.get_or_insert(line);
        self
    }
}

impl std::fmt::Display for DocError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.path.is_empty() {
            let path: Vec<&str> = self.path.iter().rev().map(String::as_str).collect();
            write!(f, "{}: ", path.join("."))?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for DocError {}

impl de::Error for DocError {
    fn custom<T: std::fmt::Display>(msg: T) -> Self {
        Self { line: None, path: Vec::new(), message: msg.to_string() }
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::custom(format!("{} was expected, found {}", plain(expected), words(found)))
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::custom(format!("{} was expected, found {}", plain(expected), words(found)))
    }

    fn invalid_length(len: usize, expected: &dyn Expected) -> Self {
        Self::custom(format!("{} was expected, found a list of {len}", plain(expected)))
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::custom(format!("unknown key \"{}\"; {}", shorten(field), suggestion(field, expected)))
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::custom(format!("\"{}\" is not one of the choices; {}", shorten(variant), suggestion(variant, expected)))
    }

    fn missing_field(field: &'static str) -> Self {
        Self::custom(format!("key \"{field}\" is missing; add it"))
    }

    fn duplicate_field(field: &'static str) -> Self {
        Self::custom(format!("key \"{field}\" is given twice; keep one"))
    }
}

/// What was expected, in words that need no knowledge of the program's types.
fn plain(expected: &dyn Expected) -> String {
    let text = expected.to_string();
    match text.as_str() {
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of at least 0".into(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".into(),
        "f32" | "f64" => "a number".into(),
        "a string" => "a text".into(),
        other => match other.strip_prefix("an array of length ") {
            Some(length) => format!("a list of {length}"),
            None => text,
        },
    }
}

fn words(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Bool(b) => format!("{b}"),
        Unexpected::Unsigned(n) => format!("the number {n}"),
        Unexpected::Signed(n) => format!("the number {n}"),
        Unexpected::Float(n) => format!("the number {n}"),
        Unexpected::Str(s) => format!("the text \"{}\"", shorten(s)),
        Unexpected::Seq => "a list".into(),
        Unexpected::Map => "a table".into(),
        Unexpected::Unit => "null".into(),
        other => other.to_string(),
    }
}

/// "did you mean ...?" with the nearest of `valid`, or the list of them.
pub(crate) fn suggestion(given: &str, valid: &[&str]) -> String {
    let given = given.to_lowercase();
    let best = valid
        .iter()
        .map(|v| (strsim::damerau_levenshtein(&given, v), *v))
        .min_by_key(|(d, _)| *d)
        .filter(|(d, v)| *d <= 1 + v.len().max(given.len()) / 3);
    let begun = valid.iter().find(|v| given.len() >= 3 && v.starts_with(&given)).map(|v| (0, *v));
    let best = best.filter(|(d, _)| *d <= 1).or(begun).or(best);
    match best {
        Some((_, v)) => format!("did you mean \"{v}\"?"),
        None if valid.is_empty() => "none is possible here".into(),
        None => format!("possible: {}", valid.join(", ")),
    }
}

/// Reads a `T` out of a node.
pub(crate) fn from_node<'a, T: de::Deserialize<'a>>(node: &'a Node) -> Result<T, DocError> {
    T::deserialize(node)
}

impl<'de> Deserializer<'de> for &'de Node {
    type Error = DocError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocError> {
        match &self.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(b) => visitor.visit_bool(*b),
            Value::Int(i) => visitor.visit_i64(*i),
            Value::Float(f) => visitor.visit_f64(*f),
            Value::Text(t) => visitor.visit_borrowed_str(t),
            Value::List(items) => visit_list(items, visitor),
            Value::Table(entries) => visitor.visit_map(Entries { rest: entries.iter(), pending: None }),
        }
        .map_err(|e| e.or_line(self.line))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocError> {
        match self.value {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, DocError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DocError> {
        match &self.value {
            Value::Text(t) => visitor.visit_enum(t.as_str().into_deserializer()),
            _ => Err(de::Error::custom(format!("a text was expected, found {}", self.describe()))),
        }
        .map_err(|e: DocError| e.or_line(self.line))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

fn visit_list<'de, V: Visitor<'de>>(items: &'de [Node], visitor: V) -> Result<V::Value, DocError> {
    let mut access = Items { rest: items.iter(), index: 0 };
    let value = visitor.visit_seq(&mut access)?;
    match access.rest.len() {
        0 => Ok(value),
        left => Err(de::Error::custom(format!(
            "the list has {} elements, {} are expected",
            items.len(),
            items.len() - left
        ))),
    }
}

struct Items<'de> {
    rest: std::slice::Iter<'de, Node>,
    index: usize,
}

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = DocError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, DocError> {
        let Some(node) = self.rest.next() else { return Ok(None) };
        self.index += 1;
        seed.deserialize(node).map(Some).map_err(|e| e.inside(format!("{}", self.index - 1)))
    }
}

struct Entries<'de> {
    rest: std::slice::Iter<'de, Entry>,
    pending: Option<&'de Entry>,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = DocError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, DocError> {
        let Some(entry) = self.rest.next() else { return Ok(None) };
        self.pending = Some(entry);
        let key: de::value::BorrowedStrDeserializer<'de, DocError> =
            de::value::BorrowedStrDeserializer::new(&entry.key);
        seed.deserialize(key).map(Some).map_err(|e| e.or_line(entry.line))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, DocError> {
        let Some(entry) = self.pending.take() else { return Err(de::Error::custom("a key has no value")) };
        seed.deserialize(&entry.value).map_err(|e| e.or_line(entry.line).inside(&entry.key))
    }
}
