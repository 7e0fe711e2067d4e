//! View-dependent multi-perspective deformation: space is carried onto a B-spline over the reference plane.

mod bound;
mod check;
mod ease;
mod plane;
mod resolve;

pub(crate) use bound::EdgeEnd;
pub use check::{EDGE_ON, PresetWarning, check_presets};
pub use plane::{ReferencePlane, default_pivot, viewing_angle};
pub use resolve::{ResolvedPreset, SplineError};

use super::{SpaceMap, finite};
use crate::Miss;
use crate::deformation::DeformationCurve;
use crate::sections::StylingSections;
use glam::{DMat3, DVec2, DVec3};
use std::sync::Arc;

/// The ground bends along a curve in the direction of view: steep where it should read as a map, flat where it should show a horizon.
///
/// A point at depth `z` and height `d` over the reference plane goes to the point of the curve at arc length `l = (z - s) / K`, plus
/// `d` along the curve's normal; nothing changes across the direction of view. Lengths along the ground are kept, straight lines continue
/// the curve at both ends, and a straight curve of slope phi is the ordinary perspective.
///
/// Everything is resolved: plain data for one camera; clones share the curve. Source: Pasewaldt et al. 2011, section 4; arc-length units, pin, `plane` frame and
/// follow are ours.
///
/// ```
/// use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
/// use belvedere_core::{DVec3, Pinhole, Projection, SpaceMap, presets::PresetDocument};
/// let camera = Pinhole::look_at(
///     DVec3::new(0.0, -800.0, 650.0), DVec3::ZERO, DVec3::Z,
///     Projection::Perspective { fov_y: 50f64.to_radians() }, [1280, 720], 1.0, None,
/// )?;
/// let ground = ReferencePlane::level(0.0);
/// let pivot = default_pivot(&camera, &ground);
/// let bend = SplineBend::new(&camera, &PresetDocument::builtin("progressive")?, &ground, pivot)?;
/// assert!(bend.apply(pivot).unwrap().distance(pivot) < 1e-9);
/// assert!(bend.apply(DVec3::new(0.0, 3000.0, 0.0)).unwrap().z < -500.0); // the far ground sinks away until it is seen flat
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SplineBend {
    /// Pivot dropped onto the plane.
    origin: DVec3,
    right: DVec3,
    heading: DVec3,
    normal: DVec3,
    /// Output directions of the curve coordinates u and v.
    out_u: DVec3,
    out_v: DVec3,
    /// Scene units per curve unit.
    scale: f64,
    /// Arc length of the origin, curve units.
    l_origin: f64,
    /// Added to the curve so that coordinates count from the origin.
    shift: DVec2,
    /// Eye in shifted curve coordinates.
    eye: DVec2,
    curve: Arc<DeformationCurve>,
    sections: Arc<StylingSections>,
    resolved: Arc<ResolvedPreset>,
}

/// Coordinates of a point along and above the deformation curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveCoordinates {
    /// Arc length from the near end, curve units; outside 0..=length on the extensions.
    pub l: f64,
    /// Signed height over the reference plane, scene units.
    pub d: f64,
    /// Distance to the right of the pivot, scene units.
    pub a: f64,
}

impl SplineBend {
    /// The deformation curve, without pin.
    pub fn curve(&self) -> &DeformationCurve {
        &self.curve
    }

    /// Styling sections along the curve.
    pub fn sections(&self) -> &StylingSections {
        &self.sections
    }

    /// The preset document, resolved for this camera.
    pub fn resolved(&self) -> &ResolvedPreset {
        &self.resolved
    }

    /// Control points of the curve where the pin has moved them, curve units.
    pub fn control(&self) -> Vec<DVec2> {
        let stated: Vec<DVec2> = self.resolved.control.iter().map(|&p| DVec2::from(p)).collect();
        // A curve begins at its first control point.
        let by = stated.first().map_or(DVec2::ZERO, |first| self.curve.at(0.0).0 - *first);
        stated.into_iter().map(|p| p + by).collect()
    }

    /// The pivot dropped onto the reference plane, scene coordinates. It does not move if the curve is pinned.
    pub fn pivot(&self) -> DVec3 {
        self.origin
    }

    /// Unit directions in which `a` (to the right), the curve's depth and `d` (off the plane) are measured.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.right, self.heading, self.normal]
    }

    /// Unit directions, orthogonal to [`SplineBend::axes`]`[0]`, of the plane in which the curve bends.
    pub fn curve_axes(&self) -> [DVec3; 2] {
        [self.out_u, self.out_v]
    }

    /// Scene units per curve unit (`K = e - s`).
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Coordinates of `p` along and above the curve.
    pub fn coordinates(&self, p: DVec3) -> CurveCoordinates {
        let v = p - self.origin;
        CurveCoordinates {
            l: self.l_origin + v.dot(self.heading) / self.scale,
            d: v.dot(self.normal),
            a: v.dot(self.right),
        }
    }

    /// Arc length of `p` as a share of the curve's length: the argument of the section weights. Below 0 and above 1 on the extensions.
    pub fn section_parameter(&self, p: DVec3) -> f64 {
        self.coordinates(p).l / self.curve.length()
    }

    /// Factor by which lengths along the heading change at `p`; the sign of the Jacobian's determinant. 1 on the reference plane.
    pub fn stretch(&self, p: DVec3) -> f64 {
        let at = self.coordinates(p);
        1.0 - self.curve.curvature_at(at.l) * at.d / self.scale
    }

    /// Whether the map has folded over at `p`: `p` lies beyond the curve's centre of curvature.
    pub fn is_folded(&self, p: DVec3) -> bool {
        !(self.stretch(p) > 0.0)
    }

    /// Heights over the reference plane between which nothing folds anywhere, scene units: `[h_min, h_max]`, `h_min < 0 < h_max`, infinite where
    /// the curve has no curvature of that sign.
    pub fn fold_heights(&self) -> [f64; 2] {
        let [down, up] = self.curve.curvature_range();
        [
            if down < 0.0 { self.scale / down } else { f64::NEG_INFINITY },
            if up > 0.0 { self.scale / up } else { f64::INFINITY },
        ]
    }

    /// Smallest sine of the angle under which the eye sees the deformed reference plane, from the near end of the curve to one curve
    /// length beyond the far end. If it is positive the ground is seen from above and rises in the picture with its depth.
    pub fn facing(&self) -> f64 {
        self.curve.min_facing(self.eye - self.shift, 0.0, 2.0 * self.curve.length())
    }

    /// [`SplineBend::facing`] between two points' depths.
    pub fn facing_between(&self, near: DVec3, far: DVec3) -> f64 {
        let (l0, l1) = (self.coordinates(near).l, self.coordinates(far).l);
        self.curve.min_facing(self.eye - self.shift, l0.min(l1), l0.max(l1))
    }

    /// Slope of the deformed ground at `p` in the coordinates of the frame, radians; in frame `camera` the viewing angle of the ground there.
    pub fn slope(&self, p: DVec3) -> f64 {
        self.curve.at(self.coordinates(p).l).1.to_angle()
    }

    /// Position of a displaced point in the plane of [`SplineBend::curve`], curve units.
    pub fn curve_position(&self, p_displaced: DVec3) -> DVec2 {
        let v = p_displaced - self.origin;
        DVec2::new(v.dot(self.out_u), v.dot(self.out_v)) / self.scale - self.shift
    }

    /// The point that the bend carries to height `d` (curve units) over arc length `l` of the curve and `a` scene units to the right.
    pub fn unbent(&self, l: f64, d: f64, a: f64) -> DVec3 {
        let along = self.scale * (l - self.l_origin);
        self.origin + a * self.right + along * self.heading + self.scale * d * self.normal
    }

    /// Image of a point over a point of the curve, where the tangent is `tangent`.
    fn image(&self, at: CurveCoordinates, point: DVec2, tangent: DVec2) -> DVec3 {
        self.scene_from_curve(at.a, point + self.shift + (at.d / self.scale) * tangent.perp())
    }

    /// Scene point of shifted curve coordinates `q` and right offset `a`.
    fn scene_from_curve(&self, a: f64, q: DVec2) -> DVec3 {
        self.origin + a * self.right + self.scale * (q.x * self.out_u + q.y * self.out_v)
    }
}

impl SpaceMap for SplineBend {
    /// Defined for every finite point, also beyond the fold limit.
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        let at = self.coordinates(finite(p)?);
        let (point, tangent) = self.curve.at(at.l);
        finite(self.image(at, point, tangent))
    }

    /// The point nearest to the reference plane whose image is `p_displaced`.
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] where no perpendicular from the curve arrives before its centre of curvature.
    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        let (l, d) = self.curve.foot(self.curve_position(finite(p_displaced)?)).ok_or(Miss::OutsideDomain)?;
        finite(self.unbent(l, d, (p_displaced - self.origin).dot(self.right)))
    }

    /// Its determinant is [`SplineBend::stretch`], negative beyond the fold limit.
    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let at = self.coordinates(finite(p)?);
        let frame = self.curve.frame_at(at.l);
        let world = |q: DVec2| q.x * self.out_u + q.y * self.out_v;
        let along = (1.0 - frame.kap * at.d / self.scale) * world(frame.tangent);
        let image = DMat3::from_cols(self.right, along, world(frame.normal()));
        let jacobian = image * DMat3::from_cols(self.right, self.heading, self.normal).transpose();
        if jacobian.is_finite() { Ok(jacobian) } else { Err(Miss::OutsideDomain) }
    }
}
