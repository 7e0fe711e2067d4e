//! The readers: bytes in, a result out, by the way that a user's file goes.

use crate::seeds::{cities, documents, meshes, molecules, packages, rasters, stacks, tables, vectors, volumes};
use belvedere::scene::Progress;
use belvedere::verbs::{info, preset};
use belvedere::{BelvedereError, OpenOptions, PictureOptions, Session, Trust};
use std::path::Path;

/// Files beside the mutated one: name and content.
pub type Beside = fn() -> Vec<(&'static str, Vec<u8>)>;

/// How a reader is called.
#[derive(Debug, Clone, Copy)]
pub enum Way {
    /// `info` describes the file.
    Described,
    /// A scene with these tables is opened and drawn.
    Scene(&'static str),
    /// A function takes the path.
    File(fn(&Path) -> Result<(), BelvedereError>),
    /// A function takes the text.
    Text(fn(&str) -> Result<(), String>),
}

/// One reader.
#[derive(Debug, Clone, Copy)]
pub struct Reader {
    /// Its name on the command line.
    pub name: &'static str,
    /// Name of the mutated file.
    pub file: &'static str,
    /// Files beside it.
    pub beside: Beside,
    /// Valid files.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// How it is called.
    pub way: Way,
}

/// Scenes over a small ground near 10.3 E, 46.9 N.
const ON_GROUND: &str = "format = 1\ncrs = \"EPSG:32632\"\n[camera]\neye = [600300, 5199500, 2600]\nlook_at = [600300, 5200300, 900]\nimage = [24, 16]\n[[layer]]\nid = \"ground\"\nkind = \"terrain\"\nsource = \"ground.asc\"\nsource_crs = \"EPSG:32632\"\n";
/// Scenes of ground alone, seen from far.
const FROM_FAR: &str =
    "format = 1\n[camera]\neye = [600300, 5195000, 9000]\nlook_at = [600300, 5200300, 900]\nimage = [24, 16]\n";
/// Scenes without ground, of things of some ten units.
const NEAR: &str = "format = 1\ncrs = \"local\"\n[camera]\neye = [4, -30, 14]\nlook_at = [4, 4, 2]\nimage = [24, 16]\n";

/// Scenes of atoms.
const OF_ATOMS: &str =
    "format = 1\nunit = \"angstrom\"\n[camera]\neye = [4, -30, 14]\nlook_at = [4, 4, 2]\nimage = [24, 16]\n";

/// Memory that one file may take, bytes.
pub const MAX_BYTES: u64 = 64 << 20;

const fn reader(
    name: &'static str,
    file: &'static str,
    beside: Beside,
    seeds: fn() -> Vec<Vec<u8>>,
    way: Way,
) -> Reader {
    Reader { name, file, beside, seeds, way }
}

fn alone() -> Vec<(&'static str, Vec<u8>)> {
    Vec::new()
}

fn ground() -> Vec<(&'static str, Vec<u8>)> {
    vec![("ground.asc", rasters::ascii_ground())]
}

use Way::{Described, File, Scene, Text};

/// Every reader.
pub const READERS: &[Reader] = &[
    reader(
        "geotiff",
        "a.tif",
        alone,
        rasters::geotiffs,
        Scene("[[layer]]\nid=\"g\"\nkind=\"terrain\"\nsource=\"a.tif\"\n"),
    ),
    reader("geotiff_described", "a.tif", alone, rasters::pictures, Described),
    reader(
        "esri_ascii",
        "a.asc",
        alone,
        rasters::ascii_grids,
        Scene("[[layer]]\nid=\"g\"\nkind=\"terrain\"\nsource=\"a.asc\"\nsource_crs=\"EPSG:32632\"\n"),
    ),
    reader(
        "srtm",
        "N46E010.hgt",
        alone,
        rasters::srtm,
        Scene("[[layer]]\nid=\"g\"\nkind=\"terrain\"\nsource=\"N46E010.hgt\"\n"),
    ),
    reader(
        "xyz",
        "a.xyz",
        alone,
        rasters::xyz,
        Scene("[[layer]]\nid=\"g\"\nkind=\"terrain\"\nsource=\"a.xyz\"\nsource_crs=\"EPSG:32632\"\n"),
    ),
    reader(
        "pmtiles",
        "a.pmtiles",
        alone,
        rasters::pmtiles,
        Scene("[[layer]]\nid=\"g\"\nkind=\"terrain\"\nsource=\"a.pmtiles\"\n"),
    ),
    reader(
        "las",
        "a.las",
        alone,
        rasters::las,
        Scene("[[layer]]\nid=\"g\"\nkind=\"terrain\"\nsource=\"a.las\"\nsource_crs=\"EPSG:32632\"\n"),
    ),
    reader(
        "projection_file",
        "a.prj",
        || vec![("a.asc", rasters::ascii_ground())],
        tables::projections,
        Scene("[[layer]]\nid=\"g\"\nkind=\"terrain\"\nsource=\"a.asc\"\n"),
    ),
    reader("drape_tiff", "a.tif", ground, rasters::pictures, Scene("drape=\"a.tif\"\n")),
    reader(
        "drape_png",
        "a.png",
        || [ground(), vec![("a.pgw", tables::world_file())]].concat(),
        rasters::pngs,
        Scene("drape=\"a.png\"\n"),
    ),
    reader(
        "world_file",
        "a.pgw",
        || [ground(), vec![("a.png", rasters::png(12, 9))]].concat(),
        || vec![tables::world_file()],
        Scene("drape=\"a.png\"\n"),
    ),
    reader(
        "delta",
        "d.tif",
        ground,
        rasters::deltas,
        Scene("[[stage]]\nkind=\"terrain_disocclusion\"\ndelta=\"d.tif\"\n"),
    ),
    reader("palette_cpt", "a.cpt", ground, tables::cpts, Scene("style={palette=\"a.cpt\"}\n")),
    reader("palette_gdal", "a.txt", ground, tables::gdal_ramps, Scene("style={palette=\"a.txt\"}\n")),
    reader(
        "gpx",
        "a.gpx",
        ground,
        vectors::gpx,
        Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.gpx\"\nstyle={labels=true,distance_markers_m=100}\n"),
    ),
    reader(
        "kml",
        "a.kml",
        ground,
        vectors::kml,
        Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.kml\"\nstyle={labels=true}\n"),
    ),
    reader("tcx", "a.tcx", ground, vectors::tcx, Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.tcx\"\n")),
    reader(
        "csv",
        "a.csv",
        ground,
        vectors::csv,
        Scene("[[layer]]\nid=\"w\"\nkind=\"point\"\nsource=\"a.csv\"\nstyle={labels=true}\n"),
    ),
    reader(
        "geojson_lines",
        "a.geojson",
        ground,
        vectors::geojson_lines,
        Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.geojson\"\nstyle={labels=true}\n"),
    ),
    reader(
        "geojson_areas",
        "a.geojson",
        ground,
        vectors::geojson_areas,
        Scene("[[layer]]\nid=\"w\"\nkind=\"area\"\nsource=\"a.geojson\"\n"),
    ),
    reader(
        "geojson_points",
        "a.geojson",
        ground,
        vectors::geojson_points,
        Scene("[[layer]]\nid=\"w\"\nkind=\"point\"\nsource=\"a.geojson\"\nstyle={labels=true}\n"),
    ),
    reader("features_described", "a.geojson", alone, vectors::geojson_all, Described),
    reader(
        "shapefile",
        "a.shp",
        || [ground(), vec![("a.dbf", vectors::dbf()), ("a.prj", tables::utm_prj())]].concat(),
        vectors::shapefiles,
        Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.shp\"\n"),
    ),
    reader(
        "shapefile_table",
        "a.dbf",
        || vec![("a.shp", vectors::shapefile_lines()), ("a.prj", tables::utm_prj())],
        || vec![vectors::dbf()],
        File(|path| info::describe(&path.with_extension("shp").display().to_string(), &Progress::silent()).map(drop)),
    ),
    reader(
        "geopackage",
        "a.gpkg",
        ground,
        vectors::geopackages,
        Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.gpkg\"\n"),
    ),
    reader(
        "osm_pbf",
        "a.osm.pbf",
        ground,
        cities::pbf,
        Scene("[[layer]]\nid=\"c\"\nkind=\"city\"\nsource=\"a.osm.pbf\"\n"),
    ),
    reader(
        "osm_xml",
        "a.osm",
        ground,
        cities::osm_xml,
        Scene("[[layer]]\nid=\"c\"\nkind=\"city\"\nsource=\"a.osm\"\n"),
    ),
    reader(
        "osm_features",
        "a.osm",
        ground,
        cities::osm_xml,
        Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.osm\"\n"),
    ),
    reader(
        "overpass",
        "a.json",
        ground,
        cities::overpass,
        Scene("[[layer]]\nid=\"c\"\nkind=\"city\"\nsource=\"a.json\"\n"),
    ),
    reader(
        "cityjson",
        "a.city.json",
        ground,
        cities::cityjson,
        Scene("[[layer]]\nid=\"c\"\nkind=\"city\"\nsource=\"a.city.json\"\n"),
    ),
    reader(
        "cityjson_sequence",
        "a.city.jsonl",
        ground,
        cities::cityjson_sequence,
        Scene("[[layer]]\nid=\"c\"\nkind=\"city\"\nsource=\"a.city.jsonl\"\n"),
    ),
    reader(
        "citygml",
        "a.gml",
        ground,
        cities::citygml,
        Scene("[[layer]]\nid=\"c\"\nkind=\"city\"\nsource=\"a.gml\"\n"),
    ),
    reader(
        "footprints",
        "a.geojson",
        ground,
        cities::footprints,
        Scene("[[layer]]\nid=\"c\"\nkind=\"city\"\nsource=\"a.geojson\"\nloa=1\n"),
    ),
    reader(
        "obj",
        "a.obj",
        meshes::beside_obj,
        meshes::obj,
        Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.obj\"\n"),
    ),
    reader(
        "mtl",
        "m.mtl",
        || vec![("a.obj", meshes::textured_obj()), ("p.png", rasters::png(4, 4)), ("p.jpg", meshes::jpeg())],
        meshes::mtl,
        Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.obj\"\n"),
    ),
    reader(
        "texture_png",
        "p.png",
        || vec![("a.obj", meshes::textured_obj()), ("m.mtl", b"newmtl paper\nmap_Kd p.png\n".to_vec())],
        rasters::pngs,
        Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.obj\"\n"),
    ),
    reader(
        "texture_jpeg",
        "p.jpg",
        || vec![("a.obj", meshes::textured_obj()), ("m.mtl", b"newmtl paper\nmap_Kd p.jpg\n".to_vec())],
        || vec![meshes::jpeg()],
        Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.obj\"\n"),
    ),
    reader("ply", "a.ply", alone, meshes::ply, Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.ply\"\n")),
    reader("stl", "a.stl", alone, meshes::stl, Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.stl\"\n")),
    reader("gltf", "a.gltf", alone, meshes::gltf, Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.gltf\"\n")),
    reader("glb", "a.glb", alone, meshes::glb, Scene("[[layer]]\nid=\"m\"\nkind=\"mesh\"\nsource=\"a.glb\"\n")),
    reader("pdb", "a.pdb", alone, molecules::pdb, Scene("[[layer]]\nid=\"m\"\nkind=\"molecule\"\nsource=\"a.pdb\"\n")),
    reader(
        "xyz_atoms",
        "b.xyz",
        alone,
        molecules::xyz,
        Scene("[[layer]]\nid=\"m\"\nkind=\"molecule\"\nsource=\"b.xyz\"\nmodel=\"all\"\n"),
    ),
    reader(
        "mmcif",
        "a.cif",
        alone,
        molecules::mmcif,
        Scene("[[layer]]\nid=\"m\"\nkind=\"molecule\"\nsource=\"a.cif\"\nstyle={representation=\"space_filling\"}\n"),
    ),
    reader("nrrd", "a.nrrd", alone, volumes::nrrd, Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.nrrd\"\n")),
    reader("vti", "a.vti", alone, volumes::vti, Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.vti\"\n")),
    reader(
        "metaimage",
        "a.mha",
        alone,
        volumes::meta_image,
        Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.mha\"\n"),
    ),
    reader("nifti", "a.nii", alone, volumes::nifti, Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.nii\"\n")),
    reader(
        "tiff_stack",
        "a.tif",
        alone,
        stacks::tiffs,
        Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.tif\"\n"),
    ),
    reader("tiff_stack_described", "a.tif", alone, stacks::tiffs, Described),
    reader("npy", "a.npy", alone, stacks::npy, Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.npy\"\n")),
    reader("mrc", "a.mrc", alone, stacks::mrc, Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.mrc\"\n")),
    reader("dicom", "a.dcm", alone, stacks::dicom, Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.dcm\"\n")),
    reader("vtk", "a.vtk", alone, volumes::vtk, Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a.vtk\"\n")),
    reader(
        "raw",
        "a_3x4x5_float32.raw",
        alone,
        volumes::raw,
        Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"a_3x4x5_float32.raw\"\n"),
    ),
    reader(
        "transfer",
        "t.json",
        volumes::beside_transfer,
        volumes::transfers,
        Scene("[[layer]]\nid=\"v\"\nkind=\"volume\"\nsource=\"v.nrrd\"\ntransfer=\"t.json\"\n"),
    ),
    reader(
        "gzip",
        "a.gpx.gz",
        ground,
        packages::gzips,
        Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.gpx.gz\"\n"),
    ),
    reader("zip", "a.zip", ground, packages::zips, Scene("[[layer]]\nid=\"w\"\nkind=\"line\"\nsource=\"a.zip\"\n")),
    reader(
        "boxes_csv",
        "b.csv",
        alone,
        tables::boxes_csv,
        Scene("[[layer]]\nid=\"b\"\nkind=\"boxes\"\nsource=\"b.csv\"\n"),
    ),
    reader(
        "boxes_json",
        "b.json",
        alone,
        tables::boxes_json,
        Scene("[[layer]]\nid=\"b\"\nkind=\"boxes\"\nsource=\"b.json\"\n"),
    ),
    reader(
        "motion",
        "m.csv",
        || vec![("b.csv", tables::boxes_csv().remove(0))],
        tables::motions,
        Scene("[[layer]]\nid=\"b\"\nkind=\"boxes\"\nsource=\"b.csv\"\nmotion=\"m.csv\"\n"),
    ),
    reader(
        "path",
        "p.csv",
        || vec![("b.csv", tables::boxes_csv().remove(0))],
        tables::paths,
        Scene(
            "[[layer]]\nid=\"b\"\nkind=\"boxes\"\nsource=\"b.csv\"\n[constructor]\nkind=\"path_preview\"\npath=\"p.csv\"\nposition_m=2.0\npreview_m=6.0\n",
        ),
    ),
    reader("scene_toml", "s.toml", documents::beside, documents::scenes, File(open)),
    reader("scene_json", "s.json", documents::beside, documents::scenes_as_json, File(open)),
    reader(
        "preset_toml",
        "p.toml",
        alone,
        documents::presets,
        File(|path| {
            preset::load(&path.display().to_string()).map(|d| {
                preset::check(&d);
            })
        }),
    ),
    reader(
        "trust_record",
        "trusted.json",
        alone,
        || vec![documents::trusted()],
        File(|path| {
            Trust::in_file(path.to_owned()).list();
            Ok(())
        }),
    ),
    reader(
        "coordinate_system",
        "crs.txt",
        alone,
        tables::systems,
        Text(|text| belvedere::io::crs::CoordinateSystem::from_text(text).map(drop).map_err(|e| e.to_string())),
    ),
    reader(
        "place",
        "place.txt",
        alone,
        tables::places,
        Text(|text| text.parse::<belvedere::places::Place>().map(drop)),
    ),
    reader(
        "track_times",
        "a.gpx",
        alone,
        vectors::gpx,
        Text(|text| belvedere::io::vector::track_times(text).map(drop)),
    ),
];

/// Opens and draws a scene file.
fn open(path: &Path) -> Result<(), BelvedereError> {
    draw(&Session::open(path, &options())?)
}

fn options() -> OpenOptions {
    OpenOptions { image: Some([24, 16]), max_bytes: Some(MAX_BYTES), ..OpenOptions::default() }
}

fn draw(session: &Session) -> Result<(), BelvedereError> {
    let mut options = PictureOptions::default();
    options.quality.samples = 1;
    session.render(&options).map(drop)
}

impl Reader {
    /// Writes the files beside the mutated one into a folder.
    ///
    /// # Errors
    /// What the file system says.
    pub fn prepare(&self, folder: &Path) -> std::io::Result<()> {
        (self.beside)().into_iter().try_for_each(|(name, bytes)| std::fs::write(folder.join(name), bytes))
    }

    /// Reads these bytes as the content of the file in a folder that was prepared.
    ///
    /// # Errors
    /// The refusal. A panic inside the facade is the error that begins with `internal error`.
    pub fn read(&self, bytes: &[u8], folder: &Path) -> Result<(), String> {
        if let Text(call) = self.way {
            return call(&String::from_utf8_lossy(bytes));
        }
        let path = folder.join(self.file);
        std::fs::write(&path, bytes).map_err(|e| format!("cannot be written: {e}"))?;
        let read = match self.way {
            Described => info::describe(&path.display().to_string(), &Progress::silent()).map(drop),
            File(call) => call(&path),
            Scene(tables) => {
                let head = self.head(tables);
                let scene = folder.join("scene.toml");
                Session::from_text(&scene, &format!("{head}{tables}"), &options()).and_then(|session| draw(&session))
            }
            Text(_) => Ok(()),
        };
        read.map_err(|e| e.to_string())
    }

    fn head(&self, tables: &str) -> &'static str {
        match tables {
            _ if (self.beside)().iter().any(|(name, _)| *name == "ground.asc") => ON_GROUND,
            _ if tables.contains("\"terrain\"") => FROM_FAR,
            _ if tables.contains("\"molecule\"") => OF_ATOMS,
            _ => NEAR,
        }
    }
}
