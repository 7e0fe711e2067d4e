//! A target point: its position in the scene and in the voxels of volumes.

use crate::BelvedereError;
use belvedere_core::DVec3;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{LayerKind, Scene, Unit, VolumeLayer};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// Position of a target point.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct TargetPlace {
    /// Scene coordinates as given.
    pub point: [f64; 3],
    /// Unit of the scene.
    pub unit: Unit,
    /// Position in every volume that contains the point.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub voxels: Vec<VoxelPlace>,
    /// Whether it lies outside the bounds of all layers.
    pub outside: bool,
    /// Kind of its mark in pictures.
    pub mark: &'static str,
}

/// A position in a volume.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct VoxelPlace {
    /// Id of the layer.
    pub layer: String,
    /// Voxel coordinates along x, y, z, the first voxel being 0.
    pub voxel: [f64; 3],
    /// Interpolated value there.
    pub value: f64,
    /// Opacity of that value over a reference step, 0..=1.
    pub opacity: f64,
    /// If that is opaque: the nearest point that is not, scene coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest_clear: Option<[f64; 3]>,
}

/// Opacity per reference step from which on rays do not enter matter.
const OPAQUE: f64 = 0.5;
/// Distance within which a point that is not opaque is searched, voxels.
const AROUND: i32 = 12;

impl TargetPlace {
    /// Refuses a point outside everything in a scene with volumes, which have nothing around them.
    ///
    /// # Errors
    /// [`BelvedereError::Position`].
    pub(crate) fn check(scene: &Scene, p: DVec3) -> Result<(), BelvedereError> {
        let bounds = scene.bounds();
        let holds_volumes = scene.layers.iter().any(|l| l.kind.volume().is_some());
        if !holds_volumes || bounds.is_empty() || (p.cmpge(bounds.min) & p.cmple(bounds.max)).all() {
            return Ok(());
        }
        let range = |axis: usize| {
            let [low, high] = [bounds.min, bounds.max].map(|corner| (corner[axis] * 1e6).round() / 1e6);
            format!("{} {low} to {high}", ["x", "y", "z"][axis])
        };
        let reason = format!(
            "the point {}, {}, {} lies outside everything in the scene ({}); give a point inside",
            p.x,
            p.y,
            p.z,
            [0, 1, 2].map(range).join(", ")
        );
        Err(BelvedereError::Position { what: "see", reason })
    }

    pub(crate) fn of(scene: &Scene, p: DVec3) -> Self {
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

    /// Warning about the position, if there is any.
    pub(crate) fn warning(&self) -> Option<Warning> {
        self.outside.then(|| {
            let text =
                "the point lies outside everything in the scene; give scene coordinates, `info` tells their range";
            Warning::new(WarningKind::Suspect, text).about("target")
        })
    }

    /// Why the point may be hidden from everywhere.
    pub(crate) fn why(&self) -> Option<String> {
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
