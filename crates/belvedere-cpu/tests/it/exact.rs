//! The rasteriser against the exact tracer: two ways to a picture that share nothing but the colours.

use crate::support::{Random, hills, layer, options, pinhole, render, scene, terrain};
use crate::support_views::{spline, turns, views};
use belvedere_core::grid::Grid;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{
    Camera, CurvedRays, DVec2, DVec3, EarthCurvature, Pinhole, Projection, SplineBend, Stage, TerrainDisocclusion, View,
};
use belvedere_cpu::{ExactRenderer, Tracer};
use belvedere_scene::{
    Aux, BoxLayer, BoxShape, Color, Frame, Heightfield, LayerKind, Light, NodeState, Progress, RenderJob,
    RenderOptions, Renderer, Scene, builtin,
};
use std::f64::consts::TAU;

/// Tolerance of the rasteriser in the comparisons: half a pixel of bend would be seen in the depth of grazing ground.
const FINE_PX: f64 = 0.02;

fn trace(scene: &Scene, view: &View, options: &RenderOptions) -> Frame {
    let job = RenderJob { scene, view, light: &Light::default(), options, progress: &Progress::silent() };
    ExactRenderer.render(&job).expect("picture is possible")
}

/// What two pictures have in common.
#[derive(Debug, Default, Clone, Copy)]
struct Difference {
    pixels: usize,
    /// Pixels off the silhouettes.
    judged: usize,
    /// Of those, with another id, and with the same id and another depth.
    ids: usize,
    depths: usize,
}

impl Difference {
    fn add(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.judged += other.judged;
        self.ids += other.ids;
        self.depths += other.depths;
    }

    /// At most one in a thousand pixels off the silhouettes.
    fn is_small(&self) -> bool {
        (self.ids + self.depths) as f64 <= 1e-3 * self.pixels as f64
    }
}

/// Compares off the silhouettes: a pixel lies on one if a neighbour of the traced picture has another id, or its depth jumps by more than 4 %.
///
/// Depths must agree within 1e-4 of themselves, and what the surface gains in depth over the two hundredths of a pixel that the
/// rasteriser may be off.
fn compare(reference: &Frame, other: &Frame) -> Difference {
    let (w, h) = (reference.width, reference.height);
    let mut out = Difference { pixels: w * h, ..Difference::default() };
    for i in 0..w * h {
        let (x, y, id, depth) = (i % w, i / w, reference.id[i], f64::from(reference.depth[i]));
        let mut gain = 0.0f64;
        let mut edge = false;
        for v in y.saturating_sub(1)..(y + 2).min(h) {
            for u in x.saturating_sub(1)..(x + 2).min(w) {
                let k = v * w + u;
                let step = if id == 0 { 0.0 } else { (f64::from(reference.depth[k]) / depth - 1.0).abs() };
                edge |= reference.id[k] != id || step > 0.04;
                gain = gain.max(step);
            }
        }
        if edge {
            continue;
        }
        out.judged += 1;
        if other.id[i] != id {
            out.ids += 1;
        } else if id != 0 && !((f64::from(other.depth[i]) / depth - 1.0).abs() <= 1e-4 + FINE_PX * gain) {
            out.depths += 1;
        }
    }
    out
}

fn difference(scene: &Scene, view: &View) -> Difference {
    let fine = RenderOptions { tolerance_px: FINE_PX, ..options(1) };
    compare(&trace(scene, view, &fine), &render(scene, view, &fine))
}

fn tower(hf: &Heightfield, x: f64, y: f64, yaw: f64) -> BoxShape {
    let z = hf.surface_at(DVec2::new(x, y)).expect("on the hills") - 20.0;
    BoxShape { base: DVec3::new(x, y, z), size: DVec3::new(60.0, 40.0, 150.0), yaw, color: Color::rgb(190, 180, 170) }
}

fn with_towers(hf: Heightfield) -> Scene {
    let boxes = [(-120.0, 60.0, 0.3), (140.0, -80.0, 1.1), (20.0, 260.0, 0.0)].map(|(x, y, yaw)| tower(&hf, x, y, yaw));
    scene(vec![
        layer("ground", LayerKind::Terrain(terrain(hf))),
        layer("towers", LayerKind::Boxes(BoxLayer { boxes: boxes.to_vec() })),
    ])
}

fn hilly() -> Scene {
    with_towers(hills(24, 50.0, 160.0, 7))
}

/// A trench across the hills.
fn trench(depth: f64) -> TerrainDisocclusion {
    let n = 31;
    let values = (0..n * n)
        .map(|i| {
            let (c, r) = ((i % n) as f64 - 15.0, (i / n) as f64 - 15.0);
            -depth * (-(c * 0.6 + r).powi(2) / 30.0).exp() * (1.0 - (c / 15.0).powi(2)) * (1.0 - (r / 15.0).powi(2))
        })
        .collect();
    let grid = Grid::new(DVec2::new(-525.0, 525.0), DVec2::splat(35.0), n, n, values).expect("well formed");
    TerrainDisocclusion::new(grid)
}

/// Named views of all stages and of chains of them.
fn all_views(image: [u32; 2]) -> Vec<(&'static str, View)> {
    let mut out = views(image);
    let low = pinhole(DVec3::new(-300.0, -560.0, 240.0), DVec3::new(30.0, 100.0, 20.0), 55.0, image);
    let earth = EarthCurvature { eye: low.eye, radius: 8_000.0, refraction: 0.13 };
    let ground = Stage::TerrainDisocclusion(trench(90.0));
    out.push(("a trench", View::new(low.clone(), vec![ground.clone()]).expect("in order")));
    let planet = vec![Stage::EarthCurvature(earth), ground.clone()];
    out.push(("a trench on a small planet", View::new(low, planet).expect("in order")));
    let bent = out.iter().find(|(name, _)| *name == "progressive").map(|(_, v)| v.clone()).expect("listed");
    let stages = [&[ground], bent.stages()].concat();
    out.push(("a trench under a spline", View::new(bent.pinhole().clone(), stages).expect("in order")));
    out
}

#[test]
fn rasteriser_and_tracer_agree_on_all_stages() {
    let scene = hilly();
    for (name, view) in all_views([160, 120]) {
        let d = difference(&scene, &view);
        assert!(d.judged > d.pixels / 2, "{name}: {d:?}");
        assert!(d.is_small(), "{name}: {d:?}");
    }
}

#[test]
fn rasteriser_and_tracer_agree_on_built_in_scenes() {
    for (name, made) in [("massif", builtin::massif(7, 257)), ("street", builtin::street(7))] {
        let (scene, camera) = made.expect("the built-in scene can be made");
        let ph = pinhole(camera.eye, camera.look_at, camera.fov_y.to_degrees(), [320, 180]);
        let ground = ReferencePlane::level(camera.look_at.z);
        let document = PresetDocument::builtin("progressive").expect("built in");
        let bend = SplineBend::new(&ph, &document, &ground, default_pivot(&ph, &ground)).expect("fits");
        let bent = View::new(bend.adapted_pinhole(&ph), vec![Stage::SplineBend(bend)]).expect("in order");
        for (kind, view) in [("straight", View::straight(ph)), ("bent", bent)] {
            let d = difference(&scene, &view);
            assert!(d.judged > d.pixels / 3, "{name} {kind}: {d:?}");
            assert!(d.is_small(), "{name} {kind}: {d:?}");
        }
    }
}

/// A camera around the hills, and one of the kinds of view, at random; `None` where the parameters make no view.
fn random_view(random: &mut Random, kind: usize, image: [u32; 2]) -> Option<View> {
    let around = DVec2::from_angle(random.range(0.0, TAU)) * random.range(350.0, 900.0);
    let eye = around.extend(random.range(180.0, 700.0));
    let at = DVec3::new(random.range(-150.0, 150.0), random.range(-150.0, 150.0), random.range(-40.0, 60.0));
    let lens = if kind == 0 && random.next() < 0.3 {
        Projection::Orthographic { height: random.range(300.0, 900.0) }
    } else {
        Projection::Perspective { fov_y: random.range(25.0, 65.0).to_radians() }
    };
    let ph = Pinhole::look_at(eye, at, DVec3::Z, lens, image, 1.0, None).ok()?;
    let earth = Stage::EarthCurvature(EarthCurvature { eye, radius: random.range(5e3, 5e4), refraction: 0.13 });
    let ground = Stage::TerrainDisocclusion(trench(random.range(-60.0, 100.0)));
    let stages = match kind {
        0 => vec![],
        1 => vec![earth],
        2 => vec![ground],
        3 => return Some(spline(ph, if random.next() < 0.5 { "progressive" } else { "degressive" })),
        4 => {
            let bent = spline(ph, "degressive");
            return View::new(bent.pinhole().clone(), [&[earth, ground], bent.stages()].concat()).ok();
        }
        kind => {
            let model = [Model::Modified, Model::Original, Model::C0, Model::C2][kind % 4];
            let rays = random_turn(random, &ph, model)?;
            if kind < 9 { vec![rays] } else { vec![earth, ground, rays] }
        }
    };
    View::new(ph, stages).ok()
}

fn random_turn(random: &mut Random, ph: &Pinhole, model: Model) -> Option<Stage> {
    let forward = ph.forward.with_z(0.0).normalize();
    let at = random.range(0.5, 1.1) * ph.eye.truncate().length();
    let plane = |share: f64| ph.eye + forward * at * share;
    let spec = TurnSpec {
        viewpoint: ph.eye + DVec3::Z * random.range(-60.0, 260.0) + ph.right * random.range(-80.0, 80.0),
        t0: plane(random.range(0.75, 0.92)),
        t1: plane(1.0),
        t2: plane(random.range(1.08, 1.25)),
        pencil: Pencil::Parallel { normal: -forward },
        m: Sharpness::Bend,
    };
    CurvedRays::new(ph, model, &[spec]).ok().map(Stage::CurvedRays)
}

#[test]
fn rasteriser_and_tracer_agree_on_200_random_views() {
    const VIEWS: usize = 200;
    let scenes: Vec<Scene> = (0..4).map(|i| with_towers(hills(24, 50.0, 120.0 + 20.0 * i as f64, 70 + i))).collect();
    let mut random = Random::new(20_100_726);
    let (mut total, mut judged_views, mut worst) = (Difference::default(), 0, Vec::new());
    for i in 0.. {
        assert!(i < 3 * VIEWS, "only {judged_views} of {i} random views are possible");
        let Some(view) = random_view(&mut random, judged_views % 10, [64, 36]) else { continue };
        let d = difference(&scenes[judged_views % scenes.len()], &view);
        total.add(d);
        if (d.ids + d.depths) as f64 > 2e-3 * d.pixels as f64 {
            let names: Vec<&str> = view.stages().iter().map(Stage::name).collect();
            worst.push(format!("view {judged_views} {names:?}: {d:?}"));
        }
        judged_views += 1;
        if judged_views == VIEWS {
            break;
        }
    }
    assert!(total.judged > total.pixels / 2, "{total:?}");
    assert!(total.is_small(), "{total:?}; {worst:#?}");
}

/// A heightfield with other node positions.
fn placed(hf: &Heightfield, north_west: DVec2, spacing: DVec2) -> Heightfield {
    let (heights, states) = (hf.heights().to_vec(), hf.states().to_vec());
    Heightfield::new(north_west, spacing, hf.cols(), hf.rows(), heights, states).expect("well formed")
}

fn ground_only(hf: Heightfield) -> Scene {
    scene(vec![layer("ground", LayerKind::Terrain(terrain(hf)))])
}

/// The rasteriser draws `right`, the tracer is given `wrong`: must be noticed; the same with `right` for both must not.
fn must_notice(name: &str, right: (&Scene, &View), wrong: (&Scene, &View)) {
    let fine = RenderOptions { tolerance_px: FINE_PX, ..options(1) };
    let drawn = render(right.0, right.1, &fine);
    let clean = compare(&trace(right.0, right.1, &fine), &drawn);
    assert!(clean.is_small(), "{name}: without the fault {clean:?}");
    let faulty = compare(&trace(wrong.0, wrong.1, &fine), &drawn);
    assert!(!faulty.is_small(), "{name} passes unnoticed: {faulty:?}");
    assert!((faulty.ids + faulty.depths) * 20 > faulty.judged, "{name} is hardly noticed: {faulty:?}");
}

fn high() -> Pinhole {
    pinhole(DVec3::new(0.0, -700.0, 520.0), DVec3::new(0.0, 0.0, 0.0), 50.0, [160, 120])
}

#[test]
fn a_bend_wrong_by_one_percent_is_noticed() {
    let scene = hilly();
    let (rise, more) = (220.0, 220.0 * 1.01);
    let [right, wrong] = [rise, more].map(|rise| turns(high(), Model::Modified, &[(600.0, rise)]));
    must_notice("a turn", (&scene, &right), (&scene, &wrong));
    let [right, wrong] = [90.0, 90.0 * 1.01]
        .map(|depth| View::new(high(), vec![Stage::TerrainDisocclusion(trench(depth))]).expect("in order"));
    let fine = RenderOptions { tolerance_px: FINE_PX, ..options(1) };
    let faulty = compare(&trace(&scene, &wrong, &fine), &render(&scene, &right, &fine));
    assert!(!faulty.is_small(), "a trench passes unnoticed: {faulty:?}");
}

#[test]
fn swapped_weights_are_noticed() {
    // The weights of a cell's corners: the picture of the mirrored ground, mirrored, has the other diagonal.
    let hf = hills(24, 50.0, 160.0, 7);
    let n = hf.cols();
    let flip = |values: &[f32]| (0..n * n).map(|i| values[i / n * n + n - 1 - i % n]).collect::<Vec<f32>>();
    let states = vec![NodeState::Measured; n * n];
    let mirrored = Heightfield::new(hf.north_west(), hf.spacing(), n, n, flip(hf.heights()), states);
    let view = View::straight(high());
    let fine = RenderOptions { tolerance_px: FINE_PX, ..options(1) };
    let drawn = render(&ground_only(hf), &view, &fine);
    let mut traced = trace(&ground_only(mirrored.expect("well formed")), &view, &fine);
    for row in traced.depth.chunks_mut(160) {
        row.reverse();
    }
    traced.id.chunks_mut(160).for_each(<[u32]>::reverse);
    let faulty = compare(&traced, &drawn);
    assert!(!faulty.is_small(), "the other diagonal passes unnoticed: {faulty:?}");
}

#[test]
fn a_cell_too_many_is_noticed() {
    let hf = hills(24, 50.0, 160.0, 7);
    let view = View::straight(high());
    let off = placed(&hf, hf.north_west() + DVec2::new(hf.spacing().x, 0.0), hf.spacing());
    must_notice("off by one cell", (&ground_only(hf), &view), (&ground_only(off), &view));
}

#[test]
fn a_missing_arc_length_table_is_noticed() {
    // The parameter of the curve taken for its arc length: places along the heading (north) lie off by a mean of L.
    let hf = hills(24, 50.0, 160.0, 7);
    let view = spline(high(), "progressive");
    let Some(Stage::SplineBend(bend)) = view.stages().first() else { panic!("a spline was asked for") };
    let rate = bend.curve().length();
    assert!((rate - 1.0).abs() > 1e-3, "the curve is {rate} units long");
    let pivot = bend.pivot().y;
    let nw = DVec2::new(hf.north_west().x, pivot + (hf.north_west().y - pivot) * rate);
    let stretched = placed(&hf, nw, hf.spacing() * DVec2::new(1.0, rate));
    must_notice("no arc length", (&ground_only(hf), &view), (&ground_only(stretched), &view));
}

#[test]
fn a_hit_is_the_point_of_the_ray_on_the_surface() {
    let scene = hilly();
    let hf = scene.terrain().expect("hills");
    for (name, view) in all_views([64, 48]) {
        let tracer = Tracer::new(&scene, &view);
        let mut hits = 0;
        for i in 0..64 * 48 {
            let pixel = DVec2::new(f64::from(i % 64) + 0.37, f64::from(i / 64) + 0.81);
            let Some(seen) = tracer.first_hit(pixel) else { continue };
            hits += 1;
            let on_ray = view.ray(pixel).at(seen.depth).expect("the ray has the point");
            assert_eq!((on_ray.point, on_ray.segment), (seen.point, seen.segment));
            if seen.layer == 0 {
                let z = hf.surface_at(seen.point.truncate()).expect("on the hills");
                assert!((seen.point.z - z).abs() < 1e-7, "{name}: {} m over the ground", seen.point.z - z);
            }
        }
        assert!(hits > 64 * 48 / 3, "{name}: {hits} hits");
    }
}

#[test]
fn nothing_lies_before_a_hit() {
    // Tiny steps along the ray up to the hit never change the side of the ground: no hill is stepped over.
    let scene = ground_only(hills(60, 20.0, 220.0, 33));
    let hf = scene.terrain().expect("hills");
    for (name, view) in all_views([48, 36]) {
        let tracer = Tracer::new(&scene, &view);
        for i in 0..48 * 36 {
            let pixel = DVec2::new(f64::from(i % 48) + 0.5, f64::from(i / 48) + 0.5);
            let (ray, seen) = (view.ray(pixel), tracer.first_hit(pixel));
            let end = seen.map_or(1500.0, |s| s.depth * (1.0 - 1e-9));
            let mut side: Option<bool> = None;
            for k in 0..400 {
                let Ok(p) = ray.at(1.0 + (end - 1.0) * f64::from(k) / 400.0) else { continue };
                let now = hf.surface_at(p.point.truncate()).map(|z| p.point.z > z);
                if let (Some(a), Some(b)) = (side, now) {
                    assert_eq!(a, b, "{name} {pixel}: ground at depth {} before {seen:?}", p.depth);
                }
                side = now;
            }
        }
    }
}

#[test]
fn pictures_do_not_depend_on_threads_and_stop_when_asked() {
    let scene = hilly();
    let (_, view) = all_views([80, 60]).swap_remove(4);
    let draw = |threads| trace(&scene, &view, &RenderOptions { threads, aux: Aux { world: true }, ..options(4) });
    let (one, three) = (draw(1), draw(3));
    assert!(one.color == three.color && one.depth == three.depth && one.id == three.id);
    let world = one.world.expect("asked for");
    assert!(one.id.iter().zip(&world).all(|(&id, p)| (id == 0) == p[0].is_nan()));
    let progress = Progress::silent();
    progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let (light, options) = (Light::default(), options(1));
    let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
    assert!(ExactRenderer.render(&job).is_err());
}
