//! Styling sections in both renderers: which layers are visible where, and the mean of the exposures.

use crate::exact::difference;
use crate::support::{hills, layer, options, pinhole, render, scene, terrain};
use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::sections::TagPoint;
use belvedere_core::{DVec3, Stage, View};
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Compositing, Frame, LayerKind, Mesh, MeshColors, MeshLayer, PaletteName, RenderOptions,
    Representation, Scene, Stylisation,
};

const IMAGE: [u32; 2] = [160, 120];

fn representation(id: &str, layers: &[&str]) -> Representation {
    Representation { id: id.into(), layers: layers.iter().map(|l| (*l).to_owned()).collect() }
}

/// Hills as relief and as plan, with towers in the relief alone.
fn land() -> Scene {
    let relief = terrain(hills(129, 25.0, 120.0, 11));
    let mut plan = relief.clone();
    (plan.palette, plan.relief) = (PaletteName::Plain.into(), belvedere_scene::Relief::None);
    let boxes = (0..49)
        .map(|i| {
            let base = DVec3::new(f64::from(i % 7 - 3) * 220.0, f64::from(i / 7 - 3) * 220.0, -40.0);
            BoxShape { base, size: DVec3::new(60.0, 60.0, 170.0), yaw: 0.3, color: Color::rgb(190, 90, 60) }
        })
        .collect();
    let layers = vec![
        layer("relief", LayerKind::Terrain(relief)),
        layer("towers", LayerKind::Boxes(BoxLayer::new(boxes))),
        layer("plan", LayerKind::Terrain(plan)),
    ];
    let representations = vec![representation("near", &["relief", "towers"]), representation("far", &["plan"])];
    Scene { representations, ..scene(layers) }
}

/// A scene whose last layer is seen in the front alone, and a bend that blends from front to back.
pub(crate) fn styled(land: &Scene, tags: &[TagPoint], image: [u32; 2]) -> (Scene, View) {
    let ids: Vec<&str> = land.layers.iter().map(|layer| layer.id.as_str()).collect();
    let representations = vec![representation("near", &ids), representation("far", &ids[..ids.len() - 1])];
    let camera = pinhole(DVec3::new(0.0, -1100.0, 620.0), DVec3::ZERO, 45.0, image);
    let plane = ReferencePlane::level(0.0);
    let mut document = PresetDocument::builtin("degressive").expect("built in");
    document.presets[0].tags = tags.to_vec();
    document.presets[0].sections = ["near", "far"].map(str::to_owned).to_vec();
    let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane)).expect("a preset");
    let view = View::new(camera, vec![Stage::SplineBend(bend)]).expect("one stage is in order");
    (Scene { representations, ..land.clone() }, view)
}

/// A degressive bend with these sections; phi is 30 degrees.
fn view(tags: &[TagPoint], sections: &[&str]) -> View {
    let camera = pinhole(DVec3::new(0.0, -2200.0, 1270.0), DVec3::ZERO, 45.0, IMAGE);
    let plane = ReferencePlane::level(0.0);
    let mut document = PresetDocument::builtin("degressive").expect("built in");
    document.presets[0].tags = tags.to_vec();
    document.presets[0].sections = sections.iter().map(|s| (*s).to_owned()).collect();
    let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane)).expect("a preset");
    View::new(camera, vec![Stage::SplineBend(bend)]).expect("one stage is in order")
}

fn parameter(view: &View, p: [f64; 3]) -> f64 {
    let Some(Stage::SplineBend(bend)) = view.stages().first() else { panic!("a spline") };
    bend.section_parameter(DVec3::from_array(p))
}

fn placed(scene: &Scene, view: &View, exposures: u32) -> Frame {
    composed(scene, view, exposures, Compositing::Dither)
}

fn composed(scene: &Scene, view: &View, exposures: u32, compositing: Compositing) -> Frame {
    let mut options = RenderOptions { exposures, compositing, ..options(1) };
    options.aux.world = true;
    render(scene, view, &options)
}

#[test]
fn each_side_of_a_hard_border_shows_its_own_representation() {
    let (scene, view) = (land(), view(&[TagPoint { u: 0.5, delta: 0.0 }], &["near", "far"]));
    let frame = placed(&scene, &view, 1);
    let mut seen = [0; 2];
    for (id, p) in frame.id.iter().zip(frame.world.expect("asked for")) {
        let t = parameter(&view, p);
        match id {
            0 => {}
            3 => {
                assert!(t > 0.5 - 1e-6, "plan at {t}");
                seen[1] += 1;
            }
            _ => {
                assert!(t < 0.5 + 1e-6, "relief at {t}");
                seen[0] += 1;
            }
        }
    }
    assert!(seen[0] > 4000 && seen[1] > 2000, "{seen:?}");
}

#[test]
fn a_transition_shows_shares_of_both_and_exactly_one_of_them_at_each_sample() {
    let (mut scene, view) = (land(), view(&[TagPoint { u: 0.5, delta: 0.3 }], &["near", "far"]));
    scene.layers[1].kind = LayerKind::Boxes(BoxLayer::default());
    let frame = placed(&scene, &view, 1);
    // For each tenth of the curve: the number of pixels of the plan, the number expected from the weights, and the number of all pixels.
    let mut tenths = [[0.0; 3]; 10];
    for (id, p) in frame.id.iter().zip(frame.world.expect("asked for")) {
        let t = parameter(&view, p);
        if *id != 0 && (0.2..0.8).contains(&t) {
            let tenth = &mut tenths[(t * 10.0) as usize];
            tenth[0] += f64::from(u8::from(*id == 3));
            tenth[1] += (t - 0.2) / 0.6;
            tenth[2] += 1.0;
        }
    }
    for (i, [plan, want, all]) in tenths.into_iter().enumerate().filter(|(_, t)| t[2] > 300.0) {
        assert!((plan - want).abs() < 0.02 * all, "tenth {i}: {plan} of {all}, weights {want}");
    }
    // Both grounds are one surface, so no sample falls between them.
    let whole = render(&Scene { representations: vec![], ..scene }, &view, &options(1));
    assert!(whole.id.iter().zip(&frame.id).all(|(a, b)| (*a == 0) == (*b == 0)));
}

/// The hills without towers in a wide transition, and their view.
fn plain_transition() -> (Scene, View) {
    let (mut scene, view) = (land(), view(&[TagPoint { u: 0.5, delta: 0.3 }], &["near", "far"]));
    scene.layers[1].kind = LayerKind::Boxes(BoxLayer::default());
    (scene, view)
}

/// Largest difference, in steps of 255, between a picture of [`plain_transition`] and the composite by weights of its layers, each drawn
/// alone.
fn off_by(scene: &Scene, view: &View, picture: &Frame) -> f64 {
    let only = |keep: &str| {
        let of = |id: &str| representation(id, if id == keep { &["relief", "plan"] } else { &[] });
        let layers = scene.layers.iter().filter(|l| l.id == keep).cloned().collect();
        render(&Scene { layers, representations: vec![of(keep)], ..Scene::default() }, view, &options(1))
    };
    let (relief, plan) = (only("relief"), only("plan"));
    let linear = |v: u8| {
        let v = f64::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    let code = |v: f64| 255.0 * if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    let (mut worst, mut mixed) = (0.0f64, 0);
    for (i, p) in picture.world.as_ref().expect("asked for").iter().enumerate() {
        let share = ((parameter(view, *p) - 0.2) / 0.6).clamp(0.0, 1.0);
        if picture.id[i] == 0 {
            continue;
        }
        mixed += usize::from(share > 0.0 && share < 1.0);
        for k in 0..3 {
            let want = (1.0 - share) * linear(relief.color[i][k]) + share * linear(plan.color[i][k]);
            worst = worst.max((code(want) - f64::from(picture.color[i][k])).abs());
        }
    }
    assert!(mixed > 4000, "{mixed}");
    worst
}

#[test]
fn exposures_tend_to_the_weighted_composite_where_layers_see_one_surface() {
    let (scene, view) = plain_transition();
    let worst = off_by(&scene, &view, &placed(&scene, &view, 64));
    // Half a step of 64 between two colours, which codes of dark colours spread (2.24 when this was written), plus rounding.
    assert!(worst <= 2.5, "{worst}");
}

#[test]
fn one_surface_in_two_colours_is_drawn_once_and_mixed_by_weight() {
    let (scene, view) = plain_transition();
    let single = composed(&scene, &view, 1, Compositing::Single);
    let worst = off_by(&scene, &view, &single);
    // Rounding of three pictures.
    assert!(worst <= 1.3, "{worst}");
    let mean = placed(&scene, &view, 64);
    let off = single.color.iter().zip(&mean.color).flat_map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k]))).max();
    assert!(off.is_some_and(|off| off <= 2), "{off:?} of 255");
    let whole = render(&Scene { representations: vec![], ..scene.clone() }, &view, &options(1));
    assert_eq!(2 * single.stats.triangles_drawn, whole.stats.triangles_drawn, "one ground instead of two");
    // Each sample has the id of the layer with the greater share.
    for (id, p) in single.id.iter().zip(single.world.expect("asked for")).filter(|(id, _)| **id != 0) {
        let t = parameter(&view, p);
        assert!(*id == if t < 0.5 { 1 } else { 3 } || (t - 0.5).abs() < 1e-6, "{id} at {t}");
    }
}

#[test]
fn meshes_of_one_surface_are_mixed_and_others_are_not() {
    let (mut scene, view) = plain_transition();
    let corners = [[-400.0, -600.0, 150.0], [400.0, -600.0, 150.0], [400.0, 900.0, 150.0], [-400.0, 900.0, 150.0]];
    let roof = |color: [u8; 3], lift: f64| {
        let corners = corners.map(|p| DVec3::from_array(p) + lift * DVec3::Z);
        let mesh = Mesh::new(&corners, vec![[0, 1, 2], [0, 2, 3]], MeshColors::Layer).expect("two triangles");
        let [r, g, b] = color;
        LayerKind::Mesh(MeshLayer::new(mesh, Color::rgb(r, g, b)))
    };
    scene.layers.push(layer("red", roof([230, 60, 40], 0.0)));
    scene.layers.push(layer("blue", roof([40, 60, 230], 0.0)));
    scene.representations[0].layers.push("red".into());
    scene.representations[1].layers.push("blue".into());
    let hues = |scene: &Scene| {
        let frame = composed(scene, &view, 1, Compositing::Single);
        let of_roof = frame.id.iter().zip(&frame.color).filter(|(id, _)| **id == 4 || **id == 5);
        // Mixtures, in which neither channel is much stronger than the other.
        of_roof.fold([0, 0], |[all, mixed], (_, c)| [all + 1, mixed + usize::from(c[0].abs_diff(c[2]) < 40)])
    };
    let [all, mixed] = hues(&scene);
    assert!(all > 1000 && mixed == 0, "two surfaces, for all that is known: {mixed} of {all}");
    let (before, [blue]) = scene.layers.split_at_mut(4) else { panic!("five layers") };
    blue.kind.share_surface(&before[3].kind);
    let [all, mixed] = hues(&scene);
    assert!(10 * mixed > all, "{mixed} of {all}");
    let d = difference(&scene, &view);
    assert!(d.judged > d.pixels / 2 && d.is_small(), "{d:?}");
    scene.layers[4].kind = roof([40, 60, 230], 5.0);
    let (before, [blue]) = scene.layers.split_at_mut(4) else { panic!("five layers") };
    blue.kind.share_surface(&before[3].kind);
    assert!(!blue.kind.is_surface_of(&before[3].kind), "five metres apart");
}

#[test]
fn rasteriser_and_tracer_show_the_same_representations() {
    for (delta, sections) in [(0.0, ["near", "far"]), (0.2, ["far", "near"])] {
        let d = difference(&land(), &view(&[TagPoint { u: 0.45, delta }], &sections));
        assert!(d.judged > d.pixels / 2 && d.is_small(), "{delta}: {d:?}");
    }
}

#[test]
fn sections_of_one_representation_are_the_plain_picture() {
    let scene = land();
    let six: Vec<TagPoint> = (1..6).map(|i| TagPoint { u: f64::from(i) / 6.0, delta: 0.05 }).collect();
    let one = render(&scene, &view(&[], &["near"]), &options(4));
    let many = render(&scene, &view(&six, &["near"; 6]), &RenderOptions { exposures: 8, ..options(4) });
    assert!(one.color == many.color && one.depth == many.depth);
    let mut alone = scene.clone();
    alone.representations.clear();
    alone.layers.truncate(2);
    assert!(one.color == render(&alone, &view(&[], &["all"]), &options(4)).color);
}

#[test]
fn layers_are_the_mean_of_the_exposures_where_they_see_one_surface() {
    let (mut scene, view) = (land(), view(&[TagPoint { u: 0.5, delta: 0.3 }], &["near", "far"]));
    scene.layers[1].kind = LayerKind::Boxes(BoxLayer::default());
    let mean = placed(&scene, &view, 64);
    let layers = render(&scene, &view, &RenderOptions { compositing: Compositing::Layers, ..options(1) });
    let off = mean.color.iter().zip(&layers.color).flat_map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k]))).max();
    assert!(off.is_some_and(|off| off <= 2), "{off:?} of 255");
    // Layers need memory for two pictures with colour, depth, identity and place; exposures need none.
    assert_eq!((layers.stats.layer_bytes, mean.stats.layer_bytes), (2 * 160 * 120 * 35, 0));
}

#[test]
fn layers_that_see_different_places_leave_no_hole() {
    let (scene, view) = (land(), view(&[TagPoint { u: 0.5, delta: 0.3 }], &["near", "far"]));
    let layers = render(&scene, &view, &RenderOptions { compositing: Compositing::Layers, ..options(1) });
    let mean = render(&scene, &view, &options(1));
    let sky = |frame: &Frame| frame.id.iter().filter(|id| **id == 0).count();
    assert!(sky(&layers) <= sky(&mean) && layers.id.contains(&2), "towers");
}

#[test]
fn edges_are_those_of_each_representation_alone() {
    let (scene, tags) = (land(), [TagPoint { u: 0.5, delta: 0.2 }]);
    let view = view(&tags, &["near", "far"]);
    let drawn = |representation: Option<usize>, edges: f32| {
        let stylisation = Stylisation { edges, unsharp: 0.0 };
        let mut options = RenderOptions { representation, stylisation, ..options(4) };
        options.aux.world = true;
        render(&scene, &view, &options)
    };
    let (picture, plain) = (drawn(None, 1.0), drawn(None, 0.0));
    let alone = [0, 1].map(|number| drawn(Some(number), 1.0));
    let (mut whole, mut inked) = ([0; 2], 0);
    for i in 0..picture.color.len() {
        let seen = [0, 1].map(|number: usize| !alone[number].world.as_ref().expect("asked for")[i][0].is_nan());
        // Where only one of them shows anything, the result is that one.
        let ([true, false] | [false, true]) = seen else { continue };
        let number = usize::from(seen[1]);
        whole[number] += 1;
        assert_eq!(picture.color[i], alone[number].color[i], "pixel {i}");
        inked += usize::from(plain.color[i] != picture.color[i]);
    }
    assert!(whole.iter().all(|n| *n > 500) && inked > 100, "{whole:?} pixels, {inked} with edges");
}
