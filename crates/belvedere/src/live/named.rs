//! The representations that the sections of a document name, kept while nothing changes that they depend on.

use crate::BelvedereError;
use crate::scene_file::paths::Roots;
use crate::scene_file::{Document, PresetsDoc, SourceDocument, StageDoc};
use belvedere_core::presets::BUILTIN_NAMES;
use belvedere_resolve::representations;
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
mod tests;
