//! Scenes that need no files.

use crate::language::later;

/// Names and texts of the built-in scenes.
pub const BUILTIN: [(&str, &str); 9] = [
    (later("Massif, a bent panorama"), include_str!("../../../scenes/massif.toml")),
    (later("Massif, the ground makes way"), include_str!("../../../scenes/massif_terrain.toml")),
    (later("Massif, panorama map"), include_str!("../../../scenes/massif_panorama.toml")),
    (later("Massif, curved rays"), include_str!("../../../scenes/massif_curved_rays.toml")),
    (later("Street, both side streets"), include_str!("../../../scenes/street_split.toml")),
    (later("Church, bent panorama of a town"), include_str!("../../../scenes/church.toml")),
    (later("Canyon, the river ahead"), include_str!("../../../scenes/canyon_preview.toml")),
    (later("Town, three levels of abstraction"), include_str!("../../../scenes/town_sections.toml")),
    (later("Engine, a volume"), include_str!("../../../scenes/engine_curved_rays.toml")),
];
