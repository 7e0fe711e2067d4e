//! Marks over a picture in scene files.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Upper end of the colours of highlights unless given, pixels.
const HIGHLIGHT_PX: f64 = 200.0;

/// What is drawn over the picture beside the layers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OverlayDoc {
    /// Lines of the coordinate system on the ground: `true` for a round spacing, or the spacing in scene units, > 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<SwitchOrLength>,
    /// A mark in a corner of pictures that anything but the earth's curvature bends: "bent view", and how far at most what is seen was moved.
    pub mark: bool,
    /// Colours for how far the bend moves what is seen.
    pub heatmap: bool,
    /// The straight picture's ridges and routes, faintly over the bent one.
    pub ghost: bool,
    /// What the bend did: any of `shift` (colours for how far it moves what is seen within the picture) or `stages` (a colour for each
    /// stage and turn, where it moves most), `revealed` (the outline of what the straight picture hides), `ghost_box` (a box where what
    /// must be seen would be, and a leader to it).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub highlight: Vec<HighlightMark>,
    /// A figure in the upper left corner, of pictures that a spline bends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inset: Option<Inset>,
    /// Distance at the upper end of the colours of `highlight`, pixels, > 0.
    pub highlight_px: f64,
}

/// A figure in a corner of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Inset {
    /// The deformation curve from the side, with its control points, tag points, the eye and what it sees.
    Curve,
}

/// A way to show what the bend did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HighlightMark {
    /// Colours for how far what is seen moved within the picture.
    Shift,
    /// Colours for the stage, or the turn, that moved it most.
    Stages,
    /// The outline of what the straight picture hides.
    Revealed,
    /// A box where what must be seen would be, and a leader to it.
    GhostBox,
}

impl Default for OverlayDoc {
    fn default() -> Self {
        Self {
            grid: None,
            mark: true,
            heatmap: false,
            ghost: false,
            highlight: Vec::new(),
            inset: None,
            highlight_px: HIGHLIGHT_PX,
        }
    }
}

/// On or off, or a length in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "true, false or a length was expected")]
pub enum SwitchOrLength {
    /// On or off.
    Switch(bool),
    /// A length.
    Length(f64),
}

/// A length in scene units, or `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "a length or \"auto\" was expected")]
pub enum AutoOrLength {
    /// A length.
    Length(f64),
    /// The word `auto`.
    Auto(AutoWord),
}

/// The word `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AutoWord {
    /// A value chosen by the program.
    Auto,
}
