//! Buffers beside a picture as channels of one OpenEXR file.

use super::AuxBuffer;
use crate::BelvedereError;
use belvedere_core::{DVec3, View};
use belvedere_io::open_exr::{self, Channel};
use belvedere_scene::Frame;
use belvedere_sight::RigidLayers;
use std::path::Path;

/// Displaced minus world position of every pixel, NaN where the pixel shows no surface.
pub(super) fn displacement<'f>(
    (view, rigid): (&'f View, &'f RigidLayers),
    frame: &'f Frame,
) -> impl Iterator<Item = [f64; 3]> + 'f {
    frame.world.iter().flatten().enumerate().map(move |(i, p)| {
        let p = DVec3::from_array(*p);
        rigid.displaced(view, frame, i, p).map_or([f64::NAN; 3], |to| (to - p).to_array())
    })
}

/// Writes `depth.Z` (float), `id` (uint), `world.X/Y/Z` and `displacement.X/Y/Z` (float).
///
/// World positions are relative to whole numbers near the eye, attribute `worldOrigin`, since scene coordinates do not fit into 32 bits.
pub(super) fn write(
    frame: &Frame,
    (view, rigid): (&View, &RigidLayers),
    buffers: &[AuxBuffer],
    path: &Path,
    overwrite: bool,
) -> Result<(), BelvedereError> {
    let origin = view.pinhole().eye.round().to_array();
    let world = frame.world.as_deref().unwrap_or_default();
    let mut channels: Vec<(String, Channel)> = Vec::new();
    let mut vector = |name: &str, of: &mut dyn Iterator<Item = [f64; 3]>| {
        let values: Vec<[f32; 3]> = of.map(|p| p.map(|v| v as f32)).collect();
        for (i, axis) in ["X", "Y", "Z"].iter().enumerate() {
            channels.push((format!("{name}.{axis}"), Channel::Float(values.iter().map(|v| v[i]).collect())));
        }
    };
    if buffers.contains(&AuxBuffer::World) {
        vector("world", &mut world.iter().map(|p| std::array::from_fn(|i| p[i] - origin[i])));
    }
    if buffers.contains(&AuxBuffer::Displacement) {
        vector("displacement", &mut displacement((view, rigid), frame));
    }
    if buffers.contains(&AuxBuffer::Depth) {
        channels.push(("depth.Z".into(), Channel::Float(frame.depth.clone())));
    }
    if buffers.contains(&AuxBuffer::Id) {
        channels.push(("id".into(), Channel::Uint(frame.id.clone())));
    }
    let origin_text = origin.map(|v| format!("{v}")).join(" ");
    Ok(open_exr::write(path, overwrite, frame.width, frame.height, channels, &[("worldOrigin", &origin_text)])?)
}
