//! Surfaces that must be seen: boxes, meshes, molecules; by lines of sight and by the buffers of a picture.

use belvedere_construct::measure::FeatureMeasure;
use belvedere_construct::{MeasureOptions, measure, sample_features};
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{CurvedRays, DVec3, Pinhole, Projection, Stage, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::molecule::Selection;
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Layer, LayerKind, Mesh, MeshColors, MeshLayer, MoleculeLayer, MoleculeStyle, Progress,
    Scene,
};

fn layer(id: &str, must_see: bool, kind: LayerKind) -> Layer {
    Layer { id: id.into(), must_see, kind }
}

fn boxed(base: [f64; 3], size: [f64; 3]) -> BoxShape {
    BoxShape { base: base.into(), size: size.into(), yaw: 0.0, color: Color::rgb(200, 190, 180) }
}

fn boxes(list: &[BoxShape]) -> LayerKind {
    LayerKind::Boxes(BoxLayer::new(list.to_vec()))
}

fn pinhole(eye: [f64; 3]) -> Pinhole {
    let lens = Projection::Perspective { fov_y: 0.7 };
    Pinhole::look_at(eye.into(), DVec3::new(0.0, 0.0, 2.0), DVec3::Z, lens, [640, 480], 0.1, None).expect("a camera")
}

fn measured(layers: Vec<Layer>, view: &View) -> FeatureMeasure {
    let scene = Scene { layers, ..Scene::default() };
    let renderer = CpuRenderer::default();
    let options = MeasureOptions::default();
    let m = measure(&scene, view, Some(&renderer), &options, &Progress::silent()).expect("measured");
    m.surfaces.expect("a surface")
}

/// Both methods find `share` of the surface.
fn assert_shares(found: &FeatureMeasure, share: f64) {
    let (sight, buffer) = (found.bent.sight.share.unwrap(), found.bent.buffer.unwrap().share.unwrap());
    assert!((sight - share).abs() < 0.015 && (buffer - share).abs() < 0.025, "{share}: {sight} {buffer}");
}

#[test]
fn of_a_box_the_faces_that_look_at_the_eye_are_seen() {
    let block = || layer("block", true, boxes(&[boxed([0.0, 0.0, 0.0], [4.0, 4.0, 4.0])]));
    // Square in front of one wall: that one. From above one edge: two walls and the top. The base does not count.
    let front = View::straight(pinhole([0.0, -20.0, 2.0]));
    let found = measured(vec![block()], &front);
    assert!((found.total - 80.0).abs() < 1e-9 && found.samples >= 1000 && found.surface_spacing.unwrap() < 0.3);
    assert_shares(&found, 0.2);
    assert_shares(&measured(vec![block()], &View::straight(pinhole([14.0, -14.0, 14.0]))), 0.6);
    // Of two boxes of one layer, one right behind the other, depth alone tells which is seen.
    let row = [boxed([0.0, 0.0, 0.0], [4.0, 4.0, 4.0]), boxed([0.0, 8.0, 0.0], [4.0, 4.0, 4.0])];
    assert_shares(&measured(vec![layer("row", true, boxes(&row))], &front), 0.1);
    // A wall half-way hides the left half of the front from an eye in front.
    let wall = layer("wall", false, boxes(&[boxed([-5.0, -11.0, -10.0], [10.0, 0.02, 30.0])]));
    assert_shares(&measured(vec![block(), wall], &front), 0.1);
}

#[test]
fn a_mesh_is_seen_like_the_box_it_draws() {
    let shape = boxed([0.0, 0.0, 0.0], [4.0, 4.0, 4.0]);
    let faces =
        [[4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [1, 3, 7], [1, 7, 5], [3, 2, 6], [3, 6, 7], [2, 0, 4], [2, 4, 6]];
    let mesh = Mesh::new(&shape.corners(), faces.to_vec(), MeshColors::Layer).expect("well formed");
    let mesh = layer("block", true, LayerKind::Mesh(MeshLayer::new(mesh, shape.color)));
    let view = View::straight(pinhole([14.0, -14.0, 14.0]));
    let (of_mesh, of_box) = (measured(vec![mesh], &view), measured(vec![layer("block", true, boxes(&[shape]))], &view));
    assert!((of_mesh.total - of_box.total).abs() < 1e-6);
    assert_shares(&of_mesh, 0.6);
    assert_shares(&of_box, 0.6);
}

#[test]
fn a_turn_shows_what_a_wall_hides() {
    let block = layer("block", true, boxes(&[boxed([0.0, 6.0, 0.0], [4.0, 4.0, 4.0])]));
    let wall = layer("wall", false, boxes(&[boxed([0.0, -8.0, -10.0], [9.0, 0.5, 30.0])]));
    let ph = pinhole([0.0, -24.0, 2.0]);
    let at = |y: f64| DVec3::new(0.0, y, 2.0);
    let viewpoint = DVec3::new(22.0, -18.0, 6.0);
    let pencil = Pencil::Parallel { normal: -DVec3::Y };
    let turn = TurnSpec { viewpoint, t0: at(-6.0), t1: at(-3.0), t2: at(0.0), pencil, m: Sharpness::Bend };
    let rays = CurvedRays::new(&ph, Model::Modified, &[turn]).unwrap_or_else(|e| panic!("{e}"));
    let view = View::new(ph, vec![Stage::CurvedRays(rays)]).expect("in order");
    let found = measured(vec![block, wall], &view);
    assert!(
        found.straight.sight.share.unwrap() < 0.01 && found.straight.buffer.unwrap().share.unwrap() < 0.01,
        "{found:#?}"
    );
    let (sight, buffer) = (found.bent.sight.share.unwrap(), found.bent.buffer.unwrap().share.unwrap());
    assert!(sight > 0.25 && (sight - buffer).abs() < 0.03, "{sight} {buffer}");
}

#[test]
fn of_a_molecule_the_selected_atoms_are_sampled() {
    let (made, _) = belvedere_builtin::dna(7, 10).expect("the helix can be built");
    let Some(dna) = made.layers[0].kind.molecule() else { panic!("a molecule") };
    let dna = MoleculeLayer::new(dna.molecule.clone(), &MoleculeStyle::default(), dna.placement).expect("well formed");
    let wanted = Selection::parse("chain B and resi 13").expect("a selection");
    let mask = wanted.mask(&dna.molecule);
    let scene =
        Scene { layers: vec![layer("dna", true, LayerKind::Molecule(Box::new(dna.clone().wanting(wanted))))], ..made };
    let features = sample_features(&scene, 0.1);
    assert_eq!((features.len(), features[0].name.as_str()), (1, "chain B and resi 13"));
    for s in &features[0].samples {
        let near = |i: usize| dna.center(i).distance(s.p_world) < 1.0;
        assert!((0..mask.len()).any(|i| mask[i] && near(i)), "{}", s.p_world);
    }
    // About as much as its balls and rods together.
    let total: f64 = features[0].samples.iter().map(|s| s.amount).sum();
    assert!((60.0..110.0).contains(&total), "{total}");
}
