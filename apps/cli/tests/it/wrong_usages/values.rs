//! Values of scene files out of their range. What stands between « and » is wrong; ranges that the message names are tried in its place.

use super::good::{MODEL, MOLECULE, SCENE};
use super::usage::{Usage, usage};

/// A scene of curved rays around nothing.
const RAYS: &str = "format = 1
[camera]
eye = [0, 0, 0]
look_at = [0, 1, 0]
image = [64, 48]
fov_y_deg = 20
[[stage]]
kind = 'curved_rays'
[[stage.turn]]
viewpoint = [10, 0, 0]
t0 = [0, 40, 0]
t1 = [0, 50, 0]
t2 = [0, 60, 0]
normal = [0, 1, 0]
";

const SPLINE: &str = "[[stage]]\nkind = 'spline_bend'\npresets = 'demo'\n";
const SOLVE: &str = "[[stage]]\nkind = 'terrain_disocclusion'\n";

/// Right lines of scenes, and wrong ones in their place.
const REPLACED: &[(&str, &str, &[&str])] = &[
    (
        SCENE,
        "image = [64, 48]",
        &["image = [«0», 48]", "image = [«-1», 48]", "image = [64.5, 48]", "image = [100000, 48]", "image = [64]"],
    ),
    (SCENE, "lat = 46.001", &["lat = 145.99", "lat = 10", "lat = nan"]),
    (SCENE, "lon = 10.006, lat = 46.001", &["lon = 400, lat = 46.001", "lat = 46.001"]),
    (SCENE, "lon = 10.006, lat = 46.006", &["lon = 10.006, lat = 80", "x = 3, lat = 46"]),
    (SCENE, "above_ground_m = 400", &["above_ground_m = inf", "height_m = 100, above_ground_m = 3"]),
    (
        SCENE,
        "title = 'hill'",
        &["crs = 'EPSG:1'", "crs = 'EPSG:4326'", "crs = 'utm 32'", "crs = ''", "unit = 'feet'", "earth = 'round'"],
    ),
    (
        MODEL,
        "look_at = [0.0, 0.0, 0.0]",
        &[
            "look_at = [0.0, -10.0, 2.0]",
            "look_at = [0.0, -10.0, 9.0]",
            "heading_deg = 10",
            "heading_deg = 10\npitch_deg = 300",
        ],
    ),
    (
        MODEL,
        "image = [64, 48]",
        &[
            "fov_y_deg = «0»",
            "fov_y_deg = «180»",
            "fov_y_deg = «-20»",
            "near = «0»",
            "near = «-1»",
            "far = 0.5",
            "up = [0, 0, 0]",
            "projection = 'orthographic'",
            "projection = 'orthographic'\northo_height_m = «-3»",
            "ortho_height_m = 3",
            "[light]\naltitude_deg = «0»",
            "[light]\naltitude_deg = «100»",
            "[light]\ntime = '2026-13-01T00:00:00Z'",
            "[light]\ntime = '2026-07-01T12:00:00Z'\nazimuth_deg = 3",
            "[overlay]\ngrid = «-5»",
            "[overlay]\nhighlight_px = «0»",
            "[stylisation]\nedges = «-1»",
            "[animation]\nturntable = { deg_per_s = 0 }",
            "[animation]\nturntable = { deg_per_s = 9 }\nfps = «0»",
            "[animation]\nsweep = { phi_deg = [20, 20, 1] }",
            "[animation]\nsweep = { phi_deg = [20, 200, 1] }",
            "[animation]\nturntable = { deg_per_s = 9 }\nframes = 1000000000",
        ],
    ),
    (
        MODEL,
        "must_see = true",
        &[
            "transform = { scale = «0» }",
            "transform = { scale = nan }",
            "style = { color = '#gggggg' }",
            "motion = 'gone.csv'",
            "transform = { translate = [1e400, 0, 0] }",
        ],
    ),
    (
        MOLECULE,
        "'all'",
        &[
            "'chain'",
            "'chane A'",
            "'resi x'",
            "'chain Q'",
            "'resi 900'",
            "'elem Xx'",
            "'('",
            "'all and'",
            "''",
            "'within 3'",
        ],
    ),
    (MOLECULE, "unit = 'angstrom'", &["unit = 'metre'", "unit = 'voxel'"]),
    (
        RAYS,
        "t0 = [0, 40, 0]",
        &["t0 = [0, 60, 0]", "t0 = [0, 50, 0]", "t0 = [0, 0.5, 0]", "t0 = [0, -5, 0]", "t0 = [0, 1e300, 0]"],
    ),
    (RAYS, "t1 = [0, 50, 0]", &["t1 = [0, -50, 0]", "t1 = [0, 0, 0]", "t1 = [0, 70, 0]"]),
    (RAYS, "t2 = [0, 60, 0]", &["t2 = [0, 45, 0]", "t2 = [0, 50, 0]"]),
    (RAYS, "viewpoint = [10, 0, 0]", &["viewpoint = [10, 55, 0]", "viewpoint = [10, 50, 0]"]),
    (
        RAYS,
        "normal = [0, 1, 0]",
        &[
            "normal = [0, 0, 0]",
            "normal = [1, 0, 0]",
            "normal = [1, 0.2, 0]",
            "line = { point = [0, 50, 0], dir = [0, 0, 1] }",
            "line = { point = [5, 50, 0], dir = [0, 0, 1] }",
            "line = { point = [50, 50, 0], dir = [0, 0, 0] }",
            "normal = [0, 1, 0]\nm = «0.1»",
            "normal = [0, 1, 0]\nm = «100»",
            "normal = [0, 1, 0]\nm = 'middle'",
            "normal = [0, 1, 0]\nline = { point = [50, 50, 0], dir = [0, 0, 1] }",
        ],
    ),
    (RAYS, "kind = 'curved_rays'", &["kind = 'curved_rays'\nmodel = 'modifed'"]),
    (RAYS, "fov_y_deg = 20", &["projection = 'orthographic'\northo_height_m = 30", "near = 45"]),
];

/// Ends of the scene with terrain and a route, each wrong.
const ADDED: &[(&str, &[&str])] = &[
    (
        SOLVE,
        &[
            "cells = «0»",
            "cells = 2.5",
            "spacing = «0»",
            "lift_m = «-1»",
            "guard = «-1»",
            "eta = «-1»",
            "mu = «-1»",
            "w = «-0.5»",
            "w = 1e300",
            "rows_weight = «-1»",
            "gamma_time_s = «-1»",
            "solver_nodes = «1»",
            "rise_limit_m = «-5»",
            "margin_m = «-1»",
            "candidates = «0»",
            "ahead_m = «0»",
            "slack_price = «0»",
            "adjust_viewpoint = «3»",
            "rivers = ['way2']",
            "delta = 'gone.tif'",
            "delta = 'route.gpx'",
        ],
    ),
    (
        "[[stage]]\nkind = 'relief'\n",
        &[
            "exaggeration = «0»",
            "exaggeration = [1, «1000»]",
            "oblique = «9»",
            "levelling = «2»",
            "horizon_radius_m = «-1»",
            "range_m = [9, 2]",
            "levelling = 0.5\nlevelling_scale_m = «0»",
            "range_tag = 1",
            "exaggeration = [1, 2, 3]",
        ],
    ),
    (
        "[[stage]]\nkind = 'strip'\n",
        &[
            "half_width_m = 300",
            "along = 'way'\nhalf_width_m = 0",
            "along = 'way'\nshare = «2»",
            "along = 'ground'",
            "along = 'gone'",
            "path = [[0, 0]]",
            "path = []",
            "along = 'way'\npath = [[0, 0], [1, 1]]",
            "along = 'way'\nsmoothing_m = -1",
        ],
    ),
    (
        SPLINE,
        &[
            "plane = { normal = [0, 0, 0] }",
            "plane = { height_m = nan }",
            "pivot = [0, 0]",
            "[[stage]]\nkind = 'relief'\noblique = 1",
            "[[stage]]\nkind = 'spline_bend'\npresets = 'demo'",
        ],
    ),
    (
        "[[stage]]\nkind = 'spline_bend'\n",
        &[
            "presets = 'gone.toml'",
            "presets = 3",
            "presets = { version = 1, presets = [] }",
            "presets = 'identity(200)'",
            "presets = 'identity(x)'",
            "presets = { version = 1, presets = [{ name = 'a', phi = 20, s = 1, e = 9, control = [[0,0],[1,1]] }] }",
            "presets = { version = 1, presets = [{ name = 'a', phi = 20, s = 9, e = 1, control = [[0,0],[0.3,0],[0.6,0],[1,0]] }] }",
        ],
    ),
    (
        "[constructor]\n",
        &[
            "kind = 'target_tracking'",
            "kind = 'target_tracking'\ntarget = 'way'\na = «0»",
            "kind = 'path_preview'",
            "kind = 'path_preview'\npath = 'way'\npreview_m = «-1»",
            "kind = 'auto_probe'\nturns = «0»",
            "kind = 'auto_probe'\nturns = «9»",
            "kind = 'auto_probe'\nreach_m = «0»",
            "kind = 'manual'\nfallback = ['glass']",
            "kind = 'manual'\nfallback = ['cutaway']",
        ],
    ),
    (
        "[animation]\n",
        &[
            "along = 'way'\nframes = «0»",
            "along = 'way'\nfps = «-25»",
            "along = 'way'\nspeed_mps = «0»",
            "along = 'way'\nturntable = { deg_per_s = 3 }",
            "frames = 3",
        ],
    ),
    (
        "[[layer]]\nid = 'x'\nkind = 'line'\nsource = 'route.gpx'\n",
        &[
            "style = { width_px = «0» }",
            "style = { width_px = «1000» }",
            "style = { lift_m = «-3» }",
            "style = { lift_m = «5000» }",
            "style = { label_px = «-3» }",
            "style = { distance_markers_m = «-3» }",
            "route = { seed = 3 }",
            "name_field = 'nom'",
        ],
    ),
    (
        "[[layer]]\nid = 'x'\nkind = 'volume'\nsource = 'volume.nrrd'\n",
        &["transfer = 'bone'", "step = «0»", "step = «100»", "spacing = [0, 1, 1]", "transfer = 'gone.toml'"],
    ),
    ("[[layer]]\nid = 'x'\nkind = 'city'\nsource = 'houses.geojson'\n", &["loa = 7"]),
];

/// The key of a line, which the message names, or what stands in its place.
fn key(line: &str) -> &str {
    let before = line.split('«').next().unwrap_or(line);
    before
        .rsplit(['\n', '{', '[', ','])
        .map(|part| part.split('=').next().unwrap_or("").trim())
        .find(|key| !key.is_empty())
        .unwrap_or("")
}

/// Ends of scenes whose mistake is found when they are drawn, and what the message names.
const DRAWN: &[(&str, &str, &str)] = &[
    ("render", "[constructor]\nkind = 'target_tracking'\ntarget = 'church'", "church"),
    ("render", "[constructor]\nkind = 'path_preview'\npath = 'gone.csv'", "gone.csv"),
    ("render", "[constructor]\nkind = 'path_preview'\npath = 'ground'", "ground"),
    ("animate", "[animation]\nalong = 'gr11'", "gr11"),
    ("animate", "[animation]\nalong = 'ground'", "ground"),
    ("animate", "[animation]\ncamera = 'gone.json'", "gone.json"),
    ("animate", "[animation]\ncamera = 'points.json'", "points.json"),
    ("animate", "[animation]\nalong = 'way'\nframes = 2\nstart_m = 1e9", "start_m"),
];

pub(super) fn table() -> Vec<Usage> {
    let mut out = Vec::new();
    for (verb, end, names) in DRAWN {
        let line = if *verb == "render" { "render s.toml -o x.png" } else { "animate s.toml -o frames" };
        out.push(usage(line).file("s.toml", format!("{SCENE}{end}\n")).names(names));
    }
    let sunk = SCENE.replacen("above_ground_m = 400", "above_ground_m = -500", 1);
    out.push(usage("render s.toml -o x.png").file("s.toml", sunk).names("500.0 m under the ground"));
    for (scene, right, wrongs) in REPLACED {
        assert!(scene.contains(right), "{right} is not in the scene");
        for wrong in *wrongs {
            out.push(usage("check s.toml").file("s.toml", scene.replacen(right, wrong, 1)).names("s.toml:").marked());
        }
    }
    for (head, wrongs) in ADDED {
        for wrong in *wrongs {
            let usage = usage("check s.toml").file("s.toml", format!("{SCENE}{head}{wrong}\n"));
            out.push(usage.names("s.toml:").names(if wrong.contains('«') { key(wrong) } else { "" }).marked());
        }
    }
    out
}
