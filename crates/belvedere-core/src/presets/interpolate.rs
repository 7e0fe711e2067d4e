//! Selection of the presets around a viewing angle, and interpolation between them.

use super::align::align;
use super::{Ease, Preset, PresetDocument, angles};
use crate::bspline::{BSpline, BSplineError};
use crate::sections::{StylingSections, TagPoint};

/// The two presets around a viewing angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Selection<'a> {
    /// Preset below.
    pub start: &'a Preset,
    /// Preset above; the same one if there is only one.
    pub target: &'a Preset,
    /// Share of `target`, 0..=1, after easing.
    pub sigma: f64,
}

/// A preset for one viewing angle.
#[derive(Debug, Clone, PartialEq)]
pub struct InterpolatedPreset {
    /// Curve, curve units.
    pub spline: BSpline,
    /// Depth of u = 0 in the document's units.
    pub s: f64,
    /// Depth of u = 1 in the document's units.
    pub e: f64,
    /// Styling sections.
    pub sections: StylingSections,
    /// Field of view, degrees; `None` = the camera's own.
    pub fov_y_deg: Option<f64>,
}

impl PresetDocument {
    /// The presets that hold at viewing angle `phi_deg`, degrees. `None` without presets.
    ///
    /// The share of the upper preset rises from the end of the lower plateau (`phi + tau`) to the start of the upper one
    /// (`phi - tau`); overlapping plateaus shrink until they no longer touch. Continuous in `phi_deg`.
    ///
    /// Source: Pasewaldt et al. 2011, section 5.1; the plateaus are used as described there (the printed formula omits tau).
    pub fn select(&self, phi_deg: f64) -> Option<Selection<'_>> {
        let sorted = self.sorted();
        let &[start, .., _] = sorted.as_slice() else {
            let &only = sorted.first()?;
            return Some(Selection { start: only, target: only, sigma: 0.0 });
        };
        let phi_deg = if phi_deg.is_nan() { start.phi } else { phi_deg };
        let above = sorted.partition_point(|p| p.phi <= phi_deg);
        let i = above.max(1).min(sorted.len() - 1) - 1;
        let (start, target) = (sorted[i], sorted[i + 1]);
        let (gap, plateaus) = (target.phi - start.phi, start.tau + target.tau);
        let shrink = if plateaus >= gap { 0.98 * gap / plateaus } else { 1.0 };
        let (lo, hi) = (start.phi + shrink * start.tau, target.phi - shrink * target.tau);
        let sigma = if hi > lo { ((phi_deg - lo) / (hi - lo)).clamp(0.0, 1.0) } else { 0.0 };
        let sigma = match self.ease {
            Ease::Linear => sigma,
            Ease::Smoothstep => sigma * sigma * (3.0 - 2.0 * sigma),
        };
        Some(Selection { start, target, sigma })
    }
}

impl Selection<'_> {
    /// The preset between the two: control points over common knots (angles, where both have them), s, e, tags and field of view interpolated linearly,
    /// representations cross-faded between `a` and `b`. `camera_fov_y_deg` stands in where only one of them has a field of view.
    ///
    /// # Errors
    /// Every [`BSplineError`] of a document that was not validated.
    pub fn interpolate(&self, camera_fov_y_deg: f64) -> Result<InterpolatedPreset, BSplineError> {
        let (p, q, sigma) = (self.start, self.target, self.sigma);
        let mix = |a: f64, b: f64| a + sigma * (b - a);
        let spline = match (sigma, &p.angles, &q.angles) {
            (0.0, ..) => p.spline()?,
            (1.0, ..) => q.spline()?,
            (_, Some(a), Some(b)) => angles::curve(&angles::between(a, b, sigma))?,
            _ => BSpline::lerp(&p.spline()?, &q.spline()?, sigma),
        };
        let [start, target] = align(p, q);
        let tags = start.tags.iter().zip(&target.tags);
        let tags = tags.map(|(a, b)| TagPoint { u: mix(a.u, b.u), delta: mix(a.delta, b.delta) }).collect();
        let fov = |preset: &Preset| preset.fov_y_deg.unwrap_or(camera_fov_y_deg);
        let has_fov = p.fov_y_deg.is_some() || q.fov_y_deg.is_some();
        let sections = StylingSections::new(tags, start.sections, target.sections, self.beta());
        Ok(InterpolatedPreset {
            spline,
            s: mix(p.s, q.s),
            e: mix(p.e, q.e),
            sections: sections.unwrap_or_else(StylingSections::plain),
            fov_y_deg: has_fov.then(|| mix(fov(p), fov(q))),
        })
    }

    /// Share of the upper preset's representations, 0..=1: rises while sigma goes from `a` to `b`.
    pub fn beta(&self) -> f64 {
        let (a, b) = (self.start.a, self.start.b);
        if b - a < 1e-9 {
            return if self.sigma > 0.0 && self.sigma >= a { 1.0 } else { 0.0 };
        }
        ((self.sigma - a) / (b - a)).clamp(0.0, 1.0)
    }
}
