//! Resolves a preset document for a camera, to a [`SplineBend`].

use super::plane::Heading;
use super::{ReferencePlane, SplineBend};
use crate::deformation::{CurveTooShort, DeformationCurve};
use crate::presets::{BendFrame, DepthUnits, PresetDocument, PresetError};
use crate::{Pinhole, Projection};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A preset document that cannot be resolved for a camera.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// The document is not valid.
    #[error(transparent)]
    Preset(#[from] PresetError),
    /// Pivot not finite.
    #[error("spline_bend pivot ({x}, {y}, {z}) is not finite; give finite coordinates")]
    PivotNotFinite {
        /// x.
        x: f64,
        /// y.
        y: f64,
        /// z.
        z: f64,
    },
    /// `units = "distance"`, but the pivot lies at the eye.
    #[error(
        "spline_bend pivot lies {distance:e} from the eye, too near to scale the curve by it; move the eye off the reference plane, give a pivot, or use units = \"absolute\""
    )]
    PivotAtEye {
        /// Distance between eye and pivot, scene units.
        distance: f64,
    },
    /// The curve between two presets vanishes.
    #[error("between two presets at viewing angle {phi_deg:.3} degrees {source}")]
    Vanishes {
        /// Viewing angle, degrees.
        phi_deg: f64,
        /// Length.
        source: CurveTooShort,
    },
}

/// A preset document resolved for one camera: for reports and tests.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ResolvedPreset {
    /// Viewing angle, degrees.
    pub phi_deg: f64,
    /// Name of the preset below.
    pub start: String,
    /// Name of the preset above.
    pub target: String,
    /// Share of the preset above, after easing, 0..=1.
    pub sigma: f64,
    /// Share of its representations, 0..=1.
    pub beta: f64,
    /// Depth of curve coordinate u = 0, scene units.
    pub s: f64,
    /// Depth of curve coordinate u = 1, scene units.
    pub e: f64,
    /// Distance from the eye to the pivot on the plane, scene units.
    pub distance: f64,
    /// Depth of the pivot along the optical axis, scene units.
    pub depth: f64,
    /// Tilt of the output by `follow`, degrees.
    pub follow_deg: f64,
    /// Control points, curve units, before the pin.
    pub control: Vec<[f64; 2]>,
    /// Knots.
    pub knots: Vec<f64>,
    /// Vertical field of view asked for, degrees; `None` = the camera's own.
    pub fov_y_deg: Option<f64>,
}

impl SplineBend {
    /// The deformation that `document` describes for the camera `pinhole` over `plane`, turning about `pivot` dropped onto the plane.
    ///
    /// The viewing angle comes from the camera alone. Default pivot: [`super::default_pivot`]. A roll of the camera does not matter.
    ///
    /// # Errors
    /// Every [`SplineError`].
    ///
    /// Source: Pasewaldt et al. 2011, sections 4 and 5.
    pub fn new(
        pinhole: &Pinhole,
        document: &PresetDocument,
        plane: &ReferencePlane,
        pivot: DVec3,
    ) -> Result<Self, SplineError> {
        document.validate()?;
        if !pivot.is_finite() {
            return Err(SplineError::PivotNotFinite { x: pivot.x, y: pivot.y, z: pivot.z });
        }
        let Heading { right, heading, phi } = Heading::of(pinhole, plane);
        let phi_deg = phi.to_degrees();
        let selection = document.select(phi_deg).ok_or(PresetError::Empty)?;
        let preset = selection
            .interpolate(fov_y_deg(pinhole))
            .map_err(|source| PresetError::Curve { preset: selection.start.label(0), source })?;
        let origin = plane.foot(pivot);
        let distance = origin.distance(pinhole.eye);
        let unit = match document.units {
            DepthUnits::Absolute => 1.0,
            DepthUnits::Distance if distance > 1e-9 => distance,
            DepthUnits::Distance => return Err(SplineError::PivotAtEye { distance }),
        };
        let (s, e) = (preset.s * unit, preset.e * unit);
        let scale = e - s;
        let depth = (origin - pinhole.eye).dot(pinhole.forward);
        let l_origin = (depth - s) / scale;
        let curve =
            DeformationCurve::new(&preset.spline).map_err(|source| SplineError::Vanishes { phi_deg, source })?;
        let shift = if document.pin { -curve.at(l_origin).0 } else { DVec2::new(-l_origin, 0.0) };
        let follow = follow_angle(document, phi_deg);
        let slope = match document.frame {
            BendFrame::Camera => phi - follow.to_radians(),
            BendFrame::Plane => 0.0,
        };
        let normal = plane.normal();
        let out_u = slope.cos() * heading - slope.sin() * normal;
        let out_v = slope.sin() * heading + slope.cos() * normal;
        let to_eye = seen_from(pinhole, preset.fov_y_deg, depth).eye - origin;
        Ok(Self {
            origin,
            right,
            heading,
            normal,
            out_u,
            out_v,
            scale,
            l_origin,
            shift,
            eye: DVec2::new(to_eye.dot(out_u), to_eye.dot(out_v)) / scale,
            curve: Arc::new(curve),
            sections: Arc::new(preset.sections),
            resolved: Arc::new(ResolvedPreset {
                phi_deg,
                start: selection.start.name.clone(),
                target: selection.target.name.clone(),
                sigma: selection.sigma,
                beta: selection.beta(),
                s,
                e,
                distance,
                depth,
                follow_deg: follow,
                control: preset.spline.control().iter().map(|p| p.to_array()).collect(),
                knots: preset.spline.knots().to_vec(),
                fov_y_deg: preset.fov_y_deg,
            }),
        })
    }

    /// The camera that photographs this deformation: `pinhole` itself unless a preset asks for a field of view; then with that field of
    /// view, moved along its axis so that the scale at the pivot stays. Orthographic cameras stay as they are.
    ///
    /// Resolve the deformation for the original `pinhole` and photograph it with the adapted one.
    pub fn adapted_pinhole(&self, pinhole: &Pinhole) -> Pinhole {
        seen_from(pinhole, self.resolved.fov_y_deg, self.resolved.depth)
    }
}

fn fov_y_deg(pinhole: &Pinhole) -> f64 {
    match pinhole.projection {
        Projection::Perspective { fov_y } => fov_y.to_degrees(),
        Projection::Orthographic { .. } => 45.0,
    }
}

/// `pinhole` with another field of view and the same scale at `depth`.
fn seen_from(pinhole: &Pinhole, fov_y_deg: Option<f64>, depth: f64) -> Pinhole {
    let (Some(fov_deg), Projection::Perspective { fov_y: old }) = (fov_y_deg, pinhole.projection) else {
        return pinhole.clone();
    };
    if !(depth > 0.0) {
        return pinhole.clone();
    }
    let fov_y = fov_deg.to_radians();
    let new_depth = depth * (0.5 * old).tan() / (0.5 * fov_y).tan();
    Pinhole {
        eye: pinhole.eye + (depth - new_depth) * pinhole.forward,
        projection: Projection::Perspective { fov_y },
        ..pinhole.clone()
    }
}

/// Excess of the viewing angle over the range of the last preset, degrees; 0 unless the document follows.
fn follow_angle(document: &PresetDocument, phi_deg: f64) -> f64 {
    if !document.follow || document.frame == BendFrame::Plane {
        return 0.0;
    }
    document.sorted().last().map_or(0.0, |last| (phi_deg - last.phi - last.tau).max(0.0))
}
