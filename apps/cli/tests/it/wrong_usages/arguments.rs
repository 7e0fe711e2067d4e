//! Verbs, options and their values.

use super::usage::{Usage, usage};

const RENDER: &str = "render scene.toml -o x.png";
const REVEAL: &str = "reveal dem.asc route.gpx -o x.png --size 64x48";
const AT: &str = "--eye 10.006,45.995,1500 --look 10.006,46.009";
const DISOCCLUDE: &str = "disocclude dem.asc route.gpx -o x.tif";

/// Options with values that are not possible, and what the message names beside them.
const VALUES: &[(&str, &str, &[&str])] = &[
    (
        RENDER,
        "--size",
        &["0x10", "10x", "-5x5", "100000x100000", "64", "x", "''", "1e3x5", "64*48", "64x48x2", "nanxnan"],
    ),
    (RENDER, "--lod", &["-1", "nan", "1000", "fine"]),
    (RENDER, "--samples", &["0", "3", "many", "1000000"]),
    (RENDER, "--thresholds", &["0", "5000"]),
    (RENDER, "--renderer", &["gpx", "fast"]),
    (RENDER, "--aux", &["dept", "normal"]),
    (RENDER, "--aux-format", &["tif"]),
    (RENDER, "--compositing", &["layer"]),
    (RENDER, "--grid=0", &[""]),
    (RENDER, "--highlight=shifts", &[""]),
    (RENDER, "--outside", &["1,2,3", "auto1", "1,2,3,4,5,x"]),
    (RENDER, "--area-style", &["watre"]),
    (RENDER, "--threads", &["-1", "many", "5000"]),
    (RENDER, "--max-mem", &["0", "5", "2XB", "lots"]),
    (RENDER, "--time-limit", &["0", "-3", "nan", "soon"]),
    (RENDER, "--seed", &["-1", "x"]),
    (REVEAL, "--eye", &["1,2", "a,b,c", "1,2,inf", "''", "1;2;3"]),
    (REVEAL, "--technique", &["splin", "magic"]),
    (REVEAL, "--crs", &["EPSG:0", "EPSG:999999", "utm", "4326"]),
    (REVEAL, "--source-crs", &["EPSG:x", "WGS84"]),
    (REVEAL, "--vertical-unit", &["feet"]),
    (REVEAL, "--nodata", &["none"]),
    (REVEAL, "--palette", &["alpin", "gone.txt"]),
    (REVEAL, "--sky", &["blue", "#12", "''"]),
    (REVEAL, "--haze", &["0", "-3", "fog"]),
    (REVEAL, "--area-style", &["forests"]),
    (REVEAL, "--name-field", &["nom"]),
];

/// Whole lines, what they name, and a line that works (empty: none is given).
const LINES: &[(&str, &str, &str)] = &[
    ("", "verb", "--help"),
    ("rendr scene.toml -o x.png", "rendr", RENDER),
    ("draw scene.toml", "draw", ""),
    ("scene.toml", "scene.toml", RENDER),
    ("dem.asc route.gpx", "dem.asc", "info dem.asc"),
    ("render", "SCENE", RENDER),
    ("render scene.toml", "--out", RENDER),
    ("render -o x.png", "SCENE", RENDER),
    ("render scene.toml -o x.png --siz 64x48", "--siz", "render scene.toml -o x.png --size 64x48"),
    ("render scene.toml -o x.png --bend", "--bend", ""),
    ("render scene.toml -o x.png -x", "-x", ""),
    ("render scene.toml -o x.png --size", "--size", "render scene.toml -o x.png --size 64x48"),
    ("render scene.toml -o x.png --size 64x48 --size 32x24", "--size", "render scene.toml -o x.png --size 64x48"),
    ("render scene.toml bare.toml -o x.png", "bare.toml", RENDER),
    ("render scene.toml -o x.png --straight --compare", "--compare", "render scene.toml -o x.png --compare"),
    ("render scene.toml -o x.png --straight --heatmap", "--heatmap", "render scene.toml -o x.png --straight"),
    ("render scene.toml -o x.png --overhead --grid", "--grid", "render scene.toml -o x.png --overhead"),
    ("render scene.toml -o x.png --overhead --outside auto", "--outside", "render scene.toml -o x.png --outside auto"),
    ("reveal dem.asc route.gpx", "--out", ""),
    ("reveal dem.asc -o x.png", "no features", ""),
    ("reveal dem.asc route.gpx -o x.png --eye 10.006,45.995,1500", "--look", ""),
    ("reveal dem.asc route.gpx -o x.png --look 10.006,46.009", "--eye", ""),
    ("reveal dem.asc route.gpx -o x.png --eye 10.006,45.995,1500 --look 10.006", "--look", ""),
    ("reveal dem.asc route.gpx -o x.png --eye 10.006,45.995,1500 --look 10.006,north", "--look", ""),
    ("reveal dem.asc route.gpx -o x.png --eye 10.006,45.995,1500 --look 10.006,45.995,1500", "--look", ""),
    ("reveal dem.asc route.gpx -o x.png --eye 10.006,45.995,1500 --look 60,60", "--look", ""),
    (
        "reveal dem.asc route.gpx -o x.png --eye 10.006,46.006,20 --look 10.006,46.009",
        "ground",
        "reveal dem.asc route.gpx -o x.png --size 64x48 --eye 10.006,46.006,797 --look 10.006,46.009",
    ),
    ("reveal dem.asc route.gpx -o x.png --fov 200", "--fov", ""),
    ("reveal dem.asc route.gpx -o x.png --fov nan", "--fov", ""),
    ("reveal dem.asc route.gpx -o x.png --fov wide", "--fov", ""),
    ("reveal dem.asc route.gpx -o x.png --drafts 0", "--drafts", ""),
    ("reveal dem.asc route.gpx -o x.png --drafts 1000", "--drafts", ""),
    ("reveal dem.asc route.gpx -o x.png --drafts few", "--drafts", ""),
    ("reveal dem.asc route.gpx -o x.png --drafts 2 --eye 10,46,900", "--drafts", ""),
    ("reveal dem.asc route.gpx -o x.png --fallback cutaway", "--see", ""),
    ("reveal cube.obj -o x.png --see roof", "roof", "reveal cube.obj -o x.png --see cube --size 64x48"),
    ("reveal cube.obj -o x.png --see cube --fallback glass", "glass", ""),
    ("reveal cube.obj -o x.png --see cube --technique spline", "--technique", ""),
    ("reveal cube.obj -o x.png --see cube --up w", "--up", ""),
    ("reveal cube.obj -o x.png --see cube --labels", "--labels", ""),
    ("reveal cube.obj -o x.png --see 1,2", "1,2", ""),
    ("reveal atoms.pdb -o x.png --see chain", "chain", "reveal atoms.pdb -o x.png --size 64x48 --see 0,0,8"),
    ("reveal volume.nrrd -o x.png --see volume --transfer bone", "bone", ""),
    ("disocclude dem.asc route.gpx -o x.tif --look 10.006,46.009", "--eye", ""),
    ("disocclude dem.asc route.gpx -o x.tif --eye 10.006,45.995,1500", "--look", ""),
    ("disocclude dem.asc route.gpx -o x.tif --eye 10.006,45.995 --look 10.006,46.009", "--eye", ""),
    ("animate bare.toml -o frames", "[animation]", ""),
    ("animate scene.toml -o frames --along gr11", "gr11", "animate scene.toml -o frames --along way --frames 2"),
    ("animate scene.toml -o frames --along way --turntable", "--turntable", ""),
    ("animate scene.toml -o frames --along way --frames 0", "--frames", ""),
    ("animate scene.toml -o frames --along way --frames 2.5", "--frames", ""),
    ("animate scene.toml -o frames --along way --frames 2 --fps 0", "fps", ""),
    ("animate scene.toml -o frames --along way --frames 2 --fps nan", "fps", ""),
    ("animate scene.toml -o frames --along way --frames 2 --fps 1e400", "fps", ""),
    ("animate scene.toml -o frames --along way --speed -1", "speed", ""),
    ("animate scene.toml -o frames --sweep phi", "--sweep", ""),
    ("animate scene.toml -o frames --sweep tau=1:2", "tau=1:2", ""),
    ("animate scene.toml -o frames --sweep phi=20:20", "phi=20:20", ""),
    ("animate scene.toml -o frames --turntable --marker --frames 2", "marker", ""),
    ("project scene.toml", "--points", "project scene.toml --points points.json"),
    (
        "rays bare.toml --pixels pixels.json --samples 0 --far 9",
        "--samples",
        "rays bare.toml --pixels pixels.json --samples 2 --far 9",
    ),
    ("rays bare.toml --pixels pixels.json --samples -1 --far 9", "--samples", ""),
    (
        "rays bare.toml --pixels pixels.json --samples 2",
        "--far",
        "rays bare.toml --pixels pixels.json --samples 2 --far 9",
    ),
    (
        "rays bare.toml --pixels pixels.json --samples 2 --far 0.1",
        "0.1",
        "rays bare.toml --pixels pixels.json --samples 2 --far 9",
    ),
    (
        "rays bare.toml --pixels pixels.json --samples 99999999 --far 9",
        "99999999",
        "rays bare.toml --pixels pixels.json --samples 2 --far 9",
    ),
    ("info", "FILES", "info dem.asc"),
    ("figures", "WHAT", ""),
    ("figures terain", "terain", ""),
    ("figures curved --scale 3", "--scale", ""),
    ("render scene.toml -o x.png --samples -1", "--samples", RENDER),
    ("render scene.toml -o x.png --thresholds -1", "--thresholds", RENDER),
    ("bench --nodes -1", "--nodes", ""),
    ("bench --rounds -1", "--rounds", ""),
    ("bench --rounds 0", "rounds", ""),
    ("bench --nodes 1", "nodes", ""),
    ("preset", "preset", "preset list"),
    ("preset lst", "lst", "preset list"),
    ("preset show demmo", "demmo", "preset show demo"),
    ("preset check nothing", "nothing", "preset list"),
    ("preset plot demo -o x.png --phi x", "--phi", ""),
    ("preset new -o mine.toml --from dem", "dem", "preset new -o mine.toml --from demo"),
    ("preset set preset.toml", "operations", "preset set preset.toml low.phi=25"),
    ("preset set preset.toml low.phi", "low.phi", "preset set preset.toml low.phi=25"),
    ("preset set preset.toml low.fi=3", "fi", "preset set preset.toml low.phi=3"),
    ("preset set preset.toml high.phi=3", "high", "preset set preset.toml low.phi=3"),
    ("preset set preset.toml low.phi=x", "x", ""),
    ("preset set preset.toml low.phi=120", "120", ""),
    ("preset set preset.toml low.point.9=1,1", "9", ""),
    ("preset set preset.toml --capture low", "--capture", ""),
    ("preset set preset.toml --capture low=scene.toml", "--capture", ""),
    ("preset set gone.toml low.phi=3", "gone.toml", ""),
    ("generalise houses.geojson -o city --margin -5", "margin", "generalise houses.geojson -o city --margin 5"),
    ("generalise houses.geojson", "--out", ""),
    ("pack scene.toml", "--out", ""),
    ("pack scene.toml -o page --app folder", "folder", ""),
];

/// Values for the solver of `disocclude`.
const SET: &[&str] = &[
    "w",
    "w=",
    "w=x",
    "w=-1",
    "width=3",
    "cells=0",
    "margin_m=nan",
    "margin_m=-1",
    "eta=1e400",
    "mode=fast",
    "detail=none",
    "solver_nodes=1",
];

pub(super) fn table() -> Vec<Usage> {
    let mut out = Vec::new();
    for (line, option, values) in VALUES {
        for value in *values {
            let shown = if *value == "''" { "" } else { value };
            let option_name = option.split([' ', '=']).next().unwrap_or(option);
            let usage = usage(&format!("{line} {option} {value}"));
            out.push(if shown.is_empty() { usage.names(option_name) } else { usage.wrong(shown).names(option_name) });
        }
    }
    for (line, names, right) in LINES {
        out.push(usage(line).names(names).or_line(right));
    }
    for set in SET {
        let key = set.split('=').next().unwrap_or(set);
        out.push(usage(&format!("{DISOCCLUDE} {AT} --set {set}")).names(key));
    }
    for fov in ["0", "180", "-70", "nan", "1e400"] {
        out.push(
            usage(&format!("{DISOCCLUDE} {AT} --fov {fov}")).names("--fov").names(if fov == "1e400" || fov == "nan" {
                ""
            } else {
                fov
            }),
        );
    }
    out
}
