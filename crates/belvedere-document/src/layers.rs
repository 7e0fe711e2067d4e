//! Layers of the scene document.

use super::by_property::{ColorByDoc, SizeByDoc};
use super::city::CityDoc;
use super::common::{Paths, TransformDoc, is_false, is_opaque};
use super::mesh::MeshDoc;
use super::molecule::MoleculeDoc;
use super::overlay::{AutoOrLength, SwitchOrLength};
use super::palette::PaletteDoc;
use super::points::PointLayerDoc;
use super::volume::VolumeDoc;
use belvedere_scene::{Edge, Hidden, LineClass, Relief, Shading};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// One layer.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum LayerDoc {
    /// Ground.
    Terrain(TerrainDoc),
    /// Polylines on the ground.
    Line(LineDoc),
    /// Polygons on the ground.
    Area(AreaDoc),
    /// Points on the ground.
    Point(PointLayerDoc),
    /// Upright boxes.
    Boxes(BoxesDoc),
    /// Triangles.
    Mesh(MeshDoc),
    /// Buildings and what is between them.
    City(CityDoc),
    /// Atoms.
    Molecule(MoleculeDoc),
    /// Voxels.
    Volume(VolumeDoc),
}

/// Names of the kinds of layers.
pub(super) const LAYER_KINDS: &[&str] =
    &["terrain", "mesh", "boxes", "city", "molecule", "volume", "line", "area", "point"];

impl LayerDoc {
    /// Unique id within the scene.
    pub fn id(&self) -> &str {
        match self {
            Self::Terrain(l) => &l.id,
            Self::Line(l) => &l.id,
            Self::Area(l) => &l.id,
            Self::Point(l) => &l.id,
            Self::Boxes(l) => &l.id,
            Self::Mesh(l) => &l.id,
            Self::Molecule(l) => &l.id,
            Self::City(l) => &l.id,
            Self::Volume(l) => &l.id,
        }
    }

    /// Whether constructors and measures work for the layer.
    pub fn must_see(&self) -> bool {
        match self {
            Self::Terrain(_) => false,
            Self::Line(l) => l.must_see,
            Self::Area(l) => l.must_see,
            Self::Point(l) => l.must_see,
            Self::Boxes(l) => l.must_see,
            Self::Mesh(l) => l.must_see,
            Self::Molecule(l) => l.must_see,
            Self::City(l) => l.must_see,
            Self::Volume(l) => l.must_see,
        }
    }

    /// Sets whether constructors and measures work for the layer; terrain stays as it is.
    pub fn set_must_see(&mut self, must_see: bool) {
        *match self {
            Self::Terrain(_) => return,
            Self::Line(l) => &mut l.must_see,
            Self::Area(l) => &mut l.must_see,
            Self::Point(l) => &mut l.must_see,
            Self::Boxes(l) => &mut l.must_see,
            Self::Mesh(l) => &mut l.must_see,
            Self::Molecule(l) => &mut l.must_see,
            Self::City(l) => &mut l.must_see,
            Self::Volume(l) => &mut l.must_see,
        } = must_see;
    }

    /// Whether bends carry its parts as rigid bodies; `None` for kinds that have none.
    pub fn rigid(&self) -> Option<bool> {
        match self {
            Self::Boxes(l) => Some(l.rigid),
            Self::Mesh(l) => Some(l.rigid),
            Self::City(l) => Some(l.rigid),
            _ => None,
        }
    }

    /// The layer with or without rigid bodies; as it is if its kind has none.
    pub fn with_rigid(&self, wanted: bool) -> Self {
        let mut layer = self.clone();
        match &mut layer {
            Self::Boxes(l) => l.rigid = wanted,
            Self::Mesh(l) => l.rigid = wanted,
            Self::City(l) => l.rigid = wanted,
            _ => {}
        }
        layer
    }

    /// The layer with another wish of whether it is seen; terrain has none.
    pub fn with_must_see(&self, wanted: bool) -> Self {
        let mut layer = self.clone();
        match &mut layer {
            Self::Terrain(_) => {}
            Self::Line(l) => l.must_see = wanted,
            Self::Area(l) => l.must_see = wanted,
            Self::Point(l) => l.must_see = wanted,
            Self::Boxes(l) => l.must_see = wanted,
            Self::Mesh(l) => l.must_see = wanted,
            Self::Molecule(l) => l.must_see = wanted,
            Self::City(l) => l.must_see = wanted,
            Self::Volume(l) => l.must_see = wanted,
        }
        layer
    }

    /// File of the layer's movement.
    pub fn motion(&self) -> Option<&str> {
        match self {
            Self::Boxes(l) => l.motion.as_deref(),
            Self::Mesh(l) => l.motion.as_deref(),
            Self::Molecule(l) => l.motion.as_deref(),
            _ => None,
        }
    }

    /// Whether the layer moves in films.
    pub fn moves(&self) -> bool {
        let changes = matches!(self, Self::Molecule(l) if l.models_per_s.is_some() || l.trajectory.is_some());
        changes || self.motion().is_some()
    }

    /// Name of the kind, as files write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Terrain(_) => "terrain",
            Self::Line(_) => "line",
            Self::Area(_) => "area",
            Self::Point(_) => "point",
            Self::Boxes(_) => "boxes",
            Self::Mesh(_) => "mesh",
            Self::City(_) => "city",
            Self::Molecule(_) => "molecule",
            Self::Volume(_) => "volume",
        }
    }
}

/// Ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TerrainDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file, a list of tiles, or a built-in scene such as `builtin:massif?seed=7`.
    pub source: Paths,
    /// Whether holes are filled; filled parts are marked.
    #[serde(default)]
    pub fill_voids: bool,
    /// Largest hole that is filled, as a share of the ground, in (0, 1]; larger ones stay open. By default every hole is filled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_hole: Option<f64>,
    /// `EPSG:n` of the files, instead of what they say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source_crs: Option<String>,
    /// Stored value that means "no data", instead of what the files say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodata: Option<f64>,
    /// Unit of the heights, instead of what the files say: `m`, `ft` or `us-ft`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertical_unit: Option<VerticalUnit>,
    /// Georeferenced pictures laid over the ground, later ones on top.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drape: Option<Paths>,
    /// What covers the ground, for palettes of materials: one raster of classes of ESA WorldCover, CORINE Land Cover or NLCD, or files of
    /// areas with the tags `natural`, `landuse` or `landcover` of OpenStreetMap, or `code_18` of CORINE. Where nothing is known the
    /// materials are drawn by rule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub land_cover: Option<Paths>,
    /// How it is drawn.
    #[serde(default)]
    pub style: TerrainStyleDoc,
}

/// A unit of heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum VerticalUnit {
    /// Metres.
    #[serde(rename = "m")]
    Metre,
    /// Feet of 0.3048 m.
    #[serde(rename = "ft")]
    Foot,
    /// US survey feet, 1200/3937 m.
    #[serde(rename = "us-ft")]
    UsFoot,
}

impl VerticalUnit {
    /// Metres per unit.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Foot => 0.3048,
            Self::UsFoot => 1200.0 / 3937.0,
        }
    }
}

/// How terrain is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TerrainStyleDoc {
    /// Relief shading.
    pub relief: Relief,
    /// Vertical exaggeration of the shading only, in (0, 100].
    pub exaggeration: f64,
    /// Normals used for the shading; by default `deformed` under terrain disocclusion, else `map`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shading: Option<Shading>,
    /// Tint by height; the heights are the true ones, wherever bends move the ground.
    pub palette: PaletteDoc,
    /// Whether the palettes auto, swiss, winter and autumn show materials by rule, from the climate, heights and form of the ground: forest,
    /// meadow, scree, rock and snow, and relief finer than the data; else tints by height alone.
    #[serde(skip_serializing_if = "is_on")]
    pub materials: bool,
    /// Whether the sea is drawn as such: connected ground at one height, 0 or the lowest below 0, that reaches the edge of the
    /// terrain, covers a square kilometre (or a twentieth of the terrain) and has a low shore; and voids at the edge whose
    /// shore is low, which become ground at 0.
    pub sea: bool,
    /// Lines of equal height, of the true heights wherever bends move the ground: `true` at an interval that fits the scale of the picture, or
    /// the interval, scene units, > 0. Every fifth line is thick, and lines that would come too close are left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contours: Option<SwitchOrLength>,
    /// How the ground ends where its data end.
    #[serde(skip_serializing_if = "is_plain")]
    pub edge: Edge,
}

fn is_on(switch: &bool) -> bool {
    *switch
}

fn is_plain(edge: &Edge) -> bool {
    *edge == Edge::Plain
}

impl Default for TerrainStyleDoc {
    fn default() -> Self {
        Self {
            relief: Relief::Swiss,
            exaggeration: 1.0,
            shading: None,
            palette: PaletteDoc::default(),
            materials: true,
            sea: true,
            contours: None,
            edge: Edge::Plain,
        }
    }
}

/// Polylines on the ground: from a file, or a valley route found by least cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LineDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file, several, or `builtin:NAME` for the lines of a built-in scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<Paths>,
    /// Those features of the files that are meant: a name, an id, or `key=value` of a property; by default all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub select: Option<String>,
    /// A generated route along the valleys instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub route: Option<RouteDoc>,
    /// Property that holds the names of features; by default the one that looks most like a name, which `info` tells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name_field: Option<String>,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// How it is drawn.
    #[serde(default)]
    pub style: LineStyleDoc,
}

/// A generated route: the cheapest way over the terrain, preferring valleys; without ends along a valley of its own choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RouteDoc {
    /// Start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<PositionDoc>,
    /// End.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<PositionDoc>,
    /// Seed of its small random windings.
    #[serde(default)]
    pub seed: u64,
}

/// A position without a height: `[x, y]` or `{ lon, lat }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PositionDoc {
    /// Scene x and y.
    Scene([f64; 2]),
    /// WGS84 degrees.
    Geographic(LonLatDoc),
}

/// A position in WGS84 degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LonLatDoc {
    /// Longitude, degrees.
    pub lon: f64,
    /// Latitude, degrees.
    pub lat: f64,
}

impl<'de> Deserialize<'de> for PositionDoc {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PositionVisitor;
        impl<'de> Visitor<'de> for PositionVisitor {
            type Value = PositionDoc;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("[x, y] or { lon, lat }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<PositionDoc, A::Error> {
                <[f64; 2]>::deserialize(SeqAccessDeserializer::new(seq)).map(PositionDoc::Scene)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PositionDoc, A::Error> {
                LonLatDoc::deserialize(MapAccessDeserializer::new(map)).map(PositionDoc::Geographic)
            }
        }
        deserializer.deserialize_any(PositionVisitor)
    }
}

/// How lines are drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LineStyleDoc {
    /// What the lines are, which gives colour, width and casing where the style states none; by default what their properties say, as
    /// OpenStreetMap writes them, else words in the name of the file. Lifts are cables above the ground. `route`: none of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub class: Option<LineClass>,
    /// `#rrggbb` or `#rrggbbaa`.
    pub color: String,
    /// Colour by a property of the file, in place of `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_by: Option<ColorByDoc>,
    /// Width on screen, pixels, in (0, 100].
    pub width_px: f64,
    /// Width by a property of the file, in place of `width_px`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width_by: Option<SizeByDoc>,
    /// Colour of the casing, or `none`.
    pub casing: String,
    /// What happens to hidden parts.
    pub hidden: Hidden,
    /// Height above ground at which the line is drawn and judged visible, metres, in [0, 1000].
    pub lift_m: f64,
    /// Marks along each line at this distance, measured in plan where there is ground, metres, > 0, or `auto`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_markers_m: Option<AutoOrLength>,
    /// Whether names are written, each once, as far as they do not overlap.
    pub labels: bool,
    /// Property whose values are written, such as `name:de`; features without it are written by their name. Names are then written
    /// without `labels`, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Height of the letters, pixels, in (0, 200].
    pub label_px: f64,
}

impl Default for LineStyleDoc {
    fn default() -> Self {
        Self {
            class: None,
            color: "#d7301f".into(),
            color_by: None,
            width_px: 3.0,
            width_by: None,
            casing: "#ffffff".into(),
            hidden: Hidden::Dash,
            lift_m: 1.0,
            distance_markers_m: None,
            labels: false,
            label: None,
            label_px: 13.0,
        }
    }
}

/// Polygons on the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AreaDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file, several, or `builtin:NAME` for the areas of a built-in scene.
    pub source: Paths,
    /// Property that holds the names of features; by default the one that looks most like a name, which `info` tells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name_field: Option<String>,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// How it is drawn.
    #[serde(default)]
    pub style: AreaStyleDoc,
}

/// What covers an area.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceDoc {
    /// What the source says: properties as OpenStreetMap, Natural Earth, glacier inventories, CORINE and the World Database on
    /// Protected Areas write them, else words in the names of layer and file, else `outline`.
    Auto,
    /// Unknown: a line, and a light fill that everything shows through.
    Outline,
    /// Nothing but its colour.
    Plain,
    /// Water: flat, with a shore line.
    Water,
    /// Forest.
    Forest,
    /// Ice.
    Glacier,
    /// A park or reserve: a line, and a light green fill that everything shows through.
    Park,
}

/// How areas are drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AreaStyleDoc {
    /// Fill, `#rrggbb` or `#rrggbbaa`; by default that of the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
    /// Fill by a property of the file, in place of `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_by: Option<ColorByDoc>,
    /// Outline colour, or `none`; by default that of the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outline: Option<String>,
    /// Outline width on screen, pixels, in (0, 100].
    pub width_px: f64,
    /// Whether it is water: flat, without relief shading. `surface` says more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub water: Option<bool>,
    /// What covers the ground, `auto` by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceDoc>,
    /// What happens to hidden parts of the outline.
    pub hidden: Hidden,
    /// Height above ground at which it is judged visible, metres, in [0, 1000].
    pub lift_m: f64,
    /// Whether names are written: each once, in the largest of the areas that bear it.
    pub labels: bool,
    /// Property whose values are written, such as `name:de`; features without it are written by their name. Names are then written
    /// without `labels`, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Which names are placed first: `area` (the default: where the room is largest), or a property that holds numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<String>,
    /// Height of the letters, pixels, in (0, 200].
    pub label_px: f64,
}

impl Default for AreaStyleDoc {
    fn default() -> Self {
        Self {
            color: None,
            color_by: None,
            outline: None,
            width_px: 1.5,
            water: None,
            surface: None,
            hidden: Hidden::Cut,
            lift_m: 1.0,
            labels: false,
            label: None,
            rank: None,
            label_px: 13.0,
        }
    }
}

/// Upright boxes: inline, or from a JSON or CSV file with the same names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxesDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A JSON file (a list of boxes), a CSV file (`x,y,z,size_x,size_y,size_z[,yaw_deg[,color]]`), or `builtin:street`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// The boxes themselves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boxes: Option<Vec<BoxDoc>>,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// Whether bends carry each box as a rigid body: moved and turned as a whole with the ground under its foot, so that walls stay straight
    /// and nothing of it folds, however tall; neighbours may interpenetrate.
    #[serde(default, skip_serializing_if = "is_false")]
    pub rigid: bool,
    /// How they are drawn.
    #[serde(default)]
    pub style: BoxStyleDoc,
    /// Moves all boxes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDoc>,
    /// Movement: a CSV file of rows `t,x,y,z[,yaw_deg]` (seconds, scene coordinates): where the layer's own origin is, after `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<String>,
}

/// How boxes are drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoxStyleDoc {
    /// Colour of boxes that have none of their own.
    pub color: String,
    /// Opacity, 0..=1: below 1 what is behind is seen through, at 0 the layer is not drawn.
    #[serde(skip_serializing_if = "is_opaque")]
    pub opacity: f64,
}

impl Default for BoxStyleDoc {
    fn default() -> Self {
        Self { color: "#c9c2b8".into(), opacity: 1.0 }
    }
}

/// One upright box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxDoc {
    /// Centre of the base, scene coordinates.
    pub base: [f64; 3],
    /// Full extents along its own x, its own y, and z, scene units, > 0.
    pub size: [f64; 3],
    /// Rotation about z, degrees counter-clockwise.
    #[serde(default)]
    pub yaw_deg: f64,
    /// Colour of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
}
