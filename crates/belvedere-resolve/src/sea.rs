//! The sea of a terrain, as a layer of its own behind all others.

use super::builtin;
use super::loader::Loader;
use crate::record::AreaRecord;
use belvedere_document::TerrainDoc;
use belvedere_scene::{AreaFeature, AreaLayer, AreaSurface, Hidden, Layer, LayerKind, Sea, TerrainLayer};

/// The sea of a terrain layer; `None` if it has none, or none is to be drawn.
pub(super) fn layer(loader: &mut Loader<'_>, doc: &TerrainDoc, terrain: &TerrainLayer) -> Option<Layer> {
    let wanted = doc.style.sea && !doc.source.as_slice().iter().any(|name| builtin::is_name(name));
    let sea = if wanted { Sea::of(&terrain.heightfield) } else { None }?;
    let taken = |id: &str| loader.layers.iter().any(|l| l.id() == id) || loader.areas.iter().any(|a| a.layer == id);
    let id = if taken("sea") { format!("sea of {}", doc.id) } else { "sea".to_owned() };
    let why = format!(
        "{:.1} km2 of connected ground at {} m reach the edge of \"{}\"",
        sea.area_m2 / 1e6,
        sea.level_m,
        doc.id
    );
    let surface = AreaSurface::Sea;
    loader.areas.push(AreaRecord { layer: id.clone(), kind: surface.name(), areas: 1, why });
    // Every second ring of a feature is a hole.
    let features = vec![AreaFeature { style: None, name: "Sea".into(), rings: sea.coasts }];
    let (fill, outline, width_px, hidden, lift_m) = (surface.color(), None, 1.0, Hidden::Cut, 0.0);
    let kind = LayerKind::Area(AreaLayer {
        features,
        fill,
        outline,
        width_px,
        surface,
        hidden,
        lift_m,
        label_px: None,
        beyond: 0.0,
    });
    Some(Layer { id, must_see: false, kind })
}
