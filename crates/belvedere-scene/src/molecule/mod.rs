//! Molecules: atoms, residues and bonds as plain data, selections of atoms, and surfaces as triangles.

mod assembly;
mod bonds;
mod density;
mod element;
mod iso;
mod joined;
mod layer;
mod near;
mod openness;
mod orders;
mod ribbon;
mod secondary;
mod selection;
mod shape;
mod sky;
mod sphere;
mod style;
mod surface;
mod trace;

pub use assembly::{Copies, Operation};
pub use bonds::BOND_TOLERANCE;
pub use element::Element;
pub use layer::{MoleculeFilm, MoleculeLayer};
pub use secondary::Secondary;
pub use selection::{Selection, SelectionError};
pub use style::{ModelTransform, MoleculeColor, MoleculeStyle, Paint, Representation, Shown};

use belvedere_core::{Aabb, DVec3};

/// One atom.
#[derive(Debug, Clone, PartialEq)]
pub struct Atom {
    /// Number in the file.
    pub serial: i64,
    /// Name, unique within its residue: `CA`, `O5'`.
    pub name: String,
    /// Element.
    pub element: Element,
    /// Index of its residue.
    pub residue: u32,
    /// Centre, angstrom.
    pub position: DVec3,
}

/// A building block: an amino acid, a nucleotide, a water, an ion.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Residue {
    /// Name: `ALA`, `DG`, `HOH`.
    pub name: String,
    /// Number within its chain.
    pub number: i32,
    /// Letter that tells residues of the same number apart.
    pub insertion: Option<char>,
    /// Chain, possibly empty.
    pub chain: String,
    /// Whether the file calls it a hetero group: neither amino acid nor nucleotide of a chain.
    pub hetero: bool,
}

impl Residue {
    /// Whether it is a water, by the names that files and force fields use.
    pub fn is_water(&self) -> bool {
        const NAMES: [&str; 8] = ["HOH", "WAT", "H2O", "SOL", "DOD", "TIP", "TIP3", "SPC"];
        NAMES.iter().any(|n| self.name.eq_ignore_ascii_case(n)) || self.name.eq_ignore_ascii_case("TIP4")
    }
}

impl std::fmt::Display for Residue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.chain.is_empty() {
            write!(f, "chain {} ", self.chain)?;
        }
        write!(f, "{} {}", self.name, self.number)?;
        self.insertion.map_or(Ok(()), |letter| write!(f, "{letter}"))
    }
}

/// Errors of a molecule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MoleculeError {
    /// There is no atom.
    #[error("there is no atom; at least one is needed")]
    Empty,
    /// More atoms than `Molecule::MAX`.
    #[error("there are {atoms} atoms, at most {limit} are possible; leave some out", limit = Molecule::MAX)]
    TooMany {
        /// Number of atoms given.
        atoms: usize,
    },
    /// A coordinate is not finite, or beyond `Molecule::FARTHEST`.
    #[error(
        "atom {serial} lies at {position}, beyond the {limit} angstrom within which atoms are drawn; repair the file",
        limit = Molecule::FARTHEST
    )]
    Position {
        /// Number in the file.
        serial: i64,
        /// Its position, angstrom.
        position: DVec3,
    },
    /// An atom names a residue that does not exist.
    #[error("atom {serial} belongs to residue {residue} of {residues}; repair the file")]
    Residue {
        /// Number in the file.
        serial: i64,
        /// Index of the residue.
        residue: u32,
        /// Number of residues.
        residues: usize,
    },
    /// A bond names an atom that does not exist, or joins an atom with itself.
    #[error("a bond joins atoms {a} and {b} of {atoms}; name two different ones", a = bond[0], b = bond[1])]
    Bond {
        /// Indices of its atoms.
        bond: [u32; 2],
        /// Number of atoms.
        atoms: usize,
    },
}

/// Atoms in residues, and the bonds between them. Plain data: finite, every residue and every bonded atom exists.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Molecule {
    atoms: Vec<Atom>,
    residues: Vec<Residue>,
    bonds: Vec<[u32; 2]>,
    /// Order of each bond, 1..=3.
    orders: Vec<u8>,
    /// Structure of the backbone at each residue; empty = not stated.
    structure: Vec<Secondary>,
    /// Number of the copy that each residue belongs to, from 1; empty = nothing is copied.
    copies: Vec<u32>,
}

impl Molecule {
    /// Most atoms.
    pub const MAX: usize = 1 << 24;
    /// Largest coordinate, angstrom.
    pub const FARTHEST: f64 = 1e6;

    /// A molecule with exactly these bonds: pairs of indices of atoms, in any order, each counted once.
    ///
    /// # Errors
    /// [`MoleculeError`].
    pub fn new(atoms: Vec<Atom>, residues: Vec<Residue>, bonds: &[[u32; 2]]) -> Result<Self, MoleculeError> {
        if atoms.is_empty() {
            return Err(MoleculeError::Empty);
        }
        if atoms.len() > Self::MAX {
            return Err(MoleculeError::TooMany { atoms: atoms.len() });
        }
        let drawable = |p: DVec3| p.abs().max_element() <= Self::FARTHEST && p.is_finite();
        if let Some(a) = atoms.iter().find(|a| !drawable(a.position)) {
            return Err(MoleculeError::Position { serial: a.serial, position: a.position });
        }
        if let Some(a) = atoms.iter().find(|a| a.residue as usize >= residues.len()) {
            let (serial, residue, residues) = (a.serial, a.residue, residues.len());
            return Err(MoleculeError::Residue { serial, residue, residues });
        }
        let wrong = |b: &&[u32; 2]| b[0] == b[1] || b.iter().any(|i| *i as usize >= atoms.len());
        if let Some(bond) = bonds.iter().find(wrong) {
            return Err(MoleculeError::Bond { bond: *bond, atoms: atoms.len() });
        }
        let mut bonds: Vec<[u32; 2]> = bonds.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
        bonds.sort_unstable();
        bonds.dedup();
        let orders = vec![1; bonds.len()];
        Ok(Self { atoms, residues, bonds, orders, structure: Vec::new(), copies: Vec::new() })
    }

    /// A molecule with the bonds that the file names and those found by distance, see [`BOND_TOLERANCE`]; of the orders that amino acids
    /// and nucleotides have, else 1.
    ///
    /// # Errors
    /// [`MoleculeError`].
    pub fn bonded(atoms: Vec<Atom>, residues: Vec<Residue>, named: &[[u32; 2]]) -> Result<Self, MoleculeError> {
        let mut molecule = Self::new(atoms, residues, named)?;
        molecule.bonds.extend(bonds::by_distance(&molecule.atoms));
        molecule.bonds.sort_unstable();
        molecule.bonds.dedup();
        molecule.orders = orders::standard(&molecule);
        Ok(molecule)
    }

    /// The same with these orders of some bonds, 1..=3 (others are brought into that range). Pairs that are not bonded are passed over.
    pub fn with_orders(mut self, orders: &[([u32; 2], u8)]) -> Self {
        for ([a, b], order) in orders {
            if let Ok(at) = self.bonds.binary_search(&[*a.min(b), *a.max(b)]) {
                self.orders[at] = (*order).clamp(1, 3);
            }
        }
        self
    }

    /// The same where the structure of the backbone is stated, one per residue; none or another number of them = not stated.
    pub fn with_structure(mut self, structure: Vec<Secondary>) -> Self {
        self.structure = if structure.len() == self.residues.len() { structure } else { Vec::new() };
        self
    }

    /// The same with its atoms at other places, angstrom; an atom for which there is none, or none that is finite, stays.
    pub fn at(&self, places: &[DVec3]) -> Self {
        let mut out = self.clone();
        for (atom, place) in out.atoms.iter_mut().zip(places).filter(|(_, place)| place.is_finite()) {
            atom.position = *place;
        }
        out
    }

    /// Atoms, in the order of the file.
    pub fn atoms(&self) -> &[Atom] {
        &self.atoms
    }

    /// Residues.
    pub fn residues(&self) -> &[Residue] {
        &self.residues
    }

    /// Bonds as pairs of indices, the smaller first, in rising order.
    pub fn bonds(&self) -> &[[u32; 2]] {
        &self.bonds
    }

    /// Order of each of [`Molecule::bonds`], 1..=3.
    pub fn orders(&self) -> &[u8] {
        &self.orders
    }

    /// Structure of the backbone at each residue, as the file states it; empty if it does not.
    pub fn structure(&self) -> &[Secondary] {
        &self.structure
    }

    /// Whether it holds copies, see [`Molecule::assembled`].
    pub fn has_copies(&self) -> bool {
        self.copies.iter().any(|copy| *copy > 1)
    }

    /// Number of the copy that a residue belongs to, from 1.
    pub fn copy(&self, residue: usize) -> u32 {
        self.copies.get(residue).copied().unwrap_or(1)
    }

    fn has_copy_at(&self, atom: usize) -> bool {
        self.copy(self.atoms[atom].residue as usize) > 1
    }

    /// Chain of a residue in the file: without the number of its copy.
    pub fn chain_in_file(&self, residue: usize) -> &str {
        let chain = self.residues[residue].chain.as_str();
        match self.copy(residue) {
            1 => chain,
            copy => chain.strip_suffix(&format!("-{copy}")).unwrap_or(chain),
        }
    }

    /// Residue of an atom.
    pub fn residue_of(&self, atom: usize) -> &Residue {
        &self.residues[self.atoms[atom].residue as usize]
    }

    /// Names of the chains in the order of their first residues.
    pub fn chains(&self) -> Vec<&str> {
        let mut out: Vec<&str> = Vec::new();
        let mut last = None;
        for r in &self.residues {
            if last != Some(r.chain.as_str()) && !out.contains(&r.chain.as_str()) {
                out.push(&r.chain);
            }
            last = Some(r.chain.as_str());
        }
        out
    }

    /// Readable name of an atom: `atom O5' of chain A DC 1`.
    pub fn name_of(&self, atom: usize) -> String {
        format!("atom {} of {}", self.atoms[atom].name, self.residue_of(atom))
    }

    /// Smallest box around the centres, angstrom.
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.atoms.iter().map(|a| a.position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atom(serial: i64, x: f64) -> Atom {
        Atom { serial, name: "C".into(), element: Element::C, residue: 0, position: DVec3::new(x, 0.0, 0.0) }
    }

    #[test]
    fn faulty_molecules_are_refused() {
        let residues = || vec![Residue::default()];
        let two = || vec![atom(1, 0.0), atom(2, 1.5)];
        assert_eq!(Molecule::new(vec![], residues(), &[]), Err(MoleculeError::Empty));
        let lost = Molecule::new(vec![atom(7, f64::NAN)], residues(), &[]);
        assert!(matches!(lost, Err(MoleculeError::Position { serial: 7, .. })));
        let far = Molecule::new(vec![atom(7, 2e6)], residues(), &[]).unwrap_err();
        assert!(far.to_string().contains("beyond the 1000000 angstrom"), "{far}");
        assert!(matches!(Molecule::new(two(), vec![], &[]), Err(MoleculeError::Residue { serial: 1, .. })));
        for bond in [[0, 2], [1, 1]] {
            assert_eq!(Molecule::new(two(), residues(), &[bond]), Err(MoleculeError::Bond { bond, atoms: 2 }));
        }
        let fine = Molecule::new(two(), residues(), &[[1, 0], [0, 1]]).unwrap();
        assert_eq!(fine.bonds(), [[0, 1]]);
    }

    #[test]
    fn atoms_have_names_that_people_know() {
        let residue = Residue { name: "DC".into(), number: 5, insertion: Some('B'), chain: "A".into(), hetero: false };
        let m = Molecule::new(vec![atom(1, 0.0)], vec![residue], &[]).unwrap();
        assert_eq!(m.name_of(0), "atom C of chain A DC 5B");
        assert_eq!(m.chains(), ["A"]);
    }
}
