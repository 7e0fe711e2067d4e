//! Where stages, constructors and animations name layers.

use serde::Serialize;
use serde_json::Value;

/// Keys whose texts name layers.
const KEYS: [&str; 7] = ["along", "fallback", "layer", "path", "rivers", "target", "volume"];

/// What follows the id where a text names a layer: nothing, `/PART` or `:KIND`; `None` if it names none of that id.
pub fn rest<'a>(text: &'a str, id: &str) -> Option<&'a str> {
    text.strip_prefix(id).filter(|rest| rest.is_empty() || rest.starts_with(['/', ':']))
}

/// Calls `visit` with every text of a part of a document that may name a layer.
pub fn each(part: &mut Value, visit: &mut dyn FnMut(&mut String)) {
    match part {
        Value::Object(map) => {
            for (key, value) in map {
                if KEYS.contains(&key.as_str()) { texts(value, visit) } else { each(value, visit) }
            }
        }
        Value::Array(list) => list.iter_mut().for_each(|item| each(item, visit)),
        _ => {}
    }
}

fn texts(value: &mut Value, visit: &mut dyn FnMut(&mut String)) {
    match value {
        Value::String(text) => visit(text),
        Value::Array(list) => list.iter_mut().for_each(|item| texts(item, visit)),
        other => each(other, visit),
    }
}

/// Whether a part of a document names a layer.
pub fn is_named_by(part: &impl Serialize, id: &str) -> bool {
    let mut found = false;
    if let Ok(mut value) = serde_json::to_value(part) {
        each(&mut value, &mut |text| found |= rest(text, id).is_some());
    }
    found
}
