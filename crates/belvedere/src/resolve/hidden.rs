//! Layers that are not drawn.

use crate::BelvedereError;
use crate::scene_file::{Document, SourceDocument, layer_names, suggestion};
use belvedere_scene::{BoxLayer, Representation, Scene};

/// Name of the representation that no section shows.
const HIDDEN: &str = "hidden";
/// Name of sections that name no representation.
const UNNAMED: &str = "all";

/// Checks that every hidden layer exists.
///
/// # Errors
/// An id of no layer.
pub(crate) fn check(source: &SourceDocument) -> Result<(), BelvedereError> {
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
pub(crate) fn apply(scene: &mut Scene, document: &Document) {
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

#[cfg(test)]
mod tests {
    use crate::picture::PictureOptions;
    use crate::scene_file::parse;
    use crate::{BelvedereError, OpenOptions, Session};
    use std::path::Path;

    const SCENE: &str = "[camera]\neye = [6000, -5200, 3600]\nlook_at = [0, 0, 300]\nimage = [160, 90]\n\
        [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n\
        [[layer]]\nkind = 'line'\nid = 'trail'\nsource = 'builtin:massif?seed=7&size=65'\nmust_see = true\n\
        [[layer]]\nkind = 'boxes'\nid = 'tower'\n[[layer.boxes]]\nbase = [0.0, 0.0, 0.0]\nsize = [2000.0, 2000.0, 4000.0]\n";

    /// Number of pixels of each layer, and whether anything must be seen.
    fn drawn(hidden: &str) -> Result<([usize; 3], bool), BelvedereError> {
        let source = parse(Path::new("s.toml"), &format!("format = 1\nhidden = [{hidden}]\n{SCENE}"))?;
        let session = Session::from_document(source, &OpenOptions::default())?;
        let id = session.render(&PictureOptions::default())?.frame.id;
        let required = session.scene().layers.iter().any(|layer| layer.must_see);
        Ok(([1, 2, 3].map(|layer| id.iter().filter(|id| **id == layer).count()), required))
    }

    #[test]
    fn a_hidden_layer_is_not_drawn_hides_nothing_and_is_not_required() {
        let ([ground, trail, tower], required) = drawn("").expect("picture");
        assert!(ground > 0 && trail > 0 && tower > 0 && required);
        let ([more, more_trail, none], _) = drawn("'tower'").expect("picture");
        assert!(none == 0 && more > ground && more_trail >= trail, "{more} {more_trail}");
        let ([_, none, _], required) = drawn("'trail'").expect("picture");
        assert!(none == 0 && !required);
        let ([none, line, solid], _) = drawn("'ground'").expect("picture");
        assert!(none == 0 && line > 0 && solid >= tower, "lines still lie on the ground: {none} {line} {solid}");
        let unknown = drawn("'towr'").expect_err("no such layer").to_string();
        assert!(unknown.contains("towr") && unknown.contains("tower"), "{unknown}");
    }
}
