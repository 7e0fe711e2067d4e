//! Outputs that cannot be written, or would destroy something.

use super::usage::{Usage, usage};

/// A command line, what the message names, and a line that works.
const LINES: &[(&str, &str, &str)] = &[
    ("render scene.toml -o folder", "folder", "render scene.toml -o x.png"),
    ("render scene.toml -o nowhere/x.png", "nowhere", "render scene.toml -o folder/x.png"),
    ("render scene.toml -o x.gif", "x.gif", "render scene.toml -o x.png"),
    ("render scene.toml -o x.pdff", "x.pdff", "render scene.toml -o x.pdf"),
    ("render scene.toml -o x.npy", "x.npy", "render scene.toml -o x.png"),
    ("render scene.toml -o scene.toml", "scene.toml", "render scene.toml -o x.png"),
    ("render scene.toml -o picture.png", "picture.png", "render scene.toml -o picture.png --overwrite"),
    ("render scene.toml -o ''", "--out", "render scene.toml -o x.png"),
    ("render scene.toml -o dem.asc --overwrite", "dem.asc", ""),
    ("render scene.toml -o x.png/y.png", "x.png", ""),
    ("render scene.toml -o scene.toml/y.png", "scene.toml", ""),
    ("reveal dem.asc route.gpx -o dem.asc --overwrite", "dem.asc", ""),
    ("reveal dem.asc route.gpx -o route.gpx", "route.gpx", ""),
    ("reveal dem.asc route.gpx -o x.png --report nowhere/r.json", "nowhere", ""),
    ("reveal dem.asc route.gpx -o x.png --before x.png", "x.png", ""),
    ("reveal dem.asc route.gpx -o x.png --scene x.png", "x.png", ""),
    (
        "disocclude dem.asc route.gpx -o dem.asc --eye 10.006,45.995,1500 --look 10.006,46.009 --overwrite",
        "dem.asc",
        "",
    ),
    ("disocclude dem.asc route.gpx -o x.png --eye 10.006,45.995,1500 --look 10.006,46.009", "x.png", ""),
    ("disocclude dem.asc route.gpx -o dem.tif --eye 10.006,45.995,1500 --look 10.006,46.009", "dem.tif", ""),
    ("animate scene.toml -o x.avi --along way --frames 2", "x.avi", ""),
    ("animate scene.toml -o scene.toml --along way --frames 2", "scene.toml", ""),
    ("project bare.toml --points points.json -o points.json --overwrite", "points.json", ""),
    ("project bare.toml --points points.json -o folder", "folder", ""),
    (
        "project bare.toml --points points.json -o pixels.json",
        "pixels.json",
        "project bare.toml --points points.json -o pixels.json --overwrite",
    ),
    ("schema -o folder", "folder", "schema -o s.json"),
    ("schema -o nowhere/s.json", "nowhere", ""),
    ("show scene.toml -o scene.toml", "scene.toml", "show scene.toml -o out.toml"),
    ("preset new -o preset.toml", "preset.toml", "preset new -o preset.toml --overwrite"),
    ("preset new -o mine.xml", "mine.xml", "preset new -o mine.toml"),
    ("preset plot demo -o x.svg", "x.svg", "preset plot demo -o x.png"),
    ("preset plot demo -o nowhere/x.png", "nowhere", ""),
    ("generalise houses.geojson -o dem.asc", "dem.asc", ""),
    ("demo -o scene.toml", "scene.toml", ""),
    ("figures curved -o scene.toml", "scene.toml", ""),
    ("pack scene.toml -o scene.toml", "scene.toml", ""),
];

pub(super) fn table() -> Vec<Usage> {
    LINES.iter().map(|(line, names, right)| usage(line).names(names).or_line(right)).collect()
}
