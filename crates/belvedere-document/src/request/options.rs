//! The options of a request: their names, those that are given, and a request from JSON.

use crate::suggestion;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// A request of a verb: an object of options, with a schema.
pub trait Request: DeserializeOwned + JsonSchema {}
impl<T: DeserializeOwned + JsonSchema> Request for T {}

/// Names of the options of a request, in the order of its fields, those of its groups among them.
pub fn options<T: JsonSchema>() -> Vec<String> {
    let schema = schemars::schema_for!(T);
    let properties = schema.get("properties").and_then(Value::as_object);
    properties.map(|all| all.keys().cloned().collect()).unwrap_or_default()
}

/// Verbs whose request is data.
pub const WITH_REQUEST: [&str; 7] = ["animate", "disocclude", "export", "generalise", "measure", "render", "reveal"];

/// The JSON Schema of the request of a verb, one of [`WITH_REQUEST`]; `None` for another one.
pub fn schema(verb: &str) -> Option<String> {
    let mut schema = match verb {
        "animate" => schemars::schema_for!(super::Animate),
        "disocclude" => schemars::schema_for!(super::Disocclude),
        "export" => schemars::schema_for!(super::Export),
        "generalise" => schemars::schema_for!(super::Generalise),
        "measure" => schemars::schema_for!(super::Measure),
        "render" => schemars::schema_for!(super::Render),
        "reveal" => schemars::schema_for!(super::Reveal),
        _ => return None,
    };
    schema.insert("title".into(), format!("what belvedere {verb} is asked").into());
    serde_json::to_string_pretty(&schema).ok().map(|text| text + "\n")
}

/// Names of the options of a request that are not as they are by default.
fn given<T: Serialize + Default>(request: &T) -> Vec<String> {
    let keys = |request: &T| serde_json::to_value(request).unwrap_or_default();
    let (asked, usual) = (keys(request), keys(&T::default()));
    let differs = |(key, value): (&String, &Value)| (usual.get(key) != Some(value)).then(|| key.clone());
    asked.as_object().into_iter().flatten().filter_map(differs).collect()
}

/// Those of `names` that are not as they are by default.
pub fn given_of<T: Serialize + Default>(request: &T, names: &[&'static str]) -> Vec<&'static str> {
    let given = given(request);
    names.iter().copied().filter(|name| given.iter().any(|given| given == name)).collect()
}

/// A request from JSON: an object of its options.
///
/// # Errors
/// A sentence with the option that is unknown, or whose value is wrong.
pub fn read<T: Request>(text: &str) -> Result<T, String> {
    let value: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    let known = options::<T>();
    let asked = value.as_object().ok_or("a request is an object of options")?;
    if let Some(name) = asked.keys().find(|name| !known.contains(name)) {
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        return Err(format!("unknown option \"{name}\"; {}", suggestion(name, &known)));
    }
    // Each alone, for serde names no key of a group.
    for (name, value) in asked {
        let alone = serde_json::Map::from_iter([(name.clone(), value.clone())]);
        serde_json::from_value::<T>(Value::Object(alone)).map_err(|e| format!("{name}: {e}"))?;
    }
    serde_json::from_value(value).map_err(|e| e.to_string())
}
