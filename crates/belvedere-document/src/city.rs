//! Layers of cities in the scene document.

use super::ColorByDoc;
use super::common::{Paths, is_false, is_opaque};
use belvedere_scene::city::Keep;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A city: CityJSON, CityJSONSeq, CityGML 1 or 2, OSM PBF or XML, or footprints and land cover as GeoJSON, shapefile or GeoPackage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CityDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file, or several.
    pub source: Paths,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// Names or ids of buildings, separated by commas, or `key=value` of an attribute, that `must_see` means; by default the whole city.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub select: Option<String>,
    /// `EPSG:n` of the files' x and y, where they do not say it or say it wrongly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crs: Option<String>,
    /// Level of detail to draw, such as `"1.2"`; by default the highest of each object.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lod: Option<String>,
    /// Level of abstraction: 0, the buildings as they are; 1, blocks between all streets; 2, blocks between main streets, landmarks
    /// kept in both. The streets are those of the files.
    #[serde(default, skip_serializing_if = "is_none")]
    pub loa: u8,
    /// What blocks keep of their buildings: their mean height, or their volume, for which they are lower.
    #[serde(default, skip_serializing_if = "is_height")]
    pub keep: Keep,
    /// Added to all heights of the files, metres: between their datum and that of the terrain.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub height_offset_m: f64,
    /// Whether bends carry each building as a rigid body: moved and turned as a whole with the ground under its foot, so that walls stay straight
    /// and nothing of it folds, however tall; neighbours may interpenetrate.
    #[serde(default, skip_serializing_if = "is_false")]
    pub rigid: bool,
    /// How it is drawn.
    #[serde(default)]
    pub style: CityStyleDoc,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn is_none(loa: &u8) -> bool {
    *loa == 0
}

fn is_height(keep: &Keep) -> bool {
    *keep == Keep::Height
}

impl CityDoc {
    /// A file in the usual style.
    pub fn of(id: String, source: &str) -> Self {
        Self {
            id,
            source: Paths::One(source.to_owned()),
            must_see: false,
            select: None,
            crs: None,
            lod: None,
            loa: 0,
            keep: Keep::Height,
            height_offset_m: 0.0,
            rigid: false,
            style: CityStyleDoc::default(),
        }
    }
}

/// How a city is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CityStyleDoc {
    /// Colour of roofs.
    pub roof: String,
    /// Colour of walls.
    pub wall: String,
    /// Colours of buildings and blocks by a property of the file's buildings, by `height`, `use` or `population`: roofs in the colour of
    /// their class, walls lighter. Blocks show the sum of counts, the mean of other numbers, and the text that most of their volume has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_by: Option<ColorByDoc>,
    /// Colour of the ground between, in scenes without terrain.
    pub ground: String,
    /// Opacity, 0..=1: below 1 what is behind is seen through (the ground between stays opaque), at 0 the layer is not drawn.
    #[serde(skip_serializing_if = "is_opaque")]
    pub opacity: f64,
    /// Ambient occlusion: how far away something may be that takes light, scene units, > 0; 40 suits a town. Computed when the scene is opened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient_occlusion: Option<f64>,
}

impl Default for CityStyleDoc {
    fn default() -> Self {
        let [roof, wall, ground] = ["#ba6e56", "#ece4d6", "#e8e5dc"].map(str::to_owned);
        Self { roof, wall, color_by: None, ground, opacity: 1.0, ambient_occlusion: None }
    }
}
