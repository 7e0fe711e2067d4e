//! Views of the test hills: straight, on a small planet, and bent.

use crate::support::pinhole;
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec3, EarthCurvature, Pinhole, SplineBend, Stage, View};

/// A planet so small that its curvature is seen across the test hills.
pub(crate) fn small_planet(pinhole: Pinhole) -> View {
    let earth = EarthCurvature { eye: pinhole.eye, radius: 8_000.0, refraction: 0.13 };
    View::new(pinhole, vec![Stage::EarthCurvature(earth)]).expect("one stage is in order")
}

/// A built-in spline preset over level ground at height 0.
pub(crate) fn spline(pinhole: Pinhole, preset: &str) -> View {
    let ground = ReferencePlane::level(0.0);
    let pivot = default_pivot(&pinhole, &ground);
    let document = PresetDocument::builtin(preset).expect("the preset is built in");
    let bend = SplineBend::new(&pinhole, &document, &ground, pivot).expect("the preset fits the camera");
    View::new(bend.adapted_pinhole(&pinhole), vec![Stage::SplineBend(bend)]).expect("one stage is in order")
}

/// Named views of hills that span 1150 m around the origin.
pub(crate) fn views(image: [u32; 2]) -> Vec<(&'static str, View)> {
    let low = pinhole(DVec3::new(-300.0, -560.0, 240.0), DVec3::new(30.0, 100.0, 20.0), 55.0, image);
    let high = pinhole(DVec3::new(-100.0, -700.0, 520.0), DVec3::new(20.0, 0.0, 0.0), 50.0, image);
    vec![
        ("straight", View::straight(low.clone())),
        ("small planet", small_planet(low)),
        ("progressive", spline(high.clone(), "progressive")),
        ("degressive", spline(high, "degressive")),
    ]
}
