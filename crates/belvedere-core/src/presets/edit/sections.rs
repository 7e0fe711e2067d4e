//! Operations on tags and sections.

use super::{EditError, Edited};
use crate::deformation::DeformationCurve;
use crate::presets::PresetError;
use crate::sections::TagPoint;
use glam::DVec2;

/// Least distance between borders, shares of the length.
const APART: f64 = 1e-3;
/// Half width of new transitions.
const DELTA: f64 = 0.05;
/// Samples of the curve that are compared before the nearest one is refined.
const PLACES: usize = 512;

impl Edited<'_> {
    pub(super) fn move_tag(self, number: usize, to: [f64; 2]) -> Result<(), EditError> {
        let to = DVec2::from(to);
        if !to.is_finite() {
            return Err(PresetError::NotFinite { preset: self.label.to_owned(), field: "tag" }.into());
        }
        let spline = self.preset.spline().map_err(|e| self.bad_curve(e))?;
        let curve = DeformationCurve::new(&spline)
            .map_err(|e| PresetError::CurveTooShort { preset: self.label.to_owned(), length: e.length })?;
        self.place_tag(number, nearest_share(&curve, to))
    }

    pub(super) fn place_tag(self, number: usize, u: f64) -> Result<(), EditError> {
        let index = self.index("tag", number, self.preset.tags.len())?;
        self.range("tag u", u, [0.0, 1.0])?;
        let [before, after] = self.neighbours(index);
        let (lo, hi) = (before + APART, after - APART);
        let tag = &mut self.preset.tags[index];
        tag.u = if lo <= hi { u.clamp(lo, hi) } else { 0.5 * (before + after) };
        tag.delta = tag.delta.min(0.5 * (tag.u - before).min(after - tag.u));
        Ok(())
    }

    pub(super) fn widen_tag(self, number: usize, delta: f64) -> Result<(), EditError> {
        let index = self.index("tag", number, self.preset.tags.len())?;
        self.range("tag delta", delta, [0.0, 1.0])?;
        let [before, after] = self.neighbours(index);
        let tag = &mut self.preset.tags[index];
        tag.delta = delta.min(0.5 * (tag.u - before).min(after - tag.u));
        Ok(())
    }

    pub(super) fn assign(self, number: usize, id: &str) -> Result<(), EditError> {
        let index = self.index("section", number, self.preset.sections.len())?;
        self.preset.sections[index] = id.to_owned();
        Ok(())
    }

    pub(super) fn split(self, number: usize) -> Result<(), EditError> {
        let index = self.index("section", number, self.preset.sections.len())?;
        let [from, to] = self.neighbours_of_section(index);
        let width = to - from;
        if width < 4.0 * APART {
            let what = format!("preset {}: section {number} is {width:.4} of the curve long", self.label);
            return Err(EditError::Needed { what, remedy: "move its borders apart first" });
        }
        self.preset.tags.insert(index, TagPoint { u: 0.5 * (from + to), delta: DELTA.min(0.25 * width) });
        self.preset.sections.insert(index, self.preset.sections[index].clone());
        Ok(())
    }

    pub(super) fn merge(self, number: usize) -> Result<(), EditError> {
        let count = self.preset.sections.len();
        let index = self.index("section", number, count)?;
        if index + 1 == count {
            let what = format!("preset {}: section {number} is the last one", self.label);
            return Err(EditError::Needed { what, remedy: "merge the one before it" });
        }
        self.preset.tags.remove(index);
        self.preset.sections.remove(index + 1);
        Ok(())
    }

    /// Positions of the borders beside a border, shares of the length.
    fn neighbours(&self, index: usize) -> [f64; 2] {
        let tags = &self.preset.tags;
        [index.checked_sub(1).map_or(0.0, |i| tags[i].u), tags.get(index + 1).map_or(1.0, |t| t.u)]
    }

    /// Positions of the borders of a section, shares of the length.
    fn neighbours_of_section(&self, index: usize) -> [f64; 2] {
        let tags = &self.preset.tags;
        [index.checked_sub(1).map_or(0.0, |i| tags[i].u), tags.get(index).map_or(1.0, |t| t.u)]
    }
}

/// Position of a curve's point nearest to `to`, as a share of the length: best sample, then ternary search.
pub(super) fn nearest_share(curve: &DeformationCurve, to: DVec2) -> f64 {
    let length = curve.length();
    let off = |u: f64| curve.at(u * length).0.distance_squared(to);
    let place = |i: usize| i as f64 / PLACES as f64;
    let nearest = (0..=PLACES).min_by(|a, b| off(place(*a)).total_cmp(&off(place(*b)))).unwrap_or(0);
    let (mut lo, mut hi) = (place(nearest.saturating_sub(1)), place((nearest + 1).min(PLACES)));
    for _ in 0..60 {
        let [a, b] = [lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0];
        if off(a) < off(b) { hi = b } else { lo = a }
    }
    0.5 * (lo + hi)
}
