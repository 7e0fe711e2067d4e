//! Values that an operation clamped.

use super::sections::nearest_share;
use super::{EditError, PresetChange, PresetOperation};
use crate::deformation::DeformationCurve;
use crate::presets::{Preset, PresetDocument};
use crate::{Warning, WarningKind};
use glam::DVec2;

/// A value that was clamped by neighbouring tags, in shares of the curve's length.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("preset {preset}: {what} is {got:.4}, not {asked:.4} as asked: {why}")]
pub struct Clamped {
    /// Preset, its name in quotes or its position.
    pub preset: String,
    /// Name of the clamped value.
    pub what: String,
    /// The value asked for.
    pub asked: f64,
    /// The value after clamping.
    pub got: f64,
    /// Reason for the clamping.
    pub why: &'static str,
}

impl From<&Clamped> for Warning {
    fn from(said: &Clamped) -> Self {
        let warning = Self::new(WarningKind::Limited, said.to_string()).about(&said.preset);
        warning.with("asked_share", said.asked).with("got_share", said.got)
    }
}

/// Differences below this are rounding.
const SAME: f64 = 1e-6;

impl PresetDocument {
    /// As [`Self::edited`], with the values that were clamped: a tag's position between its neighbours, a transition's half width.
    ///
    /// # Errors
    /// Every [`EditError`].
    ///
    /// ```
    /// use belvedere_core::presets::PresetDocument;
    /// let demo = PresetDocument::builtin("demo")?;
    /// let (_, clamped) = demo.edited_saying(&"low.tag.1=0.9".parse()?)?;
    /// assert!(clamped[0].to_string().contains("tag 1"), "the second tag lies at two thirds");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn edited_saying(&self, operation: &PresetOperation) -> Result<(Self, Vec<Clamped>), EditError> {
        let next = self.edited(operation)?;
        let PresetOperation::Preset { preset: wanted, change } = operation else { return Ok((next, Vec::new())) };
        let index = self.position(wanted)?;
        let (old, new) = (&self.presets[index], next.presets.get(index));
        let found = new.map_or_else(Vec::new, |new| clamped(old, new, change, &old.label(index)));
        Ok((next, found))
    }
}

fn clamped(old: &Preset, new: &Preset, change: &PresetChange, label: &str) -> Vec<Clamped> {
    let (number, place, width) = match change {
        PresetChange::PlaceTag(number, u) => (*number, Some(*u), None),
        PresetChange::MoveTag(number, to) => {
            let curve = old.spline().ok().and_then(|spline| DeformationCurve::new(&spline).ok());
            (*number, curve.map(|curve| nearest_share(&curve, DVec2::from(*to))), None)
        }
        PresetChange::TagWidth(number, delta) => (*number, None, Some(*delta)),
        _ => return Vec::new(),
    };
    let Some(index) = number.checked_sub(1) else { return Vec::new() };
    let (Some(before), Some(now)) = (old.tags.get(index), new.tags.get(index)) else { return Vec::new() };
    // A move should keep the transition: one that it makes narrower is reported.
    let width = width.unwrap_or(before.delta);
    let found = |what: String, asked: f64, got: f64, why| Clamped { preset: label.to_owned(), what, asked, got, why };
    let place = place
        .filter(|u| (u - now.u).abs() > SAME)
        .map(|u| found(format!("tag {number}"), u, now.u, "the tag or end of the curve beside it is in the way"));
    let width = Some(width).filter(|d| (d - now.delta).abs() > SAME).map(|d| {
        let why = "it reaches at most half of the way to the tag or end of the curve beside it";
        found(format!("the half width of the transition at tag {number}"), d, now.delta, why)
    });
    place.into_iter().chain(width).collect()
}
