//! Scenes that need no files.

/// Names and texts of the built-in scenes.
pub const BUILTIN: [(&str, &str); 9] = [
    ("Massif, a bent panorama", include_str!("../../../scenes/massif.toml")),
    ("Massif, the ground makes way", include_str!("../../../scenes/massif_terrain.toml")),
    ("Massif, panorama map", include_str!("../../../scenes/massif_panorama.toml")),
    ("Massif, curved rays", include_str!("../../../scenes/massif_curved_rays.toml")),
    ("Street, both side streets", include_str!("../../../scenes/street_split.toml")),
    ("Church, bent panorama of a town", include_str!("../../../scenes/church.toml")),
    ("Canyon, the river ahead", include_str!("../../../scenes/canyon_preview.toml")),
    ("Town, three levels of abstraction", include_str!("../../../scenes/town_sections.toml")),
    ("Engine, a volume", include_str!("../../../scenes/engine_curved_rays.toml")),
];
