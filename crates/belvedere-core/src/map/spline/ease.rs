//! A bend at a share of its strength.

use super::SplineBend;
use crate::bspline::BSpline;
use crate::deformation::DeformationCurve;
use glam::DVec2;
use std::sync::Arc;

impl SplineBend {
    /// This bend at a share of its strength: control points are interpolated from the straight line that changes nothing.
    ///
    /// * `share`: 0 = identity, 1 = the bend itself.
    ///
    /// `None` if the interpolated curve is too short.
    pub(crate) fn eased(&self, share: f64) -> Option<Self> {
        let along = DVec2::new(self.heading.dot(self.out_u), self.heading.dot(self.out_v));
        let control: Vec<DVec2> = self.resolved.control.iter().map(|&p| DVec2::from(p)).collect();
        let steps = control.windows(2).map(|pair| pair[0].distance(pair[1]));
        let reached: Vec<f64> = std::iter::once(0.0)
            .chain(steps.scan(0.0, |sum, step| {
                *sum += step;
                Some(*sum)
            }))
            .collect();
        let per_step = self.curve.length() / reached.last().filter(|&&total| total > 0.0)?;
        let eased = control.iter().zip(&reached).map(|(&point, l)| {
            let straight = (l * per_step - self.l_origin) * along;
            straight.lerp(point + self.shift, share)
        });
        let spline = BSpline::with_knots(eased.collect(), self.resolved.knots.clone()).ok()?;
        let curve = DeformationCurve::new(&spline).ok()?;
        // The pivot goes straight to where the bend carries it: a pinned one stays.
        let pivot = share * (self.curve.at(self.l_origin).0 + self.shift);
        let shift = pivot - curve.at(self.l_origin).0;
        Some(Self { shift, curve: Arc::new(curve), ..self.clone() })
    }
}
