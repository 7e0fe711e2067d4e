//! Edits of the list of layers.

use belvedere::scene_file::{self, Document, layer_names};
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
    for key in ["stage", "constructor", "animation"] {
        if let Some(part) = value.get_mut(key) {
            layer_names::each(part, &mut |text| {
                if let Some(rest) = layer_names::rest(text, from) {
                    *text = format!("{to}{rest}");
                }
            });
        }
    }
    let mut renamed = scene_file::parse(Path::new("scene.json"), &value.to_string())
        .map(|source| source.document)
        .map_err(|e| e.to_string())?;
    let lists = renamed.representations.values_mut().chain([&mut renamed.hidden]);
    lists.flatten().filter(|member| *member == from).for_each(|member| *member = to.to_owned());
    Ok(renamed)
}

/// The document without a layer; what named it by itself is removed with it.
pub fn without_layer(document: &Document, id: &str) -> Document {
    let mut next = document.clone();
    next.layer.retain(|layer| layer.id() != id);
    next.hidden.retain(|other| other != id);
    next.representations.values_mut().for_each(|members| members.retain(|member| member != id));
    next.constructor.take_if(|doc| layer_names::is_named_by(doc, id));
    next.animation.take_if(|doc| layer_names::is_named_by(doc, id));
    next.stage.retain(|stage| !layer_names::is_named_by(stage, id));
    next
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
    fn ids_that_are_words_of_the_format_are_told_from_them() {
        for word in ["strip", "target", "along", "kind", "target_tracking"] {
            let renamed = with_layer_renamed(&document(), "huts", word).expect("renamed");
            assert_eq!(renamed.representations["near"], ["way", word]);
            assert_eq!(with_layer_renamed(&renamed, word, "huts").expect("back"), document(), "{word}");
            let less = without_layer(&renamed, word);
            assert!(less.constructor.is_some() && less.stage.len() == 1 && less.layer.len() == 1, "{word}");
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
