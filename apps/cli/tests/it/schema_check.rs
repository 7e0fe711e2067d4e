//! A judge of JSON by JSON Schema: the keywords that our schemas use. It refuses others, so that none is passed over in silence.

use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// How keys are taken that a schema does not name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Strictness {
    /// As the schema says.
    AsWritten,
    /// They are errors: a schema that does not name what the program writes is out of date.
    NoUnknownKeys,
}

/// Keywords that say nothing about a value that is not said by others.
const NOTES: [&str; 8] = ["$schema", "$defs", "title", "description", "format", "default", "examples", "deprecated"];

/// Whether `value` keeps to `schema`; the error names the place.
pub(crate) fn check(schema: &Value, value: &Value, strictness: Strictness) -> Result<(), String> {
    let judge = Judge { root: schema, strictness };
    let known = judge.keys(schema, value, "$")?;
    judge.no_more(value, &known, "$")
}

struct Judge<'a> {
    root: &'a Value,
    strictness: Strictness,
}

/// Keys that a schema names; `None`: it allows all.
type Keys = Option<BTreeSet<String>>;

impl Judge<'_> {
    /// Checks a value that no other schema describes.
    fn whole(&self, schema: &Value, value: &Value, at: &str) -> Result<(), String> {
        let known = self.keys(schema, value, at)?;
        self.no_more(value, &known, at)
    }

    fn no_more(&self, value: &Value, known: &Keys, at: &str) -> Result<(), String> {
        let (Some(entries), Some(known), Strictness::NoUnknownKeys) = (value.as_object(), known, self.strictness)
        else {
            return Ok(());
        };
        match entries.keys().find(|key| !known.contains(*key)) {
            Some(key) => Err(format!("{at}.{key} stands in no schema")),
            None => Ok(()),
        }
    }

    /// Checks a value; returns the keys of an object that the schema names.
    fn keys(&self, schema: &Value, value: &Value, at: &str) -> Result<Keys, String> {
        let schema = match schema {
            Value::Bool(true) => return Ok(None),
            Value::Object(schema) => schema,
            other => return Err(format!("{at}: {other} allows nothing")),
        };
        let mut known: Keys = Some(BTreeSet::new());
        for (keyword, rule) in schema {
            match keyword.as_str() {
                "$ref" => {
                    let place = rule.as_str().and_then(|text| text.strip_prefix('#')).ok_or("a $ref is no text")?;
                    let target = self.root.pointer(place).ok_or_else(|| format!("{rule} is not there"))?;
                    join(&mut known, self.keys(target, value, at)?);
                }
                "type" => typed(rule, value, at)?,
                "const" => same(rule, value, at)?,
                "enum" => {
                    let any = rule.as_array().is_some_and(|all| all.contains(value));
                    any.then_some(()).ok_or_else(|| format!("{at}: {value} is not one of {rule}"))?;
                }
                "anyOf" | "oneOf" => join(&mut known, self.any(rule, value, at)?),
                "allOf" => {
                    for part in rule.as_array().into_iter().flatten() {
                        join(&mut known, self.keys(part, value, at)?);
                    }
                }
                "properties" | "required" | "additionalProperties" => {}
                "items" | "prefixItems" | "minItems" | "maxItems" => {}
                "minimum" | "maximum" => {
                    let (Some(limit), Some(number)) = (rule.as_f64(), value.as_f64()) else { continue };
                    let good = if keyword == "minimum" { number >= limit } else { number <= limit };
                    good.then_some(()).ok_or_else(|| format!("{at}: {number} breaks {keyword} {limit}"))?;
                }
                note if NOTES.contains(&note) => {}
                other => return Err(format!("{at}: the judge does not know the keyword {other}")),
            }
        }
        match value {
            Value::Object(entries) => join(&mut known, self.object(schema, entries, at)?),
            Value::Array(items) => self.array(schema, items, at)?,
            _ => {}
        }
        Ok(known)
    }

    fn any(&self, rule: &Value, value: &Value, at: &str) -> Result<Keys, String> {
        let mut reasons = Vec::new();
        let mut found: Option<Keys> = None;
        for part in rule.as_array().into_iter().flatten() {
            match self.keys(part, value, at) {
                Ok(keys) => match &mut found {
                    Some(all) => join(all, keys),
                    None => found = Some(keys),
                },
                Err(reason) => reasons.push(reason),
            }
        }
        found.ok_or_else(|| reasons.join(" | "))
    }

    fn object(&self, schema: &Map<String, Value>, entries: &Map<String, Value>, at: &str) -> Result<Keys, String> {
        let properties = schema.get("properties").and_then(Value::as_object);
        let required = schema.get("required").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        if (1..required.len()).any(|k| required[..k].contains(&required[k])) {
            return Err(format!("{at}: the schema requires a key twice: {required:?}"));
        }
        for key in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
            let key = key.as_str().unwrap_or_default();
            entries.contains_key(key).then_some(()).ok_or_else(|| format!("{at}.{key} is missing"))?;
        }
        let mut known: Keys = Some(BTreeSet::new());
        for (key, value) in entries {
            let at = format!("{at}.{key}");
            match (properties.and_then(|all| all.get(key)), schema.get("additionalProperties")) {
                (Some(rule), _) => {
                    self.whole(rule, value, &at)?;
                    join(&mut known, Some(BTreeSet::from([key.clone()])));
                }
                (None, Some(Value::Bool(false))) => return Err(format!("{at} is not allowed")),
                (None, Some(rule)) => {
                    self.whole(rule, value, &at)?;
                    join(&mut known, Some(BTreeSet::from([key.clone()])));
                }
                (None, None) => {}
            }
        }
        Ok(known)
    }

    fn array(&self, schema: &Map<String, Value>, items: &[Value], at: &str) -> Result<(), String> {
        let number = |key: &str| schema.get(key).and_then(Value::as_u64).map(|n| n as usize);
        let bounds = number("minItems").unwrap_or(0)..=number("maxItems").unwrap_or(usize::MAX);
        if !bounds.contains(&items.len()) {
            return Err(format!("{at}: {} items", items.len()));
        }
        let first = schema.get("prefixItems").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        for (i, item) in items.iter().enumerate() {
            if let Some(rule) = first.get(i).or_else(|| schema.get("items")) {
                self.whole(rule, item, &format!("{at}[{i}]"))?;
            }
        }
        Ok(())
    }
}

fn join(known: &mut Keys, more: Keys) {
    match (known.as_mut(), more) {
        (Some(known), Some(more)) => known.extend(more),
        _ => *known = None,
    }
}

fn same(rule: &Value, value: &Value, at: &str) -> Result<(), String> {
    if rule == value { Ok(()) } else { Err(format!("{at}: {value} is not {rule}")) }
}

fn typed(rule: &Value, value: &Value, at: &str) -> Result<(), String> {
    let is = |name: &Value| match name.as_str() {
        Some("null") => value.is_null(),
        Some("boolean") => value.is_boolean(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_i64() || value.is_u64(),
        Some("array") => value.is_array(),
        Some("object") => value.is_object(),
        _ => false,
    };
    let good = rule.as_array().map_or_else(|| is(rule), |names| names.iter().any(is));
    if good { Ok(()) } else { Err(format!("{at}: {value} is no {rule}")) }
}
