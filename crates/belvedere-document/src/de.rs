//! Serde over [`Node`]: every error knows its line and the path of keys that leads to it.

use super::doc_error::DocError;
use super::node::{Entry, Node, Value};
use serde::de::{self, DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::forward_to_deserialize_any;

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
