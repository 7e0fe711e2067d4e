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
        let want = mixture([0.35, 0.6], &draw);
        let [some, much] = [2, 8].map(|steps| off(&frame.color, &want, steps));
        // Samples of the ground share colours in one picture and not in the other.
        assert!(some * 500 <= frame.color.len() && much == 0, "{name}: {some} and {much} pixels are no mixture");
        assert!(off(&frame.color, &bare.color, 12) > frame.color.len() / 8, "{name}: nothing is seen of the layers");
        assert!(bare.id != whole.id && frame.id == bare.id && frame.depth == bare.depth, "{name}: as of what hides");
        assert!(bare.id.contains(&3), "{name}: the plate stays");
    }
}

#[test]
fn traced_pictures_are_mixtures_too_and_those_of_the_rasteriser() {
    let (town, options) = (town(), options(4));
    for (name, view) in views([48, 36]).into_iter().step_by(2) {
        let draw = |a: f32, b: f32| trace(&with(&town, &[(1, a), (2, b)]), &view, &options);
        let apart = |a: f32, b: f32| {
            let other = drawn(&with(&town, &[(1, a), (2, b)]), &view, false, &options);
            off(&draw(a, b).color, &other.color, 6)
        };
        let frame = draw(0.35, 0.6);
        let own = off(&frame.color, &mixture([0.35, 0.6], &draw), 2);
        assert!(own * 50 <= frame.color.len(), "{name}: {own} pixels are no mixture");
        // The tracer finds borders by pixel centres, the rasteriser by samples.
        let (found, usual) = (apart(0.35, 0.6), apart(1.0, 1.0));
        assert!(2 * found <= 3 * usual + 20, "{name}: {found} pixels are not the rasteriser's, usually {usual}");
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
    let boxes =
        |y: f64, color| LayerKind::Boxes(BoxLayer { opacity: 0.5, ..BoxLayer::new(vec![cube(0.0, y, 80.0, color)]) });
    let scene = scene(vec![layer("red", boxes(-100.0, red)), layer("blue", boxes(100.0, blue))]);
    for from in [-1.0, 1.0] {
        let camera = pinhole(DVec3::new(0.0, 900.0 * from, 60.0), DVec3::new(0.0, 0.0, 20.0), 20.0, IMAGE);
        let view = View::straight(camera);
        let frame = drawn(&scene, &view, false, &options(4));
        let draw = |a: f32, b: f32| drawn(&with(&scene, &[(0, a), (1, b)]), &view, false, &options(4));
        let middle = 36 * 96 + 48;
        let [both, red, blue, none] =
            [(0.5, 0.5), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)].map(|(a, b)| draw(a, b).color[middle]);
        let over = |near: [u8; 3], far: [u8; 3]| encode(0.5 * linear(near) + 0.25 * (linear(far) + linear(none)));
        let (want, other) =
            if from < 0.0 { (over(red, blue), over(blue, red)) } else { (over(blue, red), over(red, blue)) };
        assert!(off(&[both], &[want], 1) == 0 && off(&[both], &[other], 8) == 1, "{both:?}, {want:?} from {from}");
        assert_eq!((frame.id[middle], frame.depth[middle]), (0, f32::INFINITY));
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
    let mut whole_and_cut = None;
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
        // Columns in the middle: the wall hides the line behind, which shows through whole at one half, without dashes.
        let rows = |frame: &Frame, id: u32| (0..72).filter(|y| frame.id[y * 96 + 48] == id).collect::<Vec<_>>();
        let (before, behind) = (rows(&none, 2), rows(&none, 3));
        assert!(before.len() >= 2 && behind.len() >= 2, "both lines are drawn");
        let whole = &*whole_and_cut.get_or_insert(whole);
        assert!(rows(whole, 3).is_empty() && rows(&half, 2) == before && rows(&half, 3) == behind);
        for x in 40..56 {
            for y in &before {
                let i = y * 96 + x;
                assert!(off(&[half.color[i]], &[none.color[i]], 1) == 0, "over the wall");
            }
            for y in &behind {
                let i = y * 96 + x;
                let want = encode(0.5 * (linear(whole.color[i]) + linear(none.color[i])));
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
    assert!(none.id == bare.id);
    let far = [1, 2, 3, 6].map(|step| off(&none.color, &bare.color, step));
    assert!(far[1] == 0, "{far:?} pixels differ");
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
