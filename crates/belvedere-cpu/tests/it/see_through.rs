//! Solids that something shines through. The law: in linear light a picture is linear in the opacity of each layer, so that it is a mixture
//! of the pictures in which every layer is whole or not there. That holds in every sample, whatever is in front of what.

use crate::exact::trace;
use crate::support::{hills, layer, line, options, pinhole, scene, terrain};
use crate::support_views::views;
use belvedere_composite::color::{Rgb, encode, linear};
use belvedere_core::sections::TagPoint;
use belvedere_core::{DVec3, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Frame, Hidden, LayerKind, Light, Mesh, MeshColors, MeshLayer, Progress, RenderJob,
    RenderOptions, Renderer, Scene,
};

const IMAGE: [u32; 2] = [96, 72];

fn drawn(scene: &Scene, view: &View, shadows: bool, options: &RenderOptions) -> Frame {
    let light = Light { shadows, ..Light::default() };
    let job = RenderJob { scene, view, light: &light, options, progress: &Progress::silent() };
    CpuRenderer::default().render(&job).expect("picture is possible")
}

fn with(scene: &Scene, opacities: &[(usize, f32)]) -> Scene {
    let mut scene = scene.clone();
    opacities.iter().for_each(|(layer, opacity)| scene.layers[*layer].kind.set_opacity(*opacity));
    scene
}

fn cube(x: f64, y: f64, side: f64, color: Color) -> BoxShape {
    BoxShape { base: DVec3::new(x, y, -60.0), size: DVec3::new(side, side, 60.0 + 1.4 * side), yaw: 0.4, color }
}

/// Blocks among boxes on hills, which interpenetrate; blocks stand on a plate of their own (part 0).
fn town() -> Scene {
    let at = |i: u32| (f64::from(i % 4) - 1.5, f64::from(i / 4) - 1.5);
    let boxes = (0..16).map(|i| {
        let (x, y) = at(i);
        cube(150.0 * x, 150.0 * y, 70.0, Color::rgb(200, 60, 40))
    });
    let mut places = [[-260.0, -260.0], [260.0, -260.0], [260.0, 40.0], [-260.0, 40.0]]
        .map(|[x, y]| DVec3::new(x, y, 45.0))
        .to_vec();
    let (mut triangles, mut parts) = (vec![[0, 1, 2], [0, 2, 3]], vec![0, 0]);
    for i in 0..16 {
        let ((x, y), first) = (at(i), places.len() as u32);
        places.extend(cube(150.0 * x + 45.0, 150.0 * y + 30.0, 80.0, Color::rgb(0, 0, 0)).corners());
        triangles.extend(BoxShape::TRIANGLES.map(|t| t.map(|corner| first + corner as u32)));
        parts.extend([1 + i; 12]);
    }
    let mesh = Mesh::in_parts(&places, triangles, MeshColors::Layer, parts).expect("well formed");
    let blocks = MeshLayer { has_plate: true, ..MeshLayer::new(mesh, Color::rgb(40, 90, 210)) };
    scene(vec![
        layer("ground", LayerKind::Terrain(terrain(hills(49, 24.0, 90.0, 5)))),
        layer("boxes", LayerKind::Boxes(BoxLayer::new(boxes.collect()))),
        layer("blocks", LayerKind::Mesh(blocks)),
    ])
}

/// The mixture of the pictures in which each of two layers is whole or not there.
fn mixture([a, b]: [f32; 2], draw: &dyn Fn(f32, f32) -> Frame) -> Vec<[u8; 3]> {
    let parts = [(1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)].map(|(p, q)| {
        let weight = (1.0 - (p - a).abs()) * (1.0 - (q - b).abs());
        (weight, draw(p, q).color)
    });
    let pixel = |i: usize| parts.iter().fold(Rgb::ZERO, |sum, (weight, color)| sum + *weight * linear(color[i]));
    (0..parts[0].1.len()).map(|i| encode(pixel(i))).collect()
}

/// Number of pixels that differ by more than `steps`.
fn off(a: &[[u8; 3]], b: &[[u8; 3]], steps: u8) -> usize {
    let differ = |(a, b): (&[u8; 3], &[u8; 3])| (0..3).any(|k| a[k].abs_diff(b[k]) > steps);
    a.iter().zip(b).filter(|pair| differ(*pair)).count()
}

#[test]
fn pictures_are_linear_in_the_opacities_of_layers_in_every_view() {
    let (town, options) = (town(), options(4));
    for (name, view) in views(IMAGE) {
        let draw = |a: f32, b: f32| drawn(&with(&town, &[(1, a), (2, b)]), &view, false, &options);
        let (frame, whole, bare) = (draw(0.35, 0.6), draw(1.0, 1.0), draw(0.0, 0.0));
        let wrong = off(&frame.color, &mixture([0.35, 0.6], &draw), 1);
        // Samples of the ground share colours in one picture and not in the other.
        assert!(wrong * 400 <= frame.color.len(), "{name}: {wrong} pixels are no mixture");
        assert!(off(&frame.color, &bare.color, 12) > frame.color.len() / 8, "{name}: nothing is seen of the layers");
        assert!(frame.id == whole.id, "{name}: what is picked is nearest");
        assert!(frame.depth == bare.depth && bare.id != whole.id, "{name}: the depth is that of what hides");
        assert!(bare.id.contains(&3), "{name}: the plate stays");
    }
}

#[test]
fn traced_pictures_are_mixtures_too_and_those_of_the_rasteriser() {
    let town = town();
    for (name, view) in views([64, 48]).into_iter().take(5) {
        let draw = |a: f32, b: f32| {
            let light = Light { shadows: false, ..Light::default() };
            let (scene, options) = (with(&town, &[(1, a), (2, b)]), options(4));
            let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &Progress::silent() };
            belvedere_cpu::ExactRenderer.render(&job).expect("picture is possible")
        };
        let (frame, own) = (draw(0.35, 0.6), mixture([0.35, 0.6], &draw));
        let other = drawn(&with(&town, &[(1, 0.35), (2, 0.6)]), &view, false, &options(4));
        let [own, other] = [off(&frame.color, &own, 2), off(&frame.color, &other.color, 6)];
        let most = frame.color.len() / 50;
        assert!(own <= most && other <= most, "{name}: {own} pixels are no mixture, {other} are not the rasteriser's");
    }
}

#[test]
fn sections_show_what_shines_through_in_their_part_of_the_picture() {
    let (town, view) = crate::sections::styled(&town(), &[TagPoint { u: 0.5, delta: 0.3 }], IMAGE);
    let options = RenderOptions { exposures: 4, compositing: belvedere_scene::Compositing::Dither, ..options(4) };
    let draw = |a: f32, b: f32| drawn(&with(&town, &[(1, a), (2, b)]), &view, false, &options);
    let frame = draw(0.35, 0.6);
    let wrong = off(&frame.color, &mixture([0.35, 0.6], &draw), 2);
    assert!(wrong * 100 <= frame.color.len(), "{wrong} pixels are no mixture");
    assert!(off(&frame.color, &draw(0.0, 0.0).color, 12) > 200, "nothing is seen of the layers");
}

#[test]
fn the_nearer_of_two_boxes_tints_the_other_from_either_side() {
    let [red, blue] = [Color::rgb(230, 30, 30), Color::rgb(30, 30, 230)];
    let boxes = |y: f64, color| LayerKind::Boxes(BoxLayer { opacity: 0.5, ..BoxLayer::new(vec![cube(0.0, y, 80.0, color)]) });
    let scene = scene(vec![layer("red", boxes(-100.0, red)), layer("blue", boxes(100.0, blue))]);
    for (from, near) in [(-1.0, 0), (1.0, 2)] {
        let camera = pinhole(DVec3::new(0.0, 900.0 * from, 60.0), DVec3::new(0.0, 0.0, 20.0), 20.0, IMAGE);
        let view = View::straight(camera);
        let frame = drawn(&scene, &view, false, &options(4));
        let middle = frame.color[36 * 96 + 48];
        let far = 2 - near;
        assert!(middle[near] > middle[far] + 20, "{middle:?} from {from}");
        assert_eq!(frame.id[36 * 96 + 48], 1 + near as u32 / 2);
        let draw = |a: f32, b: f32| drawn(&with(&scene, &[(0, a), (1, b)]), &view, false, &options(4));
        assert!(off(&frame.color, &mixture([0.5, 0.5], &draw), 1) == 0);
    }
}

#[test]
fn a_line_is_under_the_colour_of_what_it_is_behind_and_over_what_it_is_before() {
    let wall = BoxShape {
        base: DVec3::new(0.0, 0.0, 0.0),
        size: DVec3::new(120.0, 20.0, 90.0),
        yaw: 0.0,
        color: Color::rgb(90, 90, 200),
    };
    for hidden in [Hidden::Cut, Hidden::Dash] {
        let across = |y: f64, z: f64| line(vec![DVec3::new(-150.0, y, z), DVec3::new(150.0, y, z)], hidden);
        let lines = |y: f64| LayerKind::Line(across(y, if y < 0.0 { 60.0 } else { 30.0 }));
        let scene = scene(vec![
            layer("wall", LayerKind::Boxes(BoxLayer::new(vec![wall]))),
            layer("before", lines(-60.0)),
            layer("behind", lines(60.0)),
        ]);
        let view = View::straight(pinhole(DVec3::new(0.0, -400.0, 45.0), DVec3::new(0.0, 0.0, 45.0), 24.0, IMAGE));
        let draw = |a: f32, scene: &Scene| drawn(&with(scene, &[(0, a)]), &view, false, &options(4));
        let [half, whole, none] = [0.5, 1.0, 0.0].map(|a| draw(a, &scene));
        let without = belvedere_scene::Scene { layers: scene.layers[..2].to_vec(), ..scene.clone() };
        let bare = draw(0.5, &without);
        // Columns in the middle: the wall hides the line behind, which shows through whole at one half, without dashes.
        let rows = |frame: &Frame, id: u32| (0..72).filter(|y| frame.id[y * 96 + 48] == id).collect::<Vec<_>>();
        let (before, behind) = (rows(&none, 2), rows(&none, 3));
        assert!(before.len() >= 2 && behind.len() >= 2, "both lines are drawn");
        assert!(rows(&whole, 3).is_empty() && rows(&half, 2) == before && rows(&half, 3) == behind);
        for x in 40..56 {
            for y in &before {
                assert_eq!(half.color[y * 96 + x], none.color[y * 96 + x], "over the wall");
            }
            for y in &behind {
                let i = y * 96 + x;
                let solid = linear(bare.color[i]) - 0.5 * linear(draw(0.0, &without).color[i]);
                let want = encode(solid + 0.5 * linear(none.color[i]));
                assert!(off(&[half.color[i]], &[want], 1) == 0, "{:?} is not {want:?}", half.color[i]);
            }
        }
    }
}

#[test]
fn a_layer_of_no_opacity_is_not_there_and_a_pale_one_casts_its_whole_shadow() {
    let (town, options) = (town(), options(4));
    let (_, view) = views(IMAGE).swap_remove(0);
    let boxes = Scene { layers: town.layers[..2].to_vec(), ..town.clone() };
    let ground = Scene { layers: town.layers[..1].to_vec(), ..town.clone() };
    let draw = |scene: &Scene| drawn(scene, &view, true, &options);
    let (none, bare) = (draw(&with(&boxes, &[(1, 0.0)])), draw(&ground));
    assert!(none.id == bare.id && off(&none.color, &bare.color, 1) == 0);
    let (whole, pale) = (draw(&boxes), draw(&with(&boxes, &[(1, 0.01)])));
    // Ground beside the boxes: the same in both, and darker than without them in their shadows.
    let apart = |i: &usize| {
        let (x, y) = (i % 96, i / 96);
        (x.max(1) - 1..(x + 2).min(96)).all(|u| (y.max(1) - 1..(y + 2).min(72)).all(|v| whole.id[v * 96 + u] == 1))
    };
    let ground: Vec<usize> = (0..96 * 72).filter(apart).collect();
    let of = |frame: &Frame| ground.iter().map(|i| frame.color[*i]).collect::<Vec<_>>();
    assert_eq!(off(&of(&whole), &of(&pale), 0), 0);
    assert!(off(&of(&whole), &of(&bare), 10) > 50);
    let traced = trace(&with(&boxes, &[(1, 0.0)]), &view, &options);
    assert!(traced.id == trace(&Scene { layers: town.layers[..1].to_vec(), ..town.clone() }, &view, &options).id);
}
