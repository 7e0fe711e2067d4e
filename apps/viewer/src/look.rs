//! How the scene is viewed; not part of the document.

use belvedere::scene_file::{MoveKindDoc, SwitchOrVisibility};
use serde::{Deserialize, Serialize};

/// How two pictures are compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Compare {
    /// One picture is shown.
    #[default]
    Off,
    /// Straight on the left of a bar, bent on the right.
    Split,
    /// The two pictures alternate.
    Flicker,
}

/// What the pointer does in the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Tool {
    /// Drags the map.
    #[default]
    Map,
    /// Turns about the middle.
    Orbit,
    /// Picks what is to be kept in sight.
    Track,
    /// Picks the residue that must be seen.
    Residue,
    /// Sets the points of a measurement.
    Measure,
    /// Sets the place of ground that is moved by hand.
    Move(MoveKindDoc),
}

/// How the scene is viewed; not part of the document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Look {
    /// Bent or straight.
    pub(crate) bent: bool,
    pub(crate) compare: Compare,
    /// Where the bar of a split picture stands, share of the width.
    pub(crate) split: f32,
    /// Visibility that haze had before it was switched off.
    pub(crate) visibility: Option<SwitchOrVisibility>,
    /// The straight picture in a corner.
    pub(crate) inset: bool,
    /// The camera from above.
    pub(crate) overhead: bool,
    /// Renderer and times.
    pub(crate) statistics: bool,
    pub(crate) tool: Tool,
    /// The panel beside the picture.
    pub(crate) panel: bool,
}

impl Default for Look {
    fn default() -> Self {
        let (compare, tool) = (Compare::default(), Tool::default());
        Self {
            bent: true,
            compare,
            split: 0.5,
            visibility: None,
            inset: false,
            overhead: false,
            statistics: false,
            tool,
            panel: true,
        }
    }
}
