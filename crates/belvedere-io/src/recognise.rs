//! Files that are known and not read yet: told by their first bytes, else by their names.

use crate::{IoError, fs, mesh, molecule, terrain, vector, volume};
use std::io::Read;
use std::path::Path;

/// A known format that no loader reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unread {
    /// Name of the format.
    pub format: &'static str,
    /// What such files hold.
    pub holds: &'static str,
    /// What to do meanwhile.
    pub meanwhile: &'static str,
}

/// First bytes that are looked at.
const HEAD: u64 = 64 << 10;

const MOLECULE: &str = "atoms of a molecule";
const VOLUME: &str = "a volume of voxels";
const CITY: &str = "a city model";
const OSM: &str = "a map of OpenStreetMap";
const CLOUD: &str = "a cloud of points";
const GRID: &str = "grids of science";
const DATABASE: &str = "map features in a database";
const SOLID: &str = "a model of construction";
const AS_PDB: &str = "turn it into PDB or mmCIF";
const NAME_PDB: &str = "it is read if its name ends in .pdb";
const NAME_CIF: &str = "it is read if its name ends in .cif";
const LATER: &str = "layers of this kind are planned";
const AS_GEOJSON: &str = "ogr2ogr or QGIS turn it into GeoJSON";
const AS_PACKAGE: &str =
    "a program built with the cargo feature geopackage reads it, and ogr2ogr or QGIS turn it into GeoJSON";
const AS_CITY: &str = "it is read by layers of kind city";
const AS_GLTF: &str = "turn it into glTF or OBJ";
const AS_GEOTIFF: &str = "gdal_translate turns it into GeoTIFF";
const AS_DEM: &str = "grid its ground points into a GeoTIFF, as with pdal";

const fn unread(format: &'static str, holds: &'static str, meanwhile: &'static str) -> Unread {
    Unread { format, holds, meanwhile }
}

/// Bytes at the beginning of binary files.
const MAGIC: [(&[u8], Unread); 19] = [
    (b"LASF", unread("LAS or LAZ", CLOUD, AS_DEM)),
    (b"ASTM-E57", unread("E57", CLOUD, AS_DEM)),
    (b"fgb\x03", unread("FlatGeobuf", "map features", AS_GEOJSON)),
    (b"\x89HDF\r\n\x1a\n", unread("HDF5 or netCDF-4", GRID, AS_GEOTIFF)),
    (b"CDF\x01", unread("netCDF", GRID, AS_GEOTIFF)),
    (b"CDF\x02", unread("netCDF", GRID, AS_GEOTIFF)),
    (b"GRIB", unread("GRIB", GRID, AS_GEOTIFF)),
    (b"ISO-10303-21", unread("IFC or STEP", SOLID, AS_GLTF)),
    (b"Kaydara FBX Binary", unread("FBX", "triangles", AS_GLTF)),
    (b"7z\xbc\xaf", unread("7-Zip", "packed files", "unpack it, or pack as ZIP or gzip")),
    (b"Rar!", unread("RAR", "packed files", "unpack it, or pack as ZIP or gzip")),
    (b"BZh", unread("bzip2", "a packed file", "unpack it, or pack it as gzip")),
    (b"\xfd7zXZ", unread("xz", "a packed file", "unpack it, or pack it as gzip")),
    (b"(\xb5/\xfd", unread("Zstandard", "a packed file", "unpack it, or pack it as gzip")),
    (b"PAR1", unread("GeoParquet", "map features", AS_GEOJSON)),
    (b"%PDF", unread("PDF", "pages", "give the data behind it")),
    (
        b"\x89PNG\r\n",
        unread("PNG", "a picture that says not where it lies", "gdal_translate -a_srs -a_ullr makes it a GeoTIFF"),
    ),
    (
        b"\xff\xd8\xff",
        unread("JPEG", "a picture that says not where it lies", "gdal_translate -a_srs -a_ullr makes it a GeoTIFF"),
    ),
    (b"\0\0\0\x0cjP  ", unread("JPEG 2000", "a picture", AS_GEOTIFF)),
];

/// Words among the first of text files.
const TEXT: [(&str, Unread); 11] = [
    ("CityModel", unread("CityGML", CITY, AS_CITY)),
    ("_atom_site", unread("mmCIF", MOLECULE, NAME_CIF)),
    ("<VTKFile", unread("VTK XML", "a mesh or grid of science", "ParaView turns it into PLY or OBJ")),
    ("# vtk DataFile", unread("legacy VTK", "a mesh or grid of science", "ParaView turns it into PLY or OBJ")),
    ("ObjectType = Image", unread("MetaImage", VOLUME, LATER)),
    ("<osm ", unread("OSM XML", OSM, "ogr2ogr or osmium export turn it into GeoJSON")),
    ("<kml", unread("KML", "map features", AS_GEOJSON)),
    ("<COLLADA", unread("COLLADA", "triangles", AS_GLTF)),
    ("http://www.opengis.net/gml", unread("GML", "map features", AS_GEOJSON)),
    ("#usda", unread("USD", "triangles", AS_GLTF)),
    ("SECTION\r\n  2\r\nHEADER", unread("DXF", "a drawing", AS_GEOJSON)),
];

/// Endings of names, where content tells nothing; longer ones first.
const ENDINGS: [(&str, Unread); 48] = [
    (".city.jsonl", unread("CityJSONSeq", CITY, AS_CITY)),
    (".city.json", unread("CityJSON", CITY, AS_CITY)),
    (".osm.bz2", unread("OSM XML", OSM, "osmium export turns it into GeoJSON")),
    (".nii.gz", unread("NIfTI", VOLUME, LATER)),
    (".nii", unread("NIfTI", VOLUME, LATER)),
    (".mha", unread("MetaImage", VOLUME, LATER)),
    (".mhd", unread("MetaImage", VOLUME, LATER)),
    (".dcm", unread("DICOM", VOLUME, LATER)),
    (".vdb", unread("OpenVDB", VOLUME, LATER)),
    (".bcif", unread("BinaryCIF", MOLECULE, AS_PDB)),
    (".mmtf", unread("MMTF", MOLECULE, AS_PDB)),
    (".sdf", unread("SDF", MOLECULE, AS_PDB)),
    (".mol2", unread("Mol2", MOLECULE, AS_PDB)),
    (".gro", unread("GROMACS coordinates", MOLECULE, AS_PDB)),
    (".pbf", unread("OSM PBF", OSM, AS_CITY)),
    (".kmz", unread("KMZ", "map features", AS_GEOJSON)),
    (".fit", unread("FIT", "the track of a watch", "GPSBabel turns it into GPX")),
    (".tcx", unread("TCX", "the track of a watch", "GPSBabel turns it into GPX")),
    (".dxf", unread("DXF", "a drawing", AS_GEOJSON)),
    (".dwg", unread("DWG", "a drawing", AS_GEOJSON)),
    (".tab", unread("MapInfo", "map features", AS_GEOJSON)),
    (".mif", unread("MapInfo", "map features", AS_GEOJSON)),
    (".parquet", unread("GeoParquet", "map features", AS_GEOJSON)),
    (".3mf", unread("3MF", "triangles", AS_GLTF)),
    (".usdz", unread("USD", "triangles", AS_GLTF)),
    (".e00", unread("ArcInfo export", "map features or a grid", AS_GEOJSON)),
    (".tar", unread("tar", "packed files", "unpack it, or pack as ZIP")),
    (".tgz", unread("tar", "packed files", "unpack it, or pack as ZIP")),
    (".tar.gz", unread("tar", "packed files", "unpack it, or pack as ZIP")),
    (".vtk", unread("legacy VTK", "a mesh or grid of science", "ParaView turns it into PLY or OBJ")),
    (".vtp", unread("VTK XML", "a mesh or grid of science", "ParaView turns it into PLY or OBJ")),
    (".vtu", unread("VTK XML", "a mesh or grid of science", "ParaView turns it into PLY or OBJ")),
    (".las", unread("LAS or LAZ", CLOUD, AS_DEM)),
    (".laz", unread("LAS or LAZ", CLOUD, AS_DEM)),
    (".xyz", unread("XYZ", "lines of coordinates", AS_DEM)),
    (".dem", unread("USGS DEM", "a raster", AS_GEOTIFF)),
    (".dt2", unread("DTED", "a raster", AS_GEOTIFF)),
    (".dt1", unread("DTED", "a raster", AS_GEOTIFF)),
    (".bil", unread("ESRI BIL", "a raster", AS_GEOTIFF)),
    (".flt", unread("ESRI float grid", "a raster", AS_GEOTIFF)),
    (".adf", unread("ArcInfo grid", "a raster", AS_GEOTIFF)),
    (".nc", unread("netCDF", GRID, AS_GEOTIFF)),
    (".csv", unread("a table", "rows of text", "ogr2ogr or QGIS turn its coordinates into GeoJSON")),
    (".blend", unread("Blender", "triangles", "export it as glTF")),
    (".dae", unread("COLLADA", "triangles", AS_GLTF)),
    (".wkt", unread("well-known text", "map features", AS_GEOJSON)),
    (".topojson", unread("TopoJSON", "map features", AS_GEOJSON)),
    (".img", unread("Erdas Imagine", "a raster", AS_GEOTIFF)),
];

/// Endings of files that loaders read; they say themselves what is wrong with one.
fn read_endings() -> impl Iterator<Item = &'static &'static str> {
    [terrain::ENDINGS, vector::ENDINGS, mesh::ENDINGS].into_iter().flatten()
}

/// What a file is, if its format is known and not read yet; `None` for what loaders read, and for what nobody knows.
///
/// # Errors
/// [`IoError::Os`].
pub fn recognise(path: &Path) -> Result<Option<Unread>, IoError> {
    let (path, _) = vector::split_table(path);
    let file = fs::File::open(path).map_err(|e| IoError::os(path, e))?;
    let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let tar = name.ends_with(".tar.gz");
    let reads = !tar && path.extension().is_some_and(|e| read_endings().any(|read| e.eq_ignore_ascii_case(read)));
    if reads || molecule::is_molecule(path) || volume::is_volume(path) {
        return Ok(None);
    }
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head).map_err(|e| IoError::os(path, e))?;
    Ok(of_content(&head)
        .or_else(|| ENDINGS.iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, unread)| *unread)))
}

/// The error of a loader, or, where the file is of a known format that none reads, that it is.
pub(crate) fn explain(error: IoError) -> IoError {
    let IoError::Format { path, .. } = &error else { return error };
    match recognise(path) {
        Ok(Some(known)) if known.is_broken(path) => IoError::format(path, known.broken()),
        Ok(Some(known)) => {
            let unread =
                if known.meanwhile.starts_with("it is read") { "" } else { ", which this version does not read" };
            IoError::format(path, format!("is {known}{unread}; {}", known.meanwhile))
        }
        _ => error,
    }
}

impl Unread {
    /// Whether a file is of a format that is read, by its name or some word, but does not begin like one.
    pub fn is_broken(&self, path: &Path) -> bool {
        self.meanwhile == AS_CITY && !crate::city::is_city(path).unwrap_or(true)
    }

    /// What there is to say of such a file.
    pub fn broken(&self) -> String {
        format!("is {self} by its name, but does not begin like one; it is damaged or cut off, get it again")
    }
}

impl std::fmt::Display for Unread {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.format, self.holds)
    }
}

fn of_content(head: &[u8]) -> Option<Unread> {
    if let Some((_, found)) = MAGIC.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Some(*found);
    }
    let at = |from: usize, wanted: &[u8]| head.get(from..).is_some_and(|rest| rest.starts_with(wanted));
    if at(6, b"OSMHeader") {
        return Some(unread("OSM PBF", OSM, AS_CITY));
    }
    if at(0, b"SQLite format 3\0") {
        let package = at(68, b"GPKG") || at(68, b"GP10");
        return match package {
            true if cfg!(feature = "geopackage") => None,
            true => Some(unread("GeoPackage", DATABASE, AS_PACKAGE)),
            false => Some(unread("SQLite", DATABASE, AS_GEOJSON)),
        };
    }
    if at(128, b"DICM") {
        return Some(unread("DICOM", VOLUME, LATER));
    }
    // Text has no zeros; after the header VTK and others go on in binary.
    let text = String::from_utf8_lossy(&head[..head.iter().position(|b| *b == 0).unwrap_or(head.len())]);
    if text.trim_start().starts_with('{') {
        let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let is = |kind: &str| compact.contains(&format!("\"type\":\"{kind}\""));
        let format = if is("CityJSONFeature") { "CityJSONSeq" } else { "CityJSON" };
        return (is("CityJSON") || is("CityJSONFeature")).then_some(unread(format, CITY, AS_CITY));
    }
    if let Some((_, found)) = TEXT.iter().find(|(word, _)| text.contains(word)) {
        return Some(*found);
    }
    let is_record = |line: &str| ["ATOM  ", "HETATM", "CRYST1"].iter().any(|r| line.starts_with(r)) && line.len() > 53;
    text.lines().any(is_record).then_some(unread("PDB", MOLECULE, NAME_PDB))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_tell_formats_apart() {
        let of = |head: &[u8]| of_content(head).map(|u| u.format);
        let atom = b"REMARK x\nATOM      1  O5'  DC A   1      18.935  34.195  25.617  1.00 64.35           O\n";
        let osm = b"\0\0\0\x0d\x0a\x09OSMHeader\x18";
        let mut package = b"SQLite format 3\0".to_vec();
        package.resize(68, 1);
        package.extend(b"GPKG");
        for (head, format) in [
            (&b"<VTKFile type=\"PolyData\">"[..], "VTK XML"),
            (b"{\"type\":\"CityJSON\",\"version\":\"2.0\"}", "CityJSON"),
            (b"{\"type\":\"CityJSON\"}\n{\"type\":\"CityJSONFeature\"}", "CityJSONSeq"),
            (b"<core:CityModel xmlns:gml=\"http://www.opengis.net/gml\">", "CityGML"),
            (b"<wfs xmlns:gml=\"http://www.opengis.net/gml/3.2\">", "GML"),
            (b"data_4ZKK\n#\nloop_\n_atom_site.group_PDB\n", "mmCIF"),
            (atom, "PDB"),
            (osm, "OSM PBF"),
            (b"<osm version=\"0.6\">", "OSM XML"),
        ] {
            assert_eq!(of(head), Some(format), "{}", String::from_utf8_lossy(head));
        }
        assert_eq!(of(&package), (!cfg!(feature = "geopackage")).then_some("GeoPackage"));
        for read in [
            &b"<?xml version=\"1.0\"?><gpx version=\"1.1\"><trk/></gpx>"[..],
            b"{\"type\":\"FeatureCollection\",\"name\":\"CityJSON\",\"about\":\"CityModel\",\"features\":[]}",
            b"ncols 4\nnrows 4\n",
            b"v 0 0 0\nf 1 2 3\n",
            b"ply\nformat ascii 1.0\n",
            b"glTF\x02\0\0\0",
            b"II*\0",
            b"",
        ] {
            assert_eq!(of(read), None, "{}", String::from_utf8_lossy(read));
        }
    }
}
