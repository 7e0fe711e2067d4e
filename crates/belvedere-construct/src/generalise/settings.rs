//! Settings of a generalisation.

use super::GeneraliseError;
use belvedere_scene::city::{Keep, WayClass};

/// Measures of a generalisation. The defaults are for towns mapped in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneraliseSettings {
    /// Ground within this distance of a building is settled and divided into cells, metres, >= 5.
    pub margin_m: f64,
    /// Cells smaller than this join the neighbour that they face most, m^2, >= 0.
    pub smallest_cell_m2: f64,
    /// Below this share of built ground a cell is green and has no block, 0..=1.
    pub green_below: f64,
    /// Below this share the block follows its buildings instead of its cell, `green_below`..=1.
    pub sparse_below: f64,
    /// Radius by which gaps between the buildings of such a block are closed, metres, > 0.
    pub closing_m: f64,
    /// Distance of blocks from the streets, metres, >= `simplify_m`.
    pub inset_m: f64,
    /// Largest distance by which simplification moves an outline, metres, >= 0.
    pub simplify_m: f64,
    /// Street areas, which state no class, are main streets where they are at least this wide, metres, > 0.
    pub main_width_m: f64,
    /// What blocks keep.
    pub keep: Keep,
}

impl Default for GeneraliseSettings {
    fn default() -> Self {
        Self {
            margin_m: 20.0,
            smallest_cell_m2: 200.0,
            green_below: 0.10,
            sparse_below: 0.35,
            closing_m: 10.0,
            inset_m: 2.0,
            simplify_m: 1.5,
            main_width_m: 12.0,
            keep: Keep::Height,
        }
    }
}

impl GeneraliseSettings {
    /// # Errors
    /// [`GeneraliseError::Setting`] for a value out of its range.
    pub(super) fn check(&self) -> Result<(), GeneraliseError> {
        let rules = [
            ("margin_m", self.margin_m, 5.0, f64::MAX),
            ("smallest_cell_m2", self.smallest_cell_m2, 0.0, f64::MAX),
            ("green_below", self.green_below, 0.0, 1.0),
            ("sparse_below", self.sparse_below, self.green_below, 1.0),
            ("closing_m", self.closing_m, 0.1, 1000.0),
            ("inset_m", self.inset_m, self.simplify_m, 1000.0),
            ("simplify_m", self.simplify_m, 0.0, 1000.0),
            ("main_width_m", self.main_width_m, 0.1, 1000.0),
        ];
        for (name, value, least, most) in rules {
            if !(least..=most).contains(&value) {
                return Err(GeneraliseError::Setting { name, value, least, most });
            }
        }
        Ok(())
    }
}

/// Half the width of the ground that a street, railway or waterway keeps free, metres; `None` for classes that divide no blocks.
pub fn half_width_m(class: WayClass) -> Option<f64> {
    Some(match class {
        WayClass::Motorway => 12.0,
        WayClass::Primary => 8.0,
        WayClass::Secondary => 7.0,
        WayClass::Tertiary => 5.5,
        WayClass::Residential | WayClass::Rail | WayClass::Waterway => 4.0,
        WayClass::Service => 2.5,
        WayClass::Footway => return None,
    })
}

/// Whether a way of this class still divides the blocks of the coarser level.
pub fn is_main(class: WayClass) -> bool {
    !matches!(class, WayClass::Residential | WayClass::Service | WayClass::Footway)
}
