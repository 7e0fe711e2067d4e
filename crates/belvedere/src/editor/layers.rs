//! Edits of the list of layers.

use crate::scene_file::{self, Document};
use serde_json::Value;
use std::path::Path;

/// The document with another id for a layer, wherever it is named: by stages, sections, constructors, animations and representations.
///
/// # Errors
/// One sentence if the new id is empty or taken, or if the document cannot be read with it.
pub fn with_layer_renamed(document: &Document, from: &str, to: &str) -> Result<Document, String> {
    let to = to.trim();
    if to.is_empty() {
        return Err("A layer needs a name.".into());
    }
    if document.layer.iter().any(|layer| layer.id() == to) {
        return Err(format!("There is a layer {to} already; choose another name."));
    }
    let mut value = serde_json::to_value(document).map_err(|e| e.to_string())?;
    for layer in value["layer"].as_array_mut().into_iter().flatten() {
        if layer["id"] == from {
            layer["id"] = to.into();
        }
    }
    for key in ["representations", "hidden", "stage", "constructor", "animation"] {
        if let Some(part) = value.get_mut(key) {
            replace(part, from, to);
        }
    }
    scene_file::parse(Path::new("scene.json"), &value.to_string())
        .map(|source| source.document)
        .map_err(|e| e.to_string())
}

/// The document without a layer; what named it by itself is removed with it.
pub fn without_layer(document: &Document, id: &str) -> Document {
    let mut next = document.clone();
    next.layer.retain(|layer| layer.id() != id);
    next.hidden.retain(|other| other != id);
    next.representations.values_mut().for_each(|members| members.retain(|member| member != id));
    let named = [format!("\"{id}\""), format!("\"{id}/")];
    let names = |part: String| named.iter().any(|name| part.contains(name));
    if next.constructor.as_ref().is_some_and(|doc| names(serde_json::to_string(doc).unwrap_or_default())) {
        next.constructor = None;
    }
    if next.animation.as_ref().is_some_and(|doc| names(serde_json::to_string(doc).unwrap_or_default())) {
        next.animation = None;
    }
    next.stage.retain(|stage| !names(serde_json::to_string(stage).unwrap_or_default()));
    next
}

/// Replaces texts that name a layer: the id alone, `ID/NUMBER`, `ID:KIND`.
fn replace(value: &mut Value, from: &str, to: &str) {
    match value {
        Value::String(text) => {
            let rest = text.strip_prefix(from);
            if let Some(rest) = rest.filter(|rest| rest.is_empty() || rest.starts_with(['/', ':'])) {
                *text = format!("{to}{rest}");
            }
        }
        Value::Array(list) => list.iter_mut().for_each(|item| replace(item, from, to)),
        Value::Object(map) => map.values_mut().for_each(|item| replace(item, from, to)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "format = 1\nhidden = ['way']\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[layer]]\nkind = 'line'\nid = 'way'\nsource = 'way.gpx'\n\
        [[layer]]\nkind = 'point'\nid = 'huts'\nsource = 'way.gpx'\n[[stage]]\nkind = 'strip'\nalong = 'way'\n\
        [constructor]\nkind = 'target_tracking'\ntarget = 'way/2'\n[representations]\nnear = ['way', 'huts']\n";

    fn document() -> Document {
        scene_file::parse(Path::new("s.toml"), SCENE).expect("scene").document
    }

    #[test]
    fn a_layer_is_renamed_wherever_it_is_named_and_nowhere_else() {
        let renamed = with_layer_renamed(&document(), "way", "the trail").expect("renamed");
        let text = serde_json::to_string(&renamed).expect("text");
        assert!(text.contains("\"way.gpx\"") && !text.contains("\"way\"") && !text.contains("\"way/2\""), "{text}");
        assert_eq!(renamed.constructor.as_ref().and_then(|doc| doc.target.as_deref()), Some("the trail/2"));
        assert_eq!(with_layer_renamed(&renamed, "the trail", "way").expect("back"), document());
        for taken in ["huts", " ", "way"] {
            assert!(with_layer_renamed(&document(), "way", taken).is_err(), "{taken:?}");
        }
    }

    #[test]
    fn what_follows_a_layer_goes_with_it() {
        let less = without_layer(&document(), "way");
        assert!(less.constructor.is_none() && less.stage.is_empty() && less.hidden.is_empty() && less.layer.len() == 1);
        let other = without_layer(&document(), "huts");
        assert!(other.constructor.is_some() && other.stage.len() == 1 && other.representations["near"] == ["way"]);
    }
}
