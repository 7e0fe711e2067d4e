//! Context in which stages are resolved.

use super::camera::ResolvedCamera;
use super::ground::Ground;
use crate::BelvedereError;
use belvedere_core::map::spline::ReferencePlane;
use belvedere_core::{DVec3, Stage};
use belvedere_document::paths::Roots;
use belvedere_document::{PlaneDoc, SourceDocument, Table};
use belvedere_scene::Scene;

/// Context in which stages are resolved.
pub(super) struct StageContext<'a> {
    pub(super) source: &'a SourceDocument,
    pub(super) roots: &'a Roots,
    pub(super) scene: &'a Scene,
    pub(super) ground: &'a Ground<'a>,
    pub(super) camera: &'a ResolvedCamera,
    /// Stages before those of the document, such as the earth's curvature.
    pub(super) earth: &'a [Stage],
    /// Whether presets are checked at viewing angles that the picture does not show.
    pub(super) checks: bool,
}

impl StageContext<'_> {
    pub(super) fn at(&self, index: usize) -> Table<'_> {
        Table { origin: &self.source.origin, list: "stage", index }
    }
}

/// The reference plane and its height along the unit normal.
pub(super) fn plane(
    context: &StageContext<'_>,
    doc: Option<&PlaneDoc>,
    at: Table<'_>,
) -> Result<(ReferencePlane, f64), BelvedereError> {
    let normal = doc.map_or(DVec3::Z, |p| DVec3::from_array(p.normal));
    let unit = normal.try_normalize().ok_or_else(|| {
        at.error(&["plane", "normal"], "plane normal is [0, 0, 0], it needs a direction; [0, 0, 1] is level ground")
    })?;
    let height = match doc.and_then(|p| p.height_m) {
        Some(height) => height,
        None => plane_point(context, at)?.dot(unit),
    };
    let plane = ReferencePlane::new(normal, height)
        .ok_or_else(|| at.error(&["plane"], "the reference plane is not finite; give a normal and a height"))?;
    Ok((plane, height))
}

/// A point of the default plane: at the median height of the terrain, or at look_at.
fn plane_point(context: &StageContext<'_>, at: Table<'_>) -> Result<DVec3, BelvedereError> {
    let look_at = context.camera.look_at;
    if let Some(terrain) = context.ground.terrain {
        let over = look_at.unwrap_or(context.camera.pinhole.eye);
        return Ok(over.truncate().extend(terrain.median_height()));
    }
    Ok(look_at.ok_or_else(|| {
        at.error(&["plane"], "nothing says where the reference plane lies: there is no terrain and no look_at; give plane = { height_m = ... }")
    })?)
}
