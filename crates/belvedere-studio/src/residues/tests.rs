use super::*;
use belvedere::scene::Unit;
use belvedere::scene::molecule::{Atom, Element, ModelTransform, Molecule, MoleculeStyle};

fn scene() -> Scene {
    let residue = |(chain, number, insertion, name): (&str, i32, Option<char>, &str)| Residue {
        name: name.into(),
        number,
        insertion,
        chain: chain.into(),
        hetero: name == "HOH",
    };
    let all = [
        ("A", 102, None, "ALA"),
        ("B", 102, None, "GLY"),
        ("B", 102, Some('A'), "SER"),
        ("B", -3, None, "DA"),
        ("", 7, None, "ZN"),
        ("B", 300, None, "HOH"),
    ];
    let atom = |i: usize| Atom {
        serial: i as i64,
        name: "CA".into(),
        element: Element::from_symbol("C").expect("carbon"),
        residue: i as u32,
        position: DVec3::new(20.0 * i as f64, 0.0, 0.0),
    };
    let molecule = Molecule::new((0..all.len()).map(atom).collect(), all.map(residue).to_vec(), &[]);
    let style = MoleculeStyle { selection: Selection::dry(), ..MoleculeStyle::default() };
    let layer = MoleculeLayer::new(molecule.expect("molecule"), &style, ModelTransform::default()).expect("layer");
    Scene { unit: Unit::Angstrom, ..Scene::default() }.with_layer("m", layer)
}

/// Residues that a selection means.
fn meant(scene: &Scene, select: &str) -> Vec<String> {
    let (_, layer) = molecule(scene, "m").expect("molecule");
    let selection = Selection::parse(select).expect("a selection");
    let atoms = (0..layer.molecule.atoms().len()).filter(|&i| selection.holds(&layer.molecule, i));
    atoms.map(|i| name(layer.molecule.residue_of(i))).collect()
}

#[test]
fn each_residue_that_is_drawn_is_listed_with_a_selection_that_means_it_alone() {
    let scene = scene();
    let all = residues(&scene, "m");
    let names: Vec<&str> = all.iter().map(|residue| residue.name.as_str()).collect();
    assert_eq!(names, ["A:102 ALA", "B:102 GLY", "B:102A SER", "B:-3 DA", "7 ZN"]);
    for residue in &all {
        assert_eq!(meant(&scene, &residue.select), [residue.name.as_str()], "{}", residue.select);
    }
    let (_, layer) = molecule(&scene, "m").expect("molecule");
    for (i, residue) in all.iter().enumerate() {
        let near = DVec3::new(20.0 * i as f64 + 0.4, 0.2, 0.0);
        assert_eq!(residue_at(layer, near).as_deref(), Some(residue.select.as_str()));
    }
}

#[test]
fn what_is_typed_means_the_residue() {
    let scene = scene();
    for text in ["B 102A", "b:102a", "B102A", "SER 102A", "B 102A SER", "resn SER", "chain B and resi 102A", " B/102A "]
    {
        let select = read_residues(&scene, "m", text).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(meant(&scene, &select), ["B:102A SER"], "{text}: {select}");
    }
    for (text, count) in [("102", 3), ("b -3", 1), ("7", 1), ("resi 100-110", 3)] {
        let select = read_residues(&scene, "m", text).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(meant(&scene, &select).len(), count, "{text}");
    }
    for (text, said) in
        [("C 102", "B 102"), ("B 999", "no atom is meant"), ("B 300", "no atom is drawn"), ("", "write chain")]
    {
        let said_so = read_residues(&scene, "m", text).expect_err(text).to_string();
        assert!(said_so.contains(said), "{text}: {said_so}");
    }
    assert!(read_residues(&scene, "other", "B 102").is_err());
}
