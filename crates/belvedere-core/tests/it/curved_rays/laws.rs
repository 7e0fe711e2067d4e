//! The laws of maps and cameras for every model.

use super::cameras::{self, Spec};
use belvedere_core::map::curved_rays::{CurvedRays, Model, TurnSpec};
use belvedere_core::{Aabb, DVec2, DVec3, SpaceMap};
use belvedere_testkit::laws::{CameraCase, Continuity, Joint, MapCase, Similarity};

/// A box that the picture sees, from before the first turn to past the last.
fn region() -> Aabb {
    Aabb { min: DVec3::new(-25.0, 5.0, -20.0), max: DVec3::new(25.0, 200.0, 20.0) }
}

fn in_picture(rays: &CurvedRays, p: DVec3) -> bool {
    let image = rays.apply(p).ok().and_then(|q| rays.root().project(q).ok());
    image.is_some_and(|(pixel, _)| rays.root().contains(pixel))
}

fn continuity(model: Model) -> Continuity {
    match model {
        Model::C0 => Continuity::C0,
        Model::C2 => Continuity::C2,
        _ => Continuity::C1,
    }
}

/// Where some rays of the picture cross the planes of the turns, and their directions there.
fn joints(spec: &Spec, model: Model) -> Vec<Joint> {
    let view = spec.view(model, &Similarity::IDENTITY);
    let mut joints = Vec::new();
    for pixel in [DVec2::new(640.0, 360.0), DVec2::new(100.0, 600.0), DVec2::new(1100.0, 50.0)] {
        let ray = view.ray(pixel);
        for piece in ray.pieces().unwrap().iter().skip(1) {
            let depth = piece.depth[0];
            let (before, after) = (ray.at(0.999 * depth).unwrap().point, ray.at(1.001 * depth).unwrap().point);
            joints.push(Joint { point: ray.at(depth).unwrap().point, across: after - before });
        }
    }
    joints
}

fn map_case(name: &str, spec: fn() -> Spec, model: Model) -> MapCase<CurvedRays> {
    MapCase::new(format!("{name} {model:?}"), region(), move |s| spec().rays(model, s))
        .continuity(continuity(model))
        .joints(joints(&spec(), model))
        .identity_at_zero_strength(move || {
            let mut spec = spec();
            for turn in &mut spec.turns {
                *turn = TurnSpec { viewpoint: DVec3::ZERO, ..*turn };
            }
            spec.turns.truncate(1); // later turns are placed for the rays that the first one bends
            spec.rays(model, &Similarity::IDENTITY)
        })
        .domain(0.5, in_picture)
}

fn camera_case(name: &str, spec: fn() -> Spec, model: Model, far: f64) -> CameraCase {
    CameraCase::new(format!("{name} {model:?}"), [1.5, far], move |s| spec().view(model, s)).samples(500)
}

macro_rules! laws_of_each_model {
    ($spec:ident, $far:expr) => {
        mod $spec {
            use super::*;
            fn map(model: Model) -> MapCase<CurvedRays> {
                map_case(stringify!($spec), cameras::$spec, model)
            }
            fn camera(model: Model) -> CameraCase {
                camera_case(stringify!($spec), cameras::$spec, model, $far)
            }
            belvedere_testkit::space_map_laws!(modified, super::map(super::Model::Modified));
            belvedere_testkit::space_map_laws!(original, super::map(super::Model::Original));
            belvedere_testkit::space_map_laws!(c0, super::map(super::Model::C0));
            belvedere_testkit::space_map_laws!(c2, super::map(super::Model::C2));
            belvedere_testkit::space_map_laws!(circular, super::map(super::Model::Circular));
            belvedere_testkit::camera_laws!(camera_modified, super::camera(super::Model::Modified));
            belvedere_testkit::camera_laws!(camera_original, super::camera(super::Model::Original));
            belvedere_testkit::camera_laws!(camera_c0, super::camera(super::Model::C0));
            belvedere_testkit::camera_laws!(camera_c2, super::camera(super::Model::C2));
            belvedere_testkit::camera_laws!(camera_circular, super::camera(super::Model::Circular));
        }
    };
}

laws_of_each_model!(street_corner, 2000.0);
laws_of_each_model!(sideways, 2000.0);
laws_of_each_model!(zigzag, 1500.0);
laws_of_each_model!(long_bend, 3000.0);
