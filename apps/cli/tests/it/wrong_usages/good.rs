//! Small files of every kind, all of them right: each wrong usage changes one thing of them.

use belvedere::io::{CrsKind, Limits, SourceCrs, esri_ascii, geotiff, png};
use std::path::Path;
use std::sync::LazyLock;

/// Nodes along a side of the terrain.
const NODES: usize = 24;
/// Spacing of the nodes, degrees.
const CELL: f64 = 0.0005;

/// A scene of terrain and a route over it.
pub(super) const SCENE: &str = "format = 1
title = 'hill'
[[layer]]
id = 'ground'
kind = 'terrain'
source = 'dem.asc'
[[layer]]
id = 'way'
kind = 'line'
source = 'route.gpx'
must_see = true
[camera]
eye = { lon = 10.006, lat = 46.001, above_ground_m = 400 }
look_at = { lon = 10.006, lat = 46.006, above_ground_m = 0 }
image = [64, 48]
";

/// A scene of nothing but a camera.
pub(super) const BARE: &str =
    "format = 1\n[camera]\neye = [0.0, -10.0, 2.0]\nlook_at = [0.0, 0.0, 0.0]\nimage = [64, 48]\n";

/// A scene of models.
pub(super) const MODEL: &str = "format = 1
crs = 'local'
[[layer]]
id = 'cube'
kind = 'mesh'
source = 'cube.obj'
must_see = true
[camera]
eye = [0.0, -10.0, 2.0]
look_at = [0.0, 0.0, 0.0]
image = [64, 48]
";

/// A scene of a molecule.
pub(super) const MOLECULE: &str = "format = 1
unit = 'angstrom'
[[layer]]
id = 'atoms'
kind = 'molecule'
source = 'atoms.pdb'
style = { selection = 'all' }
[camera]
eye = [0.0, -40.0, 2.0]
look_at = [0.0, 0.0, 0.0]
image = [64, 48]
";

const GPX: &str = "<?xml version=\"1.0\"?>
<gpx version=\"1.1\" creator=\"t\" xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><name>Way</name><trkseg>
<trkpt lat=\"46.009\" lon=\"10.002\"></trkpt><trkpt lat=\"46.0095\" lon=\"10.006\"></trkpt>
<trkpt lat=\"46.009\" lon=\"10.0095\"></trkpt></trkseg></trk></gpx>
";

const GEOJSON: &str = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"Path"},
"geometry":{"type":"LineString","coordinates":[[10.002,46.009],[10.006,46.0095],[10.0095,46.009]]}}]}
"#;

const OBJ: &str = "mtllib cube.mtl
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv 0 0 1
usemtl red\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

const MTL: &str = "newmtl red\nKd 0.8 0.1 0.1\n";

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z
element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n";

const STL: &str = "solid t\nfacet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop
endfacet\nendsolid t\n";

const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36}],"buffers":[{"uri":"tri.bin","byteLength":36}]}
"#;

const PDB: &str = "\
HETATM    1  O   HOH A   1       0.000   0.000   0.000  1.00  0.00           O
HETATM    2  H1  HOH A   1       0.960   0.000   0.000  1.00  0.00           H
ATOM      3  FE  HEM B   7       0.000   0.000   8.000  1.00  0.00          FE
";

const CITY: &str = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"features":[
{"type":"Feature","properties":{"height":9},"geometry":{"type":"Polygon","coordinates":[[[500000,5000000],[500020,5000000],[500020,5000020],[500000,5000020],[500000,5000000]]]}},
{"type":"Feature","properties":{"height":12},"geometry":{"type":"Polygon","coordinates":[[[500100,5000000],[500120,5000000],[500120,5000020],[500100,5000020],[500100,5000000]]]}}]}
"#;

const PRESET: &str = "version = 1
[[presets]]
name = 'low'
phi = 30
s = 10
e = 100
control = [[0, 0], [0.3, 0], [0.6, 0], [1, 0.2]]
";

/// Heights of a hill as ESRI ASCII.
fn ascii() -> String {
    let mut out = format!("ncols {NODES}\nnrows {NODES}\nxllcorner 10\nyllcorner 46\ncellsize {CELL}\n");
    for row in 0..NODES {
        let height = |col: usize| {
            let [x, y] = [col, row].map(|k| (k as f64 / (NODES - 1) as f64 - 0.5) * 4.0);
            format!("{:.1} ", 500.0 + 300.0 * (-x * x - y * y).exp())
        };
        out.extend((0..NODES).map(height));
        out.push('\n');
    }
    out
}

fn nrrd() -> String {
    let values: String = (0..512).map(|i| format!("{} ", if i % 8 > 3 { 200 } else { 10 })).collect();
    format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\nencoding: ascii\n\n{values}")
}

/// A shapefile of one line.
fn shapefile() -> Vec<u8> {
    let floats = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
    let ints = |values: &[i32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
    let places = [10.002, 46.009, 10.006, 46.0095, 10.0095, 46.009];
    let frame = [10.002, 46.009, 10.0095, 46.0095];
    let record = [ints(&[3]), floats(&frame), ints(&[1, 3, 0]), floats(&places)].concat();
    let mut out = vec![0u8; 100];
    out[..4].copy_from_slice(&9994i32.to_be_bytes());
    out[24..28].copy_from_slice(&((108 + record.len()) as i32 / 2).to_be_bytes());
    out[28..32].copy_from_slice(&1000i32.to_le_bytes());
    out[32..36].copy_from_slice(&3i32.to_le_bytes());
    out[36..68].copy_from_slice(&floats(&frame));
    out.extend([1i32.to_be_bytes(), (record.len() as i32 / 2).to_be_bytes()].concat());
    out.extend(record);
    out
}

/// The terrain as GeoTIFF.
fn tiff(folder: &Path) -> Vec<u8> {
    let mut raster = esri_ascii::read(&folder.join("dem.asc"), &Limits::default()).expect("terrain").value;
    (raster.info.crs, raster.info.crs_kind) = (SourceCrs::Epsg(4326), CrsKind::Geographic);
    let path = folder.join("dem.tif");
    geotiff::write_geotiff(&path, &raster, true).expect("GeoTIFF");
    super::super::read(&path)
}

fn picture(folder: &Path) -> Vec<u8> {
    let path = folder.join("picture.png");
    png::write(&path, true, 4, 4, png::Channels::Rgb, &[90; 48], &[]).expect("PNG");
    super::super::read(&path)
}

/// Name and content of every file.
pub(super) static FILES: LazyLock<Vec<(&'static str, Vec<u8>)>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("temporary folder");
    std::fs::write(folder.path().join("dem.asc"), ascii()).expect("terrain");
    let corners = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let prj = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
    let texts = [
        ("scene.toml", SCENE.to_owned()),
        ("bare.toml", BARE.into()),
        ("model.toml", MODEL.into()),
        ("molecule.toml", MOLECULE.into()),
        ("dem.asc", ascii()),
        ("route.gpx", GPX.into()),
        ("way.geojson", GEOJSON.into()),
        ("line.prj", prj.into()),
        ("cube.obj", OBJ.into()),
        ("cube.mtl", MTL.into()),
        ("cube.ply", PLY.into()),
        ("cube.stl", STL.into()),
        ("tri.gltf", GLTF.into()),
        ("atoms.pdb", PDB.into()),
        ("volume.nrrd", nrrd()),
        ("houses.geojson", CITY.into()),
        ("preset.toml", PRESET.into()),
        ("points.json", "[[0, 0, 0], [1, 2, 0]]".into()),
        ("pixels.json", "[[10, 10], [32, 24]]".into()),
        ("colors.txt", "0 0 80 0\n1000 250 250 250\n".into()),
    ];
    let texts = texts.into_iter().map(|(name, text)| (name, text.into_bytes()));
    let bytes = [
        ("tri.bin", corners.iter().flat_map(|v| v.to_le_bytes()).collect()),
        ("line.shp", shapefile()),
        ("dem.tif", tiff(folder.path())),
        ("picture.png", picture(folder.path())),
    ];
    texts.chain(bytes).collect()
});
