//! Bends at a share of their strength: from the straight picture to the bent one.

use crate::spline_figures::{bend, camera_at};
use crate::split_rays::{parting, root};
use belvedere_core::grid::Grid;
use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::relief::{Relief, ReliefShape};
use belvedere_core::map::spline::ReferencePlane;
use belvedere_core::map::split_rays::SplitRays;
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, DVec3, Pinhole, Stage, TerrainDisocclusion, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::Similarity;

fn spline(name: &str) -> View {
    let camera = camera_at(40.0, 1000.0);
    let bend = bend(&PresetDocument::builtin(name).unwrap(), &camera);
    View::new(bend.adapted_pinhole(&camera), vec![Stage::SplineBend(bend)]).unwrap()
}

fn turned() -> View {
    let root = root(&Similarity::IDENTITY);
    let plane = |y: f64| DVec3::new(0.0, y, 0.0);
    let turn = TurnSpec {
        viewpoint: DVec3::new(-8.0, 0.0, 1.0),
        t0: plane(25.0),
        t1: plane(30.0),
        t2: plane(35.0),
        pencil: Pencil::Parallel { normal: DVec3::Y },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&root, Model::Modified, &[turn]).unwrap();
    View::new(root, vec![Stage::CurvedRays(rays)]).unwrap()
}

fn moved_ground_and_relief() -> View {
    let camera = camera_at(40.0, 1000.0);
    let side = 41;
    let delta = (0..side * side).map(|i| 20.0 * f64::from(i % 7) - 60.0).collect();
    let delta = Grid::new(DVec2::new(-4e3, 4e3), DVec2::splat(200.0), 41, 41, delta).unwrap();
    let shape = ReliefShape { exaggeration: [1.2, 2.0], oblique: 0.3, ..ReliefShape::none([200.0, 3000.0]) };
    let relief = Relief::new(&camera, &ReferencePlane::level(0.0), shape, None).unwrap();
    View::new(camera, vec![Stage::TerrainDisocclusion(TerrainDisocclusion::new(delta)), Stage::Relief(relief)]).unwrap()
}

fn parted() -> View {
    let pinhole: Pinhole = root(&Similarity::IDENTITY);
    let rays = SplitRays::new(&pinhole, Model::Modified, &parting(&Similarity::IDENTITY)).unwrap();
    View::new(pinhole, vec![Stage::SplitRays(rays)]).unwrap()
}

/// Largest distance in pixels between the images of points in the two views; points without an image in one of them are skipped.
fn apart(a: &View, b: &View, near: f64, far: f64) -> f64 {
    let mut random = Random::new(7);
    let straight = a.straightened();
    let points = (0..400).map(|_| {
        let pixel = DVec2::new(random.range(40.0, 1240.0), random.range(300.0, 700.0));
        straight.ray(pixel).at(random.range(near, far)).unwrap().point
    });
    let both = points.filter_map(|p| Some(a.project(p).ok()?.pixel.distance(b.project(p).ok()?.pixel)));
    both.fold(0.0, f64::max)
}

#[test]
fn bends_grow_from_the_straight_picture_to_the_bent_one() {
    let cases = [
        ("progressive", spline("progressive"), 300.0, 3000.0),
        ("degressive", spline("degressive"), 300.0, 3000.0),
        ("hybrid", spline("hybrid-flat-steep-flat"), 300.0, 3000.0),
        ("curved rays", turned(), 10.0, 80.0),
        ("ground and relief", moved_ground_and_relief(), 300.0, 3000.0),
        ("rays that part", parted(), 10.0, 80.0),
    ];
    for (name, view, near, far) in cases {
        let at = |share: f64| view.eased(share).unwrap_or_else(|| panic!("{name} has nothing at {share}"));
        assert_eq!(at(1.0), view, "{name}");
        assert_eq!(at(0.0), view.straightened(), "{name}");
        let whole = apart(&view, &view.straightened(), near, far);
        assert!(whole > 5.0, "{name} bends by {whole} pixels only");
        let begins = apart(&at(1e-6), &view.straightened(), near, far);
        assert!(begins < 1e-3 * whole, "{name} begins {begins} pixels from the straight picture, of {whole}");
        let ends = apart(&at(1.0 - 1e-6), &view, near, far);
        assert!(ends < 1e-3 * whole, "{name} ends {ends} pixels from the bent picture, of {whole}");
        let steps = (0..20).map(|k| apart(&at(f64::from(k) / 20.0), &at(f64::from(k + 1) / 20.0), near, far));
        let largest = steps.fold(0.0, f64::max);
        assert!(largest < 0.6 * whole, "{name} jumps by {largest} pixels of {whole} in a twentieth of its way");
    }
}
