//! Operations on control points.

use super::{EditError, Edited};
use crate::presets::{Preset, angles};
use glam::DVec2;

/// Largest shift of the two copies of a softened point, as a share of the leg to an end of the curve, or to another point.
const SPREAD_TO_END: f64 = 0.3;
const SPREAD_TO_POINT: f64 = 0.25;
/// Fewest control points of a cubic.
const FEWEST: usize = 4;

impl Edited<'_> {
    /// Replaces the angles of a preset by control points and knots of the same curve.
    pub(super) fn with_points(self) -> Result<Self, EditError> {
        if self.preset.angles.is_some() {
            let spline = self.preset.spline().map_err(|e| self.bad_curve(e))?;
            self.preset.control = spline.control().iter().map(|p| p.to_array()).collect();
            self.preset.knots = Some(spline.knots().to_vec());
            self.preset.angles = None;
        }
        Ok(self)
    }

    pub(super) fn give_angles(self, count: usize) -> Result<(), EditError> {
        self.range("number of angles", count as f64, [2.0, 1000.0])?;
        let spline = self.preset.spline().map_err(|e| self.bad_curve(e))?;
        // A curve of no length is refused when the document is validated.
        self.preset.angles = angles::of_curve(&spline, count);
        (self.preset.control, self.preset.knots) = (Vec::new(), None);
        Ok(())
    }

    pub(super) fn turn(self, number: usize, degrees: f64) -> Result<(), EditError> {
        if self.preset.angles.is_none() {
            let what = format!("preset {}: its curve has control points, no angles", self.label);
            return Err(EditError::Needed { what, remedy: "give it angles first, as in PRESET.angles=5" });
        }
        let index = self.index("angle", number, self.preset.angles.as_ref().map_or(0, Vec::len))?;
        if let Some(angles) = &mut self.preset.angles {
            angles[index][1] = degrees;
        }
        Ok(())
    }

    pub(super) fn move_point(self, number: usize, to: [f64; 2]) -> Result<(), EditError> {
        let index = self.index("control point", number, self.preset.control.len())?;
        self.preset.control[index] = to;
        Ok(())
    }

    pub(super) fn add_point(self, t: f64) -> Result<(), EditError> {
        self.range("curve parameter", t, [1e-6, 1.0 - 1e-6])?;
        let spline = self.preset.spline().map_err(|e| self.bad_curve(e))?.with_knot_inserted(t);
        if spline.control().len() == self.preset.control.len() {
            let what = format!("preset {}: the curve has three knots at {t} already", self.label);
            return Err(EditError::Needed { what, remedy: "add the point elsewhere" });
        }
        self.preset.control = spline.control().iter().map(|p| p.to_array()).collect();
        self.preset.knots = Some(spline.knots().to_vec());
        Ok(())
    }

    pub(super) fn remove_point(self, number: usize) -> Result<(), EditError> {
        let count = self.preset.control.len();
        let index = self.index("control point", number, count)?;
        if count <= FEWEST {
            let what = format!("preset {}: a curve needs {FEWEST} control points", self.label);
            return Err(EditError::Needed { what, remedy: "add one before you remove one" });
        }
        if let Some(knots) = &mut self.preset.knots {
            let at = mean_knot(knots, index);
            // Removes the inner knot nearest to the point's mean knot.
            let off = |k: &usize| (knots[*k] - at).abs();
            if let Some(nearest) = (4..knots.len() - 4).min_by(|a, b| off(a).total_cmp(&off(b))) {
                knots.remove(nearest);
            }
        }
        self.preset.control.remove(index);
        Ok(())
    }

    pub(super) fn toggle_corner(self, number: usize) -> Result<(), EditError> {
        let count = self.preset.control.len();
        let index = self.index("control point", number, count)?;
        let same = |other: Option<&[f64; 2]>| other == Some(&self.preset.control[index]);
        let before = index.checked_sub(1).and_then(|i| self.preset.control.get(i));
        if same(before) || same(self.preset.control.get(index + 1)) {
            return self.remove_point(number);
        }
        if index == 0 || index + 1 == count {
            let what = format!("preset {}: control point {number} is an end of the curve", self.label);
            return Err(EditError::Needed { what, remedy: "make a corner of one between" });
        }
        if let Some(knots) = &mut self.preset.knots {
            let at = mean_knot(knots, index);
            let place = knots.partition_point(|k| *k <= at).clamp(4, knots.len() - 4);
            knots.insert(place, at);
        }
        self.preset.control.insert(index, self.preset.control[index]);
        Ok(())
    }

    pub(super) fn soften(self, share: f64) -> Result<(), EditError> {
        self.range("softness", share, [0.0, 1.0])?;
        let old: Vec<DVec2> = self.preset.control.iter().map(|&p| DVec2::from(p)).collect();
        let last = old.len() - 1;
        let doubled: Vec<usize> = (1..last.saturating_sub(1)).filter(|&i| old[i] == old[i + 1]).collect();
        if doubled.is_empty() {
            let what = format!("preset {}: no control point is doubled", self.label);
            return Err(EditError::Needed { what, remedy: "make a corner first" });
        }
        let leg = |from: usize, to: usize| {
            let spread = if to == 0 || to == last { SPREAD_TO_END } else { SPREAD_TO_POINT };
            old[from].lerp(old[to], share * spread).to_array()
        };
        for i in doubled {
            self.preset.control[i] = leg(i, i - 1);
            self.preset.control[i + 1] = leg(i + 1, i + 2);
        }
        Ok(())
    }

    pub(super) fn mirror(self) {
        let Preset { control, knots, angles, tags, sections, .. } = self.preset;
        if let Some(angles) = angles {
            let length = angles.last().map_or(0.0, |last| last[0]);
            angles.reverse();
            angles.iter_mut().for_each(|angle| angle[0] = length - angle[0]);
        }
        control.reverse();
        control.iter_mut().for_each(|p| *p = [1.0 - p[0], -p[1]]);
        if let Some(knots) = knots {
            knots.reverse();
            knots.iter_mut().for_each(|k| *k = 1.0 - *k);
        }
        tags.reverse();
        tags.iter_mut().for_each(|t| t.u = 1.0 - t.u);
        sections.reverse();
    }
}

/// Parameter at which a control point acts most: the mean of its inner knots (Greville).
fn mean_knot(knots: &[f64], index: usize) -> f64 {
    knots[index + 1..index + 4].iter().sum::<f64>() / 3.0
}
