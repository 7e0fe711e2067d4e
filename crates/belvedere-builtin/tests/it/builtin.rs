//! The built-in scenes: the same on every platform, with slopes of mountains and not of noise, and a route that is partly hidden.

use belvedere_builtin::{BuiltinError, SuggestedCamera, canyon, massif, street};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection};
use belvedere_scene::{BoxShape, Heightfield, LayerKind, Scene};
use std::sync::LazyLock;

/// FNV-1a over the bits of the heights.
fn hash(heights: &[f32]) -> u64 {
    heights
        .iter()
        .flat_map(|h| h.to_bits().to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

static MASSIF: LazyLock<(Scene, SuggestedCamera)> = LazyLock::new(|| massif(7, 513).unwrap());

fn terrain(scene: &Scene) -> &Heightfield {
    scene.terrain().unwrap()
}

fn must_see(scene: &Scene) -> &[DVec3] {
    scene.must_see().find_map(|(_, l)| l.kind.lines().map(|l| l.features[0].points.as_slice())).unwrap()
}

fn boxes(scene: &Scene) -> &[BoxShape] {
    scene.layers.iter().find_map(|l| l.kind.boxes().map(|b| b.boxes.as_slice())).unwrap_or_default()
}

/// Brute force: 2000 samples between eye and point, on the drawn surface and in the boxes.
fn sees(scene: &Scene, eye: DVec3, p: DVec3) -> bool {
    (1..2000).all(|k| {
        let q = eye.lerp(p, f64::from(k) / 2000.0);
        let under_ground = terrain(scene).surface_at(q.truncate()).is_some_and(|z| z > q.z);
        let in_box = boxes(scene).iter().any(|b| {
            let d = (q - b.base).abs();
            d.x < 0.5 * b.size.x && d.y < 0.5 * b.size.y && q.z > b.base.z && q.z < b.base.z + b.size.z
        });
        !under_ground && !in_box
    })
}

/// Share of the route in the picture, and visible share of that, by the real pinhole.
fn shares(scene: &Scene, camera: &SuggestedCamera, samples: usize) -> (f64, f64) {
    let lens = Projection::Perspective { fov_y: camera.fov_y };
    let pinhole = Pinhole::look_at(camera.eye, camera.look_at, DVec3::Z, lens, [1280, 720], 1.0, None).unwrap();
    let line = must_see(scene);
    let (mut framed, mut visible, mut count) = (0, 0, 0);
    for p in line.iter().step_by((line.len() / samples).max(1)) {
        count += 1;
        let p = *p + DVec3::Z * 2.0;
        if pinhole.project(p).is_ok_and(|(pixel, _)| pinhole.contains(pixel)) {
            framed += 1;
            visible += usize::from(sees(scene, camera.eye, p));
        }
    }
    (f64::from(framed) / f64::from(count), visible as f64 / f64::from(framed.max(1)))
}

/// Recorded once; other platforms and later versions must reproduce it, or the change log must mention the change.
const MASSIF_7_129: u64 = 0xd9a7_a500_fde0_785f;

#[test]
fn massif_is_the_same_bytes_everywhere() {
    let (scene, _) = massif(7, 129).unwrap();
    assert_eq!(hash(terrain(&scene).heights()), MASSIF_7_129, "{:#x}", hash(terrain(&scene).heights()));
    let (again, camera) = massif(7, 129).unwrap();
    assert_eq!(terrain(&again).heights(), terrain(&scene).heights());
    assert_eq!(camera, massif(7, 129).unwrap().1);
    let (other, _) = massif(8, 129).unwrap();
    assert_ne!(hash(terrain(&other).heights()), MASSIF_7_129);
}

#[test]
fn massif_has_the_relief_and_slopes_of_mountains() {
    let hf = terrain(&MASSIF.0);
    let [lo, hi] = hf.z_range();
    assert!((1700.0..2500.0).contains(&(hi - lo)), "relief {} m", hi - lo);
    assert_eq!(hf.spacing(), DVec2::splat(30.0));
    let mut slopes: Vec<f64> = Vec::new();
    for r in 1..hf.rows() - 1 {
        for c in 1..hf.cols() - 1 {
            let z = |c, r| hf.node(c, r).unwrap().z;
            let gradient = DVec2::new(z(c + 1, r) - z(c - 1, r), z(c, r + 1) - z(c, r - 1)) / 60.0;
            slopes.push(gradient.length().atan().to_degrees());
        }
    }
    slopes.sort_by(f64::total_cmp);
    let at = |share: f64| slopes[(share * (slopes.len() - 1) as f64) as usize];
    assert!((25.0..42.0).contains(&at(0.5)), "median slope {} deg", at(0.5));
    assert!(at(0.98) < 70.0, "98th percentile of slope {} deg", at(0.98));
    assert!(at(0.03) < 12.0, "valley floors: 3rd percentile of slope {} deg", at(0.03));
}

#[test]
fn massif_drains() {
    let hf = terrain(&MASSIF.0);
    let mut pits = 0;
    for r in 1..hf.rows() - 1 {
        for c in 1..hf.cols() - 1 {
            let z = hf.node(c, r).unwrap().z;
            let around = (0..9).filter(|k| *k != 4).map(|k| hf.node(c + k % 3 - 1, r + k / 3 - 1).unwrap().z);
            pits += usize::from(around.fold(f64::MAX, f64::min) > z);
        }
    }
    // noise of the same roughness has one node in nine as a pit
    assert!((pits as f64) < 1e-3 * (hf.cols() * hf.rows()) as f64, "{pits} pits");
}

#[test]
fn massif_has_a_flat_lake_and_the_trail_keeps_out_of_it() {
    let (scene, _) = &*MASSIF;
    let rings = scene
        .layers
        .iter()
        .find_map(|l| match &l.kind {
            LayerKind::Area(a) if a.surface == belvedere_scene::AreaSurface::Water => Some(&a.features[0].rings),
            _ => None,
        })
        .unwrap();
    let shore = &rings[0];
    let area: f64 = (0..shore.len()).map(|k| 0.5 * shore[k].perp_dot(shore[(k + 1) % shore.len()])).sum();
    assert!((0.1e6..4e6).contains(&area.abs()), "lake of {} square metres", area.abs());
    let inside = |p: DVec2| {
        (0..shore.len())
            .filter(|&k| {
                let (a, b) = (shore[k], shore[(k + 1) % shore.len()]);
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
            })
            .count()
            % 2
            == 1
    };
    let hf = terrain(scene);
    let mut levels: Vec<f64> = Vec::new();
    for r in 0..hf.rows() {
        for c in 0..hf.cols() {
            if inside(hf.node_xy(c, r)) && rings[1..].is_empty() {
                levels.push(hf.node(c, r).unwrap().z);
            }
        }
    }
    assert!(levels.len() > 100);
    assert!(levels.iter().all(|z| (z - levels[0]).abs() < 0.01), "the lake is not flat");
    let wet = must_see(scene).iter().filter(|p| inside(p.truncate())).count();
    assert_eq!(wet, 0, "{wet} vertices of the trail lie in the lake");
    let nearest =
        must_see(scene).iter().map(|p| shore.iter().map(|s| s.distance(p.truncate())).fold(f64::MAX, f64::min));
    assert!(nearest.fold(f64::MAX, f64::min) < 150.0, "the trail passes the lake");
}

#[test]
fn the_trail_lies_on_the_ground_and_winds_through_the_massif() {
    let (scene, _) = &*MASSIF;
    let line = must_see(scene);
    let mut length = 0.0;
    for w in line.windows(2) {
        length += w[0].distance(w[1]);
        let middle = 0.5 * (w[0] + w[1]);
        let ground = terrain(scene).surface_at(middle.truncate()).unwrap();
        assert!((middle.z - ground).abs() < 1e-6, "{middle} is {} m off the ground", middle.z - ground);
    }
    let straight = line[0].distance(line[line.len() - 1]);
    assert!(length > 10_000.0 && length > 1.1 * straight, "trail of {length} m between ends {straight} m apart");
}

#[test]
fn the_suggested_cameras_see_little_of_the_routes() {
    for seed in [1, 2, 7] {
        let (scene, camera) = massif(seed, 257).unwrap();
        let (framed, visible) = shares(&scene, &camera, 150);
        assert!(framed > 0.6, "massif {seed}: {framed} of the trail in the picture");
        assert!((0.1..0.6).contains(&visible), "massif {seed}: {visible} of the trail visible");
        let (scene, camera) = street(seed).unwrap();
        let (framed, visible) = shares(&scene, &camera, 60);
        assert!(framed > 0.6, "town {seed}: {framed} of the route in the picture");
        assert!((0.1..0.6).contains(&visible), "town {seed}: {visible} of the route visible");
    }
}

#[test]
fn every_seed_gives_a_massif() {
    for seed in 0..10 {
        let (scene, camera) = massif(seed, 129).unwrap();
        assert!(must_see(&scene).len() > 50, "seed {seed}");
        assert!(camera.eye.is_finite() && camera.eye.z > terrain(&scene).height_at(camera.eye.truncate()).unwrap());
    }
    assert!(matches!(massif(1, 64), Err(BuiltinError::Size { size: 64 })));
}

#[test]
fn town_has_towers_and_a_route_clear_of_them() {
    for seed in 0..10 {
        let (scene, camera) = street(seed).unwrap();
        let towers = boxes(&scene);
        assert!((180..=480).contains(&towers.len()), "{} boxes", towers.len());
        let tallest = towers.iter().map(|b| b.base.z + b.size.z).fold(0.0, f64::max);
        assert!((120.0..260.0).contains(&tallest), "tallest {tallest} m");
        let clear = |p: &DVec3| {
            towers.iter().all(|b| (p.x - b.base.x).abs() > 0.5 * b.size.x || (p.y - b.base.y).abs() > 0.5 * b.size.y)
        };
        assert!(must_see(&scene).iter().all(clear), "seed {seed}: the route runs through a tower");
        assert!(towers.iter().all(|b| {
            let d = (camera.eye - b.base).abs();
            d.x > 0.5 * b.size.x || d.y > 0.5 * b.size.y || camera.eye.z > b.base.z + b.size.z
        }));
    }
    assert_eq!(boxes(&street(3).unwrap().0), boxes(&street(3).unwrap().0));
}

/// Recorded like that of the massif.
const CANYON_7: u64 = 0x04d0_c664_b6a2_f2e3;

#[test]
fn canyon_is_the_same_bytes_everywhere_deep_and_its_river_runs_down_and_is_hidden() {
    let (scene, camera) = canyon(7).unwrap();
    let ground = terrain(&scene);
    assert_eq!(hash(ground.heights()), CANYON_7, "{:#x}", hash(ground.heights()));
    let river = must_see(&scene);
    let length: f64 = river.windows(2).map(|w| w[0].distance(w[1])).sum();
    assert!((14e3..24e3).contains(&length), "{length} m over 12.8 km");
    // It never climbs by 2 m between two vertices, and it falls by more than 15 m in all.
    let climbs = river.windows(2).map(|w| w[1].z - w[0].z).fold(0.0, f64::max);
    assert!(climbs < 2.0 && river[0].z - river[river.len() - 1].z > 15.0, "{climbs}");
    let rim = ground.heights().iter().copied().fold(0.0f32, f32::max);
    assert!(f64::from(rim) - river[0].z > 800.0, "{rim}");
    let (framed, visible) = shares(&scene, &camera, 400);
    assert!(framed > 0.4 && (0.1..0.6).contains(&visible), "{framed} {visible}");
    for seed in [1, 2, 3] {
        let (other, _) = canyon(seed).unwrap();
        assert_ne!(hash(terrain(&other).heights()), CANYON_7);
    }
}
