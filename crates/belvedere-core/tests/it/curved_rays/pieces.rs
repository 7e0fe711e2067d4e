//! Rays as pieces: they meet, they are tangent, they carry depth and length.

use super::cameras::{self, Spec};
use belvedere_core::map::curved_rays::{Model, RayPiece, Shape};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_testkit::laws::Similarity;

const MODELS: [Model; 5] = [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular];
const PIXELS: [DVec2; 4] = [DVec2::new(640.0, 360.0), DVec2::ZERO, DVec2::new(1280.0, 0.0), DVec2::new(311.7, 702.3)];

fn specs() -> [Spec; 4] {
    [cameras::street_corner(), cameras::sideways(), cameras::zigzag(), cameras::long_bend()]
}

fn views() -> impl Iterator<Item = (Model, View)> {
    specs().into_iter().flat_map(|spec| MODELS.map(|model| (model, spec.view(model, &Similarity::IDENTITY))))
}

fn direction(piece: &RayPiece, depth: f64) -> DVec3 {
    let h = 1e-6 * depth;
    let [low, high] = piece.depth;
    (piece.at((depth + h).min(high)) - piece.at((depth - h).max(low))).normalize()
}

#[test]
fn pieces_are_the_ray() {
    for (model, view) in views() {
        for pixel in PIXELS {
            let ray = view.ray(pixel);
            for piece in ray.pieces().unwrap() {
                for i in 0..=20 {
                    let [low, high] = piece.depth;
                    let depth = low.max(0.1) + (high.min(5000.0) - low.max(0.1)) * f64::from(i) / 20.0;
                    let (a, b) = (piece.at(depth), ray.at(depth).unwrap());
                    let error = (a - b.point).length();
                    assert!(error < 1e-9, "{model:?} {pixel} at {depth}: {a} {} off by {error:e}", b.point);
                    if i > 0 && i < 20 {
                        assert_eq!(piece.segment, b.segment);
                    }
                }
            }
        }
    }
}

#[test]
fn pieces_meet_and_only_broken_rays_have_kinks() {
    for (model, view) in views() {
        for pixel in PIXELS {
            let pieces = view.ray(pixel).pieces().unwrap();
            let mut sharpest = 0.0f64;
            for pair in pieces.windows(2) {
                let depth = pair[0].depth[1];
                assert_eq!(depth, pair[1].depth[0]);
                assert!((pair[0].at(depth) - pair[1].at(depth)).length() < 1e-9, "{model:?} {pixel} at {depth}");
                let kink = direction(&pair[0], depth).cross(direction(&pair[1], depth)).length();
                sharpest = sharpest.max(kink);
            }
            if model == Model::C0 {
                assert!(sharpest > 0.1, "{pixel}: broken rays without a kink ({sharpest})");
            } else {
                assert!(sharpest < 1e-4, "{model:?} {pixel}: kink of {sharpest}");
            }
        }
    }
}

#[test]
fn parameters_and_depths_of_arcs_are_inverse() {
    for (model, view) in views() {
        for pixel in PIXELS {
            for piece in view.ray(pixel).pieces().unwrap() {
                for i in 0..=10 {
                    let u = f64::from(i) / 10.0;
                    let (depth, again, point, slope) = match &piece.shape {
                        Shape::Line { .. } => continue,
                        Shape::Conic(arc) => {
                            (arc.depth(u), arc.parameter(arc.depth(u)), arc.curve.point(u), arc.curve.derivative(u))
                        }
                        Shape::C2(arc) => {
                            (arc.depth(u), arc.parameter(arc.depth(u)), arc.curve.point(u), arc.curve.derivative(u))
                        }
                    };
                    assert!((again - u).abs() < 1e-7, "{model:?} u {u}: {again}");
                    assert!((view.ray(pixel).at(depth).unwrap().point - point).length() < 1e-9);
                    assert!(slope.length() > 0.0);
                }
            }
        }
    }
}

#[test]
fn path_length_is_the_length_of_the_polyline() {
    for (model, view) in views() {
        for pixel in PIXELS {
            let ray = view.ray(pixel);
            let far = 1.2 * ray.pieces().unwrap().last().unwrap().depth[0];
            let chords = |n: u32| -> f64 {
                let at = |i: u32| ray.at(far * f64::from(i).max(1e-9) / f64::from(n)).unwrap().point;
                (0..n).map(|i| (at(i + 1) - at(i)).length()).sum()
            };
            let (coarse, fine) = (chords(2000), chords(4000));
            let expected = fine + (fine - coarse) / 3.0;
            let length = ray.path_length(far).unwrap();
            // A kink inside one chord costs up to a chord's share.
            let limit = if model == Model::C0 { 1e-3 } else { 1e-6 };
            assert!((length / expected - 1.0).abs() < limit, "{model:?} {pixel}: {length} instead of {expected}");
        }
    }
}

#[test]
fn samples_are_equidistant_in_depth() {
    let view = cameras::street_corner().view(Model::Modified, &Similarity::IDENTITY);
    let ray = view.ray(DVec2::new(200.0, 500.0));
    let depths: Vec<f64> = ray.samples(1.0, 301.0, 31).map(|s| s.unwrap().depth).collect();
    assert_eq!(depths.len(), 31);
    assert!(depths.iter().enumerate().all(|(i, d)| (d - 1.0 - 10.0 * i as f64).abs() < 1e-12));
    assert_eq!(ray.samples(5.0, 9.0, 1).map(|s| s.unwrap().depth).collect::<Vec<_>>(), [5.0]);
}

/// Far viewpoints, planes through a common line: the circular model's arcs are circles about that line.
#[test]
fn circular_arcs_are_circles() {
    use belvedere_core::map::curved_rays::{CurvedRays, Pencil, Sharpness, TurnSpec};
    use belvedere_core::{Pinhole, Projection, Stage};
    let (half, back) = (30f64.to_radians(), 1e5);
    // Rays run along +y, turn left by 60 degrees about the z axis at distance 10.
    let at = |angle: f64| 10.0 * DVec3::new(angle.cos(), angle.sin(), 0.0);
    let along = |angle: f64| DVec3::new(-angle.sin(), angle.cos(), 0.0);
    let eye = at(-half) - back * along(-half);
    let projection = Projection::Perspective { fov_y: 1e-5 };
    let root = Pinhole::look_at(eye, at(-half), DVec3::Z, projection, [100, 100], 1.0, None).unwrap();
    let turn = TurnSpec {
        viewpoint: at(half) - back * along(half),
        t0: at(-half),
        t1: at(0.0),
        t2: at(half),
        pencil: Pencil::Line { point: DVec3::ZERO, dir: DVec3::Z },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&root, Model::Circular, &[turn]).unwrap();
    assert!((rays.turns()[0].m.unwrap() - 1.0 / half.cos()).abs() < 1e-12);
    let view = View::new(root, vec![Stage::CurvedRays(rays)]).unwrap();
    for pixel in [DVec2::new(20.0, 50.0), DVec2::new(50.0, 50.0), DVec2::new(90.0, 50.0)] {
        let pieces = view.ray(pixel).pieces().unwrap();
        let Shape::Conic(arc) = &pieces[1].shape else { panic!("{pieces:?}") };
        let radius = arc.curve.t.truncate().length();
        for u in [0.2, 0.5, 0.9] {
            let r = arc.curve.point(u).truncate().length();
            assert!((r / radius - 1.0).abs() < 1e-4, "{pixel} u {u}: radius {r} instead of {radius}");
        }
    }
}
