//! Authoring: operations on preset documents, one at a time, each of which ends in a valid document or leaves the old one.

mod clamped;
mod curve;
mod history;
mod sections;
mod text;

pub use clamped::Clamped;
pub use history::PresetHistory;

use super::{BendFrame, DepthUnits, Ease, Preset, PresetDocument, PresetError};
use crate::bspline::BSplineError;
use serde::{Deserialize, Serialize};

/// One operation. A preset is given by its name or its position from 1; points, tags and sections by their position from 1.
///
/// As text (`PRESET.KEY[.NUMBER]=VALUE`) see [`PresetOperation`]'s `FromStr`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PresetOperation {
    /// An operation on one preset.
    Preset {
        /// Name or position.
        preset: String,
        /// The change.
        change: PresetChange,
    },
    /// Adds a preset from a built-in document.
    Add {
        /// Name of the built-in document; its first preset is taken.
        from: String,
        /// Name of the new preset.
        name: String,
        /// Its viewing angle, degrees.
        phi: f64,
    },
    /// Coordinates of the curves.
    Frame(BendFrame),
    /// Unit of `s` and `e`.
    Units(DepthUnits),
    /// Course of the interpolation.
    Ease(Ease),
    /// Whether the pivot stays.
    Pin(bool),
    /// Whether the picture tilts above the last preset.
    Follow(bool),
}

/// An operation on one preset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PresetChange {
    /// Moves a control point to (u, v).
    MovePoint(usize, [f64; 2]),
    /// Adds a control point at curve parameter t in (0, 1), by knot insertion; the curve stays as it is.
    AddPoint(f64),
    /// Removes a control point.
    RemovePoint(usize),
    /// A control point is doubled, which straightens the curve beside it; a doubled one is made single again.
    Corner(usize),
    /// Doubled points are spread along their legs by a share, 0..=1.
    Soften(f64),
    /// Replaces the control points by this number of angles, at evenly spaced arc lengths.
    Angles(usize),
    /// Sets an angle of a curve given by angles, degrees.
    Turn(usize, f64),
    /// Moves a tag to the point of the curve nearest to (u, v), clamped between its neighbours.
    MoveTag(usize, [f64; 2]),
    /// Moves a tag to a share of the curve's length, clamped between its neighbours.
    PlaceTag(usize, f64),
    /// Half width of a transition, a share of the length; at most half of the gap to the neighbours.
    TagWidth(usize, f64),
    /// The representation of a section.
    Section(usize, String),
    /// A section becomes two of the same representation, by a border in its middle.
    Split(usize),
    /// A section and the next one become one, of the representation of the first.
    Merge(usize),
    /// Depths of u = 0 and u = 1.
    Range([f64; 2]),
    /// Viewing angle, degrees; that of a camera, for instance.
    Phi(f64),
    /// Half width of the range of angles in which the preset holds, degrees.
    Tau(f64),
    /// Shares of the interpolation between which the representations fade.
    Fade([f64; 2]),
    /// Field of view, degrees; `None` = the camera's own.
    FieldOfView(Option<f64>),
    /// Near and far change places: the curve is turned by half a turn, its sections are reversed.
    Mirror,
    /// A copy for another viewing angle.
    Duplicate {
        /// Name of the copy.
        name: String,
        /// Its viewing angle, degrees.
        phi: f64,
    },
    /// Renames the preset.
    Rename(String),
    /// Removes the preset; the only one cannot be removed.
    Remove,
}

/// An operation that cannot be carried out. The document is as before.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// No preset of that name or position.
    #[error("there is no preset {wanted:?}; there are {known}")]
    NoPreset {
        /// Name or position asked for.
        wanted: String,
        /// Names, or positions, of the presets in the document.
        known: String,
    },
    /// No point, tag or section of that number.
    #[error("preset {preset}: there is no {what} {number}; there are {count}, counted from 1")]
    NoPart {
        /// Preset.
        preset: String,
        /// "control point", "tag" or "section".
        what: &'static str,
        /// Number asked for.
        number: usize,
        /// Number of parts of that kind.
        count: usize,
    },
    /// The operation lacks a precondition.
    #[error("{what}; {remedy}")]
    Needed {
        /// The state that forbids the operation.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A text that is not an operation.
    #[error("{text:?}: {reason}")]
    Text {
        /// The text.
        text: String,
        /// Why.
        reason: String,
    },
    /// A name that another preset has.
    #[error("there is a preset {name:?} already; give another name")]
    NameTaken {
        /// The name.
        name: String,
    },
    /// The result would not be a valid document.
    #[error(transparent)]
    Invalid(#[from] PresetError),
}

impl PresetDocument {
    /// The document after an operation.
    ///
    /// # Errors
    /// Every [`EditError`]; a document that was invalid before is refused likewise.
    pub fn edited(&self, operation: &PresetOperation) -> Result<Self, EditError> {
        let mut document = self.clone();
        match operation {
            PresetOperation::Preset { preset, change } => document.change(preset, change)?,
            PresetOperation::Add { from, name, phi } => {
                let first = Self::builtin(from)?.presets.into_iter().next().ok_or(PresetError::Empty)?;
                document.add(Preset { name: name.clone(), phi: *phi, ..first })?;
            }
            PresetOperation::Frame(frame) => document.frame = *frame,
            PresetOperation::Units(units) => document.units = *units,
            PresetOperation::Ease(ease) => document.ease = *ease,
            PresetOperation::Pin(pin) => document.pin = *pin,
            PresetOperation::Follow(follow) => document.follow = *follow,
        }
        document.validate()?;
        Ok(document)
    }

    fn add(&mut self, preset: Preset) -> Result<(), EditError> {
        if self.presets.iter().any(|p| !p.name.is_empty() && p.name == preset.name) {
            return Err(EditError::NameTaken { name: preset.name });
        }
        self.presets.push(preset);
        Ok(())
    }

    /// Position of a preset in the list.
    fn position(&self, wanted: &str) -> Result<usize, EditError> {
        let by_name = self.presets.iter().position(|p| !p.name.is_empty() && p.name == wanted);
        let by_number = wanted.parse::<usize>().ok().filter(|n| (1..=self.presets.len()).contains(n)).map(|n| n - 1);
        by_name.or(by_number).ok_or_else(|| {
            let known: Vec<String> = self.presets.iter().enumerate().map(|(i, p)| p.label(i)).collect();
            EditError::NoPreset { wanted: wanted.to_owned(), known: known.join(", ") }
        })
    }

    fn change(&mut self, wanted: &str, change: &PresetChange) -> Result<(), EditError> {
        let index = self.position(wanted)?;
        let label = self.presets[index].label(index);
        match change {
            PresetChange::Duplicate { name, phi } => {
                let copy = Preset { name: name.clone(), phi: *phi, ..self.presets[index].clone() };
                return self.add(copy);
            }
            PresetChange::Remove if self.presets.len() == 1 => {
                let what = format!("preset {label} is the only one");
                return Err(EditError::Needed { what, remedy: "add another one first" });
            }
            PresetChange::Remove => {
                self.presets.remove(index);
                return Ok(());
            }
            PresetChange::Rename(name)
                if self.presets.iter().enumerate().any(|(i, p)| i != index && p.name == *name) =>
            {
                return Err(EditError::NameTaken { name: name.clone() });
            }
            _ => {}
        }
        let at = Edited { preset: &mut self.presets[index], label: &label };
        match change {
            PresetChange::MovePoint(number, to) => at.with_points()?.move_point(*number, *to)?,
            PresetChange::AddPoint(t) => at.with_points()?.add_point(*t)?,
            PresetChange::RemovePoint(number) => at.with_points()?.remove_point(*number)?,
            PresetChange::Corner(number) => at.with_points()?.toggle_corner(*number)?,
            PresetChange::Soften(share) => at.with_points()?.soften(*share)?,
            PresetChange::Angles(count) => at.give_angles(*count)?,
            PresetChange::Turn(number, degrees) => at.turn(*number, *degrees)?,
            PresetChange::MoveTag(number, to) => at.move_tag(*number, *to)?,
            PresetChange::PlaceTag(number, u) => at.place_tag(*number, *u)?,
            PresetChange::TagWidth(number, delta) => at.widen_tag(*number, *delta)?,
            PresetChange::Section(number, id) => at.assign(*number, id)?,
            PresetChange::Split(number) => at.split(*number)?,
            PresetChange::Merge(number) => at.merge(*number)?,
            PresetChange::Range([s, e]) => (at.preset.s, at.preset.e) = (*s, *e),
            PresetChange::Phi(phi) => at.preset.phi = *phi,
            PresetChange::Tau(tau) => at.preset.tau = *tau,
            PresetChange::Fade([a, b]) => (at.preset.a, at.preset.b) = (*a, *b),
            PresetChange::FieldOfView(fov) => at.preset.fov_y_deg = *fov,
            PresetChange::Mirror => at.mirror(),
            PresetChange::Rename(name) => at.preset.name.clone_from(name),
            PresetChange::Duplicate { .. } | PresetChange::Remove => {}
        }
        Ok(())
    }
}

/// A preset that is being edited and its label for messages.
struct Edited<'a> {
    preset: &'a mut Preset,
    label: &'a str,
}

impl Edited<'_> {
    /// The index of part `number`, counted from 1.
    fn index(&self, what: &'static str, number: usize, count: usize) -> Result<usize, EditError> {
        if (1..=count).contains(&number) {
            return Ok(number - 1);
        }
        Err(EditError::NoPart { preset: self.label.to_owned(), what, number, count })
    }

    fn bad_curve(&self, source: BSplineError) -> EditError {
        PresetError::Curve { preset: self.label.to_owned(), source }.into()
    }

    fn range(&self, field: &'static str, value: f64, [min, max]: [f64; 2]) -> Result<(), EditError> {
        if (min..=max).contains(&value) {
            return Ok(());
        }
        Err(PresetError::Range { preset: self.label.to_owned(), field, value, min, max }.into())
    }
}
