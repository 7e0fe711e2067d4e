//! Buffers beside a picture as channels of one OpenEXR file.

use super::options::AuxBuffer;
use crate::BelvedereError;
use belvedere_core::{DVec3, View};
use belvedere_io::open_exr::{self, Channel};
use belvedere_scene::Frame;
use std::path::Path;

/// Displaced minus world position, NaN where there is none.
pub(super) fn displacement(view: &View, p: [f64; 3]) -> [f64; 3] {
    let p = DVec3::from_array(p);
    let to = if p.is_finite() { view.displace(p).ok() } else { None };
    to.map_or([f64::NAN; 3], |d| (d.point - p).to_array())
}

/// Writes `depth.Z` (float), `id` (uint), `world.X/Y/Z` and `displacement.X/Y/Z` (float).
///
/// World positions count from whole numbers near the eye, attribute `worldOrigin`: the scene's own would not fit into 32 bits.
pub(super) fn write(
    frame: &Frame,
    view: &View,
    buffers: &[AuxBuffer],
    path: &Path,
    overwrite: bool,
) -> Result<(), BelvedereError> {
    let origin = view.pinhole().eye.round().to_array();
    let world = frame.world.as_deref().unwrap_or_default();
    let mut channels: Vec<(String, Channel)> = Vec::new();
    let mut vector = |name: &str, of: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let values: Vec<[f32; 3]> = world.iter().map(|p| of(*p).map(|v| v as f32)).collect();
        for (i, axis) in ["X", "Y", "Z"].iter().enumerate() {
            channels.push((format!("{name}.{axis}"), Channel::Float(values.iter().map(|v| v[i]).collect())));
        }
    };
    if buffers.contains(&AuxBuffer::World) {
        vector("world", &|p| std::array::from_fn(|i| p[i] - origin[i]));
    }
    if buffers.contains(&AuxBuffer::Displacement) {
        vector("displacement", &|p| displacement(view, p));
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
