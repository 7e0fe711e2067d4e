//! The bend of a panorama as a handful of angles and places, and the preset document it stands for.

use crate::ConstructError;
use belvedere_core::map::spline::{ReferencePlane, SplineBend, viewing_angle};
use belvedere_core::presets::{BendFrame, DepthUnits, Ease, Preset, PresetDocument};
use belvedere_core::{DVec3, Pinhole, Stage, View};
use serde::Serialize;

/// A bend described by the angles at which the ground is seen from near to far.
///
/// The ground before the features is seen at `near`, the features at `middle`, what lies behind at `far`, all
/// against the optical axis (a horizon appears if `far` is less than half the field of view). Between these the
/// angle changes smoothly. Source: the angle profile of spline section 11.7, drawn with an eight-point B-spline.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BendShape {
    /// Viewing angle of the foreground, radians.
    pub near: f64,
    /// Viewing angle of the features, radians.
    pub middle: f64,
    /// Viewing angle of the background, radians.
    pub far: f64,
    /// Distance along the heading, from the eye, of the point that keeps its place in the picture, scene units.
    pub pivot: f64,
    /// Distances along the heading, from the eye, between which the angle changes from `near` to `middle`, scene units.
    pub rise: [f64; 2],
    /// Distances between which it changes from `middle` to `far`.
    pub fall: [f64; 2],
}

/// Points of the control polygon of a shape.
const CONTROL_POINTS: usize = 8;

/// A bend built for one camera.
pub(crate) struct Built {
    pub(crate) document: PresetDocument,
    pub(crate) pivot: DVec3,
    pub(crate) view: View,
}

impl BendShape {
    /// Viewing angle at a distance along the heading.
    pub fn angle_at(&self, distance: f64) -> f64 {
        let step = |[from, to]: [f64; 2]| {
            let t = ((distance - from) / (to - from).max(1e-9)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        };
        self.near + (self.middle - self.near) * step(self.rise) + (self.far - self.middle) * step(self.fall)
    }

    /// The preset document and the stage for `base`, whose earlier stages are kept.
    pub(crate) fn build(&self, base: &View, plane: &ReferencePlane) -> Result<Built, ConstructError> {
        let pinhole = base.pinhole();
        let pivot = pivot_point(pinhole, plane, self.pivot);
        let document = self.document(pinhole, plane, pivot);
        let bend = SplineBend::new(pinhole, &document, plane, pivot)?;
        let mut stages = base.stages().to_vec();
        stages.push(Stage::SplineBend(bend));
        Ok(Built { document, pivot, view: View::new(pinhole.clone(), stages)? })
    }

    /// Control points by walking the angle profile in equal legs, in units of `e - s`.
    fn document(&self, pinhole: &Pinhole, plane: &ReferencePlane, pivot: DVec3) -> PresetDocument {
        // Places along the ground, relative to the pivot. A straight stretch at either end keeps the end tangents.
        let straight = 0.02 * (self.fall[1] - self.rise[0]).abs().max(1.0);
        let first = self.rise[0].min(self.fall[0]) - straight - self.pivot;
        let last = self.fall[1].max(self.rise[1]) + straight - self.pivot;
        let pivot_depth = (pivot - pinhole.eye).dot(pinhole.forward);
        let (legs, scale) = ((CONTROL_POINTS - 1) as f64, last - first);
        let mut point = [0.0, 0.0];
        let mut control = vec![point];
        for leg in 0..CONTROL_POINTS - 1 {
            let place = self.pivot + first + scale * (leg as f64 + 0.5) / legs;
            let angle = match leg {
                0 => self.angle_at(self.pivot + first),
                l if l + 2 == CONTROL_POINTS => self.angle_at(self.pivot + last),
                _ => self.angle_at(place),
            };
            point = [point[0] + angle.cos() / legs, point[1] + angle.sin() / legs];
            control.push(point);
        }
        let tidy = |v: f64, digits: f64| (v * digits).round() / digits;
        let s = tidy(pivot_depth + first, 10.0);
        let preset = Preset {
            name: "reveal".into(),
            phi: tidy(viewing_angle(pinhole, plane).to_degrees(), 1e3),
            tau: 0.0,
            s,
            e: tidy(s + scale, 10.0),
            a: 0.0,
            b: 1.0,
            control: control.into_iter().map(|p| p.map(|v| tidy(v, 1e5))).collect(),
            knots: None,
            tags: Vec::new(),
            sections: vec!["all".into()],
            fov_y_deg: None,
        };
        PresetDocument {
            version: PresetDocument::VERSION,
            frame: BendFrame::Camera,
            units: DepthUnits::Absolute,
            pin: true,
            ease: Ease::Linear,
            follow: false,
            presets: vec![preset],
        }
    }
}

/// The point of the plane at `distance` from the eye along the camera's heading.
pub(crate) fn pivot_point(pinhole: &Pinhole, plane: &ReferencePlane, distance: f64) -> DVec3 {
    plane.foot(pinhole.eye) + distance * heading(pinhole, plane)
}

/// Unit vector of the camera's heading in the plane.
pub(crate) fn heading(pinhole: &Pinhole, plane: &ReferencePlane) -> DVec3 {
    plane.normal().cross(pinhole.right).normalize_or_zero()
}
