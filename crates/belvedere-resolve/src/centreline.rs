//! Centrelines of volumes, from `centreline` of a constructor or a tube.

use crate::BelvedereError;
use belvedere_construct::centreline::{Centreline, centreline};
use belvedere_core::DVec3;
use belvedere_document::{CentrelineDoc, DocumentError};
use belvedere_scene::volume::threshold;
use belvedere_scene::{LayerKind, Scene, Volume};

/// The centreline that a document requests.
///
/// * `fail`: the error at a key of its table.
pub(super) fn read(
    scene: &Scene,
    doc: &CentrelineDoc,
    fail: &dyn Fn(&str, String) -> DocumentError,
) -> Result<Centreline, BelvedereError> {
    let layer = scene.layers.iter().find(|l| l.id == doc.volume);
    let volume = match layer.map(|l| &l.kind) {
        Some(LayerKind::Volume(layer)) => &*layer.volume,
        Some(_) => return Err(fail("volume", format!("layer \"{}\" is no volume; name one", doc.volume)).into()),
        None => {
            let ids: Vec<&str> = scene.layers.iter().map(|l| l.id.as_str()).collect();
            let hint = belvedere_document::suggestion(&doc.volume, &ids);
            return Err(fail("volume", format!("volume \"{}\" is no layer of the scene; {hint}", doc.volume)).into());
        }
    };
    let [from, to] = [doc.from, doc.to].map(DVec3::from_array);
    let values = match doc.values {
        Some(values) => values,
        None => same_side(volume, [from, to]).map_err(|reason| fail("from", reason))?,
    };
    Ok(centreline(volume, from, to, values).map_err(|e| fail("from", e.to_string()))?)
}

/// The values on the side of the histogram's threshold on which both points are.
fn same_side(volume: &Volume, points: [DVec3; 2]) -> Result<[f64; 2], String> {
    let [lo, hi] = volume.range().map(f64::from);
    let parted = threshold(volume);
    let value = |p: DVec3| volume.at(volume.lattice_from_scene(p));
    match points.map(value) {
        [Some(a), Some(b)] if a >= parted && b >= parted => Ok([parted, hi]),
        [Some(a), Some(b)] if a < parted && b < parted => Ok([lo, parted]),
        [Some(a), Some(b)] => Err(format!(
            "the values at from and to, {a:.1} and {b:.1}, lie on both sides of the threshold {parted:.1} between background and matter; give values = [least, greatest]"
        )),
        [a, _] => {
            let (name, p) = if a.is_none() { ("from", points[0]) } else { ("to", points[1]) };
            Err(format!("{name} = [{}, {}, {}] lies outside the volume; give scene coordinates", p.x, p.y, p.z))
        }
    }
}
