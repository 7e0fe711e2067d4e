//! Warnings: oddities that do not stop the work, as values.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// What a reader learns from a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WarningKind {
    /// Damaged or contradictory input was changed so that it can be used.
    Repaired,
    /// Something in the input is left out.
    Ignored,
    /// Something that is not stated, such as a unit, a reference system or an encoding, was taken by default.
    Assumed,
    /// The input is used coarser or smaller than it is, to keep a budget.
    Reduced,
    /// Positions or values may be off by more than those of the input.
    Inexact,
    /// Input or result looks wrong, and nothing was changed; look at it.
    Suspect,
    /// A limit of time, depth, slope or length ended something early.
    Limited,
    /// Something that was asked to be visible is not.
    Hidden,
    /// The eye or the ground was moved far, or to an odd place.
    Moved,
    /// Something was done in another way than asked for.
    Fallback,
}

impl WarningKind {
    /// The word for it, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repaired => "repaired",
            Self::Ignored => "ignored",
            Self::Assumed => "assumed",
            Self::Reduced => "reduced",
            Self::Inexact => "inexact",
            Self::Suspect => "suspect",
            Self::Limited => "limited",
            Self::Hidden => "hidden",
            Self::Moved => "moved",
            Self::Fallback => "fallback",
        }
    }
}

impl fmt::Display for WarningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// An oddity that does not stop the work: its kind, the thing it is about, its figures, the key that settles it, and one sentence that says
/// all of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Warning {
    kind: WarningKind,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    subject: Option<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    figures: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    key: Option<String>,
    text: String,
}

impl Warning {
    /// A warning without subject and figures.
    ///
    /// * `text`: one sentence: the oddity, its measured value, and how it was handled or what to do.
    pub fn new(kind: WarningKind, text: impl Into<String>) -> Self {
        Self { kind, subject: None, figures: BTreeMap::new(), key: None, text: text.into() }
    }

    /// The warning "`count` `what`" with the figure `count`; `None` if nothing was counted.
    pub fn counted(kind: WarningKind, count: usize, what: &str) -> Option<Self> {
        (count > 0).then(|| Self::new(kind, format!("{count} {what}")).with("count", count as f64))
    }

    /// The same about a layer, feature, file or part of a scene.
    pub fn about(mut self, subject: impl Into<String>) -> Self {
        self.subject = Some(subject.into());
        self
    }

    /// The same with a figure; one that is not finite is left out.
    ///
    /// * `name`: in snake case, with the unit at its end, as `moved_m`; `share` is in 0..=1.
    pub fn with(mut self, name: &str, value: f64) -> Self {
        if value.is_finite() {
            self.figures.insert(name.to_owned(), value);
        }
        self
    }

    /// The same, settled by a key of a layer, a scene or a request, whose option an application may name.
    pub fn settled_by(mut self, key: &str) -> Self {
        self.key = Some(key.to_owned());
        self
    }

    /// The same with `place` and a colon before the text.
    pub fn placed(self, place: impl fmt::Display) -> Self {
        Self { text: format!("{place}: {}", self.text), ..self }
    }

    /// The same about a file, which the text names first.
    pub fn in_file(self, path: &std::path::Path) -> Self {
        self.placed(path.display()).about(path.display().to_string())
    }

    /// What a reader learns from it.
    pub fn kind(&self) -> WarningKind {
        self.kind
    }

    /// Id of the layer, name of the feature, path of the file or part of the scene that it is about.
    pub fn subject(&self) -> Option<&str> {
        self.subject.as_deref()
    }

    /// The figures by their names.
    pub fn figures(&self) -> &BTreeMap<String, f64> {
        &self.figures
    }

    /// One figure.
    pub fn figure(&self, name: &str) -> Option<f64> {
        self.figures.get(name).copied()
    }

    /// Key of a layer, a scene or a request that settles it.
    pub fn key(&self) -> Option<&str> {
        self.key.as_deref()
    }

    /// One sentence.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests;
