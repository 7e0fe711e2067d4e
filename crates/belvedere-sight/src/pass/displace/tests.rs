use super::*;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{Pinhole, Projection};

fn camera() -> Pinhole {
    let screen = Projection::Perspective { fov_y: 0.9 };
    let (eye, target) = (DVec3::new(5e5, 4.6e6, 3000.0), DVec3::new(5e5, 4.61e6, 0.0));
    Pinhole::look_at(eye, target, DVec3::Z, screen, [1280, 720], 1.0, None).unwrap()
}

fn rays(model: Model, m: Sharpness) -> View {
    let camera = camera();
    let at = |y: f64| camera.eye + DVec3::new(0.0, y, -2000.0);
    let turn = |up: f64, y: f64| TurnSpec {
        viewpoint: camera.eye + DVec3::new(50.0, -80.0, up),
        t0: at(y),
        t1: at(y + 1000.0),
        t2: at(y + 2200.0),
        pencil: Pencil::Parallel { normal: DVec3::Y },
        m,
    };
    let rays = CurvedRays::new(&camera, model, &[turn(700.0, 4000.0), turn(1300.0, 9000.0)]).unwrap();
    View::new(camera, vec![Stage::CurvedRays(rays)]).unwrap()
}

fn spline(preset: &str) -> View {
    let (camera, plane) = (camera(), ReferencePlane::level(0.0));
    let document = PresetDocument::builtin(preset).unwrap();
    let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane)).unwrap();
    View::new(camera, vec![Stage::SplineBend(bend)]).unwrap()
}

fn ground(n: usize) -> Vec<DVec3> {
    let eye = camera().eye.with_z(0.0);
    (0..n * n)
        .map(|i| {
            let (u, v) = ((i % n) as f64 / n as f64, (i / n) as f64 / n as f64);
            eye + DVec3::new(12e3 * (u - 0.5), 200.0 + 24e3 * v, 1500.0 * (20.0 * u).sin() * (31.0 * v).cos())
        })
        .collect()
}

#[test]
fn prepared_stages_place_points_like_the_stages_themselves() {
    let views = [
        rays(Model::Modified, Sharpness::Bend),
        rays(Model::Modified, Sharpness::Value(4.0)),
        rays(Model::Original, Sharpness::Bend),
        rays(Model::C2, Sharpness::Bend),
        spline("progressive"),
        spline("degressive"),
    ];
    for (k, view) in views.iter().enumerate() {
        for record in 0..view.records() {
            let displacer = Displacer::new(view, Way::Records([record; 2]));
            let (mut worst, mut seen) = (0.0f64, 0);
            for p in ground(90) {
                let exact = view.displace_in(record, p).ok().map(|d| d.point);
                let fast = displacer.point(p);
                assert_eq!(exact.is_some(), fast.is_some(), "view {k}, record {record}: {p}");
                let (Some(exact), Some(fast)) = (exact, fast) else { continue };
                let (Ok((a, depth)), Ok((b, _))) = (view.pinhole().project(exact), view.pinhole().project(fast)) else {
                    continue;
                };
                if depth > 20.0 {
                    worst = worst.max(a.distance(b));
                    seen += 1;
                }
            }
            assert!(seen > 4000, "view {k}: {seen}");
            assert!(worst < 0.002, "view {k}, record {record}: {worst} px");
        }
    }
}

#[test]
fn rows_and_single_points_agree_to_the_last_bit() {
    for view in [rays(Model::Modified, Sharpness::Bend), spline("progressive")] {
        let displacer = Displacer::new(&view, Way::Records([0; 2]));
        for row in ground(66).chunks(33) {
            let coordinate = |k: usize| row.iter().map(|p| p[k]).collect::<Vec<f64>>();
            let (mut x, mut y, mut z) = (coordinate(0), coordinate(1), coordinate(2));
            assert!(displacer.row(&mut Points { x: &mut x, y: &mut y, z: &mut z }));
            for (i, p) in row.iter().enumerate() {
                assert_eq!(displacer.point(*p), Some(DVec3::new(x[i], y[i], z[i])));
            }
        }
    }
}

#[test]
fn straight_parts_place_points_like_the_rays_themselves() {
    let view = rays(Model::Modified, Sharpness::Bend);
    for segment in [0, 2, 4] {
        let displacer = Displacer::new(&view, Way::Segment(segment));
        for p in ground(20) {
            let (exact, fast) = (view.displace_along(segment, p).unwrap().point, displacer.point(p).unwrap());
            assert!(exact.distance(fast) < 1e-6, "segment {segment}: {exact} {fast}");
        }
    }
    assert_eq!(Displacer::new(&view, Way::Records([0; 2])).point(DVec3::NAN), None);
}
