//! Path preview along winding canyons and tunnels.

use belvedere_construct::rays::{Lens, PathPreview, Target, TargetSight};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Heightfield, Scene};
use belvedere_testkit::Random;

const IMAGE: [u32; 2] = [640, 360];
const PREVIEW: f64 = 2000.0;

/// A path of legs of 350 to 500 m with four turns of 35 to 65 degrees to random sides, rounded over 120 m.
pub(crate) fn path(seed: u64) -> Vec<DVec3> {
    let mut random = Random::new(seed);
    let (mut at, mut heading) = (DVec2::ZERO, 0.0f64);
    let mut points = Vec::new();
    let mut go = |at: &mut DVec2, heading: f64, length: f64| {
        for _ in 0..(length / 5.0) as usize {
            *at += 5.0 * DVec2::new(heading.sin(), heading.cos());
            points.push(at.extend(20.0));
        }
    };
    go(&mut at, heading, 1200.0);
    for _ in 0..4 {
        let side = if random.unit() < 0.5 { -1.0 } else { 1.0 };
        let angle = side * random.range(35f64, 65.0).to_radians();
        for _ in 0..24 {
            heading += angle / 24.0;
            go(&mut at, heading, 5.0);
        }
        go(&mut at, heading, random.range(230.0, 380.0));
    }
    points
}

/// A plateau 300 m high with a canyon along the path, 50 m wide at its bottom.
pub(crate) fn canyon(path: &[DVec3]) -> Heightfield {
    let (low, high) = path
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(p.truncate()), b.max(p.truncate())));
    let (low, high) = (low - 600.0, high + 600.0);
    let step = 10.0;
    let [cols, rows] = [(high.x - low.x) / step, (high.y - low.y) / step].map(|n| n as usize + 1);
    let height = |i: usize| {
        let p = DVec2::new(low.x + step * (i % cols) as f64, high.y - step * (i / cols) as f64);
        let off = path.iter().map(|q| q.truncate().distance(p)).fold(f64::INFINITY, f64::min);
        (300.0 * ((off - 25.0) / 90.0).clamp(0.0, 1.0)) as f32
    };
    let heights = (0..cols * rows).map(height).collect();
    Heightfield::measured(DVec2::new(low.x, high.y), DVec2::splat(step), cols, rows, heights).unwrap()
}

fn share(scene: &Scene, view: &View, points: Vec<DVec3>) -> f64 {
    let target = Target::points(points);
    TargetSight::new(scene, &target).share(view, 0.0)
}

#[test]
fn canyons_are_seen_round_four_turns() {
    let (mut shares, mut straight_shares) = (Vec::new(), Vec::new());
    for seed in 0..5 {
        let path = path(seed);
        let scene = Scene::default().with_terrain("ground", canyon(&path));
        let preview = PathPreview::new(&path, PREVIEW, Lens::for_preview(PREVIEW, true), true, IMAGE).unwrap();
        for k in 0..12 {
            let from = 100.0 + 150.0 * f64::from(k);
            let seen = preview.at(from, IMAGE, None).unwrap();
            let samples = preview.samples(from, PREVIEW.min(preview.length() - from) - 10.0, 20.0);
            let [bent, straight] = [&seen.view, &seen.view.straightened()].map(|v| share(&scene, v, samples.clone()));
            shares.push(bent);
            straight_shares.push(straight);
        }
    }
    shares.sort_by(f64::total_cmp);
    straight_shares.sort_by(f64::total_cmp);
    let mean = |shares: &[f64]| shares.iter().sum::<f64>() / shares.len() as f64;
    let good = shares.iter().filter(|s| **s >= 0.95).count();
    assert!(mean(&straight_shares) < 0.35, "the straight cameras see {straight_shares:.2?}");
    assert!(mean(&shares) >= 0.96 && good * 10 >= shares.len() * 8, "{shares:.2?}");
}

#[test]
fn nothing_jumps_while_the_camera_passes_turns() {
    let path = path(3);
    let preview = PathPreview::new(&path, 900.0, Lens::for_preview(900.0, true), true, IMAGE).unwrap();
    let mut random = Random::new(1);
    let bounds = belvedere_core::Aabb::of(path.iter().copied());
    let points: Vec<DVec3> = (0..1000).map(|_| random.point(&bounds)).collect();
    let (mut largest, mut before): (Vec<f64>, Option<View>) = (Vec::new(), None);
    // A walk of 60 m/s, 60 frames a second.
    for k in 0..(preview.length() as usize - 300) {
        let now = preview.at(k as f64, IMAGE, None).unwrap().view;
        if let Some(before) = &before {
            let moved = points.iter().filter_map(|p| {
                let (a, b) = (before.project(*p).ok()?, now.project(*p).ok()?);
                let both = before.pinhole().contains(a.pixel) && now.pinhole().contains(b.pixel);
                // Right before the eye the ground moves fast whatever the rays do.
                let ahead = a.segment.min(b.segment) >= 2;
                (both && ahead).then(|| (b.pixel - a.pixel).length())
            });
            largest.push(moved.fold(0.0, f64::max));
        }
        before = Some(now);
    }
    let mut sorted = largest.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let worst = sorted[sorted.len() - 1];
    let steps: Vec<f64> = largest.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let jump = steps.iter().copied().fold(0.0, f64::max);
    // The swing into the next leg is the fastest, some ten times the median; what pops moves by hundreds of pixels.
    assert!(worst < 10.0 && jump < 4.0, "{worst} px in a frame, {median} px in most, change of {jump} px");
}

#[test]
fn tunnels_in_space_are_followed_at_the_middle_of_the_picture() {
    // A helix: turns in all directions.
    let path: Vec<DVec3> = (0..400)
        .map(|i| {
            let t = 0.01 * f64::from(i);
            DVec3::new(60.0 * t.cos(), 60.0 * t.sin(), 25.0 * t)
        })
        .collect();
    let preview = PathPreview::new(&path, 120.0, Lens::for_preview(120.0, false), false, IMAGE).unwrap();
    for from in [0.0, 40.0, 90.0] {
        let seen = preview.at(from, IMAGE, None).unwrap();
        let mut off: Vec<f64> = preview
            .samples(from, seen.report.reach_m.min(100.0), 2.0)
            .into_iter()
            .map(|p| (seen.view.project(p).unwrap().pixel - DVec2::new(320.0, 180.0)).length() / 360.0)
            .collect();
        off.sort_by(f64::total_cmp);
        let p95 = off[off.len() * 95 / 100];
        assert!(seen.report.turns >= 1, "{:?}", seen.report);
        assert!(p95 < 0.05, "the path lies {p95} of the height from the middle");
    }
}

#[test]
fn lengths_out_of_range_and_paths_without_length_are_refused() {
    let path = path(0);
    let lens = Lens::for_preview(500.0, true);
    let fails = |path: &[DVec3], preview_m: f64, lens: Lens, word: &str| {
        let error = PathPreview::new(path, preview_m, lens, true, IMAGE).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    };
    fails(&path, 0.0, lens, "preview_m is 0");
    fails(&path, 500.0, Lens { behind_m: f64::NAN, ..lens }, "behind_m");
    fails(&path, 500.0, Lens { width_m: -1.0, ..lens }, "width_m is -1");
    fails(&path, 500.0, Lens { rise_m: -1.0, ..lens }, "rise_m");
    fails(&[DVec3::ONE; 5], 500.0, lens, "length of the path");
    fails(&[], 500.0, lens, "length of the path");
    // A straight path has no turns, and lies in the middle of the picture.
    let straight = PathPreview::new(&[DVec3::ZERO, DVec3::Y * 900.0], 500.0, lens, true, IMAGE).unwrap();
    let seen = straight.at(100.0, IMAGE, None).unwrap();
    assert!(seen.report.turns == 0 && seen.report.reach_m == 500.0);
    let middle = seen.view.project(DVec3::new(0.0, 300.0, 60.0)).unwrap().pixel;
    assert!((middle.x - 320.0).abs() < 1e-6, "{middle}");
}
