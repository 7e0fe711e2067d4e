//! Explosion: parts are moved aside until their images are clear of the target's.

use super::occluders::{Extent, Part, is_one_of};
use belvedere_core::{DVec3, View};
use belvedere_scene::{LayerKind, OwnLayer, Scene, Unit};

/// Directions across the view that are tried.
const DIRECTIONS: usize = 16;
/// Number of halvings of the distance.
const HALVINGS: usize = 30;

/// The shortest displacement, scene units, that moves the image of a part clear of the target's: the best of 16 directions across the
/// view, none of them into the ground. `None` if no direction does.
/// * `target`: extent of the target's image; the part keeps `margin_px` away from it.
pub(super) fn way(view: &View, unit: Unit, part: &Part, target: &Extent, margin_px: f64) -> Option<DVec3> {
    let pinhole = view.pinhole();
    let is_clear = |by: DVec3| {
        let corners: Vec<DVec3> = part.corners.iter().map(|c| *c + by).collect();
        Extent::of(view, &corners).is_some_and(|e| !e.meets(target, margin_px))
    };
    let far = part.corners.iter().map(|c| c.distance(pinhole.eye)).fold(0.0, f64::max);
    let ways = (0..DIRECTIONS).filter_map(|k| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).sin_cos();
        let mut direction = cos * pinhole.right + sin * pinhole.down;
        if unit == Unit::Metre && direction.z < 0.0 {
            // Downward directions are projected onto the ground; straight down is left out.
            direction.z = 0.0;
        }
        let direction = direction.try_normalize()?;
        let mut high = 1e-3 * far;
        while !is_clear(high * direction) {
            high *= 2.0;
            if high > 2.0 * far {
                return None;
            }
        }
        let mut low = 0.0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if is_clear(middle * direction) { high = middle } else { low = middle }
        }
        Some(high * direction)
    });
    ways.min_by(|a, b| a.length().total_cmp(&b.length()))
}

/// The scene with parts moved, their shape unchanged.
pub(super) fn moved(scene: &Scene, moves: &[(&Part, DVec3)]) -> Scene {
    let mut out = scene.clone();
    for (i, layer) in out.layers.iter_mut().enumerate() {
        let of = |number: usize| {
            let is = |part: &Part| part.layer == i && part.number.is_none_or(|n| n == number);
            moves.iter().find(|(part, _)| is(part)).map_or(DVec3::ZERO, |(_, by)| *by)
        };
        if !moves.iter().any(|(part, _)| part.layer == i) {
            continue;
        }
        match &mut layer.kind {
            LayerKind::Boxes(b) => b.boxes.iter_mut().enumerate().for_each(|(k, b)| b.base += of(k)),
            LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) => {
                m.mesh = m.mesh.moved(&|t| of(m.mesh.part(t).unwrap_or(0) as usize))
            }
            LayerKind::Molecule(m) => {
                let spared = moves.iter().find(|(part, _)| part.layer == i).map_or(&[][..], |(part, _)| &part.spared);
                let mesh = &m.surface.mesh;
                let by = |t: usize| if is_one_of(spared, mesh.part(t)) { DVec3::ZERO } else { of(0) };
                m.surface.mesh = mesh.moved(&by);
            }
            _ => {}
        }
    }
    out
}
