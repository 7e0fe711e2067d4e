//! A point that is to be seen: where it is, in the scene and in the voxels of volumes.

use crate::overlays::ring;
use crate::picture::Picture;
use crate::scene_file::LayerDoc;
use crate::{BelvedereError, OpenOptions};
use belvedere_construct::rays::BendReport;
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::{Layer, LayerKind, Scene, Unit, VolumeLayer};
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// Where a point is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetPlace {
    /// Scene coordinates, as it was asked for.
    pub point: [f64; 3],
    /// Unit of the scene.
    pub unit: Unit,
    /// The same in every volume that it lies in.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub voxels: Vec<VoxelPlace>,
    /// Whether it lies outside everything that the scene holds.
    pub outside: bool,
    /// How pictures mark it.
    pub mark: &'static str,
}

/// A place in a volume.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VoxelPlace {
    /// Id of the layer.
    pub layer: String,
    /// Voxel coordinates along x, y, z, the first voxel being 0.
    pub voxel: [f64; 3],
    /// Value there, interpolated.
    pub value: f64,
    /// Opacity of that value over a reference step, 0..=1.
    pub opacity: f64,
    /// If that is opaque: the nearest place that is not, scene coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest_clear: Option<[f64; 3]>,
}

/// Opacity per reference step from which on rays do not get into matter.
const OPAQUE: f64 = 0.5;
/// How far around a place in such matter another is looked for, voxels.
const AROUND: i32 = 12;

/// The point that `x,y,z` means; `None` if it is something else.
pub(super) fn point(see: &str) -> Option<DVec3> {
    let numbers: Vec<f64> = see.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    match numbers[..] {
        [x, y, z] => Some(DVec3::new(x, y, z)).filter(|p| p.is_finite()),
        _ => None,
    }
}

/// Sets the transfer function of all volumes; a file may lie where it likes.
pub(super) fn set_transfer(
    layers: &mut [LayerDoc],
    transfer: &str,
    options: &mut OpenOptions,
) -> Result<(), BelvedereError> {
    let is_file = [".toml", ".json"].iter().any(|e| transfer.to_ascii_lowercase().ends_with(e));
    let mut name = transfer.to_owned();
    if is_file {
        let path =
            belvedere_io::fs::canonicalize(transfer).map_err(|e| belvedere_io::IoError::os(Path::new(transfer), e))?;
        options.allow_roots.extend(path.parent().map(Path::to_owned));
        name = path.to_str().ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))?.to_owned();
    }
    let mut volumes = layers.iter_mut().filter_map(|l| match l {
        LayerDoc::Volume(v) => Some(v),
        _ => None,
    });
    let Some(first) = volumes.next() else {
        return Err(BelvedereError::Target("--transfer is for volumes, and none is given; leave it out".into()));
    };
    first.transfer.clone_from(&name);
    volumes.for_each(|v| v.transfer.clone_from(&name));
    Ok(())
}

impl TargetPlace {
    pub(super) fn of(scene: &Scene, p: DVec3) -> Self {
        let voxels = scene.layers.iter().filter_map(|l| match &l.kind {
            LayerKind::Volume(v) => {
                let voxel = v.volume.lattice_from_scene(p);
                let value = v.volume.at(voxel)?;
                let opacity = v.transfer.at(value)[3];
                let nearest_clear = if opacity >= OPAQUE { nearest_clear(v, voxel) } else { None };
                Some(VoxelPlace { layer: l.id.clone(), voxel: voxel.to_array(), value, opacity, nearest_clear })
            }
            _ => None,
        });
        let bounds = scene.bounds();
        let inside = p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
        let mark = "a ring around it, of dashes where it is hidden";
        Self { point: p.to_array(), unit: scene.unit, voxels: voxels.collect(), outside: !inside, mark }
    }

    /// Marks the point in both pictures.
    pub(super) fn mark(&self, picture: &mut Picture, report: &BendReport) {
        let p = DVec3::from_array(self.point);
        let straight = picture.view.straightened();
        let frames = [
            (Some(&mut picture.frame), &picture.view, report.visible),
            (picture.straight.as_mut(), &straight, report.visible_straight),
        ];
        for (frame, view, visible) in frames {
            if let (Some(frame), Ok(image)) = (frame, view.project(p))
                && image.pixel.length() < 1e6
            {
                ring::draw(frame, image.pixel, visible < 0.5);
            }
        }
    }

    /// What is odd about the place.
    pub(super) fn warning(&self) -> Option<String> {
        self.outside.then(|| {
            "the point lies outside everything in the scene; give scene coordinates, `info` tells their range".into()
        })
    }

    /// Why the point may be hidden from everywhere.
    pub(super) fn why(&self) -> Option<String> {
        let deep = self.voxels.iter().find(|place| place.opacity >= OPAQUE)?;
        let clear = deep
            .nearest_clear
            .map_or_else(String::new, |[x, y, z]| format!("; the nearest place that is not is {x:.1},{y:.1},{z:.1}"));
        Some(format!(
            "the point lies in opaque matter of {} ({:.2} per reference step){clear}",
            deep.layer, deep.opacity
        ))
    }
}

/// The nearest voxel that is not opaque, scene coordinates.
fn nearest_clear(layer: &VolumeLayer, voxel: DVec3) -> Option<[f64; 3]> {
    let volume = &*layer.volume;
    let middle = voxel.round();
    let mut best: Option<(f64, DVec3)> = None;
    for i in 0..(2 * AROUND + 1).pow(3) {
        let n = 2 * AROUND + 1;
        let q = middle
            + DVec3::new(f64::from(i % n - AROUND), f64::from(i / n % n - AROUND), f64::from(i / n / n - AROUND));
        let Some(value) = volume.at(q) else { continue };
        let far = (*volume.axes() * (q - voxel)).length();
        if layer.transfer.at(value)[3] < OPAQUE && best.is_none_or(|(b, _)| far < b) {
            best = Some((far, q));
        }
    }
    best.map(|(_, q)| volume.scene_from_lattice(q).to_array())
}

/// Box around what is visible of a scene.
pub(super) fn visible_bounds(scene: &Scene) -> Aabb {
    let of = |l: &Layer| match &l.kind {
        LayerKind::Volume(v) => v.visible_bounds(),
        _ => l.bounds(),
    };
    let visible = scene.layers.iter().map(of).filter(|b| !b.is_empty()).reduce(|a, b| a.union(b));
    visible.unwrap_or_else(|| scene.bounds())
}

impl fmt::Display for TargetPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.point;
        write!(f, "point {x}, {y}, {z} in scene coordinates")?;
        for place in &self.voxels {
            let [i, j, k] = place.voxel;
            write!(f, ", voxel {i:.1}, {j:.1}, {k:.1} of {} with value {:.0}", place.layer, place.value)?;
        }
        if self.outside { write!(f, ", outside everything in the scene") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_three_numbers_and_nothing_else() {
        assert_eq!(point("1, -2.5,3e1"), Some(DVec3::new(1.0, -2.5, 30.0)));
        for other in ["1,2", "1,2,3,4", "a,1,2,3", "1,2,x", "nan,1,2", "chain A"] {
            assert_eq!(point(other), None, "{other}");
        }
    }
}
