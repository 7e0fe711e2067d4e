//! Files of every kind that are empty, cut off, or hold something else than their name says; and files that lack another beside them.

use super::good;
use super::usage::{Usage, usage};

/// Files that are nothing in part, and the share that is left of them, percent.
const CUT: &[(&str, usize)] = &[
    ("dem.tif", 60),
    ("dem.asc", 60),
    ("route.gpx", 60),
    ("way.geojson", 60),
    ("line.shp", 70),
    ("tri.gltf", 60),
    ("tri.bin", 60),
    ("cube.ply", 80),
    ("volume.nrrd", 60),
    ("houses.geojson", 60),
    ("scene.toml", 51),
    ("points.json", 60),
];

const KINDS: &[&str] = &[
    "dem.tif",
    "dem.asc",
    "route.gpx",
    "way.geojson",
    "line.shp",
    "cube.obj",
    "cube.ply",
    "cube.stl",
    "tri.gltf",
    "atoms.pdb",
    "volume.nrrd",
];

/// How a file is used.
fn used(name: &str) -> Usage {
    usage(&match name {
        "tri.bin" => "info tri.gltf".to_owned(),
        "scene.toml" => "check scene.toml".into(),
        "preset.toml" => "preset check ./preset.toml".into(),
        "houses.geojson" => "generalise houses.geojson -o city".into(),
        "points.json" => "project bare.toml --points points.json".into(),
        "colors.txt" => "reveal dem.asc route.gpx -o x.png --palette colors.txt".into(),
        _ => format!("info {name}"),
    })
}

fn good(name: &str) -> Vec<u8> {
    good::FILES.iter().find(|(known, _)| *known == name).expect("a good file").1.clone()
}

/// Bytes that are no text and begin like no format.
fn noise() -> Vec<u8> {
    (0..2000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8 | 0x81).collect()
}

pub(super) fn table() -> Vec<Usage> {
    let mut out = Vec::new();
    for (name, percent) in CUT {
        let whole = good(name);
        let named = if *name == "tri.bin" { "tri.gltf" } else { name };
        out.push(used(name).file(name, &whole[..whole.len() * percent / 100]).names(named));
    }
    for name in KINDS.iter().chain(&["scene.toml", "houses.geojson", "points.json", "preset.toml", "colors.txt"]) {
        out.push(used(name).file(name, "").names(name));
        out.push(used(name).file(name, noise()).names(name));
    }
    for name in KINDS {
        out.push(used(name).file(name, "hello, this is a text\n").names(name));
    }
    for (name, of) in
        [("dem.tif", "route.gpx"), ("route.gpx", "dem.tif"), ("cube.obj", "picture.png"), ("way.geojson", "scene.toml")]
    {
        out.push(used(name).file(name, good(of)).names(name));
    }
    for text in
        ["version https://git-lfs.github.com/spec/v1\noid sha256:1\n", "<!DOCTYPE html>\n<html><body>404</body></html>"]
    {
        out.push(used("dem.tif").file("dem.tif", text).names("dem.tif"));
    }
    out.push(usage("info tri.gltf").without("tri.bin").names("tri.bin"));
    let texts = [
        ("dem.asc", "cellsize 0.0005", "cellsize 0"),
        ("dem.asc", "cellsize 0.0005", "cellsize x"),
        ("dem.asc", "ncols 24", "ncols -24"),
        ("dem.asc", "ncols 24", "ncols 99999999999"),
        ("dem.asc", "nrows 24\n", ""),
        ("way.geojson", "LineString", "Linestrin"),
        ("way.geojson", "[10.006,46.0095]", "[10.006]"),
        ("way.geojson", "FeatureCollection", "Features"),
        ("cube.obj", "f 4 1 5", "f 4 1 99"),
        ("cube.obj", "v 0 0 1", "v 0 zero 1"),
        ("cube.ply", "3 0 1 2", "3 0 1 9"),
        ("cube.ply", "format ascii 1.0", "format roman 1.0"),
        ("cube.stl", "vertex 1 0 0", "vertex 1 0"),
        ("volume.nrrd", "uchar", "complex"),
        ("volume.nrrd", "sizes: 8 8 8", "sizes: 8 8"),
        ("volume.nrrd", "sizes: 8 8 8", "sizes: 99999 99999 99999"),
        ("volume.nrrd", "encoding: ascii", "encoding: zstd"),
        ("atoms.pdb", "0.960", "x.960"),
        ("points.json", "[1, 2, 0]", "[1, 2]"),
        ("points.json", "[1, 2, 0]", "[1, 2, nan]"),
        ("preset.toml", "s = 10", "s = 200"),
        ("preset.toml", "phi = 30", "phi = 300"),
        ("preset.toml", "version = 1", "version = 3"),
        ("preset.toml", "control", "controls"),
        ("preset.toml", "[0.3, 0], ", ""),
        ("colors.txt", "0 0 80 0", "0 rad"),
        ("colors.txt", "1000 250 250 250", "1000 250 250 900"),
    ];
    for (name, right, wrong) in texts {
        let text = String::from_utf8(good(name)).expect("text");
        assert!(text.contains(right), "{name} has no {right}");
        out.push(used(name).file(name, text.replacen(right, wrong, 1)).names(name));
    }
    out
}
