//! Palettes that show materials.

use crate::PaletteName;

impl PaletteName {
    /// Whether it shows materials, such as forest, rock and snow; others colour by height alone.
    pub fn has_materials(self) -> bool {
        matches!(self, Self::Auto | Self::Swiss | Self::Winter | Self::Autumn)
    }
}
