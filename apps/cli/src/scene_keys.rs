//! `schema keys`: the keys of scene files in prose, as Markdown, made from their schema.

use serde_json::{Map, Value};
use std::fmt::Write;

/// The page.
pub(crate) fn page(schema: &str) -> anyhow::Result<String> {
    let schema: Value = serde_json::from_str(schema)?;
    let mut text = String::from(
        "# Keys of scene files\n\nMade from the schema by `belvedere schema keys`; [scene.schema.json](scene.schema.json) is the schema itself. A key without a default may be \
         left out unless it says *required*. The same document may be JSON.\n",
    );
    section(&mut text, "Scene", &schema)?;
    let empty = Map::new();
    for (name, definition) in schema["$defs"].as_object().unwrap_or(&empty) {
        section(&mut text, &plain(name), definition)?;
    }
    Ok(text)
}

/// The name of a definition as readers know it.
fn plain(name: &str) -> String {
    name.strip_suffix("Doc").unwrap_or(name).to_owned()
}

/// A definition: its keys, the forms that it may have, or its values.
fn section(text: &mut String, title: &str, schema: &Value) -> std::fmt::Result {
    write!(text, "\n## {title}\n\n{}\n", prose(&schema["description"]))?;
    table(text, schema)?;
    let forms = schema["oneOf"].as_array().or(schema["anyOf"].as_array()).map_or(&[][..], Vec::as_slice);
    let (tables, values): (Vec<&Value>, Vec<&Value>) = forms.iter().partition(|form| form["properties"].is_object());
    if !values.is_empty() {
        text.push('\n');
    }
    for value in values {
        let meaning = prose(&value["description"]);
        let meaning = if meaning.is_empty() { meaning } else { format!(": {meaning}") };
        writeln!(text, "- {}{meaning}", kind(value))?;
    }
    for form in tables {
        let kind = &form["properties"]["kind"]["const"];
        let name = kind.as_str().map_or_else(|| "One form".to_owned(), |kind| format!("`kind = \"{kind}\"`"));
        write!(text, "\n### {title}: {name}\n\n{}\n", prose(&form["description"]))?;
        table(text, form)?;
    }
    Ok(())
}

/// A row for each key.
fn table(text: &mut String, schema: &Value) -> std::fmt::Result {
    let Some(properties) = schema["properties"].as_object().filter(|keys| !keys.is_empty()) else { return Ok(()) };
    text.push_str("\n| key | value | meaning |\n|---|---|---|\n");
    for (key, rule) in properties {
        let is_required = schema["required"].as_array().is_some_and(|all| all.iter().any(|name| name == key.as_str()));
        let mut notes = prose(&rule["description"]);
        if is_required {
            notes += " *Required.*";
        }
        match &rule["default"] {
            Value::Null => {}
            Value::Array(items) if items.is_empty() => {}
            default => write!(notes, " Default `{}`.", default.to_string().replace('|', "\\|"))?,
        }
        writeln!(text, "| `{key}` | {} | {} |", kind(rule), notes.trim())?;
    }
    Ok(())
}

/// A description on one line that a table holds.
fn prose(description: &Value) -> String {
    let text = description.as_str().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
    // Links to Rust items lead nowhere here.
    text.replace("[`", "`").replace("`]", "`").replace('|', "\\|").replace('<', "&lt;")
}

/// What a value is.
fn kind(rule: &Value) -> String {
    if let Some(name) = rule["$ref"].as_str().and_then(|place| place.rsplit('/').next()) {
        let name = plain(name);
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if !rule["const"].is_null() {
        return format!("`{}`", rule["const"]);
    }
    if let Some(values) = rule["enum"].as_array() {
        return values.iter().map(|value| format!("`{value}`")).collect::<Vec<_>>().join(", ");
    }
    for forms in [&rule["anyOf"], &rule["oneOf"]] {
        if let Some(forms) = forms.as_array() {
            let forms = forms.iter().filter(|form| form["type"] != "null").map(kind);
            return forms.collect::<Vec<_>>().join(" or ");
        }
    }
    if let Some(first) = rule["prefixItems"].as_array() {
        return format!("[{}]", first.iter().map(kind).collect::<Vec<_>>().join(", "));
    }
    let names = match &rule["type"] {
        Value::String(name) => vec![name.as_str()],
        Value::Array(names) => names.iter().filter_map(Value::as_str).filter(|name| *name != "null").collect(),
        _ => return "anything".to_owned(),
    };
    let word = |name: &str| match name {
        "array" => match (rule["minItems"].as_u64(), rule["maxItems"].as_u64()) {
            (Some(least), Some(most)) if least == most => format!("{most} of {}", kind(&rule["items"])),
            _ => format!("list of {}", kind(&rule["items"])),
        },
        "object" if rule["additionalProperties"].is_object() => {
            format!("table of {}", kind(&rule["additionalProperties"]))
        }
        "object" => "table".to_owned(),
        "string" => "text".to_owned(),
        "boolean" => "true or false".to_owned(),
        "integer" => "whole number".to_owned(),
        other => other.to_owned(),
    };
    names.into_iter().map(word).collect::<Vec<_>>().join(" or ")
}
