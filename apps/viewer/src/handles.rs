//! What the open panel edits, and the picture has handles for.

use belvedere::core::presets::PresetDocument;

/// What the open panel edits, and the picture has handles for.
#[derive(Debug, Clone)]
pub(crate) enum Handles {
    /// Turns of curved rays.
    Turns,
    /// Moves of the ground by hand.
    Moves,
    /// A preset of the spline, by its position.
    Preset(Box<PresetDocument>, usize),
}
