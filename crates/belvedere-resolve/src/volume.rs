//! Volume layers: files or built in, placed in the scene, with their transfer function.

use super::loader::Loader;
use super::{builtin, transfer};
use crate::BelvedereError;
use belvedere_core::{DMat3, DVec3, Warning, WarningKind};
use belvedere_document::{TransformDoc, VolumeDoc};
use belvedere_io::{ByteOrder, Number, RawLayout, VolumeFile, VolumeRequest, load_volume};
use belvedere_scene::{LayerKind, Volume, VolumeError, VolumeLayer};
use glam::EulerRot;

/// The layer.
pub(super) fn layer(loader: &mut Loader<'_>, index: usize, doc: &VolumeDoc) -> Result<LayerKind, BelvedereError> {
    let volume = if builtin::is_name(&doc.source) {
        loader.builtin(index, &doc.source, |kind| kind.volume().map(|layer| Volume::clone(&layer.volume)))?
    } else {
        let request = request(loader, index, doc)?;
        let path = loader.source_or_folder(index, &doc.source)?;
        let options = loader.options;
        options.progress.tick("reading volumes", 0.0)?;
        let file = match options.arrays.find(&path)? {
            Some(array) => loader.of_array(index, array, array.voxels()?.volume(&path, &request.limits)?),
            None => loader.take(index, load_volume(&path, &request)?),
        };
        made(file).map_err(|e| loader.fail(index, "source", e))?
    };
    let volume = match &doc.transform {
        Some(transform) => placed(volume, transform).map_err(|e| loader.fail(index, "transform", e))?,
        None => volume,
    };
    let constant = one_value(&volume);
    loader.note(index, constant);
    let transfer = transfer::find(loader, index, &doc.transfer, &volume)?;
    Ok(VolumeLayer { step: doc.step, model: doc.shading, ..VolumeLayer::new(volume, transfer) }.into())
}

/// The volume of a file.
pub fn made(file: VolumeFile) -> Result<Volume, VolumeError> {
    Volume::new(file.dims, file.axes, file.origin, file.values)
}

/// A warning about a volume of one value.
pub fn one_value(volume: &Volume) -> Option<Warning> {
    volume.is_constant().then(|| {
        let value = volume.range()[0];
        let text = format!(
            "all its values are {value}, so that nothing in it can be told apart; transfer functions by name show a translucent block"
        );
        Warning::new(WarningKind::Suspect, text).with("value", f64::from(value))
    })
}

fn request(loader: &Loader<'_>, index: usize, doc: &VolumeDoc) -> Result<VolumeRequest, BelvedereError> {
    let number = doc.sample_type.as_ref().map(|name| {
        Number::named(name).ok_or_else(|| {
            let reason = format!("type \"{name}\" is not known; give uint8, int8, uint16, int16, float32 or float64");
            loader.fail(index, "type", reason)
        })
    });
    let order = doc.big_endian.map(|big| if big { ByteOrder::Big } else { ByteOrder::Little });
    let raw = RawLayout { dims: doc.dims, number: number.transpose()?, spacing: doc.spacing, order };
    Ok(VolumeRequest { array: doc.array.clone(), raw, limits: loader.options.limits() })
}

/// Scaled, turned about x, then y, then z, and moved.
fn placed(volume: Volume, transform: &TransformDoc) -> Result<Volume, String> {
    if !(transform.scale > 0.0) {
        return Err(format!("scale is {}, it must be greater than 0", transform.scale));
    }
    let [x, y, z] = transform.rotate_deg.map(f64::to_radians);
    let turn = DMat3::from_euler(EulerRot::ZYX, z, y, x) * transform.scale;
    volume.placed(turn, DVec3::from_array(transform.translate)).map_err(|e| e.to_string())
}
