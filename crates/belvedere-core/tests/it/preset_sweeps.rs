//! Built-in presets change evenly while the camera tilts: how far the points of the ground move in the picture per step.

use belvedere_core::map::spline::{ReferencePlane, SplineBend};
use belvedere_core::presets::{BUILTINS, BendFrame, PresetDocument};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, SpaceMap};

const STEP_DEG: f64 = 0.5;
const WIDE: f64 = 1280.0;
const HIGH: f64 = 720.0;
/// Side in pixels of the squares of the picture in which motions are averaged first, so that the many points near the horizon do not dominate.
const SQUARE: f64 = 60.0;

fn camera_at(phi_deg: f64) -> Pinhole {
    let (sin, cos) = phi_deg.to_radians().sin_cos();
    let (eye, up) = (1000.0 * DVec3::new(0.0, -cos, sin), DVec3::new(0.0, sin, cos));
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    Pinhole::look_at(eye, DVec3::ZERO, up, lens, [WIDE as u32, HIGH as u32], 1.0, None).unwrap()
}

/// Pixels of points on the ground and on roofs.
fn places(document: &PresetDocument, phi_deg: f64) -> Vec<Option<DVec2>> {
    let camera = camera_at(phi_deg);
    let bend = SplineBend::new(&camera, document, &ReferencePlane::level(0.0), DVec3::ZERO).unwrap();
    let photograph = bend.adapted_pinhole(&camera);
    let point = |i: u32| {
        let at = |base: f64| (f64::from(i) * base).fract();
        let height = if i.is_multiple_of(3) { 30.0 * at(0.569_840_291) } else { 0.0 };
        DVec3::new(2000.0 * at(0.754_877_666) - 1000.0, 3900.0 * at(0.618_033_989) - 900.0, height)
    };
    let place = |p: DVec3| {
        let (pixel, depth) = photograph.project(bend.apply(p).unwrap()).ok()?;
        let inside = (0.0..WIDE).contains(&pixel.x) && (0.0..HIGH).contains(&pixel.y);
        (inside && depth > 50.0).then_some(pixel)
    };
    (0..4000).map(|i| place(point(i))).collect()
}

/// Mean motion over the picture, pixels per step, at the angles between `first` and `last`.
fn motions(document: &PresetDocument, [first, last]: [f64; 2]) -> Vec<(f64, f64)> {
    let steps = ((last - first) / STEP_DEG).round() as u32;
    let mut before = places(document, first);
    let mut out = Vec::new();
    for i in 1..=steps {
        let phi = first + STEP_DEG * f64::from(i);
        let now = places(document, phi);
        let mut squares = std::collections::BTreeMap::<[i32; 2], (f64, f64)>::new();
        for (a, b) in before.iter().zip(&now).filter_map(|(a, b)| Some(((*a)?, (*b)?))) {
            let square = squares.entry([(a.x / SQUARE) as i32, (a.y / SQUARE) as i32]).or_default();
            *square = (square.0 + a.distance(b), square.1 + 1.0);
        }
        let sum: f64 = squares.values().map(|(sum, count)| sum / count).sum();
        out.push((phi, sum / squares.len() as f64));
        before = now;
    }
    out
}

/// Largest and smallest motion as multiples of the median, each with its angle.
fn extremes(motions: &[(f64, f64)]) -> [(f64, f64); 2] {
    let mut sorted = motions.to_vec();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let median = sorted[sorted.len() / 2].1;
    assert!(median > 0.1, "the picture stands still: {median} pixels per step");
    [sorted[sorted.len() - 1], sorted[0]].map(|(phi, motion)| (phi, motion / median))
}

/// From the horizon to straight down the picture neither leaps nor stands still; between the presets' own angles the motion is at least half
/// the median. (Near straight down the picture of a parallel projection moves with the cosine of the angle, so it stands still there.)
#[test]
fn the_demos_turn_evenly_over_all_angles() {
    for name in ["demo", "demo-orthographic"] {
        let document = PresetDocument::builtin(name).unwrap();
        let [most, least] = extremes(&motions(&document, [0.0, 90.0]));
        assert!(most.1 <= 2.0, "{name}: {:.2} times the median at {} degrees", most.1, most.0);
        assert!(least.1 >= 0.35 || name != "demo", "{name}: {:.2} times the median at {} degrees", least.1, least.0);
        let [most, least] = extremes(&motions(&document, [0.0, 80.0]));
        // The parallel projection at the steep end begins below 80 degrees.
        let slowest = if name == "demo" { 0.5 } else { 0.25 };
        assert!(most.1 <= 2.0 && least.1 >= slowest, "{name}: {least:?} to {most:?}");
    }
}

/// The other built-in documents, in the range in which their pictures move: above their angle they follow the camera.
#[test]
fn single_presets_turn_evenly_from_their_angle_on() {
    for builtin in BUILTINS.iter().filter(|b| !b.name.starts_with("demo")) {
        let document = PresetDocument::builtin(builtin.name).unwrap();
        if document.frame == BendFrame::Plane {
            continue;
        }
        let first = document.presets[0].phi;
        let [most, _] = extremes(&motions(&document, [first, 90.0]));
        assert!(most.1 <= 3.0, "{}: {:.2} times the median at {} degrees", builtin.name, most.1, most.0);
    }
}
