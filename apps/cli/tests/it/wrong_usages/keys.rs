//! Keys of scene files: unknown, misspelt, missing, twice, of the wrong type.

use super::good::{BARE, MODEL, MOLECULE, SCENE};
use super::usage::{Usage, usage};

/// Keys that are misspelt: the right one, and how it is written. The suggestion is tried.
const MISSPELT: &[(&str, &str, &str)] = &[
    (SCENE, "format", "formt"),
    (SCENE, "title", "titel"),
    (SCENE, "source = 'dem.asc'", "sorce = 'dem.asc'"),
    (SCENE, "kind = 'line'", "knd = 'line'"),
    (SCENE, "'terrain'", "'terain'"),
    (SCENE, "'line'", "'lines'"),
    (SCENE, "must_see", "mustsee"),
    (SCENE, "[camera]", "[camra]"),
    (SCENE, "above_ground_m = 400", "above_ground = 400"),
    (SCENE, "lon = 10.006, lat = 46.001", "long = 10.006, lat = 46.001"),
    (SCENE, "look_at", "lookat"),
    (SCENE, "image", "imge"),
    (MODEL, "'mesh'", "'mech'"),
    (MODEL, "crs", "csr"),
    (MOLECULE, "unit", "units"),
    (MOLECULE, "'angstrom'", "'angstroms'"),
    (MOLECULE, "style", "styl"),
    (MOLECULE, "selection", "selecton"),
];

/// Lines that are added to a scene, and what is wrong in them. Suggestions are tried.
const ADDED: &[(&str, &str)] = &[
    ("fov = 30", "fov"),
    ("fov_y = 30", "fov_y"),
    ("zoom = 3", "zoom"),
    ("near_m = 3", "near_m"),
    ("[light]\nazimuth = 300", "azimuth"),
    ("[light]\naltitude_degree = 30", "altitude_degree"),
    ("[light]\nshadow = true", "shadow"),
    ("[animation]\nalong = 'way'\nframe = 3", "frame"),
    ("[animation]\nalong = 'way'\nfsp = 3", "fsp"),
    ("[constructor]\nkind = 'target_traking'\ntarget = 'way'", "target_traking"),
    ("[constructor]\nkind = 'manual'\ntargt = 'way'", "targt"),
    ("[stylisation]\nedge = 1", "edge"),
    ("[overlay]\ngrids = 5", "grids"),
    ("[sun]\nazimuth_deg = 3", "sun"),
    ("[[stage]]\nkind = 'terrain_dissoclusion'", "terrain_dissoclusion"),
    ("[[stage]]\nkind = 'terrain_disocclusion'\nmargin = 2", "margin"),
    ("[[stage]]\nkind = 'terrain_disocclusion'\nmode = 'qpp'", "qpp"),
    ("[[stage]]\nkind = 'relief'\nexageration = 2", "exageration"),
    ("[[stage]]\nkind = 'strip'\nalong = 'way'\nhalf_width = 300", "half_width"),
    ("[[stage]]\nkind = 'spline_bend'\npreset = 'demo'", "preset"),
    ("[[stage]]\nkind = 'spline_bend'\npresets = 'progresive'", "progresive"),
    ("[[layer]]\nid = 'm'\nkind = 'boxes'\nbox = []", "box"),
    ("[[layer]]\nid = 'l'\nkind = 'line'\nsource = 'route.gpx'\nstyle = { colour = '#f00' }", "colour"),
    ("[[layer]]\nid = 'l'\nkind = 'line'\nsource = 'route.gpx'\nstyle = { hidden = 'dashed' }", "dashed"),
    ("[[layer]]\nid = 'p'\nkind = 'point'\nsource = 'route.gpx'\nstyle = { symbol = 'sqare' }", "sqare"),
    ("[[layer]]\nid = 'm'\nkind = 'mesh'\nsource = 'cube.obj'\ntransform = { scales = 2 }", "scales"),
];

/// Values of the wrong type: what is added, and the key that the message names.
const TYPES: &[(&str, &str)] = &[
    ("near = 'close'", "camera.near"),
    ("near = true", "camera.near"),
    ("near = nan", "nan"),
    ("far = inf", "inf"),
    ("fov_y_deg = [45]", "camera.fov_y_deg"),
    ("up = [0, 1]", "camera.up"),
    ("up = 'z'", "camera.up"),
    ("projection = 'fisheye'", "fisheye"),
    ("heading_deg = 'north'", "camera.heading_deg"),
    ("light = 3", "camera"),
    ("[light]\nazimuth_deg = '300'", "azimuth_deg"),
    ("[light]\nshadows = 'yes'", "shadows"),
    ("[light]\ntime = 'noon'", "noon"),
    ("[animation]\nalong = 3", "along"),
    ("[animation]\nalong = 'way'\nframes = 2.5", "frames"),
    ("[animation]\nalong = 'way'\nframes = -2", "frames"),
    ("[[stage]]\nkind = 3", "kind"),
    ("[[stage]]\npresets = 'demo'", "kind"),
    ("[[layer]]\nkind = 'line'\nsource = 'route.gpx'", "id"),
    ("[[layer]]\nid = 'x'\nkind = 'line'\nsource = 3", "source"),
    ("[[layer]]\nid = 'x'\nkind = 'line'\nsource = 'route.gpx'\nmust_see = 'yes'", "must_see"),
    ("[[layer]]\nid = 'x'\nkind = 'line'\nsource = 'route.gpx'\nstyle = { width_px = '3' }", "width_px"),
    ("[[layer]]\nid = 'x'\nkind = 'line'\nsource = 'route.gpx'\nstyle = { color = 'reddish' }", "reddish"),
    ("[[layer]]\nid = 'x'\nkind = 'line'\nsource = 'route.gpx'\nstyle = { color = '#12' }", "#12"),
    ("[[layer]]\nid = 'x'\nkind = 'mesh'", "source"),
    ("[[layer]]\nid = 'x'\nkind = 'boxes'", "boxes"),
    ("[[layer]]\nid = 'x'\nkind = 'boxes'\nboxes = [{ base = [0, 0, 0] }]", "size"),
    ("[[stage]]\nkind = 'terrain_disocclusion'\nlimits = 'no'", "limits"),
    ("[[stage]]\nkind = 'relief'\noblique = 'much'", "oblique"),
    ("layer = 3", "camera"),
    ("[stage]\nkind = 'relief'", "stage"),
];

/// Texts that are no scene at all.
const BROKEN: &[(&str, &str)] = &[
    ("format = 1\n[camera\neye = 3\n", "s.toml:2"),
    ("format = 1\ncamera = { eye = [0,0,0], look_at = [0,1,0] \n", "s.toml"),
    ("format = 1\nformat = 1\n", "format"),
    ("format = 9\n", "format"),
    ("format = 'one'\n", "format"),
    ("title = 'x'\n", "camera"),
    ("format = 1\n", "camera"),
    ("format = 1\n[camera]\n", "eye"),
    ("format = 1\n[camera]\neye = [0, 0, 0]\n", "look_at"),
    ("format = 1\n[camera]\nlook_at = [0, 1, 0]\n", "eye"),
    ("format = 1\n[camera]\neye = [0, 0]\nlook_at = [0, 1, 0]\n", "eye"),
    ("format = 1\n[camera]\neye = { lon = 1 }\nlook_at = [0, 1, 0]\n", "eye"),
    ("hello\n", "s.toml:1"),
    ("{\"format\": 1, }", "s.toml"),
    ("{\"format\": 1, \"camera\": {\"eye\": [0,0,0], \"look_at\": [0,1,0]}", "s.toml"),
    ("{}", "camera"),
    ("[]", "s.toml"),
];

pub(super) fn table() -> Vec<Usage> {
    let mut out = Vec::new();
    for (scene, right, wrong) in MISSPELT {
        assert!(scene.contains(right), "{right} is not in the scene");
        let wrong_word = differing(right, wrong);
        out.push(
            usage("check s.toml").file("s.toml", scene.replacen(right, wrong, 1)).wrong(wrong_word).names("s.toml:"),
        );
    }
    for (added, wrong) in ADDED {
        let usage = usage("check s.toml").file("s.toml", format!("{SCENE}{added}\n"));
        out.push(usage.names(wrong).names("s.toml:"));
    }
    for (added, names) in TYPES {
        out.push(usage("check s.toml").file("s.toml", format!("{SCENE}{added}\n")).names(names).names("s.toml:"));
    }
    for (text, names) in BROKEN {
        out.push(usage("check s.toml").file("s.toml", *text).names(names).names("s.toml:"));
    }
    out.push(usage("check s.json").file("s.json", BARE).names("s.json:1"));
    out.push(
        usage("check s.json")
            .file("s.json", "{\"format\": 1, \"camera\": {\"eye\": [0,0,0], \"lookat\": [0,1,0]}}")
            .wrong("lookat"),
    );
    out
}

/// The word of `wrong` that `right` does not have.
fn differing<'a>(right: &str, wrong: &'a str) -> &'a str {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let words = |text: &'a str| text.split(move |c| !is_word(c)).filter(|w| !w.is_empty()).collect::<Vec<_>>();
    words(wrong).into_iter().find(|word| !right.split(|c| !is_word(c)).any(|w| w == *word)).expect("a wrong word")
}
