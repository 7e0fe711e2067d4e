use super::*;
use crate::simd::Kernel;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::earth::EarthCurvature;
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{CurvedRays, Projection, SplineBend, Stage};

fn camera(screen: Projection) -> Pinhole {
    let (eye, target) = (DVec3::new(512_345.678, 4_712_345.432, 3021.37), DVec3::new(513_000.0, 4.725e6, 0.0));
    Pinhole::look_at(eye, target, DVec3::Z, screen, [1280, 720], 1.0, None).unwrap()
}

fn turns(camera: &Pinhole, specs: &[(f64, f64)]) -> Stage {
    let specs: Vec<TurnSpec> = specs
        .iter()
        .map(|&(at, rise)| TurnSpec {
            viewpoint: camera.eye + DVec3::new(60.0, -90.0, rise),
            t0: camera.eye + DVec3::new(0.0, at, -2000.0),
            t1: camera.eye + DVec3::new(0.0, at + 1000.0, -2000.0),
            t2: camera.eye + DVec3::new(0.0, at + 2200.0, -2000.0),
            pencil: Pencil::Parallel { normal: DVec3::Y },
            m: Sharpness::Bend,
        })
        .collect();
    Stage::CurvedRays(CurvedRays::new(camera, Model::Modified, &specs).unwrap())
}

fn spline(camera: &Pinhole, name: &str) -> Stage {
    let plane = ReferencePlane::level(600.0);
    let document = PresetDocument::builtin(name).unwrap();
    Stage::SplineBend(SplineBend::new(camera, &document, &plane, default_pivot(camera, &plane)).unwrap())
}

fn views() -> Vec<View> {
    let camera = camera(Projection::Perspective { fov_y: 0.9 });
    let flat = self::camera(Projection::Orthographic { height: 9000.0 });
    let earth = Stage::EarthCurvature(EarthCurvature { eye: camera.eye, radius: 6.37e6, refraction: 0.13 });
    let grid = belvedere_core::grid::Grid::new(
        camera.eye.truncate() + DVec2::new(-20e3, 40e3),
        DVec2::splat(500.0),
        81,
        81,
        (0..81 * 81).map(|i| 40.0 * f64::from(i % 13).sin()).collect(),
    );
    let lift = Stage::TerrainDisocclusion(TerrainDisocclusion::new(grid.unwrap()));
    let bent = turns(&camera, &[(4000.0, 700.0), (9000.0, 1300.0)]);
    let [near, far, steep] = ["progressive", "degressive", "hybrid-flat-steep-flat"].map(|name| spline(&camera, name));
    let low = spline(&flat, "progressive");
    let stages = [
        vec![],
        vec![earth.clone()],
        vec![lift.clone()],
        vec![bent.clone()],
        vec![earth.clone(), lift.clone(), bent],
        vec![near.clone()],
        vec![far],
        vec![steep],
        vec![earth, lift, near],
    ];
    let with = |stages| View::new(camera.clone(), stages).unwrap();
    let parallel = [View::straight(flat.clone()), View::new(flat, vec![low]).unwrap()];
    stages.into_iter().map(with).chain(parallel).collect()
}

/// Columns, rows and heights around the eye, in scene coordinates.
fn ground() -> (Vec<f64>, Vec<f64>, Vec<f32>) {
    let eye = camera(Projection::Perspective { fov_y: 0.9 }).eye;
    let x = (0..33).map(|c| eye.x - 6e3 + 11.3 + 390.0 * f64::from(c)).collect();
    let y: Vec<f64> = (0..400).map(|r| eye.y + 60.0 + 1.1 * f64::from(r) + 0.15 * f64::from(r * r)).collect();
    let z = (0..33 * 400u32).map(|i| (900.0 + 700.0 * f64::from(i * 7 % 101).sin()) as f32).collect();
    (x, y, z)
}

#[test]
fn single_precision_is_within_a_hundredth_of_a_pixel() {
    let (xs, ys, zs) = ground();
    for (k, view) in views().iter().enumerate() {
        for record in 0..view.records() {
            let projector = Projector::new(view, Way::Records([record; 2])).expect("has a form");
            let (mut worst, mut seen) = (0.0f64, 0);
            for (r, &y) in ys.iter().enumerate() {
                for (c, &x) in xs.iter().enumerate() {
                    let p = DVec3::new(x, y, f64::from(zs[r * 33 + c]));
                    let [rx, ry] = projector.relative(p.truncate());
                    let ([mut px], [mut py], [mut q]) = ([0], [0], [0.0]);
                    let mut out = Row {
                        x: std::slice::from_mut(&mut px),
                        y: std::slice::from_mut(&mut py),
                        q: std::slice::from_mut(&mut q),
                    };
                    let whole = projector.row(&[rx], ry, &[zs[r * 33 + c]], &mut out);
                    let exact = view.displace_in(record, p).ok().and_then(|d| view.pinhole().project(d.point).ok());
                    let Some((pixel, depth)) = exact.filter(|(_, depth)| *depth > 5.0) else { continue };
                    let off = (pixel - view.pinhole().center_px()).abs().max_element();
                    assert!(whole || off > 15_000.0, "view {k}, record {record}: {p} at {pixel} is missed");
                    if off < 4000.0 {
                        let image = DVec2::new(f64::from(px), f64::from(py)) / f64::from(SUB);
                        worst = worst.max(image.distance(pixel));
                        let near = if view.pinhole().is_orthographic() { -depth } else { 1.0 / depth };
                        assert!((f64::from(q) - near).abs() < 2e-6 * near.abs(), "view {k}: nearness {q}, {near}");
                        seen += 1;
                    }
                }
            }
            assert!(seen > 3000, "view {k}: {seen}");
            assert!(worst <= 0.01, "view {k}, record {record}: {worst} px");
        }
    }
}

#[test]
fn a_row_and_its_nodes_agree_to_the_last_bit() {
    let (xs, ys, zs) = ground();
    for view in views() {
        let projector = Projector::new(&view, Way::Records([0; 2])).expect("has a form");
        let relative: Vec<f32> = xs.iter().map(|&x| projector.relative(DVec2::new(x, 0.0))[0]).collect();
        for (r, &y) in ys.iter().enumerate().step_by(7) {
            let (mut x, mut py, mut q) = ([0; 33], [0; 33], [0.0; 33]);
            let north = projector.relative(DVec2::new(0.0, y))[1];
            let heights = &zs[r * 33..][..33];
            let mut out = Row { x: &mut x, y: &mut py, q: &mut q };
            if !projector.row(&relative, north, heights, &mut out) {
                continue;
            }
            for c in 0..33 {
                let (mut x1, mut y1, mut q1) = ([0], [0], [0.0]);
                let mut out = Row { x: &mut x1, y: &mut y1, q: &mut q1 };
                assert!(projector.row(&relative[c..=c], north, &heights[c..=c], &mut out));
                assert_eq!((x1[0], y1[0], q1[0].to_bits()), (x[c], py[c], q[c].to_bits()));
            }
        }
    }
}

#[test]
fn all_versions_give_the_same_bits() {
    let (xs, ys, zs) = ground();
    for view in views() {
        let projector = Projector::new(&view, Way::Records([0; 2])).expect("has a form");
        let relative: Vec<f32> = xs.iter().map(|&x| projector.relative(DVec2::new(x, 0.0))[0]).collect();
        for (r, &y) in ys.iter().enumerate().step_by(7) {
            let y = projector.relative(DVec2::new(0.0, y))[1];
            let image = |plain: bool| {
                let (mut x, mut py, mut q) = ([0; 33], [0; 33], [0.0; 33]);
                let out = &mut Row { x: &mut x, y: &mut py, q: &mut q };
                let run = Run {
                    projector: &projector,
                    part: &projector.parts[0],
                    x: &relative,
                    y,
                    heights: &zs[r * 33..][..33],
                    out,
                };
                let whole = if plain { run.run() } else { simd::run(run) };
                (x, py, q.map(f32::to_bits), whole)
            };
            assert!(image(true) == image(false), "row {r}");
        }
    }
}
