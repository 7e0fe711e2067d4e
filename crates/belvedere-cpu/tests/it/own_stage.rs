//! A stage of which the renderers know only the map, its inverse and its derivative.

use crate::exact::{Difference, difference, exactly, trace};
use crate::support::{hills, layer, pinhole, render, scene, terrain};
use crate::support_views::{spline, turns};
use belvedere_core::grid::Grid;
use belvedere_core::map::StageMap;
use belvedere_core::map::curved_rays::Model;
use belvedere_core::{DMat3, DVec2, DVec3, EarthCurvature, Miss, SpaceMap, Stage, TerrainDisocclusion, View};
use belvedere_scene::{BoxLayer, BoxShape, Color, LayerKind, Scene};

/// Moves ground sideways and up along y: `x' = x + sway sin(y / reach)`, `z' = z + rise y^2 / (y^2 + 4 reach^2)`. Nothing moves south
/// of `border`.
#[derive(Debug)]
struct Dummy {
    sway: f64,
    rise: f64,
    reach: f64,
    border: f64,
}

const DUMMY: Dummy = Dummy { sway: 40.0, rise: 90.0, reach: 250.0, border: f64::NEG_INFINITY };

impl Dummy {
    fn moved(&self, y: f64) -> Result<DVec3, Miss> {
        let (s, r) = (y * y, 4.0 * self.reach * self.reach);
        let by = DVec3::new(self.sway * (y / self.reach).sin(), 0.0, self.rise * s / (s + r));
        if by.is_finite() && y >= self.border { Ok(by) } else { Err(Miss::OutsideDomain) }
    }
}

impl SpaceMap for Dummy {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        Ok(p + self.moved(p.y)?)
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        Ok(p_displaced - self.moved(p_displaced.y)?)
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        self.moved(p.y)?;
        let r = 4.0 * self.reach * self.reach;
        let across = self.sway / self.reach * (p.y / self.reach).cos();
        let up = self.rise * 2.0 * p.y * r / (p.y * p.y + r).powi(2);
        Ok(DMat3::from_cols(DVec3::X, DVec3::new(across, 1.0, up), DVec3::Z))
    }
}

impl StageMap for Dummy {}

fn town() -> Scene {
    let hf = hills(24, 50.0, 120.0, 71);
    let tower = |x: f64, y: f64, yaw: f64| {
        let base = DVec3::new(x, y, hf.surface_at(DVec2::new(x, y)).expect("on the hills") - 20.0);
        BoxShape { base, size: DVec3::new(60.0, 40.0, 150.0), yaw, color: Color::rgb(190, 180, 170) }
    };
    let towers = vec![tower(-150.0, -160.0, 0.3), tower(120.0, 40.0, 1.0), tower(-60.0, 220.0, 0.0)];
    let ground = layer("ground", LayerKind::Terrain(terrain(hf)));
    scene(vec![ground, layer("towers", LayerKind::Boxes(BoxLayer::new(towers)))])
}

/// Views with the test stage alone and between other stages.
fn views() -> Vec<(&'static str, View)> {
    let camera = pinhole(DVec3::new(-100.0, -900.0, 500.0), DVec3::new(0.0, 0.0, 60.0), 50.0, [96, 54]);
    let own = || Stage::own(DUMMY);
    let border = Stage::own(Dummy { border: -200.0, ..DUMMY });
    let earth = Stage::EarthCurvature(EarthCurvature { eye: camera.eye, radius: 2e4, refraction: 0.13 });
    let values = (0..49).map(|i| 20.0 * f64::from(i % 5)).collect();
    let grid = Grid::new(DVec2::new(-600.0, 600.0), DVec2::splat(200.0), 7, 7, values).unwrap();
    let ground = Stage::TerrainDisocclusion(TerrainDisocclusion::new(grid));
    let rays = turns(camera.clone(), Model::Modified, &[(900.0, 300.0)]).stages()[0].clone();
    let bent = spline(camera.clone(), "progressive");
    let bend = bent.stages()[0].clone();
    let of = |stages: Vec<Stage>| View::new(camera.clone(), stages).unwrap();
    vec![
        ("own", of(vec![own()])),
        ("with a border", of(vec![border])),
        ("twice", of(vec![own(), own()])),
        ("after earth and ground", of(vec![earth, ground, own()])),
        ("before curved rays", of(vec![own(), rays])),
        ("after a spline", View::new(bent.pinhole().clone(), vec![bend, own()]).unwrap()),
    ]
}

#[test]
fn rasteriser_and_tracer_agree_on_a_stage_that_they_do_not_know() {
    let scene = town();
    for (name, view) in views() {
        let d: Difference = difference(&scene, &view);
        assert!(d.judged * 3 > d.pixels && d.is_small(), "{name}: {d:?}");
        // The stage has an effect: the straight picture is another one.
        let (bent, straight) = (trace(&scene, &view, &exactly()), trace(&scene, &view.straightened(), &exactly()));
        let other = bent.depth.iter().zip(&straight.depth).filter(|(a, b)| (*a / *b - 1.0).abs() > 0.01).count();
        assert!(other * 20 > d.pixels, "{name}: {other} pixels differ from the straight picture");
    }
}

#[test]
fn what_is_drawn_of_an_unknown_stage_lies_where_the_view_has_it() {
    let scene = town();
    for (name, view) in views() {
        let frame = render(&scene, &view, &exactly());
        let mut seen = 0;
        for i in (0..frame.id.len()).filter(|i| frame.id[*i] != 0).step_by(17) {
            let pixel = DVec2::new((i % frame.width) as f64 + 0.5, (i / frame.width) as f64 + 0.5);
            let point = view.ray(pixel).at(f64::from(frame.depth[i])).unwrap().point;
            let image = view.project(point).unwrap();
            assert!(image.pixel.distance(pixel) < 1e-6, "{name} {pixel}: {}", image.pixel);
            let up = scene.terrain().and_then(|t| t.surface_at(point.truncate())).map_or(0.0, |z| point.z - z);
            // Towers begin 20 m below the ground, and next to a border one sees their lower parts.
            assert!(up > -21.0, "{name} {pixel}: {up} m above the ground");
            seen += 1;
        }
        assert!(seen > 50, "{name}: {seen}");
    }
}

#[test]
fn straight_lines_bend_through_an_unknown_stage() {
    let (_, view) = views().remove(0);
    let off = |view: &View| {
        let [a, b, c] = [-300.0, 100.0, 400.0].map(|y| view.project(DVec3::new(0.0, y, 0.0)).unwrap().pixel);
        (b - a).perp_dot(c - a).abs() / (c - a).length()
    };
    let [bent, straight] = [off(&view), off(&view.straightened())];
    assert!(bent > 0.3 && straight < 1e-9, "{bent} and {straight} px");
}

#[test]
fn own_maps_stand_between_spline_and_curved_rays() {
    let (_, view) = views().remove(4);
    let stages = view.stages().iter().rev().cloned().collect();
    let error = View::new(view.pinhole().clone(), stages).unwrap_err().to_string();
    assert!(error.contains("stage own cannot follow stage curved_rays"), "{error}");
}

#[test]
fn a_body_turns_as_the_derivative_of_an_unknown_stage_does() {
    let (_, view) = views().remove(0);
    let foot = DVec3::new(30.0, 120.0, 10.0);
    let rotation = view.body_motion(foot).unwrap().rotation();
    let j = DUMMY.jacobian(foot).unwrap();
    assert!((rotation.determinant() - 1.0).abs() < 1e-12);
    // Samples are the nearest, so the remaining error is symmetric.
    let left = rotation.transpose() * j;
    assert!((left - left.transpose()).to_cols_array().iter().all(|v| v.abs() < 1e-9), "{left}");
}
