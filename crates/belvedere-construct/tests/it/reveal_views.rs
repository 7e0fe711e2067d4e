//! Views that `reveal` chooses: kinds of places at which a chosen view may fail.

use belvedere_construct::{MeasureOptions, RevealMemory, RevealOptions, Revealed, measure, reveal};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, Progress, Scene};
use belvedere_testkit::synthetic::{line_layer, point_layer, terrain_layer};

fn run(scene: &Scene) -> Revealed {
    reveal(scene, None, &RevealOptions::default(), &mut RevealMemory::default(), &Progress::silent()).unwrap()
}

/// Ground of `nx` x `ny` nodes, 30 m apart, from the south-west corner at the origin.
fn ground(nx: usize, ny: usize, height: impl Fn(f64, f64) -> f64) -> Heightfield {
    let heights =
        (0..ny).flat_map(|r| (0..nx).map(move |c| (c, ny - 1 - r))).map(|(c, r)| height(c as f64, r as f64) as f32);
    let north = (ny - 1) as f64 * 30.0;
    Heightfield::measured(DVec2::new(0.0, north), DVec2::splat(30.0), nx, ny, heights.collect()).unwrap()
}

fn hills(x: f64, y: f64) -> f64 {
    600.0 + 120.0 * (0.35 * x + 0.6 * (0.2 * y).sin()).sin() * (0.31 * y).cos() + 90.0 * (0.11 * x + 0.17 * y).sin()
}

#[test]
fn a_strip_of_data_does_not_stand_aslant() {
    let way = |k: usize| DVec3::new(400.0 + 370.0 * k as f64, 1200.0 + 300.0 * (0.5 * k as f64).sin(), 0.0);
    let layers = vec![terrain_layer(ground(240, 80, hills)), line_layer("way", (0..17).map(way).collect())];
    let picture = run(&Scene { layers, ..Scene::default() }).report.bent;
    assert!(picture.slant < 0.15 && picture.in_frame > 0.97 && picture.visible > 0.85, "{picture:?}");
}

#[test]
fn a_view_is_chosen_for_features_of_all_kinds() {
    let way = (0..9).map(|k| DVec3::new(300.0 + 90.0 * f64::from(k), 400.0 + 60.0 * f64::from(k), 0.0)).collect();
    let layers = vec![
        terrain_layer(ground(160, 120, hills)),
        line_layer("way", way),
        point_layer("hut", DVec3::new(4200.0, 3000.0, 0.0)),
    ];
    let scene = Scene { layers, ..Scene::default() };
    let found = run(&scene);
    let measured = measure(&scene, &found.view, None, &MeasureOptions::default(), &Progress::silent()).unwrap();
    let [_, shares] = measured.shares().unwrap();
    assert!(shares.in_frame > 0.97 && shares.visible > 0.8, "the least of line and point: {shares}");
    // The total is that of the first kind, in metres.
    assert!((found.report.total - 8.0 * 90f64.hypot(60.0)).abs() < 5.0, "{}", found.report.total);
}

#[test]
fn where_a_straight_picture_from_another_side_shows_all_nothing_is_bent() {
    // A wall of 300 m beside the way; the ground is open on the other side.
    for (south, north) in [(24.0, 28.0), (40.0, 44.0)] {
        let height = |x: f64, y: f64| 300.0 + 0.8 * x + if (south..north).contains(&y) { 300.0 } else { 0.0 };
        let way = vec![DVec3::new(300.0, 1000.0, 0.0), DVec3::new(1500.0, 1100.0, 0.0)];
        let scene =
            Scene { layers: vec![terrain_layer(ground(64, 64, height)), line_layer("way", way)], ..Scene::default() };
        let found = run(&scene);
        assert!(found.bend.is_none() && found.report.bent.visible > 0.99, "{south}: {:?}", found.report);
    }
}

/// A way of `length` m across the middle of hills.
fn short_way(length: f64) -> Scene {
    let way = (0..20).map(|k| {
        let t = f64::from(k) / 19.0 - 0.5;
        DVec3::new(3600.0 + length * t, 3600.0 + 0.2 * length * (6.0 * t).sin(), 0.0)
    });
    let layers = vec![terrain_layer(ground(240, 240, hills)), line_layer("way", way.collect())];
    Scene { layers, ..Scene::default() }
}

#[test]
fn a_view_is_the_same_in_every_size_of_one_shape() {
    let scene = short_way(500.0);
    let found = |options: RevealOptions| {
        reveal(&scene, None, &options, &mut RevealMemory::default(), &Progress::silent()).unwrap().view
    };
    let sizes =
        [[640, 360], [1280, 720], [2560, 1440]].map(|image| RevealOptions { image, ..RevealOptions::default() });
    // A sheet of US letter at 75, 150 and 300 dpi, whose pixels are rounded to other shapes.
    let sheets = [[825, 638], [1650, 1275], [3300, 2550]].map(|image| RevealOptions {
        image,
        aspect: Some(279.4 / 215.9),
        ..RevealOptions::default()
    });
    for shape in [sizes, sheets] {
        let views = shape.map(|options| (found(options), options.image));
        let first = views[0].0.pinhole().clone();
        for (view, image) in &views {
            let pinhole = view.pinhole();
            assert_eq!(pinhole.image, *image);
            assert_eq!(
                (pinhole.eye, pinhole.forward, pinhole.projection),
                (first.eye, first.forward, first.projection)
            );
            assert_eq!(view.stages().len(), views[0].0.stages().len());
        }
    }
}

#[test]
fn a_short_way_fills_the_picture_under_a_horizon() {
    for length in [450.0, 900.0, 3000.0] {
        let picture = run(&short_way(length)).report.bent;
        assert!((0.45..0.85).contains(&picture.width) && picture.in_frame > 0.99, "{length}: {picture:?}");
        assert!((0.1..0.28).contains(&picture.skyline) && picture.horizon > 0.0, "{length}: {picture:?}");
    }
}

#[test]
fn what_coarse_cells_forbid_is_said() {
    let found = run(&short_way(60.0));
    let said = found.report.warnings.iter().find(|w| w.text().contains("because cells are 30 m"));
    let said = said.unwrap_or_else(|| panic!("{:?}", found.report.warnings));
    assert!(said.text().contains("the eye stands") && found.report.bent.width < 0.6, "{said:?}");
}
