use super::*;
use crate::molecule::{Element, Residue, Selection};

fn pair() -> Molecule {
    let residue = |chain: &str| Residue { name: "ALA".into(), number: 7, chain: chain.into(), ..Residue::default() };
    let atom = |i: i64, residue: u32| Atom {
        serial: i,
        name: "CA".into(),
        element: Element::C,
        residue,
        position: DVec3::new(1.5 * i as f64, 0.3, 2.0),
    };
    let atoms = vec![atom(1, 0), atom(2, 0), atom(3, 1)];
    Molecule::bonded(atoms, vec![residue("A"), residue("B")], &[]).unwrap()
}

#[test]
fn copies_have_their_shape_their_bonds_and_names_of_their_own() {
    let turn = DMat3::from_rotation_z(1.1) * DMat3::from_rotation_x(0.4);
    let moved = Operation { turn, to: DVec3::new(30.0, -4.0, 9.0) };
    let m = pair();
    let parts = [
        Copies { residues: vec![[0, 2]], operations: vec![Operation::IDENTITY, moved] },
        Copies { residues: vec![[1, 2]], operations: vec![moved.after(&moved)] },
    ];
    let all = m.assembled(&parts).unwrap();
    assert_eq!((all.atoms().len(), all.residues().len(), all.bonds().len()), (7, 5, 4));
    assert_eq!(all.chains(), ["A", "B", "A-2", "B-2", "B-3"]);
    for i in 0..3 {
        assert_eq!(all.atoms()[3 + i].position, moved.apply(m.atoms()[i].position));
        for k in 0..3 {
            let [here, there] = [&m, &all].map(|m| m.atoms());
            let far = here[i].position.distance(here[k].position);
            assert!((there[3 + i].position.distance(there[3 + k].position) - far).abs() < 1e-12);
        }
    }
    let twice = moved.apply(moved.apply(m.atoms()[2].position));
    assert!(all.atoms()[6].position.distance(twice) < 1e-12);
    let of = |text: &str| {
        let mask = Selection::parse(text).unwrap().mask(&all);
        mask.iter().map(|b| if *b { '1' } else { '0' }).collect::<String>()
    };
    assert_eq!(of("chain A"), "1101100", "all copies");
    assert_eq!((of("chain A-2"), of("chain B-3")), ("0001100".into(), "0000001".into()));
    assert_eq!((of("chain A and copy 1"), of("copy 2-3")), ("1100000".into(), "0001111".into()));
    // A name that looks like that of a copy, but is none, means what it says.
    assert_eq!(Selection::parse("chain A-2").unwrap().mask(&m), [false; 3]);
}

#[test]
fn too_many_copies_are_refused_before_memory_is_taken() {
    let copies = |n: usize| [Copies { residues: vec![[0, 2]], operations: vec![Operation::IDENTITY; n] }];
    let error = pair().assembled(&copies(6_000_000)).unwrap_err();
    assert!(error.to_string().contains("there are 18000000 atoms, at most 16777216"), "{error}");
    assert_eq!(pair().assembled(&[]), Err(MoleculeError::Empty));
    assert_eq!(
        pair().assembled(&[Copies { residues: vec![[2, 9]], operations: vec![Operation::IDENTITY] }]),
        Err(MoleculeError::Empty)
    );
}

#[test]
fn rigid_operations_are_told_from_others() {
    assert!(Operation::IDENTITY.is_rigid());
    assert!(Operation { turn: DMat3::from_rotation_y(2.0), to: DVec3::ONE }.is_rigid());
    assert!(!Operation { turn: 1.1 * DMat3::IDENTITY, to: DVec3::ZERO }.is_rigid());
    assert!(!Operation { turn: DMat3::ZERO, to: DVec3::ZERO }.is_rigid());
    assert!(!Operation { turn: DMat3::IDENTITY, to: DVec3::NAN }.is_rigid());
}
