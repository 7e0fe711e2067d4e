use super::*;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::earth::EarthCurvature;
use belvedere_core::{CurvedRays, Pinhole, Projection, Stage};
use belvedere_sight::pass::InView;

fn views() -> Vec<View> {
    let (eye, target) = (DVec3::new(300.0, -9000.0, 2600.0), DVec3::new(0.0, 0.0, -900.0));
    let camera = |screen| Pinhole::look_at(eye, target, DVec3::Z, screen, [640, 360], 1.0, None).unwrap();
    let wide = camera(Projection::Perspective { fov_y: 0.9 });
    let turn = TurnSpec {
        viewpoint: eye + DVec3::Z * 1200.0,
        t0: DVec3::new(0.0, -1500.0, 0.0),
        t1: DVec3::ZERO,
        t2: DVec3::new(0.0, 1500.0, 0.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&wide, Model::Modified, &[turn]).unwrap();
    let earth = Stage::EarthCurvature(EarthCurvature { eye, radius: 6.37e6, refraction: 0.13 });
    let flat = View::straight(camera(Projection::Orthographic { height: 6000.0 }));
    let stages = [vec![], vec![earth.clone()], vec![earth, Stage::CurvedRays(rays)]];
    stages.into_iter().map(|s| View::new(wide.clone(), s).unwrap()).chain([flat]).collect()
}

#[test]
fn nor_in_what_the_image_shows_of_boxes_that_reach_behind_the_eye() {
    let mut around = 0;
    for view in views().iter().filter(|view| view.curved_rays().is_none() && !view.pinhole().is_orthographic()) {
        let (screen, pass) = (Screen::new(view.pinhole()), &Pass::all(view)[0]);
        let (eye, size) = (view.pinhole().eye, 2.0 * screen.center);
        for k in 0..40 {
            let turn = |seed: f64| (f64::from(k) * seed).fract();
            let min = eye + DVec3::new(-4e3 * turn(0.618), -4e3 * turn(0.755), -200.0 - 1500.0 * turn(0.57));
            let bounds = Aabb { min, max: min + DVec3::new(5e3, 5e3, 150.0) };
            let InView::Maybe(extent) = pass.plain.in_view(&screen, &bounds) else { continue };
            let shown = pass.shown_extent(&screen, &bounds, extent);
            assert!(shown.is_some(), "{bounds:?}");
            let most = pass.px_per_height(&screen, &bounds, shown);
            assert!(most.is_finite() && most <= pass.px_per_height(&screen, &bounds, extent));
            around += usize::from(extent.is_none());
            for i in 0..1600 {
                let low = min + DVec3::new(125.0 * f64::from(i % 40), 125.0 * f64::from(i / 40), 0.0);
                let image = |p: DVec3| view.displace_in(0, p).ok().and_then(|d| view.pinhole().project(d.point).ok());
                let (Some((a, _)), Some((b, _))) = (image(low), image(low + DVec3::Z * 0.5)) else { continue };
                if [a, b].iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(size).all()) {
                    assert!(a.distance(b) / 0.5 <= most * (1.0 + 1e-9), "{low}: {} > {most}", a.distance(b) / 0.5);
                }
            }
        }
    }
    assert!(around > 20, "{around} boxes reach behind the eye");
}

#[test]
fn no_height_changes_the_image_by_more_than_is_said_nor_is_much_more_said() {
    for (k, view) in views().iter().enumerate() {
        let screen = Screen::new(view.pinhole());
        let pass = &Pass::all(view)[0];
        let (mut boxes, mut loose) = (0, 0.0f64);
        for (i, j) in (-8..8).flat_map(|i| (-6..24).map(move |j| (i, j))) {
            let min = DVec3::new(500.0 * f64::from(i), 500.0 * f64::from(j), -200.0);
            let bounds = Aabb { min, max: min + DVec3::new(400.0, 400.0, 300.0) };
            let InView::Maybe(extent @ Some(_)) = pass.plain.in_view(&screen, &bounds) else { continue };
            let most = pass.px_per_height(&screen, &bounds, extent);
            let mut worst = 0.0f64;
            let image = |p: DVec3| view.displace_in(0, p).ok().and_then(|d| view.pinhole().project(d.point).ok());
            for n in 0..64 {
                let at = |k: i32| f64::from(n >> (2 * k) & 3) / 3.0;
                let low = min + DVec3::new(400.0 * at(0), 400.0 * at(1), 270.0 * at(2));
                let (Some((a, _)), Some((b, _))) = (image(low), image(low + DVec3::Z * 30.0)) else { continue };
                if [a, b].iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(2.0 * screen.center).all()) {
                    worst = worst.max(a.distance(b) / 30.0);
                }
            }
            assert!(worst <= most * (1.0 + 1e-9), "view {k}, box {i} {j}: {worst} > {most}");
            boxes += usize::from(worst > 0.0);
            // Far away, where the depths of all points of a box are about equal.
            if worst > 0.0 && j >= 10 {
                loose = loose.max(most / worst);
            }
        }
        assert!(boxes > 60 && loose < 1.02, "view {k}: {boxes} boxes, {loose} times too much");
    }
}
