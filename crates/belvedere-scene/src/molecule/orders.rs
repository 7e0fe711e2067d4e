//! Orders of bonds in amino acids and nucleotides, from their names.

use super::Molecule;

/// Residues by name, and the pairs of atoms that share four electrons in one of their mesomeric forms: chemistry, as any textbook has it.
const DOUBLE: [(&[&str], &[[&str; 2]]); 12] = [
    (&["ARG"], &[["CZ", "NH2"]]),
    (&["ASN", "ASP", "ASH"], &[["CG", "OD1"]]),
    (&["GLN", "GLU", "GLH"], &[["CD", "OE1"]]),
    (&["HIS", "HID", "HIE", "HIP", "HSD", "HSE", "HSP"], &[["CG", "CD2"], ["ND1", "CE1"]]),
    (&["PHE", "TYR"], &[["CG", "CD1"], ["CE1", "CZ"], ["CD2", "CE2"]]),
    (&["TRP"], &[["CG", "CD1"], ["CD2", "CE2"], ["CE3", "CZ3"], ["CZ2", "CH2"]]),
    (&["A", "DA", "ADE"], &[["N1", "C6"], ["C2", "N3"], ["C4", "C5"], ["N7", "C8"]]),
    (&["G", "DG", "GUA"], &[["C6", "O6"], ["C2", "N3"], ["C4", "C5"], ["N7", "C8"]]),
    (&["C", "DC", "CYT"], &[["C2", "O2"], ["N3", "C4"], ["C5", "C6"]]),
    (&["U", "DU", "URA"], &[["C2", "O2"], ["C4", "O4"], ["C5", "C6"]]),
    (&["T", "DT", "THY"], &[["C2", "O2"], ["C4", "O4"], ["C5", "C6"]]),
    (&["I", "DI"], &[["C6", "O6"], ["C2", "N3"], ["C4", "C5"], ["N7", "C8"]]),
];

/// The same in every amino acid and every nucleotide of a chain.
const BACKBONE: [[&str; 2]; 3] = [["C", "O"], ["P", "OP1"], ["P", "O1P"]];

/// Amino acids besides those of [`DOUBLE`].
const OTHERS: [&str; 14] =
    ["ALA", "CYS", "GLY", "ILE", "LEU", "LYS", "MET", "MSE", "PRO", "SER", "THR", "VAL", "CYX", "LYN"];

/// Order of each bond of a molecule: 2 for those that the names of residues and atoms tell, else 1.
pub(super) fn standard(molecule: &Molecule) -> Vec<u8> {
    let atoms = molecule.atoms();
    let is_double = |&[a, b]: &[u32; 2]| {
        let (a, b) = (&atoms[a as usize], &atoms[b as usize]);
        if a.residue != b.residue {
            return false;
        }
        let name = molecule.residues()[a.residue as usize].name.as_str();
        let row = DOUBLE.iter().find(|(names, _)| names.contains(&name));
        let own = row.map_or(&[][..], |(_, pairs)| pairs);
        let shared = if row.is_some() || OTHERS.contains(&name) { &BACKBONE[..] } else { &[] };
        let is =
            |pair: &[&str; 2]| (pair[0] == a.name && pair[1] == b.name) || (pair[1] == a.name && pair[0] == b.name);
        own.iter().chain(shared).any(is)
    };
    molecule.bonds().iter().map(|bond| 1 + u8::from(is_double(bond))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::{Atom, Element, Residue};
    use belvedere_core::DVec3;

    #[test]
    fn no_atom_of_a_table_shares_more_than_four_electrons_with_one_other() {
        for (names, pairs) in DOUBLE {
            let mut atoms: Vec<&str> = pairs.iter().flatten().copied().collect();
            atoms.sort_unstable();
            let count = atoms.len();
            atoms.dedup();
            assert_eq!(atoms.len(), count, "{names:?}");
        }
    }

    #[test]
    fn names_of_residues_and_atoms_tell_orders_and_files_may_say_otherwise() {
        let residue = |name: &str| Residue { name: name.into(), ..Residue::default() };
        let atom = |(i, (name, residue)): (usize, &(&str, u32))| Atom {
            serial: i as i64,
            name: (*name).into(),
            element: Element::C,
            residue: *residue,
            position: DVec3::new(1.3 * i as f64, 0.0, 0.0),
        };
        let list = [("CA", 0), ("C", 0), ("O", 0), ("C", 1), ("O", 1)];
        let atoms = list.iter().enumerate().map(atom).collect();
        let m = Molecule::bonded(atoms, vec![residue("GLY"), residue("LIG")], &[]).unwrap();
        assert_eq!((m.bonds(), m.orders()), (&[[0, 1], [1, 2], [2, 3], [3, 4]][..], &[1, 2, 1, 1][..]));
        let m = m.with_orders(&[([4, 3], 3), ([1, 2], 1), ([0, 4], 2), ([2, 3], 9)]);
        assert_eq!(m.orders(), [1, 1, 3, 3]);
    }
}
