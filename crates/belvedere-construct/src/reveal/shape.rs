//! The bend of a panorama as a handful of angles and distances, and the preset document it stands for.

use crate::ConstructError;
use belvedere_core::map::spline::{ReferencePlane, SplineBend, viewing_angle};
use belvedere_core::presets::{BendFrame, DepthUnits, Ease, Preset, PresetDocument};
use belvedere_core::{DVec3, Pinhole, Stage, View};
use serde::Serialize;

/// A bend described by the angles under which the eye sees the ground, from near to far.
///
/// The angle between the line of sight and the ground is `near` before the features, `middle` along them and `far`
/// behind them, with smooth changes between. As long as all three are positive the ground faces the eye and rises in
/// the picture with its distance. Source: ours; a curve that is seen under a constant angle is a logarithmic spiral
/// around the eye. It is handed on as a B-spline (Pasewaldt et al. 2011).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BendShape {
    /// Angle under which the foreground is seen, radians, > 0.
    pub near: f64,
    /// Angle under which the ground of the features is seen, radians, > 0.
    pub middle: f64,
    /// Angle under which the far end of the curve is seen, radians, > 0; behind it the ground goes on straight, to a horizon.
    pub far: f64,
    /// Distance along the heading, from the eye, of the point that stays where it is in the picture, scene units.
    pub pivot: f64,
    /// Distances along the heading, from the eye, between which the angle changes from `near` to `middle`, scene units.
    pub rise: [f64; 2],
    /// Distances between which it changes from `middle` to `far`.
    pub fall: [f64; 2],
}

/// Points of the control polygon of a shape.
const CONTROL_POINTS: usize = 10;

/// A bend built for one camera.
pub(crate) struct BuiltBend {
    pub(crate) document: PresetDocument,
    pub(crate) pivot: DVec3,
    pub(crate) view: View,
}

impl BendShape {
    /// Angle under which the ground at a distance along the heading is seen, radians.
    pub fn angle_at(&self, distance: f64) -> f64 {
        let step = |[from, to]: [f64; 2]| {
            let t = ((distance - from) / (to - from).max(1e-9)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        };
        self.near + (self.middle - self.near) * step(self.rise) + (self.far - self.middle) * step(self.fall)
    }

    /// The preset document and the stage for `base`, whose earlier stages are kept.
    pub(crate) fn build(&self, base: &View, plane: &ReferencePlane) -> Result<BuiltBend, ConstructError> {
        let pinhole = base.pinhole();
        let pivot = pivot_point(pinhole, plane, self.pivot);
        let document = self.document(pinhole, plane, pivot);
        let bend = SplineBend::new(pinhole, &document, plane, pivot)?;
        let mut stages = base.stages().to_vec();
        stages.push(Stage::SplineBend(bend));
        Ok(BuiltBend { document, pivot, view: View::new(pinhole.clone(), stages)? })
    }

    /// Slopes of the curve against the optical axis: (distance along the heading, slope), by rising distance.
    fn slopes(&self, pinhole: &Pinhole, pivot: DVec3) -> Vec<(f64, f64)> {
        let to_pivot = pivot - pinhole.eye;
        let (along, up) = (to_pivot.dot(pinhole.forward), -to_pivot.dot(pinhole.down));
        let walk = |sign: f64, end: f64| {
            // Polar coordinates around the eye: distance and elevation over the optical axis.
            let (mut r, mut elevation) = (along.hypot(up).max(1e-9), up.atan2(along));
            let mut place = self.pivot;
            let mut out = Vec::new();
            while sign * (end - place) > 0.0 && elevation.abs() < 1.2 && out.len() < 2_000 {
                let step = (0.01 * r).min((end - place).abs()).max(1e-9);
                let seen = self.angle_at(place + 0.5 * sign * step);
                out.push((place + 0.5 * sign * step, elevation + seen));
                r += sign * step * seen.cos();
                elevation += sign * step * seen.sin() / r.max(1e-9);
                place += sign * step;
            }
            out
        };
        let mut slopes = walk(-1.0, self.rise[0]);
        slopes.reverse();
        slopes.extend(walk(1.0, self.fall[1]));
        slopes
    }

    /// Control points by walking the slopes in legs that grow with the distance, in units of `e - s`.
    fn document(&self, pinhole: &Pinhole, plane: &ReferencePlane, pivot: DVec3) -> PresetDocument {
        let slopes = self.slopes(pinhole, pivot);
        let ends = slopes.first().zip(slopes.last());
        let (first, last) = ends.map_or((self.rise[0], self.fall[1]), |(a, b)| (a.0, b.0.max(a.0 + 1.0)));
        let pivot_depth = (pivot - pinhole.eye).dot(pinhole.forward);
        let (legs, scale) = (CONTROL_POINTS - 1, last - first);
        let place = |i: usize| {
            let t = i as f64 / legs as f64;
            0.5 * (first + t * scale) + 0.5 * first * (last / first).powf(t)
        };
        let mut point = [0.0, 0.0];
        let mut control = vec![point];
        for leg in 0..legs {
            let (from, to) = (place(leg), place(leg + 1));
            // The curve ends in the direction of its first and last leg.
            let angle = match leg {
                0 => slope_over(&slopes, from, from),
                l if l + 1 == legs => slope_over(&slopes, to, to),
                _ => slope_over(&slopes, from, to),
            };
            let length = (to - from) / scale;
            point = [point[0] + length * angle.cos(), point[1] + length * angle.sin()];
            control.push(point);
        }
        let tidy = |v: f64, digits: f64| (v * digits).round() / digits;
        let s = tidy(pivot_depth + first - self.pivot, 10.0);
        let preset = Preset {
            name: "reveal".into(),
            phi: tidy(viewing_angle(pinhole, plane).to_degrees(), 1e3),
            tau: 0.0,
            s,
            e: tidy(s + scale, 10.0),
            a: 0.0,
            b: 1.0,
            control: control.into_iter().map(|p| p.map(|v| tidy(v, 1e5))).collect(),
            angles: None,
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

/// Mean slope between two distances; the nearest one where there is none between.
fn slope_over(slopes: &[(f64, f64)], from: f64, to: f64) -> f64 {
    let between: Vec<f64> = slopes.iter().filter(|s| (from..=to).contains(&s.0)).map(|s| s.1).collect();
    if between.is_empty() {
        let nearest = slopes.iter().min_by(|a, b| (a.0 - from).abs().total_cmp(&(b.0 - from).abs()));
        return nearest.map_or(0.0, |s| s.1);
    }
    between.iter().sum::<f64>() / between.len() as f64
}

/// The point of the plane at `distance` from the eye along the camera's heading.
pub(crate) fn pivot_point(pinhole: &Pinhole, plane: &ReferencePlane, distance: f64) -> DVec3 {
    plane.foot(pinhole.eye) + distance * heading(pinhole, plane)
}

/// Unit vector of the camera's heading in the plane.
pub(crate) fn heading(pinhole: &Pinhole, plane: &ReferencePlane) -> DVec3 {
    plane.normal().cross(pinhole.right).normalize_or_zero()
}
