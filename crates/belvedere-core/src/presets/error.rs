//! Errors of a preset document.

use crate::bspline::BSplineError;

/// A number as text, in exponential form from 1e7 on.
fn short(value: f64) -> String {
    if value.abs() < 1e7 { value.to_string() } else { format!("{value:e}") }
}

/// A preset document that describes no usable deformation. `preset` is the name in quotes, or the position from 1 if it has none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PresetError {
    /// Unknown version.
    #[error("preset document has version {version}, this program reads version 1; use a newer program or convert it")]
    Version {
        /// Version found.
        version: u32,
    },
    /// No preset at all.
    #[error("preset document holds 0 presets, at least 1 is needed; add one")]
    Empty,
    /// NaN or infinite.
    #[error("preset {preset}: {field} is not a finite number; give a finite value")]
    NotFinite {
        /// Preset.
        preset: String,
        /// Which value.
        field: &'static str,
    },
    /// A value outside its range.
    #[error("preset {preset}: {field} is {}, it must be in {min}..={max}", short(*value))]
    Range {
        /// Preset.
        preset: String,
        /// Which value.
        field: &'static str,
        /// The value.
        value: f64,
        /// Smallest allowed.
        min: f64,
        /// Largest allowed.
        max: f64,
    },
    /// `e <= s`.
    #[error("preset {preset}: far depth e = {} does not exceed near depth s = {}; give e > s", short(*e), short(*s))]
    EndBeforeStart {
        /// Preset.
        preset: String,
        /// Near depth.
        s: f64,
        /// Far depth.
        e: f64,
    },
    /// Bad control points or knots.
    #[error("preset {preset}: {source}")]
    Curve {
        /// Preset.
        preset: String,
        /// Error of the curve.
        source: BSplineError,
    },
    /// The preset has angles as well as control points or knots.
    #[error(
        "preset {preset}: it has angles and control points or knots; a curve is told by one of them, remove the other"
    )]
    TwoCurves {
        /// Preset.
        preset: String,
    },
    /// Too few or too many angles.
    #[error("preset {preset}: it has {count} angles, from 2 to {limit} make a curve")]
    AngleCount {
        /// Preset.
        preset: String,
        /// Number of angles.
        count: usize,
        /// Largest allowed number.
        limit: usize,
    },
    /// Arc lengths of angles that do not rise from 0.
    #[error("preset {preset}: the arc lengths of its angles do not rise from 0; sort them, the first one is 0")]
    AngleOrder {
        /// Preset.
        preset: String,
    },
    /// The control points run towards the eye.
    #[error(
        "preset {preset}: the last control point (u = {far}) is nearer than the first (u = {near}); list them near to far"
    )]
    FarEndNearer {
        /// Preset.
        preset: String,
        /// u of the first control point.
        near: f64,
        /// u of the last control point.
        far: f64,
    },
    /// All control points coincide.
    #[error("preset {preset}: the curve is {length:e} long, at least 1e-9 is needed; move its control points apart")]
    CurveTooShort {
        /// Preset.
        preset: String,
        /// Length, curve units.
        length: f64,
    },
    /// Tags not ascending.
    #[error("preset {preset}: tag {index} lies at u = {u}, not beyond the tag before it ({before}); sort the tags")]
    TagOrder {
        /// Preset.
        preset: String,
        /// Index of the tag, from 0.
        index: usize,
        /// Its position, share of the arc length.
        u: f64,
        /// Position of the tag before.
        before: f64,
    },
    /// Number of sections.
    #[error("preset {preset}: {sections} sections for {tags} tags; exactly {needed} are needed")]
    SectionCount {
        /// Preset.
        preset: String,
        /// Sections found.
        sections: usize,
        /// Tags found.
        tags: usize,
        /// Tags + 1.
        needed: usize,
    },
    /// Two presets for one angle.
    #[error("presets {first} and {second} have the same phi = {phi} degrees; change one of them")]
    DuplicatePhi {
        /// One preset.
        first: String,
        /// The other.
        second: String,
        /// The angle, degrees.
        phi: f64,
    },
    /// Two presets of one name.
    #[error(
        "two presets are named {name:?} (phi = {first} and {second} degrees); rename one of them, operations tell presets by name"
    )]
    DuplicateName {
        /// The name.
        name: String,
        /// Viewing angle of one of them, degrees.
        first: f64,
        /// Of the other, degrees.
        second: f64,
    },
    /// No built-in document of that name.
    #[error("there is no built-in preset {name:?}; use one of {}", super::BUILTIN_NAMES.join(", "))]
    UnknownName {
        /// Name asked for.
        name: String,
    },
    /// More representations than a picture can tell apart.
    #[error("the presets name {count} different representations, {limit} at most; use fewer")]
    ManyRepresentations {
        /// Different ids.
        count: usize,
        /// Limit.
        limit: usize,
    },
}
