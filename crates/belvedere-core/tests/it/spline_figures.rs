//! The measured figures of the built-in presets.

use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec3, Pinhole, Projection};

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
