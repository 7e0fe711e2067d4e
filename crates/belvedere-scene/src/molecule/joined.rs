//! Molecules side by side as one.

use super::{Molecule, MoleculeError};

impl Molecule {
    /// The molecule of several, with the bonds within each. A residue of chain A of number k > 1 stands in chain `A-k` and belongs to
    /// copy k; atoms keep their numbers. Structure is kept where all state it.
    ///
    /// # Errors
    /// [`MoleculeError`] if there are too many atoms, or none.
    pub fn joined(all: Vec<Self>) -> Result<Self, MoleculeError> {
        let atoms = all.iter().map(|molecule| molecule.atoms.len()).fold(0usize, usize::saturating_add);
        if atoms > Self::MAX {
            return Err(MoleculeError::TooMany { atoms });
        }
        let states = all.iter().all(|molecule| !molecule.structure.is_empty());
        let mut out = Self::default();
        for (number, one) in (1u32..).zip(all) {
            let (first, residue) = (out.atoms.len() as u32, out.residues.len() as u32);
            for mut of_one in one.residues {
                if number > 1 {
                    of_one.chain = format!("{}-{number}", of_one.chain);
                }
                out.residues.push(of_one);
                out.copies.push(number);
            }
            for mut atom in one.atoms {
                atom.residue += residue;
                out.atoms.push(atom);
            }
            out.bonds.extend(one.bonds.into_iter().map(|bond| bond.map(|atom| atom + first)));
            out.orders.extend(one.orders);
            if states {
                out.structure.extend(one.structure);
            }
        }
        if out.atoms.is_empty() { Err(MoleculeError::Empty) } else { Ok(out) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Atom, Element, Residue};
    use super::*;
    use belvedere_core::DVec3;

    #[test]
    fn molecules_over_one_another_share_no_bonds() {
        let atom = |x: f64| Atom {
            serial: 7,
            name: "C".into(),
            element: Element::C,
            residue: 0,
            position: DVec3::new(x, 0.0, 0.0),
        };
        let residue = Residue { chain: "A".into(), ..Residue::default() };
        let one =
            |x: f64| Molecule::bonded(vec![atom(x), atom(x + 1.4)], vec![residue.clone()], &[]).expect("two atoms");
        let joined = Molecule::joined(vec![one(0.0), one(0.1)]).expect("four atoms");
        assert_eq!((joined.bonds(), joined.atoms().len()), (&[[0, 1], [2, 3]][..], 4));
        let chains: Vec<&str> = joined.residues().iter().map(|r| r.chain.as_str()).collect();
        assert_eq!((chains, joined.has_copies()), (vec!["A", "A-2"], true));
        assert_eq!(Molecule::joined(Vec::new()), Err(MoleculeError::Empty));
    }
}
