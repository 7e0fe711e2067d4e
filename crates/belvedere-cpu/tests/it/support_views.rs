//! Views of the test hills: straight, on a small planet, and along bent rays.

use crate::support::pinhole;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{CurvedRays, DVec3, EarthCurvature, Pinhole, SplineBend, Stage, View};

/// A planet so small that its curvature is visible across the test hills.
pub(crate) fn small_planet(pinhole: Pinhole) -> View {
    let earth = EarthCurvature { eye: pinhole.eye, radius: 8_000.0, refraction: 0.13 };
    View::new(pinhole, vec![Stage::EarthCurvature(earth)]).expect("one stage is in order")
}

/// A built-in spline preset over level ground at height 0.
pub(crate) fn spline(pinhole: Pinhole, preset: &str) -> View {
    spline_over(pinhole, preset, 0.0)
}

/// A built-in spline preset over level ground at a given height.
pub(crate) fn spline_over(pinhole: Pinhole, preset: &str, height: f64) -> View {
    let ground = ReferencePlane::level(height);
    let pivot = default_pivot(&pinhole, &ground);
    let document = PresetDocument::builtin(preset).expect("the preset is built in");
    let bend = SplineBend::new(&pinhole, &document, &ground, pivot).expect("the preset fits the camera");
    View::new(bend.adapted_pinhole(&pinhole), vec![Stage::SplineBend(bend)]).expect("one stage is in order")
}

/// Rays that rise and look down: after the turn at distance `at` they seem to start `rise` metres higher.
pub(crate) fn turns(pinhole: Pinhole, model: Model, turns: &[(f64, f64)]) -> View {
    let forward = pinhole.forward.with_z(0.0).normalize();
    let eye = pinhole.eye;
    let mut specs = Vec::new();
    for &(at, rise) in turns {
        let plane = |d: f64| eye + forward * d;
        specs.push(TurnSpec {
            viewpoint: eye + DVec3::Z * rise,
            t0: plane(at * 0.85),
            t1: plane(at),
            t2: plane(at * 1.15),
            pencil: Pencil::Parallel { normal: -forward },
            m: Sharpness::Bend,
        });
    }
    let rays = CurvedRays::new(&pinhole, model, &specs).unwrap_or_else(|e| panic!("{e}"));
    View::new(pinhole, vec![Stage::CurvedRays(rays)]).expect("one stage is in order")
}

/// Named views of hills that span 1150 m around the origin.
pub(crate) fn views(image: [u32; 2]) -> Vec<(&'static str, View)> {
    let low = pinhole(DVec3::new(-300.0, -560.0, 240.0), DVec3::new(30.0, 100.0, 20.0), 55.0, image);
    let high = pinhole(DVec3::new(-100.0, -700.0, 520.0), DVec3::new(20.0, 0.0, 0.0), 50.0, image);
    vec![
        ("straight", View::straight(low.clone())),
        ("small planet", small_planet(low)),
        ("progressive", spline(high.clone(), "progressive")),
        ("degressive", spline(high.clone(), "degressive")),
        ("one turn", turns(high.clone(), Model::Modified, &[(600.0, 220.0)])),
        ("a sharp turn", turns(high.clone(), Model::C0, &[(600.0, 220.0)])),
        ("two turns", turns(high, Model::Modified, &[(500.0, 120.0), (800.0, 220.0)])),
    ]
}
