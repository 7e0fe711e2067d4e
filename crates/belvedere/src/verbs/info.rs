//! `info`: contents of files, and capabilities of this machine.

mod city;
mod volume;

pub use super::molecule_info::MoleculeInfo;
pub use city::CityInfo;
pub use volume::VolumeInfo;

use crate::BelvedereError;
use crate::guard::guarded;
use crate::scene_file::VerticalUnit;
use belvedere_core::DVec2;
use belvedere_core::{Warning, WarningKind};
use belvedere_io::formats::{self, Reader};
use belvedere_io::terrain::{TerrainRequest, survey};
use belvedere_io::vector::{Geometry, Vectors};
use belvedere_io::{Arrays, GeoTiff, Known, Limits, Loaded};
use belvedere_io::{LiftedBy, load_vectors};
use belvedere_io::{join_table, split_table};
use belvedere_resolve::builtin;
use belvedere_scene::Progress;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Description of one file.
#[derive(Debug, Clone, JsonSchema, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum FileInfo {
    /// Terrain.
    Terrain(TerrainInfo),
    /// A picture.
    Picture(PictureInfo),
    /// A raster that is not usable as terrain; a warning of kind [`WarningKind::Fallback`] gives the reason.
    Raster(PictureInfo),
    /// Lines, areas or points.
    Features(FeatureInfo),
    /// A mesh.
    Mesh(MeshInfo),
    /// A city.
    City(CityInfo),
    /// A molecule.
    Molecule(MoleculeInfo),
    /// A volume.
    Volume(VolumeInfo),
    /// A built-in scene.
    Builtin(BuiltinInfo),
    /// A known format that this version does not read.
    Unread(UnreadInfo),
}

/// A file of a known format that this version does not read.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct UnreadInfo {
    /// The file.
    pub path: String,
    /// Format.
    pub format: &'static str,
    /// Kind of contents of such files.
    pub holds: &'static str,
    /// Note that it is not read, and what to do.
    pub note: String,
}

/// A mesh.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct MeshInfo {
    /// The file.
    pub path: String,
    /// Format.
    pub format: &'static str,
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Whether vertices have normals.
    pub normals: bool,
    /// Whether it has colours.
    pub colors: bool,
    /// Sizes of its pictures: columns and rows.
    pub pictures: Vec<[usize; 2]>,
    /// Names of its parts, as paths through the file; the first hundred.
    pub parts: Vec<String>,
    /// Smallest coordinates, in the file's own system.
    pub min: [f64; 3],
    /// Largest coordinates.
    pub max: [f64; 3],
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// Terrain: the file, and the ground that a scene gets from it.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct TerrainInfo {
    /// The file.
    pub path: String,
    /// Columns and rows of the file.
    pub size: [usize; 2],
    /// Coordinate system of the file.
    pub crs: String,
    /// Unit of its horizontal coordinates.
    pub unit: String,
    /// Spacing of its samples, in that unit.
    pub spacing: [f64; 2],
    /// First and last samples in the file's system: west, south, east, north.
    pub extent: [f64; 4],
    /// Longitude and latitude: west, south, east, north; degrees.
    pub extent_deg: Option<[f64; 4]>,
    /// Lowest and highest height of the file, metres.
    pub heights_m: Option<[f32; 2]>,
    /// Samples of the file without data.
    pub voids: usize,
    /// Their share, 0..=1.
    pub void_share: f64,
    /// The ground of a scene.
    pub scene: GroundInfo,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// The ground that a scene gets from a file.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct GroundInfo {
    /// Coordinate system of the scene.
    pub crs: String,
    /// Columns and rows.
    pub nodes: [usize; 2],
    /// Spacing of the nodes, metres.
    pub spacing_m: [f64; 2],
    /// Scene x, y: west, south, east, north.
    pub extent: [f64; 4],
    /// Whether its nodes are the samples of the file; else these were resampled.
    pub as_in_file: bool,
}

/// Properties of files that override those in the files.
#[derive(Debug, Clone, Default)]
pub struct InfoRequest {
    /// `EPSG:n` of the terrain.
    pub source_crs: Option<String>,
    /// Stored value of the terrain that means "no data".
    pub nodata: Option<f64>,
    /// Unit of heights.
    pub vertical_unit: Option<VerticalUnit>,
    /// Property that holds the names of features.
    pub name_field: Option<String>,
    /// Most bytes of decoded samples; 4 GiB if left out.
    pub max_bytes: Option<u64>,
}

/// A picture.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct PictureInfo {
    /// The file.
    pub path: String,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Bands.
    pub bands: usize,
    /// Type of the samples.
    pub samples: &'static str,
    /// Coordinate system of the file.
    pub crs: String,
    /// Model coordinates of the corners: top left, top right, bottom right, bottom left.
    pub corners: Option<[[f64; 2]; 4]>,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// Lines, areas, points.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct FeatureInfo {
    /// The file.
    pub path: String,
    /// Format.
    pub format: &'static str,
    /// Coordinate system.
    pub crs: String,
    /// Features with lines.
    pub lines: usize,
    /// Features with areas.
    pub areas: usize,
    /// Features with points.
    pub points: usize,
    /// Field that their names are taken from, if any.
    pub name_field: Option<String>,
    /// Number of features with a name.
    pub named: usize,
    /// Their properties, at most fifty.
    pub properties: Vec<PropertyInfo>,
    /// Vertices of all features.
    pub vertices: usize,
    /// Smallest x, y and largest x, y in the file's system.
    #[schemars(with = "Option<[[f64; 2]; 2]>")]
    pub extent: Option<[DVec2; 2]>,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// A property of features.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct PropertyInfo {
    /// Its name.
    pub name: String,
    /// Features that have it.
    pub features: usize,
    /// Type of its values: "number", "yes or no" or "text".
    pub kind: &'static str,
    /// Shortened value of one of them.
    pub example: String,
}

/// A built-in scene.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct BuiltinInfo {
    /// Its name.
    pub path: String,
    /// Ids of its layers.
    pub layers: Vec<String>,
    /// Smallest corner, scene units.
    pub min: [f64; 3],
    /// Largest corner, scene units.
    pub max: [f64; 3],
    /// Eye of the suggested camera.
    pub eye: [f64; 3],
    /// Target of the suggested camera.
    pub look_at: [f64; 3],
    /// Vertical field of view of the suggested camera, degrees.
    pub fov_y_deg: f64,
}

/// Capabilities of the machine.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct MachineInfo {
    /// Worker threads.
    pub threads: usize,
    /// Renderers.
    pub renderers: Vec<String>,
    /// GPU adapters: none in this version.
    pub adapters: Vec<String>,
    /// Summary in words.
    pub note: &'static str,
}

/// Capabilities of this machine.
pub fn machine() -> MachineInfo {
    MachineInfo {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        renderers: crate::renderers::names(),
        adapters: Vec::new(),
        note: "no GPU renderer in this version",
    }
}

/// Describes a file: features, a picture, terrain, a mesh, a city, a molecule or a volume; or a built-in scene.
///
/// # Errors
/// [`BelvedereError::Io`] with the reason.
pub fn describe(name: &str, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    describe_as(name, &InfoRequest::default(), progress)
}

/// Like [`describe`], with properties that override those in the file.
///
/// # Errors
/// [`BelvedereError::Io`] with the reason.
pub fn describe_as(name: &str, request: &InfoRequest, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    guarded(|| described(name, request, progress))
}

fn described(name: &str, request: &InfoRequest, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    if name.starts_with("builtin:") {
        return built_in(name);
    }
    if let Some(Reader::Volume) = folder_reader(Path::new(name))? {
        return Ok(FileInfo::Volume(VolumeInfo::of(Path::new(name))?));
    }
    if Path::new(name).is_dir() && belvedere_io::is_pyramid(Path::new(name)) {
        return terrain(Path::new(name), &request.terrain(Path::new(name))?, progress);
    }
    let meant = match split_table(Path::new(name)) {
        (whole, Some(_)) => join_table(whole.to_owned(), split_table(Path::new(name)).1),
        (whole, None) => belvedere_io::inside(whole)?,
    };
    let (path, name) = (meant.as_path(), meant.display().to_string());
    let name_field = request.name_field.clone();
    let request = request.terrain(path)?;
    if belvedere_io::city::is_city(path)? {
        return CityInfo::of(path).map(FileInfo::City);
    }
    let readable = belvedere_io::readable(path)?;
    if let Some(known) = belvedere_io::recognise(path)?.filter(|known| known.is_broken || readable.is_none()) {
        if known.is_broken {
            return Err(belvedere_io::IoError::format(path, known.reason()).into());
        }
        let format = known.format;
        let note = format!("not read by this version; {}", format.advice());
        return Ok(FileInfo::Unread(UnreadInfo { path: name, format: format.name, holds: format.holds, note }));
    }
    let plain = split_table(path).0;
    let by_name = || [Reader::Features, Reader::Terrain].into_iter().find(|reader| reader.may_read(plain));
    match readable.and_then(|format| format.reader).or_else(by_name) {
        Some(Reader::Features) => return features(path, name_field.as_deref()),
        Some(Reader::Mesh) => return mesh(path),
        Some(Reader::Molecule) => return super::molecule_info::describe(path).map(FileInfo::Molecule),
        Some(Reader::Volume) => return Ok(FileInfo::Volume(VolumeInfo::of(path)?)),
        Some(Reader::Terrain) => {}
        Some(Reader::City) | None => {
            let reason = format!("it is of no kind that this version reads: {}", formats::read_ones());
            return Err(belvedere_io::IoError::format(path, reason).into());
        }
    }
    if readable.is_some_and(|format| format.name == "GeoTIFF") {
        return geotiff(path, &name, &request, progress);
    }
    terrain(path, &request, progress)
}

/// The loader of a folder; `None` for anything else.
fn folder_reader(path: &Path) -> Result<Option<Reader>, BelvedereError> {
    Ok(if path.is_dir() { Known::of(path, &Arrays::default())?.reader } else { None })
}

impl InfoRequest {
    fn terrain(&self, path: &Path) -> Result<TerrainRequest, BelvedereError> {
        let code = |text: &String| {
            let reason = format!("source_crs \"{text}\" is not known; give EPSG:n");
            belvedere_resolve::ground::epsg(text).ok_or_else(|| belvedere_io::IoError::format(path, reason))
        };
        Ok(TerrainRequest {
            source_crs: self.source_crs.as_ref().map(code).transpose()?,
            nodata: self.nodata,
            vertical_unit_m: self.vertical_unit.map(VerticalUnit::metres),
            limits: self.max_bytes.map_or_else(Limits::default, |max_bytes| Limits { max_bytes }),
            ..TerrainRequest::default()
        })
    }
}

/// Describes a GeoTIFF as picture, as terrain, or else as raster.
fn geotiff(path: &Path, name: &str, request: &TerrainRequest, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    let opened = GeoTiff::open(path, request.limits)?;
    let (file, info) = (&opened.value, opened.value.info());
    let picture = PictureInfo {
        path: name.to_owned(),
        size: [info.width, info.height],
        bands: info.bands,
        samples: info.sample_type.name(),
        crs: info.crs.to_string(),
        corners: info.corners(),
        warnings: opened.warnings,
    };
    if belvedere_io::is_picture(info) {
        return Ok(FileInfo::Picture(picture));
    }
    match terrain(path, request, progress) {
        Err(reason) if reason.lifted_by() == LiftedBy::Memory => Err(reason),
        // Readable, but not usable as ground of a scene.
        Err(reason) if !reason.is_cancelled() && file.read(0, progress).is_ok() => {
            let unusable = Warning::new(WarningKind::Fallback, reason.to_string()).about(name);
            let warnings = picture.warnings.iter().cloned().chain([unusable]).collect();
            Ok(FileInfo::Raster(PictureInfo { warnings, ..picture }))
        }
        answer => answer,
    }
}

fn terrain(path: &Path, request: &TerrainRequest, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    let Loaded { value: survey, warnings, .. } = survey(path, request, progress)?;
    let (terrain, field) = (&survey.ground, &survey.ground.heightfield);
    let b = field.bounds();
    Ok(FileInfo::Terrain(TerrainInfo {
        path: path.display().to_string(),
        size: survey.size,
        crs: survey.system,
        unit: survey.unit,
        spacing: survey.spacing,
        extent: survey.extent,
        extent_deg: terrain.extent_deg,
        heights_m: survey.heights_m,
        voids: terrain.void_samples,
        void_share: terrain.void_share,
        scene: GroundInfo {
            crs: terrain.crs.to_string(),
            nodes: [field.cols(), field.rows()],
            spacing_m: field.spacing().to_array(),
            extent: [b.min.x, b.min.y, b.max.x, b.max.y],
            as_in_file: terrain.resample_error.is_none() && survey.size == [field.cols(), field.rows()],
        },
        warnings,
    }))
}

/// Largest number of properties listed, and of characters of an example.
const LISTED: usize = 50;
const EXAMPLE: usize = 60;

/// Properties of features, the most frequent first.
fn properties(vectors: &Vectors) -> Vec<PropertyInfo> {
    let mut found: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, value) in vectors.features.iter().flat_map(|f| &f.properties) {
        found.entry(name).or_default().push(value);
    }
    let info = |(name, values): (&str, Vec<&str>)| PropertyInfo {
        name: name.to_owned(),
        features: values.len(),
        kind: kind_of(&values),
        example: values[0].chars().take(EXAMPLE).collect(),
    };
    let mut list: Vec<PropertyInfo> = found.into_iter().map(info).collect();
    list.sort_by_key(|p| std::cmp::Reverse(p.features));
    list.truncate(LISTED);
    list
}

/// The type of a property by its values: "number", "yes or no" or "text".
fn kind_of(values: &[&str]) -> &'static str {
    let all = |fits: fn(&str) -> bool| values.iter().all(|value| fits(value));
    if all(|v| v.trim().parse::<f64>().is_ok()) {
        "number"
    } else if all(|v| ["true", "false", "yes", "no", "T", "F"].contains(&v)) {
        "yes or no"
    } else {
        "text"
    }
}

fn features(path: &Path, name_field: Option<&str>) -> Result<FileInfo, BelvedereError> {
    let mut loaded = load_vectors(path)?;
    if let Some(field) = name_field {
        let failed = |reason| belvedere_io::IoError::format(path, reason);
        loaded.value.name_by(field).map_err(failed)?;
    }
    let vectors = &loaded.value;
    let count = |wanted: fn(&Geometry) -> bool| vectors.features.iter().filter(|f| wanted(&f.geometry)).count();
    let all = properties(vectors);
    Ok(FileInfo::Features(FeatureInfo {
        path: path.display().to_string(),
        format: vectors.format,
        crs: vectors.crs.name().to_owned(),
        lines: count(|g| matches!(g, Geometry::Lines(_))),
        areas: count(|g| matches!(g, Geometry::Polygons(_))),
        points: count(|g| matches!(g, Geometry::Points(_))),
        name_field: name_field
            .or_else(|| belvedere_io::vector::name_field(all.iter().map(|p| p.name.as_str())))
            .map(str::to_owned),
        named: vectors.features.iter().filter(|f| !f.name.is_empty()).count(),
        properties: all,
        vertices: vectors.vertex_count(),
        extent: vectors.extent(),
        warnings: loaded.warnings.clone(),
    }))
}

fn mesh(path: &Path) -> Result<FileInfo, BelvedereError> {
    let loaded = belvedere_io::load_mesh(path, &Limits::default())?;
    let mesh = &loaded.value;
    let bounds = belvedere_core::Aabb::of(mesh.positions.iter().copied());
    Ok(FileInfo::Mesh(MeshInfo {
        path: path.display().to_string(),
        format: mesh.format,
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        normals: mesh.normals.is_some(),
        colors: mesh.colors != belvedere_scene::MeshColors::Layer,
        pictures: mesh.texturing.iter().flat_map(|t| &t.textures).map(|t| t.size()).collect(),
        parts: mesh.names.iter().take(100).cloned().collect(),
        min: bounds.min.to_array(),
        max: bounds.max.to_array(),
        warnings: loaded.warnings,
    }))
}

fn built_in(name: &str) -> Result<FileInfo, BelvedereError> {
    let (scene, camera) = builtin::scene(name).map_err(BelvedereError::Builtin)?;
    let b = scene.bounds();
    Ok(FileInfo::Builtin(BuiltinInfo {
        path: name.to_owned(),
        layers: scene.layers.iter().map(|l| l.id.clone()).collect(),
        min: b.min.to_array(),
        max: b.max.to_array(),
        eye: camera.eye.to_array(),
        look_at: camera.look_at.to_array(),
        fov_y_deg: camera.fov_y.to_degrees(),
    }))
}
