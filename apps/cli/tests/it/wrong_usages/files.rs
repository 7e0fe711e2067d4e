//! Files of the wrong kind, swapped files, and files that do not exist.

use super::usage::{Usage, usage};

/// Files of every kind but scenes.
const DATA: &[&str] = &[
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
    "picture.png",
    "preset.toml",
    "folder",
    "gone.toml",
    "points.json",
];

/// Lines in which FILE stands for a file, and the files that they cannot take.
const PLACES: &[(&str, &[&str])] = &[
    (
        "render FILE -o x.png",
        &["route.gpx", "way.geojson", "line.shp", "picture.png", "preset.toml", "folder", "gone.toml", "points.json"],
    ),
    ("check FILE", DATA),
    ("show FILE", &["picture.png", "route.gpx"]),
    ("measure FILE", &["dem.tif", "way.geojson"]),
    ("animate FILE -o frames --turntable", &["picture.png", "folder"]),
    ("pick FILE --pixels pixels.json", &["dem.tif"]),
    ("project FILE --points points.json", &["cube.obj"]),
    (
        "project bare.toml --points FILE",
        &["dem.tif", "scene.toml", "gone.json", "folder", "picture.png", "way.geojson"],
    ),
    ("rays bare.toml --samples 2 --far 9 --pixels FILE", &["points.json", "dem.tif"]),
    (
        "reveal FILE route.gpx -o x.png",
        &[
            "scene.toml",
            "route.gpx",
            "cube.obj",
            "picture.png",
            "folder",
            "gone.tif",
            "atoms.pdb",
            "points.json",
            "colors.txt",
        ],
    ),
    (
        "reveal dem.asc FILE -o x.png",
        &[
            "scene.toml",
            "cube.obj",
            "picture.png",
            "folder",
            "gone.gpx",
            "atoms.pdb",
            "volume.nrrd",
            "points.json",
            "colors.txt",
            "dem.asc",
        ],
    ),
    ("reveal FILE -o x.png --see 0,0,0", &["dem.asc", "route.gpx", "picture.png", "gone.obj", "folder"]),
    ("reveal dem.asc route.gpx -o x.png --drape FILE", &["picture.png", "route.gpx", "gone.tif", "cube.obj"]),
    ("reveal dem.asc route.gpx -o x.png --technique terrain --rivers FILE", &["dem.tif", "gone.gpx", "cube.obj"]),
    ("reveal dem.asc route.gpx -o x.png --palette FILE", &["dem.asc", "picture.png", "folder"]),
    (
        "disocclude FILE route.gpx -o x.tif --eye 10.006,45.995,1500 --look 10.006,46.009",
        &["scene.toml", "route.gpx", "picture.png", "gone.tif", "cube.obj"],
    ),
    (
        "disocclude dem.asc FILE -o x.tif --eye 10.006,45.995,1500 --look 10.006,46.009",
        &["dem.asc", "scene.toml", "gone.gpx", "cube.obj"],
    ),
    (
        "generalise FILE -o city",
        &["dem.tif", "route.gpx", "cube.obj", "scene.toml", "gone.json", "folder", "picture.png", "line.shp"],
    ),
    ("generalise houses.geojson FILE -o city", &["dem.tif", "gone.geojson", "cube.obj"]),
    ("preset check FILE", &["dem.tif", "scene.toml", "./gone.toml", "route.gpx"]),
    ("preset show FILE", &["picture.png", "cube.obj"]),
    ("preset set FILE low.phi=20", &["dem.tif", "scene.toml", "folder"]),
    ("preset set preset.toml --capture low=FILE", &["dem.tif", "preset.toml", "gone.toml"]),
    ("info FILE", &["gone.tif", "folder", "gone", "scene.txt"]),
    ("view FILE", &["gone.tif"]),
    ("pack -o page FILE", &["gone.tif"]),
    ("figures terrain FILE -o figures", &["dem.tif", "gone.toml"]),
];

pub(super) fn table() -> Vec<Usage> {
    let mut out = Vec::new();
    for (line, files) in PLACES {
        for file in *files {
            out.push(usage(&line.replace("FILE", file)).names(file));
        }
    }
    let swapped = usage("reveal route.gpx dem.tif -o x.png --size 64x48").names("route.gpx");
    out.push(swapped.or_line("reveal dem.tif route.gpx -o x.png --size 64x48"));
    out.push(
        usage("disocclude route.gpx dem.tif -o x.tif --eye 10.006,45.995,1500 --look 10.006,46.009").names("route.gpx"),
    );
    out.push(usage("info nowhere/dem.tif").names("nowhere/dem.tif"));
    out.push(usage("info builtin:masif").wrong("masif"));
    out.push(usage("reveal builtin:massif?sed=7 builtin:massif?seed=7 -o x.png").names("sed"));
    out
}
