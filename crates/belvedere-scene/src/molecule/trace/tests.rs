use super::*;
use crate::molecule::{Atom, Residue};

#[test]
fn chains_end_at_gaps_other_chains_and_other_kinds() {
    let mut atoms = Vec::new();
    let mut residues = Vec::new();
    let mut add = |chain: &str, names: &[&str], element: Element, x: f64, hetero: bool| {
        let residue = residues.len() as u32;
        residues.push(Residue { name: "X".into(), chain: chain.into(), hetero, ..Residue::default() });
        for (k, name) in names.iter().enumerate() {
            let position = DVec3::new(x, k as f64, 0.0);
            let serial = atoms.len() as i64;
            atoms.push(Atom { serial, name: (*name).into(), element, residue, position });
        }
    };
    for x in [0.0, 3.8, 7.6, 20.0, 23.8] {
        add("A", &["CA"], Element::C, x, false);
    }
    add("B", &["CA"], Element::C, 27.6, false);
    add("B", &["CA"], Element::from_symbol("Ca").unwrap(), 31.0, true);
    add("B", &["CA"], Element::C, 31.4, true);
    add("B", &["N", "CA", "C", "O"], Element::C, 31.4, true);
    add("B", &["P", "C1'", "N1", "C2"], Element::C, 35.0, false);
    add("B", &["O5'", "C1'"], Element::C, 41.0, false);
    let m = Molecule::new(atoms, residues, &[]).unwrap();
    let by = ByResidue::of(&m);
    let found = traces(&m, &vec![true; m.atoms().len()], &by);
    let told: Vec<(Kind, Vec<u32>)> =
        found.iter().map(|t| (t.kind, t.links.iter().map(|l| l.residue).collect())).collect();
    let expected = vec![
        (Kind::Protein, vec![0, 1, 2]),
        (Kind::Protein, vec![3, 4]),
        (Kind::Protein, vec![5, 8]),
        (Kind::Nucleic, vec![9, 10]),
    ];
    assert_eq!(told, expected);
    assert_eq!(by.atoms(8).len(), 4);
    let none = traces(&m, &vec![false; m.atoms().len()], &by);
    assert_eq!(none, []);
}
