//! Preset documents: deformation curves, styling sections and the viewing angles they are made for.

mod align;
mod angles;
mod builtin;
pub mod edit;
mod error;
mod interpolate;
mod names;

pub use error::PresetError;
pub use interpolate::{InterpolatedPreset, Selection};
pub use names::{BUILTIN_NAMES, BUILTINS, Builtin};

use crate::bspline::{BSpline, BSplineError};
use crate::deformation::DeformationCurve;
use crate::sections::{MOST_REPRESENTATIONS, TagPoint};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Coordinates in which the curve's slope is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum BendFrame {
    /// Slope against the optical axis: it is the angle under which the ground is seen (the paper's frame).
    #[default]
    Camera,
    /// Slope against the reference plane: the bend stands still in the world when the camera pitches (ours).
    Plane,
}

/// Unit of `s` and `e`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum DepthUnits {
    /// Scene units.
    #[default]
    Absolute,
    /// Shares of the distance from the eye to the pivot.
    Distance,
}

/// Course of the interpolation between two presets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Ease {
    /// Proportional to the viewing angle.
    #[default]
    Linear,
    /// Starts and ends gently: `sigma^2 (3 - 2 sigma)`.
    Smoothstep,
}

/// One deformation made for one viewing angle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Name for messages, possibly empty.
    #[serde(default)]
    pub name: String,
    /// Viewing angle, degrees: 0 horizontal, 90 straight down; -90..=90.
    pub phi: f64,
    /// Half width of the range of angles around `phi` in which the preset holds unchanged, degrees, >= 0.
    #[serde(default)]
    pub tau: f64,
    /// Depth of curve coordinate u = 0, scene units or shares of the pivot distance.
    pub s: f64,
    /// Depth of curve coordinate u = 1, > `s`.
    pub e: f64,
    /// Share of the interpolation to the next preset at which its representations begin to fade in, 0..=1.
    #[serde(default)]
    pub a: f64,
    /// Share at which they are complete, `a`..=1.
    #[serde(default = "one")]
    pub b: f64,
    /// Control points (u, v) of the curve, near to far, at least 4; none where there are `angles`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub control: Vec<[f64; 2]>,
    /// In place of control points: the slope of the curve (in frame `camera` the angle under which the ground is seen), degrees, at arc
    /// lengths that rise from 0, curve units; linear between them. The curve begins at (0, 0).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angles: Option<Vec<[f64; 2]>>,
    /// Knots, `control.len() + 4` of them, clamped; clamped uniform if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub knots: Option<Vec<f64>>,
    /// Borders between the styling sections, near to far.
    #[serde(default)]
    pub tags: Vec<TagPoint>,
    /// Representation of each section, near to far, one more than tags.
    #[serde(default = "one_section")]
    pub sections: Vec<String>,
    /// Vertical field of view while this preset holds, degrees; the camera moves so that the scale at the pivot stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fov_y_deg: Option<f64>,
}

/// A set of presets for the range of viewing angles, as stored in files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PresetDocument {
    /// Format of the document, 1.
    pub version: u32,
    /// Coordinates of the curve.
    #[serde(default)]
    pub frame: BendFrame,
    /// Unit of `s` and `e`.
    #[serde(default)]
    pub units: DepthUnits,
    /// Whether the curve is moved so that the pivot stays where it is.
    #[serde(default = "yes")]
    pub pin: bool,
    /// Course of the interpolation.
    #[serde(default)]
    pub ease: Ease,
    /// Whether the picture tilts with the camera above the last preset's range (frame `camera` only).
    #[serde(default)]
    pub follow: bool,
    /// Presets in any order, no two for the same angle or of the same name, at least one.
    pub presets: Vec<Preset>,
}

/// Most angles of a curve.
const MOST_ANGLES: usize = 1000;

fn one() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

fn one_section() -> Vec<String> {
    vec!["all".to_owned()]
}

impl Preset {
    /// The curve, curve units.
    ///
    /// # Errors
    /// Every [`BSplineError`].
    pub fn spline(&self) -> Result<BSpline, BSplineError> {
        if let Some(angles) = &self.angles {
            return angles::curve(angles);
        }
        let control = self.control.iter().map(|&p| DVec2::from(p)).collect();
        match &self.knots {
            Some(knots) => BSpline::with_knots(control, knots.clone()),
            None => BSpline::clamped_uniform(control),
        }
    }

    fn validate(&self, index: usize) -> Result<(), PresetError> {
        let preset = || self.label(index);
        let numbers =
            [("phi", self.phi), ("tau", self.tau), ("s", self.s), ("e", self.e), ("a", self.a), ("b", self.b)];
        let tags = self.tags.iter().flat_map(|t| [("tag u", t.u), ("tag delta", t.delta)]);
        let control = self.control.iter().flatten().map(|&v| ("control", v));
        let fov = self.fov_y_deg.map(|v| ("fov_y_deg", v));
        if let Some((field, _)) = numbers.into_iter().chain(tags).chain(control).chain(fov).find(|n| !n.1.is_finite()) {
            return Err(PresetError::NotFinite { preset: preset(), field });
        }
        let ranges = [
            ("phi", self.phi, -90.0, 90.0),
            ("tau", self.tau, 0.0, 90.0),
            ("a", self.a, 0.0, 1.0),
            ("b", self.b, self.a, 1.0),
            ("fov_y_deg", self.fov_y_deg.unwrap_or(45.0), 0.001, 179.0),
        ];
        if let Some(&(field, value, min, max)) = ranges.iter().find(|r| !(r.2..=r.3).contains(&r.1)) {
            return Err(PresetError::Range { preset: preset(), field, value, min, max });
        }
        if let Some(&value) = self.control.iter().flatten().find(|v| v.abs() > 1e6) {
            return Err(PresetError::Range { preset: preset(), field: "control", value, min: -1e6, max: 1e6 });
        }
        if self.e <= self.s {
            return Err(PresetError::EndBeforeStart { preset: preset(), s: self.s, e: self.e });
        }
        if let Some(angles) = &self.angles {
            self.validate_angles(angles, &preset)?;
        }
        let spline = self.spline().map_err(|source| PresetError::Curve { preset: preset(), source })?;
        let [near, far] = [0, spline.control().len() - 1].map(|i| spline.control()[i].x);
        if far < near - 1e-12 {
            return Err(PresetError::FarEndNearer { preset: preset(), near, far });
        }
        DeformationCurve::new(&spline)
            .map_err(|e| PresetError::CurveTooShort { preset: preset(), length: e.length })?;
        self.validate_sections(index)
    }

    fn validate_angles(&self, angles: &[[f64; 2]], preset: &dyn Fn() -> String) -> Result<(), PresetError> {
        if !self.control.is_empty() || self.knots.is_some() {
            return Err(PresetError::TwoCurves { preset: preset() });
        }
        if angles.iter().flatten().any(|v| !v.is_finite()) {
            return Err(PresetError::NotFinite { preset: preset(), field: "angles" });
        }
        if !(2..=MOST_ANGLES).contains(&angles.len()) {
            return Err(PresetError::AngleCount { preset: preset(), count: angles.len(), limit: MOST_ANGLES });
        }
        let ranges = angles.iter().flat_map(|[l, degrees]| [(*l, 0.0, 1e6), (*degrees, -360.0, 360.0)]);
        if let Some((value, min, max)) = ranges.into_iter().find(|r| !(r.1..=r.2).contains(&r.0)) {
            return Err(PresetError::Range { preset: preset(), field: "angles", value, min, max });
        }
        let rises = |pair: &[[f64; 2]]| pair[1][0] > pair[0][0] + 1e-9;
        if angles[0][0] != 0.0 || !angles.windows(2).all(rises) {
            return Err(PresetError::AngleOrder { preset: preset() });
        }
        Ok(())
    }

    fn validate_sections(&self, index: usize) -> Result<(), PresetError> {
        let preset = || self.label(index);
        for (i, tag) in self.tags.iter().enumerate() {
            if !(0.0..=1.0).contains(&tag.u) {
                return Err(PresetError::Range { preset: preset(), field: "tag u", value: tag.u, min: 0.0, max: 1.0 });
            }
            if !(0.0..=1.0).contains(&tag.delta) {
                let (field, value) = ("tag delta", tag.delta);
                return Err(PresetError::Range { preset: preset(), field, value, min: 0.0, max: 1.0 });
            }
            if i > 0 && tag.u <= self.tags[i - 1].u {
                return Err(PresetError::TagOrder { preset: preset(), index: i, u: tag.u, before: self.tags[i - 1].u });
            }
        }
        let (sections, needed) = (self.sections.len(), self.tags.len() + 1);
        if sections != needed {
            return Err(PresetError::SectionCount { preset: preset(), sections, tags: self.tags.len(), needed });
        }
        Ok(())
    }

    /// Name in quotes, or the position in the document.
    pub(crate) fn label(&self, index: usize) -> String {
        if self.name.is_empty() { format!("{}", index + 1) } else { format!("{:?}", self.name) }
    }
}

impl PresetDocument {
    /// Version this program reads and writes.
    pub const VERSION: u32 = 1;

    /// Whether the document describes usable deformations.
    ///
    /// # Errors
    /// Every [`PresetError`].
    pub fn validate(&self) -> Result<(), PresetError> {
        if self.version != Self::VERSION {
            return Err(PresetError::Version { version: self.version });
        }
        if self.presets.is_empty() {
            return Err(PresetError::Empty);
        }
        for (index, preset) in self.presets.iter().enumerate() {
            preset.validate(index)?;
        }
        let ids: BTreeSet<&String> = self.presets.iter().flat_map(|p| &p.sections).collect();
        if ids.len() > MOST_REPRESENTATIONS {
            return Err(PresetError::ManyRepresentations { count: ids.len(), limit: MOST_REPRESENTATIONS });
        }
        let sorted = self.sorted();
        for pair in sorted.windows(2) {
            if pair[0].phi == pair[1].phi {
                let [first, second] = [0, 1].map(|i| format!("{:?}", pair[i].name));
                return Err(PresetError::DuplicatePhi { first, second, phi: pair[0].phi });
            }
        }
        for (i, preset) in sorted.iter().enumerate().filter(|(_, p)| !p.name.is_empty()) {
            if let Some(other) = sorted[..i].iter().find(|p| p.name == preset.name) {
                let (first, second) = (other.phi, preset.phi);
                return Err(PresetError::DuplicateName { name: preset.name.clone(), first, second });
            }
        }
        Ok(())
    }

    /// The presets by rising viewing angle.
    pub fn sorted(&self) -> Vec<&Preset> {
        let mut sorted: Vec<&Preset> = self.presets.iter().collect();
        sorted.sort_by(|p, q| p.phi.total_cmp(&q.phi));
        sorted
    }
}
