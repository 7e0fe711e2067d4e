//! JSON to [`Node`], keeping lines; refuses duplicate keys and numbers that are not finite.

use super::DocError;
use super::node::{Entry, MAX_DEPTH, Node, Value};

/// Parses a whole JSON document.
pub(crate) fn parse(text: &str) -> Result<Node, DocError> {
    let mut p = Parser { bytes: text.as_bytes(), text, at: 0, line: 1 };
    p.space();
    let node = p.value(1)?;
    p.space();
    if p.at < p.bytes.len() {
        return Err(p.fail("there is text after the end of the document"));
    }
    Ok(node)
}

struct Parser<'a> {
    bytes: &'a [u8],
    text: &'a str,
    at: usize,
    line: usize,
}

impl Parser<'_> {
    fn fail(&self, what: impl Into<String>) -> DocError {
        DocError::at(self.line, format!("not valid JSON: {}", what.into()))
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn space(&mut self) {
        while let Some(b) = self.peek() {
            match b {
                b'\n' => self.line += 1,
                b' ' | b'\t' | b'\r' => {}
                _ => return,
            }
            self.at += 1;
        }
    }

    fn found(&self) -> String {
        match self.text.get(self.at..).and_then(|t| t.chars().next()) {
            Some(c) => format!("'{}'", c.escape_default()),
            None => "the end of the file".into(),
        }
    }

    fn value(&mut self, depth: usize) -> Result<Node, DocError> {
        if depth > MAX_DEPTH {
            return Err(DocError::at(
                self.line,
                format!("the document is nested more than {MAX_DEPTH} deep; flatten it"),
            ));
        }
        let line = self.line;
        let value = match self.peek() {
            Some(b'{') => self.table(depth)?,
            Some(b'[') => self.list(depth)?,
            Some(b'"') => Value::Text(self.string()?),
            Some(b'-' | b'0'..=b'9') => self.number()?,
            _ => self.word()?,
        };
        Ok(Node { line, value })
    }

    fn word(&mut self) -> Result<Value, DocError> {
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        let words = [("true", Value::Bool(true)), ("false", Value::Bool(false)), ("null", Value::Null)];
        for (word, value) in words {
            if rest.starts_with(word.as_bytes()) {
                self.at += word.len();
                return Ok(value);
            }
        }
        if ["NaN", "nan", "Infinity", "inf"].iter().any(|w| rest.starts_with(w.as_bytes())) {
            return Err(DocError::at(self.line, "a number is not finite; give finite numbers".to_owned()));
        }
        Err(self.fail(format!("a value was expected, found {}", self.found())))
    }

    fn list(&mut self, depth: usize) -> Result<Value, DocError> {
        self.at += 1;
        let mut items = Vec::new();
        self.space();
        if self.peek() == Some(b']') {
            self.at += 1;
            return Ok(Value::List(items));
        }
        loop {
            self.space();
            items.push(self.value(depth + 1)?);
            self.space();
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b']') => {
                    self.at += 1;
                    return Ok(Value::List(items));
                }
                _ => return Err(self.fail(format!("',' or ']' was expected, found {}", self.found()))),
            }
        }
    }

    fn table(&mut self, depth: usize) -> Result<Value, DocError> {
        self.at += 1;
        let mut entries: Vec<Entry> = Vec::new();
        let mut seen = std::collections::HashSet::new();
        self.space();
        if self.peek() == Some(b'}') {
            self.at += 1;
            return Ok(Value::Table(entries));
        }
        loop {
            self.space();
            let line = self.line;
            if self.peek() != Some(b'"') {
                return Err(self.fail(format!("a key in quotes was expected, found {}", self.found())));
            }
            let key = self.string()?;
            if !seen.insert(key.clone()) {
                return Err(DocError::at(line, format!("key \"{key}\" is given twice; keep one")));
            }
            self.space();
            if self.peek() != Some(b':') {
                return Err(self.fail(format!("':' was expected after key \"{key}\", found {}", self.found())));
            }
            self.at += 1;
            self.space();
            let value = self.value(depth + 1)?;
            entries.push(Entry { line, key, value });
            self.space();
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b'}') => {
                    self.at += 1;
                    return Ok(Value::Table(entries));
                }
                _ => return Err(self.fail(format!("',' or '}}' was expected, found {}", self.found()))),
            }
        }
    }

    /// A string; the escapes are left to the JSON library.
    fn string(&mut self) -> Result<String, DocError> {
        let start = self.at;
        self.at += 1;
        loop {
            match self.peek() {
                Some(b'"') => break,
                Some(b'\\') => self.at += 2,
                Some(b'\n') | None => return Err(self.fail("a text is not closed")),
                Some(_) => self.at += 1,
            }
        }
        self.at += 1;
        let raw = self.text.get(start..self.at).ok_or_else(|| self.fail("a text is not closed"))?;
        serde_json::from_str(raw).map_err(|_| self.fail("a text holds an invalid escape or control character"))
    }

    fn number(&mut self) -> Result<Value, DocError> {
        let start = self.at;
        while matches!(self.peek(), Some(b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9')) {
            self.at += 1;
        }
        let raw = &self.text[start..self.at];
        // The JSON library knows the grammar (no leading zeros, digits after the point), the standard library rounds exactly.
        let bad = || {
            DocError::at(
                self.line,
                format!("\"{}\" is not a finite number; give finite numbers", super::node::shorten(raw)),
            )
        };
        serde_json::from_str::<serde_json::Number>(raw).map_err(|_| bad())?;
        if let Ok(i) = raw.parse::<i64>() {
            return Ok(Value::Int(i));
        }
        match raw.parse::<f64>() {
            Ok(f) if f.is_finite() => Ok(Value::Float(f)),
            _ => Err(bad()),
        }
    }
}
