//! Scene and preset documents, and the record of trust.

use super::tables;
use belvedere::core::presets::{BUILTIN_NAMES, PresetDocument};
use belvedere::scene_file;
use belvedere::verbs::preset;
use std::path::Path;

/// Files that the scenes name.
pub fn beside() -> Vec<(&'static str, Vec<u8>)> {
    vec![("ground.asc", super::rasters::ascii_ground()), ("b.csv", tables::boxes_csv().remove(0))]
}

const STAGES: &str = r##"format = 1
title = "A seed"
crs = "EPSG:32632"
earth = "curved"
[camera]
eye = [600300, 5199500, 2600]
look_at = [600300, 5200300, 900]
fov_y_deg = 40
[[layer]]
id = "ground"
kind = "terrain"
source = "ground.asc"
source_crs = "EPSG:32632"
style = { relief = "swiss", palette = "desert", exaggeration = 1.5 }
[light]
azimuth_deg = 300
altitude_deg = 40
shadows = true
[stylisation]
edges = true
unsharp = 2
[overlay]
grid = true
[[stage]]
kind = "spline_bend"
presets = "demo"
[[stage]]
kind = "curved_rays"
[[stage.turn]]
viewpoint = [600300, 5199500, 2900]
t0 = [600300, 5200100, 900]
t1 = [600300, 5200200, 900]
t2 = [600300, 5200300, 900]
normal = [0.0, -1.0, 0.0]
"##;

const THINGS: &str = r##"format = 1
crs = "local"
[camera]
eye = [4, -30, 14]
look_at = [4, 4, 2]
projection = "perspective"
[[layer]]
id = "towers"
kind = "boxes"
source = "b.csv"
must_see = true
rigid = true
transform = { translate = [1, 2, 0], rotate_deg = [0, 0, 20], scale = 1.5 }
[[layer]]
id = "more"
kind = "boxes"
boxes = [{ base = [10, 3, 0], size = [2, 2, 4], yaw_deg = 12, color = "#445566" }]
[[stage]]
kind = "relief"
exaggeration = 1.5
plane = { height_m = 0.0 }
"##;

const ATOMS: &str = r##"format = 1
unit = "angstrom"
[camera]
eye = [0.0, -60.0, 10.0]
look_at = [0.0, 0.0, 0.0]
projection = "orthographic"
ortho_height_m = 40
[[layer]]
id = "atoms"
kind = "molecule"
source = "builtin:dna?pairs=3&seed=7"
select = "chain A and resi 1-2 or name P"
style = { representation = "space_filling" }
"##;

/// Scenes with most kinds of tables.
pub fn scenes() -> Vec<Vec<u8>> {
    [STAGES, THINGS, ATOMS].map(Vec::from).into()
}

/// The same as JSON.
pub fn scenes_as_json() -> Vec<Vec<u8>> {
    let json = |bytes: Vec<u8>| {
        let text = String::from_utf8(bytes).expect("text");
        let document = scene_file::parse(Path::new("s.toml"), &text).expect("valid").document;
        belvedere::output::pretty(&document).expect("a document is JSON").into_bytes()
    };
    scenes().into_iter().map(json).collect()
}

/// Built-in presets as TOML and JSON.
pub fn presets() -> Vec<Vec<u8>> {
    let text = |name: &&str, ending: &str| {
        let document = PresetDocument::builtin(name).expect("built in");
        preset::text(&document, Path::new(ending)).expect("text").into_bytes()
    };
    BUILTIN_NAMES.iter().flat_map(|name| [text(name, "p.toml"), text(name, "p.json")]).collect()
}

/// A record of trust with one scene.
pub fn trusted() -> Vec<u8> {
    br#"{"format":1,"scenes":[{"scene":"/tmp/a.toml","files":["/tmp/b.tif","/tmp/c.gpx"]}]}"#.to_vec()
}
