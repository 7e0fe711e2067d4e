//! Films along routes of scenes as `reveal` writes them: the ground is seen from above in every frame, the camera moves smoothly, and the mark
//! at the walker is always there.

use belvedere::request::Stated;
use belvedere::scene::Progress;
use belvedere::scene_file::AnimationDoc;
use belvedere::verbs::animate::{AnimateRequest, Animation, FrameRecord, animate};
use belvedere::{DataFiles, OpenOptions, Session};
use std::path::{Path, PathBuf};

const NODES: usize = 41;
const EDGE: f64 = 500_000.0;

/// A ground of the given cell size with a route: heights by east and north in 0..=1, metres, and corners of the route in the same units.
struct Ground {
    name: &'static str,
    cell_m: f64,
    height: fn(f64, f64) -> f64,
    route: &'static [[f64; 2]],
}

/// Waves of several lengths.
fn waves(x: f64, y: f64) -> f64 {
    let wave = |k: f64, p: f64| (k * x + p).sin() * (1.3 * k * y - 2.0 * p).cos();
    600.0 * wave(5.0, 0.7) + 250.0 * wave(13.0, 1.9) + 90.0 * wave(31.0, 3.1)
}

const GROUNDS: [Ground; 4] = [
    Ground {
        name: "hairpins over steep waves",
        cell_m: 40.0,
        height: waves,
        route: &[[0.2, 0.3], [0.7, 0.33], [0.25, 0.4], [0.7, 0.45], [0.3, 0.7]],
    },
    Ground {
        name: "along a cliff",
        cell_m: 25.0,
        height: |x, y| if x + 0.05 * (9.0 * y).sin() > 0.5 { 900.0 } else { 100.0 } + 0.1 * waves(x, y),
        route: &[[0.41, 0.1], [0.40, 0.4], [0.42, 0.6], [0.40, 0.9]],
    },
    Ground {
        name: "a canyon of walls",
        cell_m: 30.0,
        height: |x, y| if (y - 0.5 - 0.2 * (6.0 * x).sin()).abs() < 0.06 { 0.0 } else { 700.0 } + 0.05 * waves(x, y),
        route: &[[0.1, 0.61], [0.3, 0.69], [0.5, 0.53], [0.7, 0.33], [0.9, 0.35]],
    },
    Ground {
        name: "coarse cells, from rim to rim",
        cell_m: 500.0,
        height: |x, y| 2.5 * waves(1.4 * x, 1.4 * y),
        route: &[[0.02, 0.05], [0.5, 0.5], [0.98, 0.6]],
    },
];

impl Ground {
    fn files(&self, folder: &Path) -> DataFiles {
        let side = self.cell_m * (NODES - 1) as f64;
        let row = |r: usize| {
            let at = |k: usize| k as f64 / (NODES - 1) as f64;
            (0..NODES).map(|c| format!("{:.2} ", (self.height)(at(c), 1.0 - at(r)))).collect::<String>() + "\n"
        };
        let header = format!(
            "ncols {NODES}\nnrows {NODES}\nxllcenter {EDGE}\nyllcenter 5000000\ncellsize {}\nNODATA_value -9999\n",
            self.cell_m
        );
        let [dem, route] = ["dem.asc", "route.geojson"].map(|name| folder.join(name));
        std::fs::write(&dem, header + &(0..NODES).map(row).collect::<String>()).unwrap();
        let corners: Vec<String> =
            self.route.iter().map(|[x, y]| format!("[{}, {}]", EDGE + x * side, 5_000_000.0 + y * side)).collect();
        let line = format!(
            r#"{{"type": "LineString", "crs": {{"type": "name", "properties": {{"name": "EPSG:32632"}}}}, "coordinates": [{}]}}"#,
            corners.join(", ")
        );
        std::fs::write(&route, line).unwrap();
        let text = |path: &Path| path.display().to_string();
        DataFiles {
            dem: text(&dem),
            features: vec![text(&route)],
            stated: Stated::in_crs("EPSG:32632"),
            ..DataFiles::default()
        }
    }

    /// A scene as `reveal` writes it: its bend is placed for a still picture of the whole ground.
    fn scene(&self, folder: &Path, technique: &str) -> PathBuf {
        let DataFiles { dem, features, .. } = self.files(folder);
        let side = self.cell_m * (NODES - 1) as f64;
        let at = |x: f64, y: f64, z: f64| format!("[{}, {}, {}]", EDGE + x * side, 5_000_000.0 + y * side, z * side);
        let stage = match technique {
            "spline_bend" => format!(
                "pivot = {}\nplane = {{ height_m = 0 }}\n[stage.presets]\nversion = 1\nframe = 'camera'\nunits = 'absolute'\npin = true\n\
                 [[stage.presets.presets]]\nname = 'reveal'\nphi = 18.0\ns = {}\ne = {}\na = 0.0\nb = 1.0\n\
                 control = [[0.0, 0.0], [0.08882, 0.02529], [0.1787, 0.0591], [0.27053, 0.09892], [0.36436, 0.14504], \
                 [0.46045, 0.19744], [0.55948, 0.25563], [0.66622, 0.3122], [0.7841, 0.36036], [0.91338, 0.39757]]\n\
                 sections = ['all']\n",
                at(0.5, 0.5, 0.0),
                0.7 * side,
                1.6 * side
            ),
            "curved_rays" => format!(
                "[[stage.turn]]\nviewpoint = {}\nt0 = {}\nt1 = {}\nt2 = {}\nnormal = [0.0, 0.951057, -0.309017]\n",
                at(0.6, -0.5, 0.45),
                at(0.5, 0.0, 0.1626),
                at(0.5, 0.1, 0.13),
                at(0.5, 0.2, 0.0975)
            ),
            _ => String::new(),
        };
        let scene = folder.join("scene.toml");
        let text = format!(
            "format = 1\n[camera]\neye = {}\nlook_at = {}\nimage = [48, 27]\nnear = 1.0\n\
             [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = '{dem}'\nsource_crs = 'EPSG:32632'\n\
             [[layer]]\nkind = 'line'\nid = 'features1'\nsource = '{}'\nmust_see = true\n\
             [[stage]]\nkind = '{technique}'\n{stage}",
            at(0.5, -0.5, 0.325),
            at(0.5, 0.5, 0.0),
            features[0]
        );
        std::fs::write(&scene, text).unwrap();
        scene
    }
}

fn film(folder: &Path, scene: &Path, animation: AnimationDoc) -> Animation {
    let options = OpenOptions { allow_roots: vec![folder.to_owned()], unsolved: true, ..OpenOptions::default() };
    let session = Session::open(scene, &options).unwrap();
    let request = AnimateRequest { animation, out: folder.join("film"), overwrite: true, ..AnimateRequest::default() };
    animate(&session, &request, &Progress::silent()).unwrap()
}

fn along(frames: u32) -> AnimationDoc {
    AnimationDoc {
        along: Some("features1".into()),
        frames: Some(frames),
        marker: Some(true),
        profile: Some(true),
        ..AnimationDoc::default()
    }
}

fn frames(film: &Animation) -> Vec<&FrameRecord> {
    film.manifest.frames.iter().map(|f| f.as_ref().expect("a frame")).collect()
}

#[test]
fn every_frame_shows_the_ground_from_above_with_every_technique() {
    for ground in &GROUNDS {
        for technique in ["spline_bend", "curved_rays", "terrain_disocclusion"] {
            let folder = tempfile::tempdir().unwrap();
            let scene = ground.scene(folder.path(), technique);
            let made = film(folder.path(), &scene, along(8));
            let case = format!("{} by {technique}", ground.name);
            assert_eq!(made.warnings, [], "{case}");
            for (i, frame) in frames(&made).into_iter().enumerate() {
                let seen = frame.ground.expect("terrain");
                assert!(seen.pixels > 200, "{case}, frame {i}: {seen:?}");
                assert!(seen.from_below == 0, "{case}, frame {i}: {seen:?}");
                let clearance = seen.clearance_m.unwrap_or(f64::INFINITY);
                assert!(
                    seen.needed_m >= 0.25 * ground.cell_m && clearance >= seen.needed_m,
                    "{case}, frame {i}: {seen:?}"
                );
                // The ground sinks at most, so the eye lies over the ground of the file as well.
                let [x, y, z] = frame.view.eye;
                let side = ground.cell_m * (NODES - 1) as f64;
                let under = (ground.height)((x - EDGE) / side, (y - 5_000_000.0) / side);
                assert!(technique != "terrain_disocclusion" || z > under, "{case}, frame {i}: {z} over {under}");
                assert!(frame.view.right[2].abs() < 1e-9, "{case}, frame {i}: the horizon is level");
                let [_, row] = frame.marker.expect("the walker is in the picture").pixel;
                assert!((0.4..1.0).contains(&(row / 27.0)), "{case}, frame {i}: the walker at {row} of 27");
            }
        }
    }
}

#[test]
fn the_walker_stays_in_the_picture_round_hairpins_and_where_the_ground_under_him_sinks() {
    let ground = Ground {
        name: "wide waves",
        cell_m: 80.0,
        height: |x, y| waves(1.7 * x, 1.7 * y),
        route: &[[0.2, 0.3], [0.7, 0.33], [0.25, 0.4], [0.7, 0.45], [0.3, 0.7], [0.8, 0.9]],
    };
    let folder = tempfile::tempdir().unwrap();
    let scene = ground.scene(folder.path(), "terrain_disocclusion");
    let close = AnimationDoc { behind_m: Some(350.0), above_m: Some(250.0), ..along(24) };
    let made = film(folder.path(), &scene, close);
    let sunk = frames(&made).iter().map(|f| -f.ground.expect("terrain").walker_m).fold(0.0, f64::max);
    assert!(sunk > 60.0, "the case is too mild: {sunk}");
    for (i, f) in frames(&made).into_iter().enumerate() {
        let [x, y] = f.marker.unwrap_or_else(|| panic!("frame {i} has lost the walker: {:?}", f.ground)).pixel;
        assert!((0.5..47.5).contains(&x) && (0.2..26.8).contains(&y), "frame {i}: at {x}, {y} of 48 x 27");
    }
}

#[test]
fn a_film_moves_smoothly() {
    let folder = tempfile::tempdir().unwrap();
    let scene = GROUNDS[0].scene(folder.path(), "spline_bend");
    let made = film(folder.path(), &scene, along(30));
    let eyes: Vec<[f64; 3]> = frames(&made).iter().map(|f| f.view.eye).collect();
    let step = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let steps: Vec<f64> = eyes.windows(2).map(|p| step(&p[0], &p[1])).collect();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    let jump = steps.windows(2).map(|p| (p[1] - p[0]).abs()).fold(0.0, f64::max);
    assert!(jump < 1.5 * mean, "from frame to frame the pace changes by {jump}, steps are {mean} long");
    let shares: Vec<f64> = frames(&made).iter().map(|f| f.ground.expect("terrain").bend_share).collect();
    let change = shares.windows(2).map(|p| (p[1] - p[0]).abs()).fold(0.0, f64::max);
    assert!(change < 0.2, "bends change by {change} of their strength: {shares:?}");
}

#[test]
fn a_number_of_frames_without_a_speed_takes_the_whole_route() {
    let folder = tempfile::tempdir().unwrap();
    let scene = GROUNDS[0].scene(folder.path(), "spline_bend");
    let text = std::fs::read_to_string(&scene).unwrap();
    std::fs::write(&scene, text + "\n[animation]\nalong = 'features1'\nspeed_mps = 1e5\nfps = 5.0\n").unwrap();
    let asked = AnimationDoc { frames: Some(9), ..AnimationDoc::default() };
    let made = film(folder.path(), &scene, asked);
    let animation = &made.manifest.settings.animation;
    assert_eq!((made.manifest.frames.len(), animation.frames), (9, Some(9)));
    assert!(animation.speed_mps.is_some_and(|v| v < 1e4), "{animation:?}");
}

/// A route west to east over the ground as a track with a time at every point.
fn track(folder: &Path) {
    let point = |k: usize| {
        let lon = 9.002 + 0.0015 * k as f64;
        format!("<trkpt lon='{lon}' lat='45.158'><time>2024-07-06T10:{:02}:00Z</time></trkpt>", 5 * k)
    };
    let points: String = (0..10).map(point).collect();
    std::fs::write(folder.join("track.gpx"), format!("<gpx><trk><trkseg>{points}</trkseg></trk></gpx>")).unwrap();
}

#[test]
fn marker_clock_and_profile_are_drawn_where_they_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let scene = GROUNDS[0].scene(folder.path(), "spline_bend");
    track(folder.path());
    let text =
        std::fs::read_to_string(&scene).unwrap().replace("route.geojson", "track.gpx").replace("[48, 27]", "[160, 90]");
    std::fs::write(&scene, text).unwrap();
    let first = |animation: AnimationDoc| {
        let made =
            film(folder.path(), &scene, AnimationDoc { along: Some("features1".into()), frames: Some(2), ..animation });
        assert_eq!(made.warnings, []);
        let file = made.folder.join(&made.manifest.frames[0].as_ref().expect("a frame").file);
        std::fs::read(file).unwrap()
    };
    let bare = first(AnimationDoc::default());
    let over = [
        AnimationDoc { marker: Some(true), ..AnimationDoc::default() },
        AnimationDoc { clock: Some(true), ..AnimationDoc::default() },
        AnimationDoc { profile: Some(true), ..AnimationDoc::default() },
    ];
    let drawn = over.map(first);
    assert!(drawn.iter().all(|d| *d != bare) && drawn[0] != drawn[1] && drawn[1] != drawn[2]);
    // Files without times.
    let scene = GROUNDS[0].scene(folder.path(), "spline_bend");
    let made = film(folder.path(), &scene, AnimationDoc { clock: Some(true), ..along(2) });
    assert!(made.warnings.iter().any(|w| w.text().contains("no times")), "{:?}", made.warnings);
    let session =
        Session::open(&scene, &OpenOptions { allow_roots: vec![folder.path().to_owned()], ..OpenOptions::default() });
    let turntable = belvedere::scene_file::TurntableDoc { deg_per_s: 90.0 };
    let animation = AnimationDoc { turntable: Some(turntable), marker: Some(true), ..AnimationDoc::default() };
    let request = AnimateRequest { animation, out: folder.path().join("turn"), ..AnimateRequest::default() };
    let error = animate(&session.unwrap(), &request, &Progress::silent()).unwrap_err().to_string();
    assert!(error.contains("marker follows a walker along a route"), "{error}");
}
