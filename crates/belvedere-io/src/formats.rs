//! The table of formats: name, marks in content and file name, and loader.

use crate::columns;
use crate::sqlite::MAGIC;
use crate::text::text_of;
use quick_xml::{Reader as XmlReader, events::Event};
use std::path::Path;

mod lines;

pub(crate) use lines::begins_as_atoms;
use lines::begins_as_points;
pub(crate) use lines::words;

use Mark::{At, Atoms, Both, Columns, Database, First, Json, Points, Record, Root, Word};
use Reader::{City, Features, Mesh, Molecule, Terrain, Volume};

/// The loader that reads a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reader {
    /// [`crate::load_terrain`].
    Terrain,
    /// [`crate::load_vectors`].
    Features,
    /// [`crate::load_city`].
    City,
    /// [`crate::load_mesh`].
    Mesh,
    /// [`crate::load_molecule`].
    Molecule,
    /// [`crate::load_volume`].
    Volume,
}

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Format {
    /// Its name.
    pub name: &'static str,
    /// Content of such files, in words.
    pub holds: &'static str,
    /// Endings of the names of its files, in lower case, with their dots.
    pub endings: &'static [&'static str],
    marks: &'static [Mark],
    /// Loader that reads it; `None` = not read.
    pub reader: Option<Reader>,
    /// Advice for formats that are not read.
    pub meanwhile: &'static str,
}

/// Mark by which a format is recognised in the first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// Bytes at an offset.
    At(usize, &'static [u8]),
    /// Bytes at two offsets.
    Both([(usize, &'static [u8]); 2]),
    /// A word in the schema of an SQLite database.
    Database(&'static str),
    /// The first word of a text, in any case.
    First(&'static str),
    /// A word among the first of a text.
    Word(&'static str),
    /// The local name of the root of an XML document.
    Root(&'static str),
    /// A member of a JSON object, without white space.
    Json(&'static str),
    /// A line that begins with one of these records, longer than 53 characters.
    Record(&'static [&'static str]),
    /// A first line that names columns of coordinates.
    Columns,
    /// A line with a whole number alone, one of any text, and one of an element and three numbers.
    Atoms,
    /// Lines of three numbers.
    Points,
}

/// Number of first bytes that are examined.
pub(crate) const HEAD: u64 = 64 << 10;

const ATOMS: &str = "atoms of a molecule";
const OVER_TIME: &str = "places of atoms over time";
const VOXELS: &str = "a volume of voxels";
const CITY: &str = "a city model";
const FEATURES: &str = "map features";
const TRIANGLES: &str = "triangles";
const RASTER: &str = "a raster";
const CLOUD: &str = "a cloud of points";
const GRIDS: &str = "grids of science";
const MESH_OR_GRID: &str = "a mesh or grid of science";
const TILES: &str = "tiles of heights";
const SIDE: &str = "a part of a shapefile";
const PACKED: &str = "packed files";
const WATCH: &str = "the track of a watch";
const UNPLACED: &str = "a picture without a georeference";

const AS_PDB: &str = "turn it into PDB or mmCIF";
const AS_TRAJECTORY: &str = "name it as trajectory of the molecule that it moves";
const AS_GEOJSON: &str = "ogr2ogr or QGIS turn it into GeoJSON";
const AS_GEOTIFF: &str = "gdal_translate turns it into GeoTIFF";
const AS_DEM: &str = "grid its ground points into a GeoTIFF, as with pdal";
const AS_GLTF: &str = "turn it into glTF or OBJ";
const AS_PLY: &str = "ParaView turns it into PLY or OBJ";
const AS_GPX: &str = "GPSBabel turns it into GPX";
const PLACED: &str = "gdal_translate -a_srs -a_ullr makes it a GeoTIFF";
const WHOLE: &str = "give the .shp file beside it";
const UNPACK: &str = "unpack it, or pack it as ZIP or gzip";

/// Name of TIFFs whose pages are a volume; their directories tell them from elevation models and pictures.
pub(crate) const TIFF_STACK: &str = "TIFF stack";

const fn read(
    reader: Reader,
    name: &'static str,
    holds: &'static str,
    endings: &'static [&'static str],
    marks: &'static [Mark],
) -> Format {
    Format { name, holds, endings, marks, reader: Some(reader), meanwhile: "" }
}

const fn unread(
    name: &'static str,
    holds: &'static str,
    endings: &'static [&'static str],
    marks: &'static [Mark],
    meanwhile: &'static str,
) -> Format {
    Format { name, holds, endings, marks, reader: None, meanwhile }
}

/// Every format that is known. Where several fit a content or a name, the first one counts.
pub const FORMATS: &[Format] = &[
    // Recognised by their first bytes.
    read(Terrain, "LAS or LAZ", CLOUD, &[".las", ".laz"], &[At(0, b"LASF")]),
    unread("E57", CLOUD, &[".e57"], &[At(0, b"ASTM-E57")], AS_DEM),
    read(Features, "FlatGeobuf", FEATURES, &[".fgb"], &[At(0, b"fgb\x03")]),
    unread("HDF5 or netCDF-4", GRIDS, &[".h5", ".hdf5", ".nc4"], &[At(0, b"\x89HDF\r\n\x1a\n")], AS_GEOTIFF),
    unread("netCDF", GRIDS, &[".nc"], &[At(0, b"CDF\x01"), At(0, b"CDF\x02"), At(0, b"CDF\x05")], AS_GEOTIFF),
    unread("GRIB", GRIDS, &[".grib", ".grib2", ".grb"], &[At(0, b"GRIB")], AS_GEOTIFF),
    unread("IFC or STEP", "a model of construction", &[".ifc", ".step", ".stp"], &[At(0, b"ISO-10303-21")], AS_GLTF),
    unread("FBX", TRIANGLES, &[".fbx"], &[At(0, b"Kaydara FBX Binary"), First("; FBX")], AS_GLTF),
    unread(
        "3D Studio",
        TRIANGLES,
        &[".3ds"],
        &[Both([(0, b"MM"), (6, b"\x02\0")]), Both([(0, b"MM"), (6, b"\x3d\x3d")])],
        AS_GLTF,
    ),
    unread("Rhino 3DM", TRIANGLES, &[".3dm"], &[At(0, b"3D Geometry File Format")], AS_GLTF),
    unread("SketchUp", TRIANGLES, &[".skp"], &[At(0, b"\xff\xfe\xff\x0eS\0k\0e\0t\0c\0h\0U\0p\0")], AS_GLTF),
    unread("Alembic", TRIANGLES, &[".abc"], &[At(0, b"Ogawa")], AS_GLTF),
    unread(
        "3D Tiles",
        CITY,
        &[".b3dm", ".i3dm", ".cmpt"],
        &[At(0, b"b3dm"), At(0, b"i3dm"), At(0, b"cmpt"), Json("\"geometricError\":")],
        "give the city model behind it, as CityJSON or glTF",
    ),
    unread("DWG", "a drawing", &[".dwg"], &[At(0, b"AC10")], AS_GEOJSON),
    unread(
        "Git LFS pointer",
        "the place of a file that was not fetched",
        &[],
        &[First("version https://git-lfs")],
        "git lfs pull fetches the file itself",
    ),
    unread(
        "HTML",
        "a page of the web, perhaps of a failed download",
        &[".html", ".htm"],
        &[First("<!doctype html"), First("<html")],
        "get the file itself again",
    ),
    unread("7-Zip", PACKED, &[".7z"], &[At(0, b"7z\xbc\xaf")], UNPACK),
    unread("RAR", PACKED, &[".rar"], &[At(0, b"Rar!")], UNPACK),
    unread("bzip2", PACKED, &[".bz2"], &[At(0, b"BZh")], UNPACK),
    unread("xz", PACKED, &[".xz"], &[At(0, b"\xfd7zXZ")], UNPACK),
    unread("Zstandard", PACKED, &[".zst"], &[At(0, b"(\xb5/\xfd")], UNPACK),
    unread("tar", PACKED, &[".tar", ".tgz", ".tar.gz"], &[At(257, b"ustar")], UNPACK),
    unread("GeoParquet", FEATURES, &[".parquet", ".geoparquet"], &[At(0, b"PAR1")], AS_GEOJSON),
    unread("PDF", "pages", &[".pdf"], &[At(0, b"%PDF")], "give the data behind it"),
    unread("PNG", UNPLACED, &[".png"], &[At(0, b"\x89PNG\r\n")], PLACED),
    unread("JPEG", UNPLACED, &[".jpg", ".jpeg"], &[At(0, b"\xff\xd8\xff")], PLACED),
    unread(
        "JPEG 2000",
        "a picture",
        &[".jp2", ".j2k", ".jpx"],
        &[At(0, b"\0\0\0\x0cjP  "), At(0, b"\xff\x4f\xff\x51")],
        AS_GEOTIFF,
    ),
    unread("GIF", UNPLACED, &[".gif"], &[At(0, b"GIF8")], PLACED),
    unread("WebP", UNPLACED, &[".webp"], &[Both([(0, b"RIFF"), (8, b"WEBP")])], PLACED),
    unread("Windows bitmap", UNPLACED, &[".bmp"], &[Both([(0, b"BM"), (6, b"\0\0\0\0")])], PLACED),
    unread("OpenEXR", UNPLACED, &[".exr"], &[At(0, b"\x76\x2f\x31\x01")], PLACED),
    unread("MrSID", "a picture", &[".sid"], &[At(0, b"msid")], AS_GEOTIFF),
    unread("ECW", "a picture", &[".ecw"], &[], AS_GEOTIFF),
    unread("NITF", "a picture", &[".ntf", ".nitf"], &[At(0, b"NITF0")], AS_GEOTIFF),
    unread("Surfer grid", RASTER, &[], &[At(0, b"DSBB"), At(0, b"DSRB"), At(0, b"DSAA")], AS_GEOTIFF),
    read(Volume, "MRC", VOXELS, &[".mrc", ".map", ".ccp4", ".rec"], &[At(208, b"MAP ")]),
    read(Volume, "NumPy array", VOXELS, &[".npy"], &[At(0, b"\x93NUMPY")]),
    unread("Arrow", "a table", &[".arrow", ".feather"], &[At(0, b"ARROW1")], AS_GEOJSON),
    read(Terrain, "PMTiles", TILES, &[".pmtiles"], &[At(0, b"PMTiles")]),
    read(Terrain, "MBTiles", TILES, &[".mbtiles"], &[At(68, b"MPBX"), Database("tile_column")]),
    read(Volume, "DICOM", VOXELS, &[".dcm", ".dicom"], &[At(128, b"DICM")]),
    read(Features, "GeoPackage", "map features in a database", &[".gpkg"], &[At(68, b"GPKG"), At(68, b"GP10")]),
    unread("SQLite", "map features in a database", &[".sqlite"], &[At(0, b"SQLite format 3\0")], AS_GEOJSON),
    read(City, "OSM PBF", "a map of OpenStreetMap", &[".pbf"], &[At(6, b"OSMHeader")]),
    read(City, "OSM XML", "a map of OpenStreetMap", &[".osm"], &[Root("osm")]),
    read(City, "Overpass JSON", "a map of OpenStreetMap", &[".overpass.json"], &[Json("\"osm3s\":{")]),
    // Recognised by words of their text.
    read(City, "CityJSONSeq", CITY, &[".city.jsonl"], &[Json("\"type\":\"CityJSONFeature\"")]),
    read(City, "CityJSON", CITY, &[".city.json"], &[Json("\"type\":\"CityJSON\""), Json("\"CityObjects\":{")]),
    read(City, "CityGML", CITY, &[".citygml"], &[Root("CityModel")]),
    read(Molecule, "mmCIF", ATOMS, &[".cif", ".mmcif"], &[Word("_atom_site")]),
    read(Molecule, "PDB", ATOMS, &[".pdb", ".ent"], &[Record(&["ATOM  ", "HETATM", "CRYST1"])]),
    read(Volume, "VTK ImageData", VOXELS, &[".vti"], &[]),
    unread("VTK XML", MESH_OR_GRID, &[".vtp", ".vtu", ".vtr", ".vts"], &[Root("VTKFile")], AS_PLY),
    read(Volume, "legacy VTK", VOXELS, &[".vtk"], &[First("# vtk DataFile")]),
    read(Volume, "MetaImage", VOXELS, &[".mha", ".mhd"], &[Word("ObjectType = Image")]),
    read(Features, "KML", FEATURES, &[".kml", ".kmz"], &[Root("kml")]),
    read(Features, "TCX", WATCH, &[".tcx"], &[Root("TrainingCenterDatabase")]),
    unread("COLLADA", TRIANGLES, &[".dae"], &[Root("COLLADA")], AS_GLTF),
    unread("GML", FEATURES, &[".gml"], &[Word("http://www.opengis.net/gml")], AS_GEOJSON),
    unread("USD", TRIANGLES, &[".usd", ".usda", ".usdc", ".usdz"], &[Word("#usda"), At(0, b"PXR-USDC")], AS_GLTF),
    unread(
        "DXF",
        "a drawing",
        &[".dxf"],
        &[
            Word("SECTION\r\n  2\r\nHEADER"),
            Word("SECTION\n  2\nHEADER"),
            Word("SECTION\n2\nHEADER"),
            Word("SECTION\r\n2\r\nHEADER"),
            At(0, b"AutoCAD Binary DXF"),
        ],
        AS_GEOJSON,
    ),
    // Recognised by their names.
    read(Volume, TIFF_STACK, VOXELS, &[".ome.tif", ".ome.tiff"], &[]),
    read(Terrain, "GeoTIFF", "elevation or a picture", &[".tif", ".tiff"], &[]),
    read(Terrain, "SRTM", "elevation", &[".hgt"], &[]),
    read(Terrain, "ESRI ASCII", "elevation", &[".asc", ".grd", ".txt"], &[]),
    read(Features, "GPX", FEATURES, &[".gpx"], &[]),
    read(Features, "GeoJSON", FEATURES, &[".geojson", ".geojsonl", ".geojsons", ".ndjson"], &[]),
    read(Features, "shapefile", FEATURES, &[".shp"], &[]),
    read(Features, "CSV", "rows with coordinates", &[".csv", ".tsv"], &[]),
    read(Mesh, "OBJ", TRIANGLES, &[".obj"], &[]),
    read(Mesh, "PLY", TRIANGLES, &[".ply"], &[]),
    read(Mesh, "STL", TRIANGLES, &[".stl"], &[]),
    read(Mesh, "glTF", TRIANGLES, &[".gltf", ".glb"], &[]),
    read(Volume, "NRRD", VOXELS, &[".nrrd", ".nhdr"], &[]),
    read(Volume, "raw samples", VOXELS, &[".raw", ".raw.gz"], &[]),
    read(
        Volume,
        "NIfTI",
        VOXELS,
        &[".nii"],
        &[At(344, b"n+1\0"), At(344, b"ni1\0"), At(4, b"n+2\0\r\n"), At(4, b"ni2\0\r\n")],
    ),
    unread("OpenVDB", VOXELS, &[".vdb"], &[At(0, b" BDV\0")], "turn it into NRRD"),
    unread("BinaryCIF", ATOMS, &[".bcif"], &[], AS_PDB),
    unread("MMTF", ATOMS, &[".mmtf"], &[], AS_PDB),
    unread("SDF", ATOMS, &[".sdf"], &[], AS_PDB),
    unread("Mol2", ATOMS, &[".mol2"], &[], AS_PDB),
    unread("GROMACS coordinates", ATOMS, &[".gro"], &[], AS_PDB),
    unread("XTC", OVER_TIME, &[".xtc"], &[At(0, b"\0\0\x07\xcb"), At(0, b"\0\0\x07\xe7")], AS_TRAJECTORY),
    unread("DCD", OVER_TIME, &[".dcd"], &[At(4, b"CORD")], AS_TRAJECTORY),
    unread("GROMACS trajectory", OVER_TIME, &[".trr"], &[], "turn it into XTC with gmx trjconv"),
    unread("FIT", WATCH, &[".fit"], &[At(8, b".FIT")], AS_GPX),
    unread("IGC", WATCH, &[".igc"], &[], AS_GPX),
    unread("NMEA", WATCH, &[".nmea"], &[First("$GP"), First("$GN")], AS_GPX),
    unread("MapInfo", FEATURES, &[".tab", ".mif"], &[], AS_GEOJSON),
    unread("3MF", TRIANGLES, &[".3mf"], &[], AS_GLTF),
    unread("Blender", TRIANGLES, &[".blend"], &[At(0, b"BLENDER")], "export it as glTF"),
    unread("ArcInfo export", "map features or a grid", &[".e00"], &[], AS_GEOJSON),
    read(Terrain, "XYZ", "a grid as lines of coordinates", &[".xyz"], &[Points]),
    read(Molecule, "XYZ of atoms", ATOMS, &[".xyz"], &[Atoms]),
    unread("LERC", RASTER, &[".lerc", ".lrc"], &[At(0, b"Lerc2 "), At(0, b"CntZImage ")], AS_GEOTIFF),
    unread("USGS DEM", RASTER, &[".dem"], &[], AS_GEOTIFF),
    unread("DTED", RASTER, &[".dt0", ".dt1", ".dt2"], &[At(0, b"UHL1")], AS_GEOTIFF),
    unread("ESRI BIL", RASTER, &[".bil"], &[], AS_GEOTIFF),
    unread("ESRI float grid", RASTER, &[".flt"], &[], AS_GEOTIFF),
    unread("ArcInfo grid", RASTER, &[".adf"], &[], AS_GEOTIFF),
    unread("Erdas Imagine", RASTER, &[".img"], &[At(0, b"EHFA_HEADER_TAG")], AS_GEOTIFF),
    read(Terrain, "GDAL virtual raster", "elevation models side by side", &[".vrt"], &[Root("VRTDataset")]),
    unread("PCD", CLOUD, &[".pcd"], &[First("# .PCD")], AS_DEM),
    unread(
        "o5m",
        "a map of OpenStreetMap",
        &[".o5m"],
        &[At(0, b"\xff\xe0\x04o5m2")],
        "osmconvert turns it into .osm.pbf",
    ),
    unread("shapefile's index", SIDE, &[".shx"], &[], WHOLE),
    unread("shapefile's table", SIDE, &[".dbf"], &[], WHOLE),
    unread("SVG", "a drawing", &[".svg"], &[Root("svg")], "give the data behind it"),
    unread("well-known text", FEATURES, &[".wkt"], &[], AS_GEOJSON),
    unread("TopoJSON", FEATURES, &[".topojson"], &[Json("\"type\":\"Topology\"")], AS_GEOJSON),
    unread("ESRI JSON", FEATURES, &[], &[Json("\"geometryType\":\"esri")], AS_GEOJSON),
];

impl Reader {
    /// Whether it reads files of this name. The content of `.json`, `.jsonl`, `.gml` and `.xml` decides who reads them, see
    /// [`Reader::may_read`].
    pub fn reads(self, path: &Path) -> bool {
        of_name(path).is_some_and(|format| format.reader == Some(self))
    }

    /// Whether it may read files of this name, depending on their content: features and cities also have unspecific names.
    pub fn may_read(self, path: &Path) -> bool {
        let open: &[&str] = match self {
            Self::Features => &[".json", ".jsonl"],
            Self::City => &[".json", ".jsonl", ".gml", ".xml"],
            _ => &[],
        };
        self.reads(path) || (self == Self::City && Self::Features.reads(path)) || ends(path, open)
    }
}

impl Format {
    /// Advice on a file of this format that no loader reads under its name.
    pub fn advice(&self) -> String {
        match self.reader {
            None => self.meanwhile.to_owned(),
            Some(City) => "it is read by layers of kind city".to_owned(),
            Some(Molecule) => "it is read by layers of kind molecule".to_owned(),
            Some(_) => format!("it is read if its name ends in {}", self.endings[0]),
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.name, self.holds)
    }
}

/// Endings of the formats that are read, by what they hold, in words.
pub fn read_ones() -> String {
    let kinds = [
        (Terrain, "terrain and pictures"),
        (Features, "features"),
        (City, "cities"),
        (Mesh, "meshes"),
        (Molecule, "molecules"),
        (Volume, "volumes"),
    ];
    let of = |(reader, what): (Reader, &str)| {
        let formats = FORMATS.iter().filter(|format| format.reader == Some(reader));
        let mut endings: Vec<&str> = Vec::new();
        for ending in formats.flat_map(|format| format.endings.iter().copied()) {
            if !endings.contains(&ending) {
                endings.push(ending);
            }
        }
        format!("{what} ({})", endings.join(", "))
    };
    format!("{}; all of them also in .zip and .gz", kinds.map(of).join("; "))
}

/// Whether a file's name ends in one of these, given in lower case with their dots.
pub(crate) fn ends(path: &Path, endings: &[&str]) -> bool {
    let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    endings.iter().any(|ending| name.ends_with(ending))
}

/// The format of a file by its name: that with the longest ending.
pub fn of_name(path: &Path) -> Option<&'static Format> {
    let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let fit = |format: &&'static Format| format.endings.iter().filter(|e| name.ends_with(*e)).map(|e| e.len()).max();
    FORMATS.iter().rev().filter(|f| fit(f).is_some()).max_by_key(fit)
}

/// The format of a name.
pub(crate) fn named(name: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.name == name)
}

/// The format of a file by its first bytes, at most 64 KiB of them.
pub fn of_content(head: &[u8]) -> Option<&'static Format> {
    let head = Head::of(head);
    FORMATS.iter().find(|format| head.fits(format.marks))
}

/// First bytes of a file, and what they are as text.
struct Head<'h> {
    bytes: &'h [u8],
    text: String,
    /// The text without white space, if it is a JSON object.
    object: Option<String>,
    /// Name of the root, if it is XML.
    root: Option<String>,
}

impl<'h> Head<'h> {
    fn of(bytes: &'h [u8]) -> Self {
        // Text of two or four bytes has zeros, other text has none; after the header VTK and others go on in binary.
        let is_wide = matches!(
            bytes,
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [0, 1..=255, ..] | [1..=255, 0, ..] | [0, 0, 0xfe, 0xff, ..]
        );
        let text = if is_wide {
            text_of(bytes, &mut Vec::new()).into()
        } else {
            String::from_utf8_lossy(&bytes[..bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len())])
        };
        let text = text.trim_start_matches('\u{feff}').trim_start().to_owned();
        let object = text.starts_with('{').then(|| text.chars().filter(|c| !c.is_whitespace()).collect());
        let root = text.starts_with('<').then(|| xml_root(&text)).flatten();
        Self { bytes, text, object, root }
    }

    /// Whether one of these marks is there.
    fn fits(&self, marks: &[Mark]) -> bool {
        let Self { bytes, text, object, root } = self;
        let at = |offset: usize, mark: &[u8]| bytes.get(offset..).is_some_and(|rest| rest.starts_with(mark));
        marks.iter().any(|mark| match mark {
            At(offset, mark) => at(*offset, mark),
            Both(places) => places.iter().all(|(offset, mark)| at(*offset, mark)),
            Database(word) => {
                at(0, MAGIC) && bytes.windows(word.len()).any(|w| w.eq_ignore_ascii_case(word.as_bytes()))
            }
            First(word) => text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word)),
            Json(member) => object.as_ref().is_some_and(|dense| dense.contains(member)),
            Root(name) => root.as_deref() == Some(name),
            Columns => columns::has_coordinates(text),
            Word(word) => object.is_none() && text.contains(word),
            Atoms => object.is_none() && begins_as_atoms(text),
            Points => object.is_none() && begins_as_points(text),
            Record(records) => {
                let is_record = |line: &str| line.len() > 53 && records.iter().any(|r| line.starts_with(r));
                object.is_none() && text.lines().any(is_record)
            }
        })
    }
}

/// Marks of formats that are read, for files whose names do not tell.
const READABLE: &[(&str, &[Mark])] = &[
    ("GeoTIFF", &[At(0, b"II*\0"), At(0, b"MM\0*"), At(0, b"II+\0"), At(0, b"MM\0+")]),
    ("ESRI ASCII", &[First("ncols"), First("nrows"), First("cellsize"), First("xllc")]),
    ("GPX", &[Root("gpx")]),
    ("GeoJSON", &[Json("\"type\":\"FeatureCollection\""), Json("\"type\":\"Feature\"")]),
    ("shapefile", &[At(0, b"\0\0\x27\x0a")]),
    ("NRRD", &[At(0, b"NRRD000")]),
    ("glTF", &[At(0, b"glTF"), Json("\"asset\":{")]),
    ("PLY", &[First("ply\n"), First("ply\r")]),
    ("STL", &[First("solid "), First("solid\t"), First("solid\n"), First("solid\r")]),
    ("OBJ", &[First("mtllib "), First("v ")]),
    ("CSV", &[Columns]),
];

/// The format of a file that is read, by its first bytes alone; `None` if they do not tell, or tell one that is not read.
pub fn readable_content(head: &[u8]) -> Option<&'static Format> {
    if let Some(known) = of_content(head) {
        return Some(known).filter(|format| format.reader.is_some());
    }
    let head = Head::of(head);
    let (name, _) = READABLE.iter().find(|(_, marks)| head.fits(marks))?;
    named(name)
}

/// Local name of the first element of an XML document that may be cut off.
pub(crate) fn xml_root(text: &str) -> Option<String> {
    let mut reader = XmlReader::from_str(text);
    loop {
        match reader.read_event().ok()? {
            Event::Start(e) | Event::Empty(e) => return Some(e.local_name().as_ref().to_owned()),
            Event::Eof => return None,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
