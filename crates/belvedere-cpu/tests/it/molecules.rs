//! Molecules in both renderers: both draw the same picture, straight and bent, and report atoms at their true places.

use crate::exact::difference;
use crate::support::{pinhole, scene};
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{CurvedRays, DVec3, Stage, View};
use belvedere_scene::molecule::{ModelTransform, Representation, Selection};
use belvedere_scene::{Layer, MoleculeLayer, MoleculeStyle, Scene, Unit};
use belvedere_sight::trace::Tracer;

fn helix(representation: Representation) -> Scene {
    let (made, _) = belvedere_builtin::dna(7, 10).expect("the helix can be built");
    let Some(layer) = made.layers[0].kind.molecule() else { panic!("a molecule") };
    let style = MoleculeStyle { representation, ..MoleculeStyle::default() };
    let layer = MoleculeLayer::new(layer.molecule.clone(), &style, ModelTransform::default()).expect("well formed");
    let layers = vec![Layer { id: "dna".into(), must_see: false, kind: layer.into() }];
    Scene { unit: Unit::Angstrom, ..scene(layers) }
}

/// Rays that turn to the right half-way along the helix.
fn bent(model: Model, image: [u32; 2]) -> View {
    let eye = DVec3::new(0.0, -80.0, 10.0);
    let ph = pinhole(eye, DVec3::ZERO, 30.0, image);
    let at = |y: f64| DVec3::new(0.0, y, 0.0);
    let viewpoint = DVec3::new(45.0, -65.0, 12.0);
    let pencil = Pencil::Parallel { normal: -DVec3::Y };
    let turn = TurnSpec { viewpoint, t0: at(-9.0), t1: at(-3.0), t2: at(3.0), pencil, m: Sharpness::Bend };
    let rays = CurvedRays::new(&ph, model, &[turn]).unwrap_or_else(|e| panic!("{e}"));
    View::new(ph, vec![Stage::CurvedRays(rays)]).expect("one stage is in order")
}

#[test]
fn rasteriser_and_tracer_agree_on_molecules() {
    let image = [240, 200];
    for representation in [Representation::BallAndStick, Representation::SpaceFilling] {
        let scene = helix(representation);
        let straight = View::straight(pinhole(DVec3::new(0.0, -80.0, 10.0), DVec3::ZERO, 30.0, image));
        let views = [
            ("straight", straight),
            ("modified", bent(Model::Modified, image)),
            ("original", bent(Model::Original, image)),
            ("c0", bent(Model::C0, image)),
        ];
        for (name, view) in views {
            let d = difference(&scene, &view);
            assert!(d.judged > d.pixels / 2, "{representation:?} {name}: {d:?}");
            assert!(d.is_small(), "{representation:?} {name}: {d:?}");
        }
    }
}

#[test]
fn a_ray_at_an_atom_meets_that_atom_or_one_before_it() {
    let scene = helix(Representation::SpaceFilling);
    let Some(layer) = scene.layers[0].kind.molecule() else { panic!("a molecule") };
    let view = bent(Model::Modified, [240, 200]);
    let tracer = Tracer::new(&scene, &view);
    let oxygen = Selection::parse("element O").expect("a selection");
    let (mut own, mut others) = (0, 0);
    for i in (0..layer.molecule.atoms().len()).filter(|&i| oxygen.holds(&layer.molecule, i)) {
        let image = view.project(layer.center(i)).expect("in the domain");
        let hit = tracer.first_hit(image.pixel).expect("an atom stands there");
        let named = layer.name_of(hit.triangle().expect("of a molecule")).expect("of an atom");
        assert!(hit.depth < image.depth, "the surface lies before the centre");
        if named == layer.molecule.name_of(i) { own += 1 } else { others += 1 }
    }
    // Of the oxygens of the phosphates, those on the near side are not covered.
    assert!(own >= 20 && others >= 20, "{own} {others}");
}
