//! The measured figures of the built-in presets.

use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere_core::presets::{Preset, PresetDocument};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, SpaceMap};

/// Camera at `distance` from the origin at viewing angle `phi_deg`, looking north at the origin.
pub(crate) fn camera_at(phi_deg: f64, distance: f64) -> Pinhole {
    let (sin, cos) = phi_deg.to_radians().sin_cos();
    let eye = DVec3::new(0.0, -cos * distance, sin * distance);
    let up = DVec3::new(0.0, sin, cos);
    let projection = Projection::Perspective { fov_y: 50f64.to_radians() };
    Pinhole::look_at(eye, DVec3::ZERO, up, projection, [1280, 720], 1.0, None).unwrap()
}

pub(crate) fn bend(document: &PresetDocument, camera: &Pinhole) -> SplineBend {
    let plane = ReferencePlane::level(0.0);
    SplineBend::new(camera, document, &plane, default_pivot(camera, &plane)).unwrap()
}

fn builtin_at_its_angle(name: &str) -> SplineBend {
    let document = PresetDocument::builtin(name).unwrap();
    bend(&document, &camera_at(document.presets[0].phi, 1000.0))
}

#[test]
fn lengths_angles_and_facing_are_those_of_the_table() {
    let table = [
        ("progressive", [63.0, 40.0, 16.0], 1.218, 0.035),
        ("degressive", [12.0, 29.0, 73.0], 1.368, 0.407),
        ("hybrid-flat-steep-flat", [15.0, 53.0, 16.0], 1.159, 0.067),
        ("hybrid-steep-flat-steep", [60.0, 20.0, 65.0], 1.498, 0.230),
        ("map", [80.0, 80.0, 80.0], 1.828, 0.241),
    ];
    for (name, angles_deg, length, facing) in table {
        let b = builtin_at_its_angle(name);
        let curve = b.curve();
        let slopes = [curve.at(0.0).1, curve.at((1000.0 - b.resolved().s) / b.scale()).1, curve.at(curve.length()).1];
        let slopes = slopes.map(|t| t.to_angle().to_degrees());
        for (slope, angle) in slopes.into_iter().zip(angles_deg) {
            assert!((slope - angle).abs() < 0.6, "{name}: slopes {slopes:?}, table {angles_deg:?}");
        }
        assert!((curve.length() - length).abs() < 6e-4, "{name}: length {}, table {length}", curve.length());
        assert!((b.facing() - facing).abs() < 6e-4, "{name}: facing {}, table {facing}", b.facing());
    }
}

#[test]
fn fold_heights_are_those_measured_at_one_kilometre() {
    let table = [
        ("progressive", -1089.0, f64::INFINITY),
        ("degressive", f64::NEG_INFINITY, 1141.0),
        ("hybrid-flat-steep-flat", -97.0, 99.0),
        ("hybrid-steep-flat-steep", -178.0, 156.0),
    ];
    for (name, low, high) in table {
        let [a, b] = builtin_at_its_angle(name).fold_heights();
        assert!(a == low || (a - low).abs() < 0.6, "{name}: folds below {a}, table {low}");
        assert!(b == high || (b - high).abs() < 0.6, "{name}: folds above {b}, table {high}");
    }
}

#[test]
fn demo_faces_the_camera_and_never_folds_over_the_whole_range_of_angles() {
    let document = PresetDocument::builtin("demo").unwrap();
    for i in 0..=340 {
        let phi_deg = 5.0 + 0.25 * f64::from(i);
        let b = bend(&document, &camera_at(phi_deg, 1000.0));
        // The plateau of the progressive preset has the least facing, 0.035 as in the table.
        assert!(b.facing() > 0.034, "facing {} at {phi_deg}", b.facing());
        let [low, high] = b.fold_heights();
        assert!(high >= 1140.0 && low <= -1089.0, "folds at {low}..{high} at {phi_deg}");
    }
}

/// Tilting from level to straight down in quarter degrees: the ground is never seen from below, and nothing leaps.
#[test]
fn demos_sweep_through_all_angles_without_leaps() {
    const STEP_DEG: f64 = 0.25;
    for (name, most) in [("demo", 0.02), ("demo-orthographic", 0.05)] {
        let document = PresetDocument::builtin(name).unwrap();
        let range = |f: fn(f64, f64) -> f64, of: fn(&Preset) -> f64| document.presets.iter().map(of).reduce(f).unwrap();
        let (first, last) = (range(f64::min, |p| p.phi), range(f64::max, |p| p.phi));
        let ground: Vec<DVec3> = (0..21 * 31)
            .map(|i| DVec3::new(100.0 * f64::from(i % 21) - 1000.0, 100.0 * f64::from(i / 21) - 800.0, 0.0))
            .collect();
        let mut before: Option<Vec<Option<DVec2>>> = None;
        let mut worst = 0.0f64;
        for i in 0..=360 {
            let phi_deg = STEP_DEG * f64::from(i);
            let camera = camera_at(phi_deg, 1000.0);
            // The camera turns about the origin, also where it looks along the ground.
            let b = SplineBend::new(&camera, &document, &ReferencePlane::level(0.0), DVec3::ZERO).unwrap();
            if (first..=last).contains(&phi_deg) {
                assert!(b.facing() > 0.0, "{name}: facing {} at {phi_deg}", b.facing());
            }
            let photograph = b.adapted_pinhole(&camera);
            // Image coordinates in multiples of the distance of the image from the eye, for the camera's own field of view.
            let place = |p: &DVec3| {
                let (pixel, _) = photograph.project(b.apply(*p).unwrap()).ok()?;
                let at = (pixel - photograph.center_px()) / camera.scale_px();
                (at.abs().max_element() < 0.6).then_some(at)
            };
            let now: Vec<Option<DVec2>> = ground.iter().map(place).collect();
            if let Some(before) = &before {
                let motion = |(a, b): (&Option<DVec2>, &Option<DVec2>)| Some(a.as_ref()?.distance(*b.as_ref()?));
                worst = before.iter().zip(&now).filter_map(motion).fold(worst, f64::max);
            }
            before = Some(now);
        }
        assert!(worst > 0.001 && worst <= most, "{name}: {worst} per {STEP_DEG} degrees");
    }
}

/// The steep end of `demo-orthographic`: edges of towers that are parallel in space are so in the picture.
#[test]
fn the_steep_end_may_be_a_parallel_projection() {
    let document = PresetDocument::builtin("demo-orthographic").unwrap();
    let camera = camera_at(85.0, 1000.0);
    let photograph = bend(&document, &camera).adapted_pinhole(&camera);
    let image = |p: DVec3| photograph.project(p).unwrap().0;
    let edge = |x: f64, y: f64| image(DVec3::new(x, y, 50.0)) - image(DVec3::new(x, y, 0.0));
    for (x, y) in [(-400.0, -200.0), (300.0, 250.0), (0.0, 300.0)] {
        let off = edge(x, y) - edge(0.0, 0.0);
        assert!(off.length() < 0.1, "({x}, {y}): {} pixels", off.length());
    }
    assert!((image(DVec3::ZERO) - photograph.center_px()).length() < 1e-6);
}
