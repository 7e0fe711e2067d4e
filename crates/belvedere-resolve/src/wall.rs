//! Volumes around the path of a preview, drawn as its wall alone.

use crate::BelvedereError;
use belvedere_construct::ConstructError;
use belvedere_construct::rays::{Wall, find_wall, share_inside};
use belvedere_core::DVec3;
use belvedere_core::{Warning, WarningKind};
use belvedere_document::{LayerDoc, SourceDocument, VolumeDoc};
use belvedere_scene::volume::WALL;
use belvedere_scene::{Scene, TransferFunction};
use serde::{Deserialize, Serialize};

/// Share of the path inside a volume from which on the volume is drawn as a wall by default.
const INSIDE: f64 = 0.5;
/// Transfer function of volumes without one.
const AUTO: &str = "auto";

/// A volume that is drawn as the wall around the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WallReport {
    /// Id of the layer.
    pub layer: String,
    /// The wall.
    #[serde(flatten)]
    pub wall: Wall,
}

impl WallReport {
    fn transfer(&self) -> TransferFunction {
        TransferFunction::wall(self.wall.lumen, self.wall.isovalue, self.wall.wall)
    }
}

/// Refuses walls in scenes without a path preview.
pub(super) fn check(source: &SourceDocument, previews: bool) -> Result<(), BelvedereError> {
    let asks = |layer: &LayerDoc| matches!(layer, LayerDoc::Volume(v) if v.transfer == WALL);
    match source.document.layer.iter().position(asks) {
        Some(index) if !previews => {
            let reason = "transfer \"wall\" is the wall around the path of a preview, and there is none; add [constructor] with kind = \"path_preview\", or name another transfer";
            Err(fail(source, index, reason))
        }
        _ => Ok(()),
    }
}

/// The walls around a path: of volumes that ask for one, and of volumes without a transfer function that contain most of the path; and a
/// warning for each of the latter without a wall.
pub(super) fn around(
    source: &SourceDocument,
    scene: &Scene,
    path: &[DVec3],
) -> Result<(Vec<WallReport>, Vec<Warning>), BelvedereError> {
    let (mut walls, mut warnings) = (Vec::new(), Vec::new());
    for (index, doc) in volumes(source) {
        let is_asked = doc.transfer == WALL;
        let Some(layer) = scene.layers.iter().find(|l| l.id == doc.id) else { continue };
        let Some(volume) = layer.kind.volume() else { continue };
        let is_meant = is_asked || (doc.transfer == AUTO && share_inside(&volume.volume, path) >= INSIDE);
        if !is_meant {
            continue;
        }
        match find_wall(&volume.volume, path) {
            Ok(wall) => walls.push(WallReport { layer: doc.id.clone(), wall }),
            Err(e @ (ConstructError::NoWall { .. } | ConstructError::PathOutside)) if !is_asked => {
                let text = format!("layer \"{}\": {e}; it is drawn with transfer \"{AUTO}\"", doc.id);
                warnings.push(Warning::new(WarningKind::Fallback, text).about(&doc.id));
            }
            Err(e) => return Err(fail(source, index, &e.to_string())),
        }
    }
    Ok((walls, warnings))
}

/// The scene with exactly these walls; `None` if nothing changes.
pub fn drawn(scene: &Scene, walls: &[WallReport]) -> Option<Scene> {
    let mut changed = None;
    for (i, layer) in scene.layers.iter().enumerate() {
        let Some(volume) = layer.kind.volume() else { continue };
        let transfer = match walls.iter().find(|wall| wall.layer == layer.id) {
            Some(wall) => wall.transfer(),
            // A wall of an earlier path is replaced.
            None if volume.transfer.name() == WALL => TransferFunction::auto(&volume.volume),
            None => continue,
        };
        if transfer != volume.transfer {
            let changed: &mut Scene = changed.get_or_insert_with(|| scene.clone());
            if let Some(volume) = changed.layers[i].kind.volume_mut() {
                volume.transfer = transfer;
            }
        }
    }
    changed
}

fn volumes(source: &SourceDocument) -> impl Iterator<Item = (usize, &VolumeDoc)> {
    source.document.layer.iter().enumerate().filter_map(|(i, layer)| match layer {
        LayerDoc::Volume(doc) => Some((i, doc)),
        _ => None,
    })
}

fn fail(source: &SourceDocument, index: usize, reason: &str) -> BelvedereError {
    let id = source.document.layer[index].id();
    source.error(&["layer", &index.to_string(), "transfer"], format!("layer \"{id}\": {reason}")).into()
}
