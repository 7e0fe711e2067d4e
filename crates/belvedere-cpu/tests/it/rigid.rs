//! Rigid bodies in both renderers: they move as a whole, look the same in both, and are reported at their true places.

use crate::exact::{difference, trace};
use crate::support::{hills, layer, options, pinhole, render, scene, terrain};
use crate::support_views::{spline, turns};
use belvedere_core::map::curved_rays::Model;
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::sections::TagPoint;
use belvedere_core::{DVec2, DVec3, EarthCurvature, SplineBend, Stage, View};
use belvedere_scene::{
    BoxLayer, BoxShape, Color, LayerKind, Mesh, MeshColors, MeshLayer, RenderOptions, Representation, RigidParts, Scene,
};
use belvedere_sight::Carried;
use belvedere_sight::trace::Tracer;

const IMAGE: [u32; 2] = [120, 90];

fn tower(x: f64, y: f64, height: f64, yaw: f64) -> BoxShape {
    let size = DVec3::new(14.0, 11.0, height);
    BoxShape { base: DVec3::new(x, y, 0.0), size, yaw, color: Color::rgb(190, 180, 170) }
}

/// Rows of houses, of which every third is a tower.
fn shapes() -> Vec<BoxShape> {
    (0..80)
        .map(|i| {
            let (c, r) = (f64::from(i % 8) - 3.5, f64::from(i / 8) - 4.0);
            let height = if i % 3 == 0 { 70.0 } else { 12.0 + f64::from(i % 5) };
            tower(32.0 * c, 38.0 * r, height, 0.3 * f64::from(i % 4))
        })
        .collect()
}

/// Every second shape is a part of a mesh over a plate that is not rigid. The triangles of the parts alternate, and two parts share one
/// corner.
fn houses(shapes: &[BoxShape], rigid: RigidParts) -> MeshLayer {
    let plate = [[-200.0, -200.0], [200.0, -200.0], [200.0, 260.0], [-200.0, 260.0]];
    let mut places: Vec<DVec3> = plate.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    let (mut triangles, mut parts) = (vec![[0, 1, 2], [0, 2, 3]], vec![0, 0]);
    for t in 0..12 {
        for (k, _) in shapes.iter().enumerate() {
            let first = 4 + 8 * k as u32;
            triangles.push(BoxShape::TRIANGLES[t].map(|corner| first + corner as u32));
            parts.push(1 + k as u32);
        }
    }
    places.extend(shapes.iter().flat_map(BoxShape::corners));
    let mesh = Mesh::in_parts(&places, triangles, MeshColors::Layer, parts).expect("well formed");
    MeshLayer { rigid, ..MeshLayer::new(mesh, Color::rgb(220, 200, 170)) }
}

fn town(rigid: bool) -> Scene {
    let (mut boxes, mut parts) = (shapes(), shapes());
    let mut keep = [true, false].into_iter().cycle();
    boxes.retain(|_| keep.next() == Some(true));
    let mut keep = [false, true].into_iter().cycle();
    parts.retain(|_| keep.next() == Some(true));
    let of_parts = if rigid { RigidParts::Only((1..=parts.len() as u32).collect()) } else { RigidParts::None };
    scene(vec![
        layer("towers", LayerKind::Boxes(BoxLayer { rigid, ..BoxLayer::new(boxes) })),
        layer("houses", LayerKind::Mesh(houses(&parts, of_parts))),
    ])
}

/// So near that houses fold.
fn hybrid() -> View {
    let camera = pinhole(DVec3::new(-40.0, -250.0, 180.0), DVec3::ZERO, 50.0, IMAGE);
    spline(camera, "hybrid-flat-steep-flat")
}

/// The chain with other stages before and after its spline.
fn around(view: &View, before: Vec<Stage>, rise: f64) -> View {
    let rays = turns(view.pinhole().clone(), Model::Modified, &[(330.0, rise)]);
    let stages = before.into_iter().chain(view.stages().iter().cloned());
    let stages = stages.chain(rays.stages().iter().filter(|_| rise > 0.0).cloned()).collect();
    View::new(view.pinhole().clone(), stages).expect("in order")
}

fn chains() -> Vec<(&'static str, View)> {
    let view = hybrid();
    let earth = EarthCurvature { eye: view.pinhole().eye, radius: 4_000.0, refraction: 0.13 };
    let earth = Stage::EarthCurvature(earth);
    vec![
        ("hybrid", view.clone()),
        ("on a small planet", around(&view, vec![earth], 0.0)),
        ("before a turn", around(&view, vec![], 60.0)),
    ]
}

#[test]
fn the_rasteriser_draws_rigid_bodies_as_the_tracer_meets_them() {
    for (name, view) in chains() {
        let found = difference(&town(true), &view);
        assert!(found.is_small() && 2 * found.judged > found.pixels, "{name}: {found:?}");
        // They are not where the bend would move them.
        let (rigid, bent) = (render(&town(true), &view, &options(1)), render(&town(false), &view, &options(1)));
        let moved = rigid.depth.iter().zip(&bent.depth).filter(|(a, b)| (*a - *b).abs() > 0.01 * a.min(**b)).count();
        assert!(moved > 180, "{name}: {moved}");
    }
}

/// The exact renderer follows a row of rays together, the tracer one after another.
#[test]
fn rows_of_rays_meet_the_bodies_that_single_rays_meet() {
    let view = spline(pinhole(DVec3::new(-40.0, -250.0, 180.0), DVec3::ZERO, 50.0, [24, 18]), "hybrid-flat-steep-flat");
    let boxes = shapes().into_iter().step_by(9).collect();
    let scene = scene(vec![layer("towers", LayerKind::Boxes(BoxLayer { rigid: true, ..BoxLayer::new(boxes) }))]);
    let (rows, tracer) = (trace(&scene, &view, &options(1)), Tracer::new(&scene, &view));
    let single = |i: usize| tracer.first_hit(DVec2::new((i % 24) as f64 + 0.5, (i / 24) as f64 + 0.5));
    let met: Vec<u32> = (0..24 * 18).map(|i| u32::from(single(i).is_some())).collect();
    assert_eq!(rows.id, met);
    assert!((40..400).contains(&met.iter().filter(|id| **id == 1).count()), "{met:?}");
}

#[test]
fn rigid_bodies_stand_on_hills() {
    let view = hybrid();
    let hf = hills(33, 16.0, 16.0, 5);
    let on = |b: &BoxShape| {
        let z = hf.surface_at(DVec2::new(b.base.x, b.base.y)).expect("on the hills");
        BoxShape { base: b.base.with_z(z - 2.0), ..*b }
    };
    let boxes: Vec<BoxShape> = shapes().iter().filter(|b| b.base.y < 230.0).map(on).collect();
    let towers = LayerKind::Boxes(BoxLayer { rigid: true, ..BoxLayer::new(boxes) });
    let scene = scene(vec![layer("ground", LayerKind::Terrain(terrain(hf))), layer("towers", towers)]);
    let found = difference(&scene, &view);
    assert!(found.is_small(), "{found:?}");
}

#[test]
fn what_is_seen_of_a_body_is_told_by_its_true_place() {
    for (name, view) in chains() {
        let town = town(true);
        let (carried, tracer) = (Carried::new(&town, &view).expect("bodies"), Tracer::new(&town, &view));
        let mut wanted = RenderOptions::default();
        (wanted.samples, wanted.aux.world, wanted.aux.exact) = (1, true, true);
        let frame = render(&town, &view, &wanted);
        let (mut boxes, mut parts, mut high) = (0, 0, 0);
        for (i, p) in frame.world.as_ref().expect("asked for").iter().enumerate().step_by(5) {
            let pixel = DVec2::new((i % IMAGE[0] as usize) as f64 + 0.5, (i / IMAGE[0] as usize) as f64 + 0.5);
            let Some(hit) = tracer.first_hit(pixel) else { continue };
            if frame.id[i] as usize != hit.layer + 1 || (f64::from(frame.depth[i]) / hit.depth - 1.0).abs() > 1e-5 {
                continue;
            }
            let p = DVec3::from_array(*p);
            assert!(p.distance(hit.point) < 0.02, "{name}: {p} is {}", hit.point);
            let body = match hit.layer {
                // The place is on the surface of one of the boxes. The frame does not store the number of the box, so the nearest is used.
                0 => {
                    let Some(layer) = town.layers[0].kind.boxes() else { panic!("boxes") };
                    let far = |b: &BoxShape| {
                        let local = DVec2::from_angle(-b.yaw).rotate((p - b.base).truncate());
                        let out = (local.abs() - 0.5 * b.size.truncate()).max(DVec2::ZERO).length();
                        out + (p.z - b.size.z).max(-p.z).max(0.0)
                    };
                    let near =
                        (0..layer.boxes.len()).min_by(|a, b| far(&layer.boxes[*a]).total_cmp(&far(&layer.boxes[*b])));
                    let near = near.expect("there are some");
                    assert!(far(&layer.boxes[near]) < 1e-3, "{name}: {p} is beside every box");
                    boxes += 1;
                    carried.layer(0).and_then(|l| l.motion(near))
                }
                _ => {
                    let triangle = hit.triangle().expect("of a mesh");
                    parts += 1;
                    carried.layer(1).and_then(|l| l.body(triangle)).map(|(_, motion)| motion)
                }
            };
            high += usize::from(p.z > 45.0);
            let own = body.map_or(view.clone(), |motion| view.of_body(*motion));
            let image = own.project(p).expect("seen");
            assert!(image.pixel.distance(pixel) < 0.02, "{name}: {p} has its image at {}, not {pixel}", image.pixel);
            assert!(!image.folded || body.is_none());
        }
        assert!(boxes > 100 && parts > 100 && high > 10, "{name}: {boxes} {parts} {high}");
    }
}

#[test]
fn towers_beyond_the_fold_limit_are_drawn_whole() {
    let view = hybrid();
    let Some(Stage::SplineBend(bend)) = view.stages().first() else { panic!("a spline") };
    let limit = bend.fold_heights()[1];
    assert!(limit < 50.0, "{limit}");
    // The place where the curve bends upwards most.
    let foot = (-200..400).map(|y| DVec3::new(0.0, f64::from(y), 0.0)).min_by(|a, b| {
        let stretch = |p: &DVec3| bend.stretch(*p + 100.0 * DVec3::Z);
        stretch(a).total_cmp(&stretch(b))
    });
    let foot = foot.expect("some");
    assert!(bend.is_folded(foot + 60.0 * DVec3::Z));
    let tall = BoxShape { base: foot, ..tower(0.0, 0.0, 70.0, 0.2) };
    let drawn = |rigid: bool| {
        let boxes = LayerKind::Boxes(BoxLayer { rigid, ..BoxLayer::new(vec![tall]) });
        let scene = scene(vec![layer("tower", boxes)]);
        render(&scene, &view, &options(1))
    };
    // The image is that of a convex body: every row of pixels is one run without gaps, and so is the outline of the corners.
    let motion = view.body_motion(foot).expect("an image");
    let corners = tall.corners().map(|p| view.of_body(motion).project(p).expect("in front").pixel);
    let (low, high) = corners.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
    let rigid = drawn(true);
    let seen: Vec<DVec2> = (0..rigid.id.len())
        .filter(|i| rigid.id[*i] == 1)
        .map(|i| DVec2::new((i % rigid.width) as f64 + 0.5, (i / rigid.width) as f64 + 0.5))
        .collect();
    let (least, most) = seen.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
    let size = DVec2::new(f64::from(IMAGE[0]), f64::from(IMAGE[1]));
    let (low, high) = (low.clamp(DVec2::ZERO, size), high.clamp(DVec2::ZERO, size));
    assert!(
        (least - low).abs().max_element() < 1.5 && (most - high).abs().max_element() < 1.5,
        "{least} {low} {most} {high}"
    );
    assert_ne!(rigid.id, drawn(false).id);
}

#[test]
fn styling_sections_show_rigid_bodies_by_their_true_places() {
    let view = hybrid();
    let mut document = PresetDocument::builtin("hybrid-flat-steep-flat").expect("built in");
    document.presets[0].tags = vec![TagPoint { u: 0.5, delta: 0.2 }];
    document.presets[0].sections = ["near", "far"].map(str::to_owned).to_vec();
    let plane = ReferencePlane::level(0.0);
    let pivot = default_pivot(view.pinhole(), &plane);
    let bend = SplineBend::new(view.pinhole(), &document, &plane, pivot).expect("fits");
    let view = View::new(view.pinhole().clone(), vec![Stage::SplineBend(bend)]).expect("in order");
    let of = |id: &str, layers: &[&str]| Representation {
        id: id.into(),
        layers: layers.iter().map(|l| (*l).to_owned()).collect(),
    };
    let scene = Scene { representations: vec![of("near", &["towers"]), of("far", &["houses"])], ..town(true) };
    let found = difference(&scene, &view);
    assert!(found.is_small(), "{found:?}");
    let shown = render(&scene, &view, &options(1));
    let count = |id: u32| shown.id.iter().filter(|i| **i == id).count();
    assert!(count(1) > 180 && count(2) > 180, "{} {}", count(1), count(2));
}
