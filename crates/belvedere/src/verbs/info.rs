//! `info`: what files hold, and what this machine can do.

mod city;
mod volume;

pub use super::molecule_info::MoleculeInfo;
pub use city::CityInfo;
pub use volume::VolumeInfo;

use crate::BelvedereError;
use crate::resolve::builtin;
use belvedere_core::DVec2;
use belvedere_io::terrain::{TerrainRequest, load_terrain};
use belvedere_io::vector::{self, Geometry, load_vectors};
use belvedere_io::{GeoTiff, Limits};
use belvedere_scene::{NodeState, Progress};
use serde::Serialize;
use std::path::Path;

/// Description of one file.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum FileInfo {
    /// Heights.
    Terrain(TerrainInfo),
    /// A picture.
    Picture(PictureInfo),
    /// Samples that make no terrain of a scene; the last warning says why.
    Raster(PictureInfo),
    /// Lines, areas, points.
    Features(FeatureInfo),
    /// Triangles.
    Mesh(MeshInfo),
    /// A city.
    City(CityInfo),
    /// Atoms.
    Molecule(MoleculeInfo),
    /// Voxels.
    Volume(VolumeInfo),
    /// A built-in scene.
    Builtin(BuiltinInfo),
    /// A known format that this version does not read.
    Unread(UnreadInfo),
}

/// A file of a known format that this version does not read.
#[derive(Debug, Clone, Serialize)]
pub struct UnreadInfo {
    /// The file.
    pub path: String,
    /// Format.
    pub format: &'static str,
    /// What such files hold.
    pub holds: &'static str,
    /// That it is not read, and what to do.
    pub note: String,
}

/// Triangles.
#[derive(Debug, Clone, Serialize)]
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
    /// Whether it has colours of its own.
    pub colors: bool,
    /// Sizes of the pictures that it wears: columns and rows.
    pub pictures: Vec<[usize; 2]>,
    /// Names of its parts, as paths through the file; the first hundred.
    pub parts: Vec<String>,
    /// Smallest coordinates, the file's own.
    pub min: [f64; 3],
    /// Largest coordinates.
    pub max: [f64; 3],
    /// What was odd.
    pub warnings: Vec<String>,
}

/// Heights.
#[derive(Debug, Clone, Serialize)]
pub struct TerrainInfo {
    /// The file.
    pub path: String,
    /// Format, size and system of the file.
    pub sources: Vec<String>,
    /// Coordinate system that a scene gets from it.
    pub scene_crs: String,
    /// Columns and rows of the scene's grid.
    pub nodes: [usize; 2],
    /// Spacing of the scene's grid, metres.
    pub spacing_m: [f64; 2],
    /// Scene x, y: west, south, east, north.
    pub extent: [f64; 4],
    /// Longitude and latitude: west, south, east, north; degrees.
    pub extent_deg: Option<[f64; 4]>,
    /// Lowest and highest height, metres.
    pub heights_m: [f64; 2],
    /// Samples of the file without data.
    pub voids: usize,
    /// Their share, 0..=1.
    pub void_share: f64,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// A picture.
#[derive(Debug, Clone, Serialize)]
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
    /// What was odd.
    pub warnings: Vec<String>,
}

/// Lines, areas, points.
#[derive(Debug, Clone, Serialize)]
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
    /// Vertices of all.
    pub vertices: usize,
    /// Smallest x, y and largest x, y in the file's system.
    pub extent: Option<[DVec2; 2]>,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// A built-in scene.
#[derive(Debug, Clone, Serialize)]
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
    /// Its look_at.
    pub look_at: [f64; 3],
    /// Its field of view, degrees.
    pub fov_y_deg: f64,
}

/// What the machine offers.
#[derive(Debug, Clone, Serialize)]
pub struct MachineInfo {
    /// Worker threads.
    pub threads: usize,
    /// Renderers.
    pub renderers: Vec<&'static str>,
    /// GPU adapters: none in this version.
    pub adapters: Vec<String>,
    /// In words.
    pub note: &'static str,
}

/// What this machine can do.
pub fn machine() -> MachineInfo {
    MachineInfo {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        renderers: vec!["cpu", "exact"],
        adapters: Vec::new(),
        note: "no GPU renderer in this version",
    }
}

/// Describes a file: features, a picture, terrain, triangles, or atoms; or a built-in scene.
///
/// # Errors
/// [`BelvedereError::Io`] with what is wrong with it.
pub fn describe(name: &str, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    if name.starts_with("builtin:") {
        return built_in(name);
    }
    let path = Path::new(name);
    if belvedere_io::city::is_city(path)? {
        return CityInfo::of(path).map(FileInfo::City);
    }
    if let Some(known) = belvedere_io::recognise(path)? {
        if known.is_broken(path) {
            return Err(belvedere_io::IoError::format(path, known.broken()).into());
        }
        let note = format!("not read by this version; {}", known.meanwhile);
        let (path, format, holds) = (name.to_owned(), known.format, known.holds);
        return Ok(FileInfo::Unread(UnreadInfo { path, format, holds, note }));
    }
    let plain = vector::split_table(path).0;
    let ends = |list: &[&str]| plain.extension().is_some_and(|e| list.iter().any(|l| e.eq_ignore_ascii_case(l)));
    if ends(vector::ENDINGS) || ends(&["json"]) {
        return features(path);
    }
    if ends(belvedere_io::mesh::ENDINGS) {
        return mesh(path);
    }
    if belvedere_io::molecule::is_molecule(path) {
        return super::molecule_info::describe(path).map(FileInfo::Molecule);
    }
    if belvedere_io::is_volume(path) {
        return Ok(FileInfo::Volume(VolumeInfo::of(path)?));
    }
    if !ends(belvedere_io::terrain::ENDINGS) {
        return Err(belvedere_io::IoError::format(
            path,
            "it is of no kind that this version reads: terrain and pictures as GeoTIFF, SRTM .hgt (also .zip) or ESRI ASCII, features as GPX, GeoJSON, shapefile (.shp) or GeoPackage (.gpkg, where that is built in), meshes as OBJ, PLY, STL, glTF or GLB, molecules as PDB or mmCIF, volumes as .vti, NRRD or raw samples",
        )
        .into());
    }
    if ends(&["tif", "tiff"]) {
        return geotiff(path, name, progress);
    }
    terrain(path, progress)
}

/// A picture, terrain, or else the raster alone.
fn geotiff(path: &Path, name: &str, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    let opened = GeoTiff::open(path, Limits::default())?;
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
    if info.bands >= 3 || matches!(info.photometric, belvedere_io::Photometric::Palette(_)) {
        return Ok(FileInfo::Picture(picture));
    }
    match terrain(path, progress) {
        // Whole and readable, only no ground of a scene as it stands.
        Err(reason) if !reason.is_cancelled() && file.read(0, progress).is_ok() => {
            let warnings = picture.warnings.iter().cloned().chain([reason.to_string()]).collect();
            Ok(FileInfo::Raster(PictureInfo { warnings, ..picture }))
        }
        answer => answer,
    }
}

fn terrain(path: &Path, progress: &Progress) -> Result<FileInfo, BelvedereError> {
    let loaded = load_terrain(&[path.to_owned()], &TerrainRequest::default(), progress)?;
    let (terrain, field) = (&loaded.value, &loaded.value.heightfield);
    let b = field.bounds();
    let filled = field.share_of(NodeState::Filled);
    debug_assert!(filled == 0.0, "nothing was asked to be filled");
    Ok(FileInfo::Terrain(TerrainInfo {
        path: path.display().to_string(),
        sources: terrain.sources.clone(),
        scene_crs: terrain.crs.to_string(),
        nodes: [field.cols(), field.rows()],
        spacing_m: field.spacing().to_array(),
        extent: [b.min.x, b.min.y, b.max.x, b.max.y],
        extent_deg: terrain.extent_deg,
        heights_m: field.z_range(),
        voids: terrain.void_samples,
        void_share: terrain.void_share,
        warnings: loaded.warnings,
    }))
}

fn features(path: &Path) -> Result<FileInfo, BelvedereError> {
    let loaded = load_vectors(path)?;
    let vectors = &loaded.value;
    let count = |wanted: fn(&Geometry) -> bool| vectors.features.iter().filter(|f| wanted(&f.geometry)).count();
    Ok(FileInfo::Features(FeatureInfo {
        path: path.display().to_string(),
        format: vectors.format,
        crs: vectors.crs.name().to_owned(),
        lines: count(|g| matches!(g, Geometry::Lines(_))),
        areas: count(|g| matches!(g, Geometry::Polygons(_))),
        points: count(|g| matches!(g, Geometry::Points(_))),
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
