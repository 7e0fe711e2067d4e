//! Compares the rasteriser with the exact tracer. The two ways to make a picture have only the colours in common.

use crate::support::{Random, hills, layer, options, pinhole, render, scene, terrain};
use crate::support_views::{spline, turns, views};
use belvedere_core::grid::Grid;
use belvedere_core::map::curved_rays::{Model, Pencil, Shape, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{
    CurvedRays, DVec2, DVec3, EarthCurvature, Pinhole, Projection, SplineBend, Stage, TerrainDisocclusion, View,
};
use belvedere_cpu::ExactRenderer;
use belvedere_scene::{
    Aux, BoxLayer, BoxShape, Color, Frame, Heightfield, LayerKind, Light, Mesh, MeshColors, MeshLayer, NodeState,
    Progress, RenderJob, RenderOptions, Renderer, Scene,
};
use belvedere_sight::trace::Tracer;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Largest allowed relative difference in depth.
const DEPTH: f64 = 1e-4;

/// Options with the default tolerance, and depths by the true map, which is what `--aux depth` requests.
pub(crate) fn exactly() -> RenderOptions {
    let options = options(1);
    assert_eq!(options.tolerance_px, RenderOptions::default().tolerance_px);
    RenderOptions { aux: Aux { exact: true, ..Aux::default() }, ..options }
}

pub(crate) fn trace(scene: &Scene, view: &View, options: &RenderOptions) -> Frame {
    let job = RenderJob { scene, view, light: &Light::default(), options, progress: &Progress::silent() };
    ExactRenderer.render(&job).expect("picture is possible")
}

/// The result of comparing two pictures.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Difference {
    pub(crate) pixels: usize,
    /// Number of pixels away from the silhouettes.
    pub(crate) judged: usize,
    /// How many of those pixels have another id, and how many have the same id and another depth.
    pub(crate) ids: usize,
    depths: usize,
}

impl Difference {
    pub(crate) fn add(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.judged += other.judged;
        self.ids += other.ids;
        self.depths += other.depths;
    }

    /// Requires that at most one in a thousand pixels away from the silhouettes differs in id, and one in a thousand in depth.
    pub(crate) fn is_small(&self) -> bool {
        self.is_below([1e-3; 2])
    }

    /// Requires at most these shares of pixels that differ in id, and in depth.
    pub(crate) fn is_below(&self, [ids, depths]: [f64; 2]) -> bool {
        self.ids as f64 <= ids * self.judged as f64 && self.depths as f64 <= depths * self.judged as f64
    }
}

/// Compares the pixels away from the silhouettes. A pixel is on a silhouette if a neighbour in the traced picture has another id, or if
/// the depth between them jumps by more than [`STEP`].
fn compare(reference: &Frame, other: &Frame) -> Difference {
    let (w, h) = (reference.width, reference.height);
    let mut out = Difference { pixels: w * h, ..Difference::default() };
    for i in 0..w * h {
        if on_silhouette(reference, i) {
            continue;
        }
        out.judged += 1;
        let (id, depth) = (reference.id[i], f64::from(reference.depth[i]));
        if other.id[i] != id {
            out.ids += 1;
        } else if id != 0 && !((f64::from(other.depth[i]) / depth - 1.0).abs() <= DEPTH) {
            out.depths += 1;
        }
    }
    out
}

/// Largest relative step of depth between neighbours on one surface.
const STEP: f64 = 0.04;

pub(crate) fn on_silhouette(frame: &Frame, i: usize) -> bool {
    let (w, h) = (frame.width, frame.height);
    let (x, y, id, depth) = (i % w, i / w, frame.id[i], frame.depth[i]);
    (y.saturating_sub(1)..(y + 2).min(h)).any(|v| {
        (x.saturating_sub(1)..(x + 2).min(w)).any(|u| {
            let k = v * w + u;
            frame.id[k] != id || (id != 0 && f64::from((frame.depth[k] / depth - 1.0).abs()) > STEP)
        })
    })
}

pub(crate) fn difference(scene: &Scene, view: &View) -> Difference {
    compare(&trace(scene, view, &exactly()), &render(scene, view, &exactly()))
}

fn tower(hf: &Heightfield, x: f64, y: f64, yaw: f64) -> BoxShape {
    let z = hf.surface_at(DVec2::new(x, y)).expect("on the hills") - 20.0;
    BoxShape { base: DVec3::new(x, y, z), size: DVec3::new(60.0, 40.0, 150.0), yaw, color: Color::rgb(190, 180, 170) }
}

/// The built-in church at twice its size; with a fault, two of its corners are exchanged.
fn church(at: DVec3, faulty: bool) -> LayerKind {
    let (scene, _) = belvedere_builtin::church().expect("the church can be built");
    let Some(made) = scene.layers[0].kind.mesh() else { panic!("a mesh") };
    let swapped = |v: u32| match v {
        4 if faulty => 40,
        40 if faulty => 4,
        v => v,
    };
    let places: Vec<DVec3> = (0..made.mesh.vertex_count() as u32).map(|v| at + 2.0 * made.mesh.vertex(v)).collect();
    let triangles = made.mesh.triangles().iter().map(|t| t.map(swapped)).collect();
    let mesh = Mesh::new(&places, triangles, MeshColors::Layer).expect("well formed");
    LayerKind::Mesh(MeshLayer::new(mesh, Color::rgb(220, 210, 190)))
}

fn with_towers(hf: Heightfield) -> Scene {
    let z = hf.surface_at(DVec2::new(-150.0, -160.0)).expect("on the hills");
    let boxes = [(-120.0, 60.0, 0.3), (140.0, -80.0, 1.1), (20.0, 260.0, 0.0)].map(|(x, y, yaw)| tower(&hf, x, y, yaw));
    scene(vec![
        layer("ground", LayerKind::Terrain(terrain(hf))),
        layer("towers", LayerKind::Boxes(BoxLayer::new(boxes.to_vec()))),
        layer("church", church(DVec3::new(-150.0, -160.0, z - 10.0), false)),
    ])
}

fn hilly() -> Scene {
    with_towers(hills(24, 50.0, 160.0, 7))
}

/// A trench through the hills.
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
    for (name, made) in [("massif", belvedere_builtin::massif(7, 257)), ("street", belvedere_builtin::street(7))] {
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

/// A camera around the hills and one of the kinds of view, at random; `None` where the parameters give no valid view.
fn random_view(random: &mut Random, kind: usize, image: [u32; 2]) -> Option<View> {
    let around = DVec2::from_angle(random.range(0.0, TAU)) * random.range(350.0, 900.0);
    let eye = around.extend(random.range(180.0, 700.0));
    let at = DVec3::new(random.range(-150.0, 150.0), random.range(-150.0, 150.0), random.range(-40.0, 60.0));
    let lens = if kind == 0 && random.unit() < 0.3 {
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
        3 => return Some(spline(ph, if random.unit() < 0.5 { "progressive" } else { "degressive" })),
        4 => {
            let bent = spline(ph, "degressive");
            return View::new(bent.pinhole().clone(), [&[earth, ground], bent.stages()].concat()).ok();
        }
        kind => {
            let model = MODELS[kind % 5];
            match kind {
                5..10 => vec![random_turns(random, &ph, model, 1)?],
                10 => vec![earth, ground, random_turns(random, &ph, model, 1)?],
                11 => return under_spline(random, &ph, ground, model),
                kind => vec![random_turns(random, &ph, MODELS[kind - 12], 2)?],
            }
        }
    };
    View::new(ph, stages).ok()
}

/// Kinds of random views, see [`random_view`].
const KINDS: usize = 17;
const MODELS: [Model; 5] = [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular];

/// Ground that is displaced by disocclusion, under a spline, seen along curved rays.
fn under_spline(random: &mut Random, ph: &Pinhole, ground: Stage, model: Model) -> Option<View> {
    let bent = spline(ph.clone(), "progressive");
    let rays = random_turns(random, bent.pinhole(), model, 1)?;
    View::new(bent.pinhole().clone(), [&[ground], bent.stages(), &[rays]].concat()).ok()
}

/// Rays of one or two turns that look over the hills.
fn random_turns(random: &mut Random, ph: &Pinhole, model: Model, turns: usize) -> Option<Stage> {
    let forward = ph.forward.with_z(0.0).normalize();
    let far = random.range(0.5, 1.1) * ph.eye.truncate().length();
    let mut rise = 0.0;
    let specs: Vec<TurnSpec> = (0..turns)
        .map(|k| {
            let at = far * (1.0 + 0.55 * k as f64);
            let plane = |share: f64| ph.eye + forward * at * share;
            rise += random.range(-60.0, 260.0) / turns as f64;
            TurnSpec {
                viewpoint: ph.eye + DVec3::Z * rise + ph.right * random.range(-80.0, 80.0),
                t0: plane(random.range(0.75, 0.92)),
                t1: plane(1.0),
                t2: plane(random.range(1.08, 1.25)),
                pencil: Pencil::Parallel { normal: -forward },
                // Around 1.05 a conic arc is a parabola.
                m: match model {
                    Model::Modified if random.unit() < 0.7 => Sharpness::Value(random.range(0.6, 1.5)),
                    _ => Sharpness::Bend,
                },
            }
        })
        .collect();
    CurvedRays::new(ph, model, &specs).ok().map(Stage::CurvedRays)
}

/// For a lattice of pixels of a picture, how often the seen place is on each kind of curve.
fn count_curves(scene: &Scene, view: &View, counts: &mut BTreeMap<String, usize>) {
    let tracer = Tracer::new(scene, view);
    let [w, h] = view.pinhole().image.map(f64::from);
    let names: Vec<&str> = view.stages().iter().map(|s| s.name()).collect();
    for i in 0..96 {
        let pixel = DVec2::new((f64::from(i % 12) + 0.5) * w / 12.0, (f64::from(i / 12) + 0.5) * h / 8.0);
        let Some(seen) = tracer.first_hit(pixel) else { continue };
        let mut add = |name: String| *counts.entry(name).or_default() += 1;
        add(format!("stages {}", names.join(" ")));
        let turned = view.curved_rays().filter(|_| names.len() == 1);
        let Some(rays) = turned else { continue };
        let pieces = view.ray(pixel).pieces().expect("curved rays alone have pieces");
        let piece = pieces.iter().find(|p| seen.depth <= p.depth[1]).expect("the last one has no end");
        let shape = match piece.shape {
            Shape::Line { .. } if piece.segment > 0 => "a line past a turn".to_owned(),
            Shape::Line { .. } => "a line".to_owned(),
            Shape::Conic(arc) if (arc.curve.weight - 1.0).abs() < 1e-12 => "a parabola".to_owned(),
            Shape::Conic(arc) if arc.curve.weight < 1.0 => "an ellipse".to_owned(),
            Shape::Conic(_) => "a hyperbola".to_owned(),
            Shape::C2(_) => "a quartic".to_owned(),
        };
        add(shape);
        add(format!("segment {} of {} turns", piece.segment, rays.turn_count()));
    }
}

#[test]
fn rasteriser_and_tracer_agree_on_random_views_of_all_stages() {
    const VIEWS: usize = 12 * KINDS;
    let scenes: Vec<Scene> = (0..4).map(|i| with_towers(hills(24, 50.0, 120.0 + 20.0 * i as f64, 70 + i))).collect();
    let mut random = Random::new(20_100_726);
    let (mut total, mut judged_views, mut worst) = (Difference::default(), 0, Vec::new());
    let mut curves = BTreeMap::new();
    for i in 0.. {
        assert!(i < 3 * VIEWS, "only {judged_views} of {i} random views are possible");
        let Some(view) = random_view(&mut random, judged_views % KINDS, [64, 36]) else { continue };
        let scene = &scenes[judged_views % scenes.len()];
        let d = difference(scene, &view);
        total.add(d);
        count_curves(scene, &view, &mut curves);
        if (d.ids + d.depths) as f64 > 2e-3 * d.pixels as f64 {
            let names: Vec<&str> = view.stages().iter().map(|s| s.name()).collect();
            worst.push(format!("view {judged_views} {names:?}: {d:?}"));
        }
        judged_views += 1;
        if judged_views == VIEWS {
            break;
        }
    }
    assert!(total.judged > total.pixels / 2, "{total:?}");
    assert!(total.is_small(), "{total:?}; {worst:#?}");
    // Every kind of curve and every chain of stages has been seen.
    let wanted = ["a line", "a line past a turn", "a parabola", "an ellipse", "a hyperbola", "a quartic"];
    for name in wanted.iter().map(ToString::to_string).chain((0..5).map(|k| format!("segment {k} of 2 turns"))) {
        assert!(curves.get(&name).is_some_and(|n| *n >= 20), "{name}: {curves:#?}");
    }
    let chains = curves.keys().filter(|k| k.starts_with("stages ")).count();
    assert!(chains >= 8, "{curves:#?}");
}

#[test]
fn less_detail_and_the_tracer_agree_on_random_views_of_all_stages() {
    const VIEWS: usize = 2 * KINDS;
    let scenes: Vec<Scene> = (0..2).map(|i| with_towers(hills(769, 1.5, 70.0 + 50.0 * i as f64, 70 + i))).collect();
    let options = RenderOptions { lod_px: RenderOptions::default().lod_px, ..exactly() };
    let mut random = Random::new(19_970_803);
    let (mut total, mut views, mut worst, mut less) = (Difference::default(), 0, Vec::new(), 0);
    for i in 0..3 * VIEWS {
        if views == VIEWS {
            break;
        }
        let Some(view) = random_view(&mut random, i % KINDS, [144, 81]) else { continue };
        let scene = &scenes[views % scenes.len()];
        let drawn = render(scene, &view, &options);
        less += usize::from(2 * drawn.stats.triangles_drawn < drawn.stats.triangles_in);
        let d = compare(&trace(scene, &view, &exactly()), &drawn);
        total.add(d);
        if !d.is_small() {
            let names: Vec<&str> = view.stages().iter().map(|s| s.name()).collect();
            worst.push(format!("view {views} {names:?}: {d:?}"));
        }
        views += 1;
    }
    assert!(views == VIEWS && total.judged > total.pixels / 2, "{views} views: {total:?}");
    assert!(less > VIEWS / 2, "less detail in {less} of {VIEWS} views");
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

/// The rasteriser draws `right` and the tracer gets `wrong`. The difference must be noticed, and with `right` for both there must be
/// none.
fn must_notice(name: &str, right: (&Scene, &View), wrong: (&Scene, &View)) {
    let drawn = render(right.0, right.1, &exactly());
    let clean = compare(&trace(right.0, right.1, &exactly()), &drawn);
    assert!(clean.is_small(), "{name}: without the fault {clean:?}");
    let faulty = compare(&trace(wrong.0, wrong.1, &exactly()), &drawn);
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
    let faulty = compare(&trace(&scene, &wrong, &exactly()), &render(&scene, &right, &exactly()));
    assert!(!faulty.is_small(), "a trench passes unnoticed: {faulty:?}");
}

#[test]
fn the_other_diagonal_is_noticed() {
    // Wrong weights of the corners of a cell: the mirrored picture of the mirrored ground has the other diagonal.
    let hf = hills(24, 50.0, 160.0, 7);
    let n = hf.cols();
    let flip = |values: &[f32]| (0..n * n).map(|i| values[i / n * n + n - 1 - i % n]).collect::<Vec<f32>>();
    let states = vec![NodeState::Measured; n * n];
    let mirrored = Heightfield::new(hf.north_west(), hf.spacing(), n, n, flip(hf.heights()), states);
    let view = View::straight(high());
    let drawn = render(&ground_only(hf), &view, &exactly());
    let mut traced = trace(&ground_only(mirrored.expect("well formed")), &view, &exactly());
    for row in traced.depth.chunks_mut(160) {
        row.reverse();
    }
    traced.id.chunks_mut(160).for_each(<[u32]>::reverse);
    let faulty = compare(&traced, &drawn);
    assert!(!faulty.is_small(), "the other diagonal passes unnoticed: {faulty:?}");
}

#[test]
fn swapped_conic_weights_are_noticed() {
    // The weights of the arc, (1, w, 1), are exchanged to (w, 1, w). The result is a conic of weight 1 / w, that is m_sigma^2 / m.
    let scene = hilly();
    let turn = |m: Sharpness| {
        let ph = high();
        let forward = ph.forward.with_z(0.0).normalize();
        let plane = |d: f64| ph.eye + forward * d;
        let spec = TurnSpec {
            viewpoint: ph.eye + DVec3::Z * 220.0,
            t0: plane(480.0),
            t1: plane(600.0),
            t2: plane(720.0),
            pencil: Pencil::Parallel { normal: -forward },
            m,
        };
        CurvedRays::new(&ph, Model::Modified, &[spec])
            .map(|rays| View::new(ph, vec![Stage::CurvedRays(rays)]).expect("in order"))
    };
    let bend = turn(Sharpness::Bend).expect("possible");
    let m = bend.curved_rays().and_then(|r| r.turns()[0].m).expect("the modified model has one");
    let [right, wrong] = [1.8, 1.0 / 1.8].map(|w| turn(Sharpness::Value(w * m)).expect("possible"));
    must_notice("swapped weights", (&scene, &right), (&scene, &wrong));
}

#[test]
fn refraction_left_out_is_noticed() {
    let scene = hilly();
    let [right, wrong] = [0.13, 0.0].map(|refraction| {
        let earth = EarthCurvature { eye: high().eye, radius: 20_000.0, refraction };
        View::new(high(), vec![Stage::EarthCurvature(earth)]).expect("in order")
    });
    must_notice("no refraction", (&scene, &right), (&scene, &wrong));
}

#[test]
fn two_vertices_taken_for_each_other_are_noticed() {
    let place = DVec3::new(0.0, 0.0, -40.0);
    let [right, wrong] = [false, true].map(|faulty| scene(vec![layer("church", church(place, faulty))]));
    let near = pinhole(DVec3::new(60.0, -190.0, 60.0), DVec3::new(0.0, 0.0, 5.0), 40.0, [160, 120]);
    let view = View::straight(near);
    let drawn = render(&right, &view, &exactly());
    assert!(compare(&trace(&right, &view, &exactly()), &drawn).is_small());
    let faulty = compare(&trace(&wrong, &view, &exactly()), &drawn);
    assert!(!faulty.is_small(), "{faulty:?}");
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
    // The parameter of the curve is used in place of its arc length: places along the heading (north) are wrong by a mean of L.
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
            assert!(on_ray.point.distance(seen.point) < 1e-6, "{name}: {} from {}", seen.point, on_ray.point);
            assert_eq!(on_ray.segment, seen.segment);
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
    // Small steps along the ray up to the hit never change the side of the ground, so the tracer steps over no hill.
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
    let draw = |threads| {
        trace(&scene, &view, &RenderOptions { threads, aux: Aux { world: true, ..Aux::default() }, ..options(4) })
    };
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
