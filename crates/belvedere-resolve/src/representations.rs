//! Representations of a scene, and the styling sections that name them.

use super::spline;
use crate::BelvedereError;
use belvedere_core::presets::{BUILTIN_NAMES, PresetDocument};
use belvedere_document::paths::Roots;
use belvedere_document::{SourceDocument, StageDoc, Table, suggestion};
use belvedere_scene::Representation;

/// Name of sections that name no representation: the first one is shown.
const UNNAMED: &str = "all";

/// The representations of the document, and a further one for each layer that a section names; those of near sections first.
///
/// # Errors
/// A layer or a section of no known name; presets that cannot be read.
pub fn of(source: &SourceDocument, roots: &Roots) -> Result<Vec<Representation>, BelvedereError> {
    let layers: Vec<&str> = source.document.layer.iter().map(|layer| layer.id()).collect();
    let mut all: Vec<Representation> = Vec::new();
    for (id, members) in &source.document.representations {
        if let Some(unknown) = members.iter().find(|layer| !layers.contains(&layer.as_str())) {
            let hint = suggestion(unknown, &layers);
            let reason = format!("representation \"{id}\": there is no layer \"{unknown}\"; {hint}");
            return Err(source.error(&["representations", id], reason).into());
        }
        all.push(Representation { id: id.clone(), layers: members.clone() });
    }
    for (i, stage) in source.document.stage.iter().enumerate() {
        let StageDoc::SplineBend(stage) = stage else { continue };
        let at = Table { origin: &source.origin, list: "stage", index: i };
        let presets = spline::presets(roots, &stage.presets, &mut Vec::new(), at)?;
        let named: Vec<&str> = presets.presets.iter().flat_map(|p| &p.sections).map(String::as_str).collect();
        for &id in named.iter().filter(|id| **id != UNNAMED) {
            if all.iter().any(|r| r.id == id) {
                continue;
            }
            if layers.contains(&id) {
                all.push(Representation { id: id.to_owned(), layers: vec![id.to_owned()] });
            } else if !is_builtin(&presets) {
                let known: Vec<&str> = all.iter().map(|r| r.id.as_str()).chain(layers.iter().copied()).collect();
                let reason = format!(
                    "section \"{id}\" is neither a representation nor a layer of the scene; {}, or name its layers under [representations]",
                    suggestion(id, &known)
                );
                return Err(at.error(&["presets"], reason).into());
            }
        }
        // Pictures without the bend show the first representation: that of the nearest section.
        all.sort_by_key(|r| named.iter().position(|id| *id == r.id).unwrap_or(named.len()));
    }
    Ok(all)
}

/// Whether the presets are built in: a scene may lack the sections that they name.
fn is_builtin(presets: &PresetDocument) -> bool {
    BUILTIN_NAMES.iter().any(|name| PresetDocument::builtin(name).is_ok_and(|builtin| builtin == *presets))
}
