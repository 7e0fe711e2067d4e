//! The representations that the sections of a document name, kept while nothing changes that they depend on.

use crate::BelvedereError;
use crate::resolve::representations;
use crate::scene_file::paths::Roots;
use crate::scene_file::{Document, PresetsDoc, SourceDocument, StageDoc};
use belvedere_core::presets::BUILTIN_NAMES;
use belvedere_scene::Representation;
use std::collections::BTreeMap;

/// What representations depend on: those of the document, its layers, its bends along splines.
#[derive(Debug, PartialEq)]
struct Key {
    own: BTreeMap<String, Vec<String>>,
    layers: Vec<String>,
    bends: Vec<StageDoc>,
}

/// Representations of the last document.
#[derive(Debug, Default)]
pub(super) struct NamedSections {
    last: Option<(Key, Vec<Representation>)>,
}

impl NamedSections {
    /// As [`representations::of`].
    ///
    /// # Errors
    /// As [`representations::of`].
    pub(super) fn of(&mut self, document: &Document, roots: &Roots) -> Result<Vec<Representation>, BelvedereError> {
        let bends = document.stage.iter().filter(|stage| matches!(stage, StageDoc::SplineBend(_)));
        let key = Key {
            own: document.representations.clone(),
            layers: document.layer.iter().map(|layer| layer.id().to_owned()).collect(),
            bends: bends.cloned().collect(),
        };
        if let Some((_, known)) = self.last.as_ref().filter(|(last, _)| *last == key) {
            return Ok(known.clone());
        }
        let found = representations::of(&SourceDocument::new(document.clone()), roots)?;
        // A file of presets may change.
        let is_file = |stage: &StageDoc| match stage {
            StageDoc::SplineBend(bend) => {
                matches!(&bend.presets, PresetsDoc::Named(name) if !BUILTIN_NAMES.contains(&name.as_str()))
            }
            _ => false,
        };
        self.last = (!key.bends.iter().any(is_file)).then(|| (key, found.clone()));
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn representations_follow_the_document() {
        let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[representations]\nnear = ['a']\n\
            [[layer]]\nid = 'a'\nkind = 'terrain'\nsource = 'builtin:massif?seed=7&size=65'\n\
            [[stage]]\nkind = 'spline_bend'\npresets = 'map'\n";
        let mut document = crate::scene_file::parse(Path::new("s.toml"), text).expect("scene").document;
        let (mut named, roots) = (NamedSections::default(), Roots::default());
        let fresh =
            |document: &Document| representations::of(&SourceDocument::new(document.clone()), &Roots::default());
        let first = named.of(&document, &roots).expect("known");
        assert_eq!(first, fresh(&document).expect("known"));
        document.camera.fov_y_deg = 20.0;
        assert_eq!(named.of(&document, &roots).expect("the same"), first);
        document.representations.insert("far".into(), vec!["a".into()]);
        let next = named.of(&document, &roots).expect("changed");
        assert!(next != first && next == fresh(&document).expect("known"));
        document.representations.insert("wrong".into(), vec!["b".into()]);
        assert!(named.of(&document, &roots).is_err() && named.of(&document, &roots).is_err());
    }
}
