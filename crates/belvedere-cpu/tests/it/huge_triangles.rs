//! Compares the rasteriser with the exact tracer where things stand on ground of few triangles, of any size, under bends.

use crate::exact::{exactly, on_silhouette, trace};
use crate::strip;
use crate::support::{layer, pinhole, render, scene};
use crate::support_views::{spline, turns};
use belvedere_core::{DVec2, DVec3, EarthCurvature, Stage, View};
use belvedere_scene::{BoxLayer, BoxShape, Color, LayerKind, Mesh, MeshColors, MeshLayer, Scene};
use belvedere_testkit::Random;
use belvedere_testkit::rays::{MODELS, RandomRays};

const IMAGE: [u32; 2] = [64, 48];
/// Sides of the ground, scene units.
const SIZES: [f64; 4] = [1e2, 1e4, 1e6, 1e8];

/// How the ground is made.
#[derive(Debug, Clone, Copy)]
enum Ground {
    /// Two triangles.
    Mesh,
    /// The top of a box.
    Slab,
}

/// Level ground of a size with its middle at `middle`.
fn ground(kind: Ground, middle: DVec3, size: f64, yaw: f64) -> LayerKind {
    let color = Color::rgb(120, 140, 100);
    match kind {
        Ground::Mesh => {
            let turn = DVec2::from_angle(yaw);
            let corner = |x: f64, y: f64| middle + (size * turn.rotate(DVec2::new(x, y))).extend(0.0);
            let corners = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
            let mesh = Mesh::new(&corners, vec![[0, 1, 2], [0, 2, 3]], MeshColors::Layer).expect("well formed");
            LayerKind::Mesh(MeshLayer::new(mesh, color))
        }
        Ground::Slab => {
            let base = middle - 0.5 * DVec3::Z;
            LayerKind::Boxes(BoxLayer::new(vec![BoxShape { base, size: DVec3::new(size, size, 0.5), yaw, color }]))
        }
    }
}

/// Ground, and blocks that stand on it at some places.
fn with_blocks(kind: Ground, size: f64, places: &[DVec3], random: &mut Random) -> Scene {
    let z = places[0].z;
    let mut block = |p: &DVec3| BoxShape {
        base: p.with_z(z - 0.25),
        size: DVec3::new(random.range(2.0, 20.0), random.range(2.0, 20.0), random.range(1.0, 20.0)),
        yaw: random.range(0.0, 3.0),
        color: Color::rgb(200, 60, 50),
    };
    let blocks = places.iter().map(&mut block).collect();
    let middle = places[0] + size * random.range(-0.2, 0.2) * DVec3::new(1.0, -0.7, 0.0);
    let ground = ground(kind, middle, size, random.range(0.0, 3.0));
    scene(vec![layer("ground", ground), layer("blocks", LayerKind::Boxes(BoxLayer::new(blocks)))])
}

/// Places at one height through which rays of the picture pass.
fn places(view: &View, random: &mut Random) -> Option<Vec<DVec3>> {
    let any = |random: &mut Random| {
        let pixel = DVec2::new(random.unit(), random.unit()) * DVec2::from_array(IMAGE.map(f64::from));
        view.ray(pixel).at(random.range(30.0, 500.0)).ok().map(|seen| seen.point)
    };
    let first = any(random)?;
    Some(std::iter::once(first).chain((0..24).filter_map(|_| any(random))).collect())
}

/// What was compared, and where rasteriser and tracer see other surfaces.
#[derive(Debug, Default, Clone, Copy)]
struct Compared {
    /// Pixels away from silhouettes.
    judged: usize,
    /// How many of them see a surface that lies farther from the traced one than a pixel is wide there, or another place on the same.
    wrong: usize,
}

impl Compared {
    /// Bent edges are drawn straight within half a pixel, also in depth: surfaces that lie nearer together may take each other's place.
    fn add(&mut self, scene: &Scene, view: &View) {
        let (traced, drawn) = (trace(scene, view, &exactly()), render(scene, view, &exactly()));
        for i in (0..traced.id.len()).filter(|&i| !on_silhouette(&traced, i)) {
            self.judged += 1;
            let [at, seen] = [&traced, &drawn].map(|frame| (frame.id[i], f64::from(frame.depth[i])));
            let allowed = at.1 / view.pinhole().scale_px();
            let same = at.0 == 0 && seen.0 == 0;
            self.wrong += usize::from(!same && !((at.1 - seen.1).abs() <= allowed));
        }
    }
}

#[test]
fn what_stands_on_ground_of_few_triangles_is_seen_along_curved_rays_whatever_the_size_of_the_ground() {
    const VIEWS: usize = 60;
    for (s, size) in SIZES.into_iter().enumerate() {
        let (mut all, mut views, mut found) = (Compared::default(), 0, Vec::new());
        for seed in 0.. {
            let mut random = Random::new(0x9047 + 977 * seed + s as u64);
            let (model, turns) = (MODELS[views % 5], 1 + views / 5 % 3);
            let Some(view) = RandomRays::new(&mut random, model, turns, IMAGE).map(|made| made.view()) else {
                continue;
            };
            let Some(places) = places(&view, &mut random) else { continue };
            let kind = if views % 3 == 0 { Ground::Slab } else { Ground::Mesh };
            let before = all;
            all.add(&with_blocks(kind, size, &places, &mut random), &view);
            if all.wrong > before.wrong {
                found.push((seed, model, turns, kind, all.wrong - before.wrong));
            }
            views += 1;
            if views == VIEWS {
                break;
            }
        }
        assert!(all.judged > VIEWS * 1000 && all.wrong == 0, "{size}: {all:?}, {found:?}");
    }
}

#[test]
fn what_stands_on_ground_of_few_triangles_is_seen_in_every_chain() {
    let camera = || pinhole(DVec3::new(0.0, -500.0, 300.0), DVec3::new(0.0, 50.0, 0.0), 50.0, IMAGE);
    let mut views: Vec<(String, View)> = ["progressive", "degressive", "hybrid-flat-steep-flat"]
        .map(|preset| (preset.to_owned(), spline(camera(), preset)))
        .into();
    let earth = Stage::EarthCurvature(EarthCurvature { eye: camera().eye, radius: 6.371e6, refraction: 0.13 });
    for (name, view) in views.clone() {
        let stages = [std::slice::from_ref(&earth), view.stages()].concat();
        views.push((format!("earth, {name}"), View::new(view.pinhole().clone(), stages).expect("in order")));
        let rays = turns(view.pinhole().clone(), MODELS[views.len() % 5], &[(700.0, 200.0)]);
        let stages = [view.stages(), rays.stages()].concat();
        views.push((format!("{name}, rays"), View::new(view.pinhole().clone(), stages).expect("in order")));
    }
    views.extend(strip::views(IMAGE).into_iter().take(4).map(|(name, view)| (name.to_owned(), view)));
    let mut all = Compared::default();
    for (k, (name, view)) in views.iter().enumerate() {
        // Ground that is larger than the planet has no horizon that it could end at.
        let sizes = SIZES.into_iter().filter(|size| *size > 1e3 && (*size < 1e7 || !name.starts_with("earth")));
        for (s, size) in sizes.enumerate() {
            let mut random = Random::new((10 * k + s) as u64);
            let height = if s % 2 == 0 { 3.0 } else { 0.0 };
            let at = |random: &mut Random| DVec3::new(random.range(-200.0, 200.0), random.range(-250.0, 900.0), height);
            let places: Vec<DVec3> = (0..40).map(|_| at(&mut random)).collect();
            for kind in [Ground::Mesh, Ground::Slab] {
                let before = all;
                all.add(&with_blocks(kind, size, &places, &mut random), view);
                let (judged, wrong) = (all.judged - before.judged, all.wrong - before.wrong);
                // The corner of a block may fill a pixel that the tracer just misses.
                assert!(judged > 800 && wrong <= 1, "{name}, {size}, {height}, {kind:?}: {wrong} of {judged}");
            }
        }
    }
    assert!(all.wrong * 20_000 <= all.judged, "{all:?}");
}
