use super::*;
use belvedere::scene::molecule::{Atom, Element, ModelTransform, Molecule, MoleculeStyle, Residue};
use belvedere::scene::{BoxLayer, BoxShape, Color, LineFeature, LineLayer, PointFeature, PointLayer, PointStyle, Unit};
use std::time::{Duration, Instant};

fn points(names: impl Iterator<Item = String>) -> Scene {
    let feature = |(i, name)| PointFeature { name, position: DVec3::new(i as f64, 0.0, 0.0), style: None };
    let features = names.enumerate().map(feature).collect();
    let color = Color::rgb(0, 0, 0);
    let (size_px, style, hidden, lift_m) = (5.0, PointStyle::default(), Default::default(), 0.0);
    Scene::default().with_layer("huts", PointLayer { features, color, size_px, style, hidden, lift_m, beyond: 0.0 })
}

fn names<'i>(index: &'i NameIndex, text: &str) -> Vec<&'i str> {
    index.search(text, 20).best.into_iter().map(|i| index.things[i].name.as_str()).collect()
}

#[test]
fn what_begins_with_the_text_stands_before_what_holds_it_and_accents_do_not_matter() {
    let all = ["Sestrière", "Étoile", "Grand Étang", "Petoile", "Étang", "Łódź", "Straße"].map(str::to_owned);
    let index = NameIndex::of(&points(all.into_iter()));
    assert_eq!(names(&index, "etang"), ["Étang", "Grand Étang"]);
    assert_eq!(names(&index, "ETO"), ["Étoile", "Petoile"]);
    assert_eq!(names(&index, "E\u{301}toile"), ["Étoile", "Petoile"]);
    assert_eq!(names(&index, "lodz"), ["Łódź"]);
    assert_eq!(names(&index, "strasse"), ["Straße"]);
    assert_eq!(names(&index, "etang grand"), ["Grand Étang"]);
    assert_eq!(names(&index, "hut"), ["huts"], "layers have names, too");
    assert!(names(&index, "").is_empty() && names(&index, "nothing").is_empty());
}

#[test]
fn pieces_of_a_line_with_one_name_are_one_thing() {
    let piece = |x: f64| LineFeature {
        name: "Inn".into(),
        points: vec![DVec3::new(x, 0.0, 5.0), DVec3::new(x + 1.0, 2.0, 5.0)],
        style: None,
    };
    let line = LineLayer::new(vec![piece(0.0), piece(7.0)], Color::rgb(0, 0, 0));
    let index = NameIndex::of(&Scene::default().with_layer("rivers", line));
    let found = index.search("inn", 5);
    assert_eq!(found.total, 1);
    let bounds = index.get(found.best[0]).expect("it").bounds;
    assert_eq!((bounds.min, bounds.max), (DVec3::new(0.0, 0.0, 5.0), DVec3::new(8.0, 2.0, 5.0)));
}

#[test]
fn residues_chains_and_boxes_have_names_and_selections_of_atoms_are_found() {
    let residue = |chain: &str, number: i32, name: &str| Residue {
        name: name.into(),
        number,
        chain: chain.into(),
        ..Residue::default()
    };
    let residues = vec![residue("A", 12, "ALA"), residue("A", 120, "GLY"), residue("B", 12, "HOH")];
    let atom = |i: usize| Atom {
        serial: i as i64,
        name: "CA".into(),
        element: Element::from_symbol("C").expect("carbon"),
        residue: i as u32,
        position: DVec3::new(20.0 * i as f64, 0.0, 0.0),
    };
    let molecule = Molecule::new((0..3).map(atom).collect(), residues, &[]).expect("molecule");
    let style = MoleculeStyle::default();
    let layer = MoleculeLayer::new(molecule, &style, ModelTransform::default()).expect("layer");
    let shape = BoxShape { base: DVec3::ZERO, size: DVec3::ONE, yaw: 0.0, color: Color::rgb(0, 0, 0) };
    let scene = Scene { unit: Unit::Angstrom, ..Scene::default() }
        .with_layer("protein", layer)
        .with_layer("towers", BoxLayer::new(vec![shape]));
    let index = NameIndex::of(&scene);
    assert_eq!(names(&index, "a:12"), ["A:12 ALA", "A:120 GLY"]);
    assert_eq!((names(&index, "chain b"), names(&index, "towers/1")), (vec!["chain B"], vec!["towers/1"]));
    let bounds = index.get(index.search("A:120", 1).best[0]).expect("it").bounds;
    assert!(bounds.center().distance(DVec3::new(20.0, 0.0, 0.0)) < 1e-9 && bounds.max.x > 20.1);
    let selected = atoms_in(&scene, "resn ALA or resi 120").expect("atoms");
    assert!((selected.center().x - 10.0).abs() < 1.0, "{selected:?}");
    assert!(atoms_in(&scene, "resn XYZ").is_none() && atoms_in(&scene, "1,2,3").is_none());
}

#[test]
fn a_hundred_thousand_names_are_searched_within_a_frame() {
    let index = NameIndex::of(&points((0..100_000).map(|i| format!("Refuge numéro {i} de la Montagne"))));
    let mut longest = Duration::ZERO;
    for text in ["r", "re", "refuge", "numero 99999", "montagne", "99 montagne", "zzz"] {
        let began = Instant::now();
        let found = index.search(text, 30);
        longest = longest.max(began.elapsed());
        assert!(found.best.len() <= 30 && found.total <= index.len());
    }
    // A slow build of a test has room; a release build needs some milliseconds.
    assert!(longest < Duration::from_millis(if cfg!(debug_assertions) { 900 } else { 60 }), "{longest:?}");
    assert_eq!(index.search("refuge", 30).total, 100_000);
}
