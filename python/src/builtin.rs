//! Built-in scenes: those of the folder `scenes` that need no file.

use crate::errors::{raised, wrong};
use belvedere::{output, scene_file};
use pyo3::prelude::*;
use std::path::Path;

const SCENES: [(&str, &str); 13] = [
    ("massif", include_str!("../../scenes/massif.toml")),
    ("massif_terrain", include_str!("../../scenes/massif_terrain.toml")),
    ("massif_curved_rays", include_str!("../../scenes/massif_curved_rays.toml")),
    ("massif_panorama", include_str!("../../scenes/massif_panorama.toml")),
    ("massif_moves", include_str!("../../scenes/massif_moves.toml")),
    ("massif_strip", include_str!("../../scenes/massif_strip.toml")),
    ("massif_circle", include_str!("../../scenes/massif_circle.toml")),
    ("church", include_str!("../../scenes/church.toml")),
    ("dna", include_str!("../../scenes/dna.toml")),
    ("engine", include_str!("../../scenes/engine_curved_rays.toml")),
    ("street", include_str!("../../scenes/street.toml")),
    ("tube", include_str!("../../scenes/tube_preview.toml")),
    ("tube_straight", include_str!("../../scenes/tube_straight.toml")),
];

/// Names of the built-in scenes.
#[pyfunction]
pub(crate) fn builtin_names() -> Vec<&'static str> {
    SCENES.iter().map(|(name, _)| *name).collect()
}

/// The document of a built-in scene, JSON.
#[pyfunction]
pub(crate) fn builtin_scene(name: &str) -> PyResult<String> {
    let Some((_, text)) = SCENES.iter().find(|(other, _)| *other == name) else {
        return Err(wrong(&format!("there is no built-in scene {name:?}; possible: {}", builtin_names().join(", "))));
    };
    let source = scene_file::parse(Path::new(name), text).map_err(|e| raised(&e.into()))?;
    output::document_json(&source.document).map_err(|e| raised(&e))
}
