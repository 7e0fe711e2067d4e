//! Features as a reader finds them, and counts of what it leaves out.

use super::{Geometry, VectorFeature, Vertex, certainly_not_degrees, name_of, not_degrees};
use crate::crs::CoordinateSystem;
use crate::exchanged;
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Default)]
pub(super) struct Collected {
    pub(super) features: Vec<VectorFeature>,
    pub(super) without_geometry: usize,
    pub(super) null_members: usize,
    short_lines: usize,
    one_position: usize,
    short_rings: usize,
}

impl Collected {
    /// A line, if it is one.
    pub(super) fn line(&mut self, line: Vec<Vertex>) -> Option<Vec<Vertex>> {
        if line.len() < 2 {
            self.short_lines += 1;
            return None;
        }
        let is_line = line.iter().any(|v| v.xy != line[0].xy);
        self.one_position += usize::from(!is_line);
        is_line.then_some(line)
    }

    /// A ring without its last position if that closes it, if it is one.
    pub(super) fn ring(&mut self, mut ring: Vec<Vertex>) -> Option<Vec<Vertex>> {
        if ring.len() > 1 && ring.first().map(|v| v.xy) == ring.last().map(|v| v.xy) {
            ring.pop();
        }
        self.short_rings += usize::from(ring.len() < 3);
        (ring.len() >= 3).then_some(ring)
    }

    /// Adds a feature, unless its geometry is empty.
    pub(super) fn add(&mut self, geometry: Geometry, properties: BTreeMap<String, String>) {
        if geometry.vertices().next().is_none() {
            self.without_geometry += 1;
            return;
        }
        self.features.push(VectorFeature { style: None, name: name_of(&properties), properties, geometry });
    }

    /// Warnings about what was left out.
    ///
    /// # Errors
    /// A sentence if nothing is left.
    pub(super) fn told(&self, path: &Path, what: &str) -> Result<Vec<Warning>, String> {
        let mut warnings = Vec::new();
        let mut warn = |count: usize, what: &str| {
            warnings.extend(Warning::counted(WarningKind::Ignored, count, what).map(|w| w.in_file(path)));
        };
        warn(self.without_geometry, "features without geometry were dropped");
        warn(self.null_members, "members that are null where a feature, geometry or position is needed were dropped");
        warn(self.short_lines, "lines of fewer than 2 points were dropped");
        warn(self.one_position, "lines of one position only were dropped, a line needs 2 that differ");
        warn(self.short_rings, "polygon rings of fewer than 3 points were dropped");
        if !self.features.is_empty() {
            return Ok(warnings);
        }
        let found = [
            (self.without_geometry, "features without geometry"),
            (self.short_lines, "lines of fewer than 2 points"),
            (self.short_rings, "rings of fewer than 3 points"),
            (self.one_position, "lines of one position only"),
        ];
        let found: Vec<String> =
            found.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
        let found = if found.is_empty() { "no feature at all".to_owned() } else { found.join(", ") };
        Err(format!("{what} no usable geometry ({found}); choose another file"))
    }

    /// Exchanges the two numbers of every position where only so they fit; see [`exchanged::reason`].
    pub(super) fn exchange(&mut self, stated: Option<[DVec2; 2]>, are_degrees: bool) -> Option<Warning> {
        let positions = self.features.iter().flat_map(|f| f.geometry.vertices()).map(|v| v.xy);
        let reason = exchanged::reason(positions, stated, are_degrees)?;
        let turn = |v: &mut Vertex| v.xy = DVec2::new(v.xy.y, v.xy.x);
        for feature in &mut self.features {
            match &mut feature.geometry {
                Geometry::Points(points) => points.iter_mut().for_each(turn),
                Geometry::Lines(lines) => lines.iter_mut().flatten().for_each(turn),
                Geometry::Polygons(polygons) => polygons.iter_mut().flatten().flatten().for_each(turn),
            }
        }
        Some(Warning::new(WarningKind::Assumed, exchanged::said(&reason)))
    }

    /// The system of the positions, and whether it is stated: local where it is degrees by default alone and they cannot be degrees.
    ///
    /// # Errors
    /// A sentence if they cannot be in the system.
    pub(super) fn system(&self, crs: CoordinateSystem, stated: bool) -> Result<(CoordinateSystem, bool), String> {
        let Some(reason) = not_degrees(&self.features).filter(|_| crs.is_geographic()) else {
            return Ok((crs, stated));
        };
        if !stated && certainly_not_degrees(&self.features) {
            return Ok((CoordinateSystem::local(), false));
        }
        let crs = if stated { crs.name() } else { "longitude and latitude, the default" };
        Err(format!("{reason}, but the file's system is {crs}; correct them, or its \"crs\" member"))
    }
}
