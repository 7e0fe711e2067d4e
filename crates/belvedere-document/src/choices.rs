//! Named choices of the scene file, for other interfaces that offer them.

use schemars::JsonSchema;
use serde_json::Value;

/// Name and description of each variant of a plain enum of the scene file, in the order of the schema; none for another type.
pub fn choices<T: JsonSchema>() -> Vec<(String, String)> {
    let schema = schemars::schema_for!(T);
    let variants = schema.get("oneOf").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let text =
        |variant: &Value, key: &str| variant.get(key).and_then(Value::as_str).map(|text| text.replace('\n', " "));
    variants.iter().filter_map(|v| Some((text(v, "const")?, text(v, "description").unwrap_or_default()))).collect()
}

#[cfg(test)]
mod tests {
    use super::choices;
    use crate::SurfaceDoc;

    #[test]
    fn every_choice_has_its_name_and_description_and_can_be_read() {
        let surfaces = choices::<SurfaceDoc>();
        assert_eq!(surfaces.len(), 7);
        assert_eq!(surfaces[3], ("water".into(), "Water: flat, with a shore line.".into()));
        for (name, says) in surfaces {
            assert!(says.ends_with('.'), "{name}: {says}");
            serde_json::from_value::<SurfaceDoc>(name.into()).unwrap();
        }
        assert!(choices::<f64>().is_empty());
    }
}
