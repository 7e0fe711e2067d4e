//! `reveal`: what must be seen, from where, and how the picture looks.

#[cfg(feature = "clap")]
use super::args::one_of;
#[cfg(feature = "clap")]
use super::value;
use super::{Look, Paper, RendererName, Stated};
use crate::SurfaceDoc;
use crate::place::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A picture in which routes, areas, points or a part of a model are visible.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Reveal {
    /// Terrain: GeoTIFF, .hgt, ESRI ASCII, a folder of tiles, or builtin:massif?seed=7; or a city: CityJSON, CityGML, OSM PBF or XML; with --see
    /// also a model: OBJ, PLY, STL, glTF, PDB, mmCIF, XYZ, VTI, VTK, NRRD, MetaImage, NIfTI, raw voxels, footprints, or a scene file
    #[cfg_attr(feature = "clap", arg(value_name = "DATA"))]
    pub data: String,
    /// Routes, areas or points: GPX, KML, TCX, GeoJSON, shapefiles, GeoPackages, FlatGeobuf, CSV, or builtin:massif?seed=7; the first file is
    /// what must be seen, later ones are drawn as its context; elevation models among them are further tiles of the terrain; with --see more
    /// models; - = standard input (one of all data)
    #[cfg_attr(feature = "clap", arg())]
    pub features: Vec<String>,
    /// Part of a model or city that must be seen: a file (by its name without ending) or layer, a named part of a mesh, atoms such as
    /// "chain B", a building, street or area by name, id or key=value (`info` lists them), a file of routes, or a point x,y,z in scene
    /// coordinates or as 46.5N,11.3E,+2; rays bend around what hides it
    #[cfg_attr(feature = "clap", arg(long, value_name = "WHAT", allow_hyphen_values = true))]
    pub see: Option<String>,
    /// Means that show it where no bend does: transparency, cutaway or explosion of everything that hides it, or LAYER:KIND for one
    /// layer; several separated by commas
    #[cfg_attr(feature = "clap", arg(long, value_delimiter = ',', value_name = "LIST", requires = "see", value_parser = value::fallback))]
    pub fallback: Vec<String>,
    /// Colours and opacities of volumes with --see: auto, solid, engine, ct-bone, ct-soft, vessels, grey, or a file
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME|FILE", requires = "see"))]
    pub transfer: Option<String>,
    /// Eye: x,y of the scene, lon,lat in degrees, or 46.5N,11.3E; and height in metres, or +20 for 20 m above the ground. Chosen
    /// automatically if left out
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = value::with_height))]
    pub eye: Option<Place>,
    /// Point to look at, written as the eye; without Z it lies on the ground
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true))]
    pub look: Option<Place>,
    /// Full vertical field of view, degrees
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = value::number))]
    pub fov: Option<f64>,
    /// Size of the picture, such as 1920x1080
    #[cfg_attr(feature = "clap", arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = value::size))]
    pub size: Option<[u32; 2]>,
    /// Renderer, as of `render`: auto, cpu, exact, or one that the program registers
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", default_value_t))]
    pub renderer: RendererName,
    /// Coverage samples per pixel: 1, 4 or 16; 4 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", allow_negative_numbers = true, value_parser = value::samples))]
    pub samples: Option<u32>,
    /// Paper of the picture.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub paper: Paper,
    /// Lower the ground with the distance, as on a sphere, with refraction
    #[cfg_attr(feature = "clap", arg(long))]
    pub curved_earth: bool,
    /// Leave holes of the terrain open instead of filling them
    #[cfg_attr(feature = "clap", arg(long))]
    pub keep_voids: bool,
    /// Fill all holes of the terrain, also large ones; by default those of at most 3 % of it
    #[cfg_attr(feature = "clap", arg(long, conflicts_with = "keep_voids"))]
    pub fill_voids: bool,
    /// Tint of the terrain: auto (the default: meadows, forest, rock and snow as the climate of the place has them), swiss, winter, autumn,
    /// alpine, desert, glacial, atlas, clear, plain, night, or a file of colours by height (GDAL colour-relief text, GMT .cpt)
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME|FILE"))]
    pub palette: Option<String>,
    /// Georeferenced picture laid over the ground, such as a map or an aerial photograph; may be given several times, later ones on top
    #[cfg_attr(feature = "clap", arg(long, value_name = "FILE", conflicts_with = "see"))]
    pub drape: Vec<String>,
    /// Write the names of lines, areas and points
    #[cfg_attr(feature = "clap", arg(long, conflicts_with = "see"))]
    pub labels: bool,
    /// Draw the sea as ordinary ground
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_sea: bool,
    /// Rivers that do not run uphill where the ground makes way: a file of lines, GPX, GeoJSON, shapefile; may be given several times
    #[cfg_attr(feature = "clap", arg(long, value_name = "FILE", conflicts_with = "see"))]
    pub rivers: Vec<String>,
    /// Style of areas, instead of the one that their properties and names give
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<SurfaceDoc>(), value_name = "STYLE"))]
    pub area_style: Option<SurfaceDoc>,
    /// What the lines of a file are, as FILE=CLASS, instead of what their properties and the name of the file say: route (drawn as if nothing
    /// were known), main_road, road, track, path, railway, lift, river, stream, piste_green, piste_blue, piste_red, piste_black, piste or
    /// border; may be given several times
    #[cfg_attr(feature = "clap", arg(long, value_name = "FILE=CLASS", conflicts_with = "see", value_parser = value::line_class))]
    pub line_class: Vec<String>,
    /// Axis that points upwards in the picture, with --see: x, y, z, -x, -y or -z
    #[cfg_attr(feature = "clap", arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = value::axis, requires = "see"))]
    pub up: Option<[f64; 3]>,
    /// Technique that bends the picture; by default a spline, with --see curved rays
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<Technique>()))]
    pub technique: Option<Technique>,
    /// Lift the limits of plausible ground: no lower than a fifth of the relief below the lowest point, no steeper than twice the 99.9th
    /// percentile of the terrain's slopes
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_limits: bool,
    /// Coordinate system of the scene: auto, EPSG:n or local
    #[cfg_attr(feature = "clap", arg(long, value_name = "CRS"))]
    pub crs: Option<String>,
    /// What the files do not say.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub stated: Stated,
    /// Light, stylisation, mark, furniture.
    #[cfg_attr(feature = "clap", command(flatten, next_help_heading = "Look of the picture"))]
    #[serde(flatten)]
    pub appearance: Look,
}

impl Reveal {
    /// Options that say something of terrain with features, and nothing of models and cities.
    pub const OF_TERRAIN: [&'static str; 20] = [
        "relief",
        "hidden",
        "exaggeration",
        "fill_voids",
        "drape",
        "labels",
        "keep_voids",
        "palette",
        "landcover",
        "no_sea",
        "area_style",
        "line_class",
        "curved_earth",
        "no_limits",
        "crs",
        "source_crs",
        "nodata",
        "vertical_unit",
        "name_field",
        "rivers",
    ];
    /// Options that say something of a part of a model, and nothing of terrain with features.
    pub const OF_MODELS: [&'static str; 4] = ["fallback", "transfer", "up", "no_shadows"];
}

/// Technique that bends the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Technique {
    /// The technique that shows most; tries a spline, both, and terrain disocclusion, 120 s of solving each (or --time-limit)
    Auto,
    /// A spline over the mean ground
    #[default]
    Spline,
    /// Terrain disocclusion
    Terrain,
    /// Spline and terrain
    Both,
    /// Rays that bend once, around what hides most; the technique for models (--see)
    CurvedRays,
}
