//! Curves that are stated by angles.

use belvedere_core::DVec2;
use belvedere_core::deformation::DeformationCurve;
use belvedere_core::presets::edit::{EditError, PresetOperation};
use belvedere_core::presets::{Preset, PresetDocument, PresetError};

/// A plane of 60 degrees, a bend, a plane of 20 degrees.
const STEEP_FLAT: [[f64; 2]; 4] = [[0.0, 60.0], [0.5, 60.0], [1.0, 20.0], [1.6, 20.0]];

fn document(angles: &[[f64; 2]]) -> PresetDocument {
    let mut document = PresetDocument::builtin("progressive").unwrap();
    document.presets.truncate(1);
    told(&mut document.presets[0], angles);
    document
}

fn told(preset: &mut Preset, angles: &[[f64; 2]]) {
    (preset.control, preset.knots, preset.angles) = (Vec::new(), None, Some(angles.to_vec()));
}

fn slope(curve: &DeformationCurve, l: f64) -> f64 {
    curve.at(l).1.to_angle().to_degrees()
}

fn stated(angles: &[[f64; 2]], l: f64) -> f64 {
    let pair = angles.windows(2).find(|pair| l <= pair[1][0]).unwrap();
    pair[0][1] + (l - pair[0][0]) / (pair[1][0] - pair[0][0]) * (pair[1][1] - pair[0][1])
}

fn edited(document: &PresetDocument, operation: &str) -> Result<PresetDocument, EditError> {
    document.edited(&operation.parse::<PresetOperation>()?)
}

#[test]
fn slopes_and_lengths_are_those_that_are_stated() {
    let document = document(&STEEP_FLAT);
    document.validate().unwrap();
    let curve = DeformationCurve::new(&document.presets[0].spline().unwrap()).unwrap();
    assert!((curve.length() - 1.6).abs() < 1e-6, "{}", curve.length());
    // The curve by summing its directions.
    let steps = 160_000;
    let mut by_sum = DVec2::ZERO;
    for k in 0..steps {
        let l = 1.6 * (f64::from(k) + 0.5) / f64::from(steps);
        by_sum += 1.6 / f64::from(steps) * DVec2::from_angle(stated(&STEEP_FLAT, l).to_radians());
        if k % 500 == 0 {
            assert!((slope(&curve, l) - stated(&STEEP_FLAT, l)).abs() < 2e-3, "{l}: {}", slope(&curve, l));
        }
    }
    assert!(curve.at(curve.length()).0.distance(by_sum) < 1e-6, "{by_sum}");
    let bend = -(40.0f64.to_radians()) / 0.5;
    for l in [0.6, 0.75, 0.9] {
        assert!((curve.curvature_at(l) / bend - 1.0).abs() < 0.02, "{l}: {}", curve.curvature_at(l));
    }
    assert!(curve.curvature_at(0.25).abs() < 1e-6 && curve.curvature_at(1.3).abs() < 1e-6);
}

#[test]
fn between_two_presets_angles_of_view_are_between_theirs() {
    let mut document = document(&STEEP_FLAT);
    let other = [[0.0, 80.0], [1.2, 50.0]];
    let mut second = document.presets[0].clone();
    (second.phi, second.name) = (document.presets[0].phi + 30.0, "second".into());
    told(&mut second, &other);
    document.presets.push(second);
    document.validate().unwrap();
    let half_way = document.presets[0].phi + 15.0;
    let selection = document.select(half_way).unwrap();
    let curve = DeformationCurve::new(&selection.interpolate(45.0).unwrap().spline).unwrap();
    let sigma = selection.sigma;
    assert!((curve.length() - (1.6 + sigma * (1.2 - 1.6))).abs() < 1e-6);
    for k in 0..=40 {
        let t = f64::from(k) / 40.0;
        let expected = (1.0 - sigma) * stated(&STEEP_FLAT, 1.6 * t) + sigma * stated(&other, 1.2 * t);
        let found = slope(&curve, curve.length() * t);
        assert!((found - expected).abs() < 2e-3, "{t}: {found}, {expected}");
    }
}

#[test]
fn control_points_become_angles_and_angles_become_control_points() {
    let built_in = PresetDocument::builtin("progressive").unwrap();
    let curve_of = |d: &PresetDocument| DeformationCurve::new(&d.presets[0].spline().unwrap()).unwrap();
    let angles = edited(&built_in, "1.angles=40").unwrap();
    assert!(angles.presets[0].control.is_empty() && angles.presets[0].angles.as_ref().unwrap().len() == 40);
    let (old, new) = (curve_of(&built_in), curve_of(&angles));
    assert!((old.length() - new.length()).abs() < 1e-6);
    for k in 0..=100 {
        let l = old.length() * f64::from(k) / 100.0;
        assert!((slope(&old, l) - slope(&new, l)).abs() < 0.3, "{l}: {} {}", slope(&old, l), slope(&new, l));
    }
    let turned = edited(&angles, "1.angle.2=70").unwrap();
    assert_eq!(turned.presets[0].angles.as_ref().unwrap()[1][1], 70.0);
    let points = edited(&angles, "1.add-point=0.5").unwrap();
    assert!(points.presets[0].angles.is_none() && points.presets[0].control.len() > 4);
    let again = curve_of(&points);
    for k in 0..=20 {
        let l = new.length() * f64::from(k) / 20.0;
        assert!(new.at(l).0.distance(again.at(l).0) < 1e-9);
    }
    let twice = edited(&edited(&angles, "1.mirror").unwrap(), "1.mirror").unwrap();
    for (a, b) in twice.presets[0].angles.iter().flatten().zip(angles.presets[0].angles.iter().flatten()) {
        assert!((a[0] - b[0]).abs() < 1e-12 && a[1] == b[1]);
    }
    assert!(matches!(edited(&built_in, "1.angle.2=70"), Err(EditError::Needed { .. })));
    assert!(matches!(edited(&angles, "1.angle.41=70"), Err(EditError::NoPart { count: 40, .. })));
}

#[test]
fn what_makes_no_curve_is_refused() {
    let refused = |angles: &[[f64; 2]]| document(angles).validate().unwrap_err();
    assert!(matches!(refused(&[[0.0, 10.0]]), PresetError::AngleCount { count: 1, .. }));
    assert!(matches!(refused(&[[0.0, 10.0], [0.0, 20.0]]), PresetError::AngleOrder { .. }));
    assert!(matches!(refused(&[[0.1, 10.0], [1.0, 20.0]]), PresetError::AngleOrder { .. }));
    assert!(matches!(refused(&[[0.0, f64::NAN], [1.0, 20.0]]), PresetError::NotFinite { field: "angles", .. }));
    assert!(matches!(refused(&[[0.0, 1e9], [1.0, 20.0]]), PresetError::Range { field: "angles", .. }));
    assert!(matches!(refused(&[[0.0, 170.0], [1.0, 170.0]]), PresetError::FarEndNearer { .. }));
    let mut both = document(&STEEP_FLAT);
    both.presets[0].control = vec![[0.0, 0.0]; 4];
    assert!(matches!(both.validate(), Err(PresetError::TwoCurves { .. })));
    let mut none = document(&STEEP_FLAT);
    none.presets[0].angles = None;
    assert!(matches!(none.validate(), Err(PresetError::Curve { .. })));
}
