//! Laws of the fallbacks, tested on a wall of boxes in front of a block.

use super::*;
use belvedere_core::Projection;
use belvedere_cpu::{CpuRenderer, ExactRenderer};
use belvedere_scene::molecule::{
    Atom, Element, ModelTransform, Molecule, MoleculeLayer, MoleculeStyle, Representation, Residue,
};
use belvedere_scene::{Aux, BoxLayer, BoxShape, Light, Progress, RenderJob, RenderOptions, Renderer, Unit};

/// Five boxes side by side in front of the eye, a block behind the middle one, and two boxes that hide nothing.
fn scene() -> Scene {
    let shape = |base: [f64; 3], size: [f64; 3]| BoxShape {
        base: DVec3::from_array(base),
        size: DVec3::from_array(size),
        yaw: 0.0,
        color: Color::rgb(180, (100.0 + base[0]) as u8, 60),
    };
    let mut wall: Vec<BoxShape> =
        (-2..=2).map(|k| shape([8.0 * f64::from(k), 50.0, -10.0], [7.9, 3.0, 20.0])).collect();
    // A fraction of a pixel next to the target, so that it hides nothing.
    wall.push(shape([20.865, 80.0, -10.0], [8.0, 1.0, 20.0]));
    wall.push(shape([0.0, 200.0, -10.0], [30.0, 5.0, 30.0]));
    let scene = Scene::default().with_layer("wall", BoxLayer::new(wall));
    let block = BoxLayer::new(vec![shape([0.0, 100.0, -6.0], [40.0, 8.0, 12.0])]);
    scene.with_layer("block", block)
}

fn view() -> View {
    let lens = Projection::Perspective { fov_y: 40f64.to_radians() };
    let pinhole = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, [180, 120], 1.0, None);
    View::straight(pinhole.unwrap())
}

fn planned(rule: &str) -> FallbackPlan {
    let scene = scene();
    let target = Target::layer(&scene, 1).unwrap();
    plan(&scene, &view(), ("block", &target), &[rule.parse().unwrap()]).unwrap()
}

fn by(renderer: &dyn Renderer, scene: &Scene, view: &View) -> Result<Frame, BelvedereError> {
    let options = RenderOptions { aux: Aux { world: true, exact: true }, ..RenderOptions::default() };
    let (light, progress) = (Light::default(), Progress::default());
    Ok(renderer.render(&RenderJob { scene, view, light: &light, options: &options, progress: &progress })?)
}

fn pictures(plan: &FallbackPlan) -> [Frame; 2] {
    let (cpu, view) = (CpuRenderer::default(), view());
    [&cpu as &dyn Renderer, &ExactRenderer].map(|r| plan.draw(&view, &|scene, view| by(r, scene, view)).unwrap().frame)
}

const RULES: [&str; 4] = ["transparency", "cutaway", "explosion", "wall:cutaway"];

#[test]
fn whatever_gives_way_the_target_is_seen_and_only_what_hides_it_gives_way() {
    for rule in RULES {
        let plan = planned(rule);
        let FallbackRecord { visible_before, visible, changed, .. } = &plan.record;
        assert!(*visible_before < 0.01 && *visible > 0.999, "{rule}: {visible_before} {visible}");
        // The three boxes in the middle, but neither those at the ends nor the objects next to the wall or behind it.
        assert!(changed.len() == 1 && changed[0].parts == 3 && changed[0].stuck == 0, "{rule}: {changed:?}");
        let [cpu, exact] = pictures(&plan);
        let alone = by(&CpuRenderer::default(), &occluders::without(&scene(), &[&whole(0)]), &view()).unwrap();
        let count = |f: &Frame| f.id.iter().filter(|id| **id == 2).count();
        assert_eq!(count(&cpu), count(&alone), "{rule}: as much is seen as with nothing else there");
        let differ = |a: [u8; 3], b: [u8; 3]| (0..3).any(|c| a[c].abs_diff(b[c]) > 12);
        let wrong = cpu.color.iter().zip(&exact.color).filter(|(a, b)| differ(**a, **b)).count();
        assert!(wrong * 100 < cpu.color.len(), "{rule}: {wrong} pixels differ between the renderers");
    }
}

fn whole(layer: usize) -> Part {
    Part { layer, number: None, corners: Vec::new(), spared: Vec::new() }
}

#[test]
fn a_cutaway_changes_nothing_beside_the_target() {
    let plan = planned("cutaway");
    let [cut, _] = pictures(&plan);
    let full = by(&CpuRenderer::default(), &scene(), &view()).unwrap();
    let region = region::mask(&view(), &plan.target, plan.margin_px + 3.0, [180, 120]);
    let changed: Vec<usize> = (0..region.len()).filter(|i| cut.color[*i] != full.color[*i]).collect();
    assert!(changed.len() > 200 && changed.iter().all(|i| region[*i]), "{}", changed.len());
    assert!(cut.id.contains(&1), "the rest of the wall stands");
}

#[test]
fn what_is_transparent_is_blended_over_what_lies_behind() {
    let plan = planned("transparency");
    let [blended, _] = pictures(&plan);
    let [full, open] = [scene(), occluders::without(&scene(), &plan.transparent.iter().collect::<Vec<_>>())]
        .map(|s| by(&CpuRenderer::default(), &s, &view()).unwrap());
    for i in 0..full.color.len() {
        for c in 0..3 {
            let [a, b] = [&full, &open].map(|f| f32::from(f.color[i][c]));
            assert!((f32::from(blended.color[i][c]) - (OPACITY * a + (1.0 - OPACITY) * b)).abs() <= 0.5);
        }
    }
    assert_ne!(full.color, open.color);
}

#[test]
fn parts_that_are_moved_keep_their_shape_and_go_no_farther_than_needed() {
    let plan = planned("explosion");
    let [LayerKind::Boxes(before), LayerKind::Boxes(after)] =
        [&scene(), plan.scene()].map(|s| s.layers[0].kind.clone())
    else {
        panic!("boxes")
    };
    let target = Extent::of(&view(), &plan.target.points).unwrap();
    let mut moved = 0;
    for (a, b) in before.boxes.iter().zip(&after.boxes) {
        assert_eq!((a.size, a.yaw, a.color), (b.size, b.yaw, b.color));
        if a.base == b.base {
            continue;
        }
        moved += 1;
        let at = |share: f64| {
            let base = a.base + share * (b.base - a.base);
            Extent::of(&view(), &BoxShape { base, ..*a }.corners()).unwrap()
        };
        assert!(!at(1.0).meets(&target, plan.margin_px) && at(0.999).meets(&target, plan.margin_px));
        assert!(b.base.z >= a.base.z, "nothing sinks into the ground");
    }
    assert_eq!(moved, 3);
}

#[test]
fn rules_that_cannot_be_followed_say_why() {
    let scene = scene();
    let target = Target::layer(&scene, 1).unwrap();
    let refused = |rule: &str| {
        let rule: Result<Fallback, String> = rule.parse();
        rule.and_then(|r| plan(&scene, &view(), ("block", &target), &[r]).map(|_| ()).map_err(|e| e.to_string()))
            .unwrap_err()
    };
    assert!(refused("wal:cutaway").contains("\"wall\""), "{}", refused("wal:cutaway"));
    assert!(refused("wall:melt").contains("possible are transparency"), "{}", refused("wall:melt"));
    assert!(
        possible(&LayerKind::Line(belvedere_scene::LineLayer::new(vec![], EDGE[0])), FallbackKind::Cutaway).is_err()
    );
}

/// An oxygen atom, alone in its residue, in the middle of a ball of carbon atoms that hides it from all sides.
fn molecule() -> Scene {
    let residue = |name: &str, number| Residue { name: name.into(), number, chain: "A".into(), ..Residue::default() };
    let atom =
        |serial, element, residue, position| Atom { serial, name: format!("X{serial}"), element, residue, position };
    let middle = DVec3::new(0.0, 40.0, 0.0);
    let around = (0..400).map(|k| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 400.0;
        let (sin, cos) = (2.399_963 * f64::from(k)).sin_cos();
        middle + 7.0 * DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
    });
    let mut atoms = vec![atom(0, Element::O, 0, middle)];
    atoms.extend(around.enumerate().map(|(k, p)| atom(k as i64 + 1, Element::C, 1, p)));
    let molecule = Molecule::new(atoms, vec![residue("COR", 1), residue("SHL", 2)], &[]).unwrap();
    let style = MoleculeStyle { representation: Representation::SpaceFilling, ..MoleculeStyle::default() };
    let layer = MoleculeLayer::new(molecule, &style, ModelTransform::default()).unwrap();
    Scene { unit: Unit::Angstrom, ..Scene::default() }.with_layer("ball", layer)
}

#[test]
fn atoms_of_a_molecule_are_spared_by_what_shows_them_and_measured_in_the_picture() {
    let scene = molecule();
    let target = Target::atoms(&scene, 0, &[0]).unwrap();
    for rule in ["transparency", "cutaway", "explosion"] {
        let plan = plan(&scene, &view(), ("COR", &target), &[rule.parse().unwrap()]).unwrap();
        assert_eq!(plan.record.changed.len(), 1, "{rule}: {:?}", plan.record);
        for renderer in [&CpuRenderer::default() as &dyn Renderer, &ExactRenderer] {
            let draw = |scene: &Scene, view: &View| by(renderer, scene, view);
            let picture = plan.draw(&view(), &draw).unwrap();
            let record = plan.measured(&view(), (&scene, &picture), &draw).unwrap();
            let frame = &picture.frame;
            assert!(record.pixels_alone > Some(50), "{rule}: {record:?}");
            assert!(record.visible_before == 0.0 && record.visible >= 0.99, "{rule}: {record:?}");
            // Oxygen is red and carbon grey, so the colour confirms the result.
            let [r, g, _] = frame.color[60 * 180 + 90];
            assert!(r > g + 40, "{rule}: {r} {g}");
            // For a picture that does not show the target, no visible part is reported.
            let full = FallbackPicture { frame: by(renderer, &scene, &view()).unwrap(), pixels_opened: None };
            assert_eq!(plan.measured(&view(), (&scene, &full), &draw).unwrap().visible, 0.0, "{rule}");
        }
    }
}
