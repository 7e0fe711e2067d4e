//! Layers that are not drawn.

use crate::BelvedereError;
use belvedere_document::{Document, SourceDocument, layer_names, suggestion};
use belvedere_scene::{BoxLayer, Representation, Scene};

/// Name of the representation that no section shows.
const HIDDEN: &str = "hidden";
/// Name of sections that name no representation.
const UNNAMED: &str = "all";

/// Checks that every hidden layer exists.
///
/// # Errors
/// An id of no layer.
pub fn check(source: &SourceDocument) -> Result<(), BelvedereError> {
    let layers: Vec<&str> = source.document.layer.iter().map(|layer| layer.id()).collect();
    match source.document.hidden.iter().find(|id| !layers.contains(&id.as_str())) {
        None => Ok(()),
        Some(unknown) => {
            let hint = suggestion(unknown, &layers);
            Err(source.error(&["hidden"], format!("hidden: there is no layer \"{unknown}\"; {hint}")).into())
        }
    }
}

/// Hides the layers of the document's list: terrain, and what a stage, a constructor or an animation follows, is left out of pictures
/// and not required; other layers are emptied.
pub fn apply(scene: &mut Scene, document: &Document) {
    if document.hidden.is_empty() {
        return;
    }
    let followers = (&document.stage, &document.constructor, &document.animation);
    let is_hidden = |id: &String| document.hidden.contains(id);
    for layer in scene.layers.iter_mut().filter(|layer| is_hidden(&layer.id)) {
        layer.must_see = false;
        let moves = document.layer.iter().any(|doc| *doc.id() == *layer.id && doc.motion().is_some());
        let is_followed = moves || layer_names::is_named_by(&followers, &layer.id);
        if layer.kind.terrain().is_none() && !is_followed {
            layer.kind = BoxLayer::default().into();
        }
    }
    for representation in &mut scene.representations {
        representation.layers.retain(|id| !is_hidden(id));
    }
    if scene.representations.is_empty() {
        scene.representations.push(Representation { id: UNNAMED.into(), layers: Vec::new() });
    }
    scene.representations.push(Representation { id: HIDDEN.into(), layers: document.hidden.clone() });
}
