//! Copies of a molecule's parts, turned and moved: biological assemblies.

use super::{Atom, Molecule, MoleculeError};
use belvedere_core::{DMat3, DVec3};

/// A rotation and a shift, angstrom; the rotation comes first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operation {
    /// Rotation.
    pub turn: DMat3,
    /// Added last, angstrom.
    pub to: DVec3,
}

impl Operation {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self { turn: DMat3::IDENTITY, to: DVec3::ZERO };

    /// Image of a point.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.turn * p + self.to
    }

    /// The operation that does `first`, and then this one.
    pub fn after(&self, first: &Self) -> Self {
        Self { turn: self.turn * first.turn, to: self.apply(first.to) }
    }

    /// Whether it keeps distances to a thousandth, reflections included, so that copies are no distorted ones.
    pub fn is_rigid(&self) -> bool {
        let gram = self.turn.transpose() * self.turn - DMat3::IDENTITY;
        self.to.is_finite() && gram.to_cols_array().iter().all(|v| v.abs() < 1e-3)
    }
}

/// Some residues of a molecule, and the operations that each make a copy of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Copies {
    /// Ranges of indices of residues: from, and one past the last.
    pub residues: Vec<[u32; 2]>,
    /// One per copy.
    pub operations: Vec<Operation>,
}

impl Molecule {
    /// The molecule of all copies, with the bonds within each. Copy k > 1 of a residue of chain A stands in chain `A-k`; atoms keep their
    /// numbers. Residues that no part names are left out.
    ///
    /// # Errors
    /// [`MoleculeError`], before memory is taken, if there are too many atoms, or none.
    pub fn assembled(&self, parts: &[Copies]) -> Result<Self, MoleculeError> {
        let (count, residue_count) = (self.residues.len(), self.residues.len() as u32);
        let mut sizes = vec![0u64; count];
        self.atoms.iter().for_each(|a| sizes[a.residue as usize] += 1);
        let inside = |&[from, to]: &[u32; 2]| [from.min(residue_count), to.min(residue_count)];
        let of_part = |part: &Copies| {
            let once: u64 = part.residues.iter().map(inside).flat_map(|[a, b]| a..b).map(|r| sizes[r as usize]).sum();
            once.saturating_mul(part.operations.len() as u64)
        };
        let total = parts.iter().map(of_part).fold(0u64, u64::saturating_add);
        if total == 0 {
            return Err(MoleculeError::Empty);
        }
        if total > Self::MAX as u64 {
            return Err(MoleculeError::TooMany { atoms: usize::try_from(total).unwrap_or(usize::MAX) });
        }
        let mut out = Builder {
            made: vec![0; count],
            from: self,
            atoms: Vec::with_capacity(total as usize),
            ..Builder::of(self)
        };
        for part in parts {
            let ranges: Vec<[u32; 2]> = part.residues.iter().map(inside).collect();
            for operation in &part.operations {
                out.add(&ranges, operation);
            }
        }
        let Builder { atoms, residues, bonds, orders, structure, copies, .. } = out;
        let mut molecule = Self::new(atoms, residues, &[])?;
        (molecule.bonds, molecule.orders) = (bonds, orders);
        (molecule.structure, molecule.copies) = (structure, copies);
        Ok(molecule)
    }
}

struct Builder<'m> {
    from: &'m Molecule,
    atoms: Vec<Atom>,
    residues: Vec<super::Residue>,
    bonds: Vec<[u32; 2]>,
    orders: Vec<u8>,
    structure: Vec<super::Secondary>,
    copies: Vec<u32>,
    /// Copies of each residue so far.
    made: Vec<u32>,
    /// Index among the copies of the residue and of the atom that were copied last, or `NONE`.
    residue_at: Vec<u32>,
    atom_at: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl<'m> Builder<'m> {
    fn of(from: &'m Molecule) -> Self {
        Self {
            from,
            atoms: Vec::new(),
            residues: Vec::new(),
            bonds: Vec::new(),
            orders: Vec::new(),
            structure: Vec::new(),
            copies: Vec::new(),
            made: Vec::new(),
            residue_at: Vec::new(),
            atom_at: Vec::new(),
        }
    }

    /// Adds one copy of ranges of residues.
    fn add(&mut self, ranges: &[[u32; 2]], operation: &Operation) {
        let from = self.from;
        self.residue_at.clear();
        self.residue_at.resize(from.residues.len(), NONE);
        for r in ranges.iter().flat_map(|&[a, b]| a as usize..b as usize) {
            if self.residue_at[r] != NONE {
                continue;
            }
            self.made[r] += 1;
            self.residue_at[r] = self.residues.len() as u32;
            let (mut residue, copy) = (from.residues[r].clone(), self.made[r]);
            if copy > 1 {
                residue.chain = format!("{}-{copy}", residue.chain);
            }
            self.residues.push(residue);
            self.copies.push(copy);
            self.structure.extend(from.structure.get(r));
        }
        self.atom_at.clear();
        self.atom_at.resize(from.atoms.len(), NONE);
        for (i, atom) in from.atoms.iter().enumerate() {
            let residue = self.residue_at[atom.residue as usize];
            if residue != NONE {
                self.atom_at[i] = self.atoms.len() as u32;
                self.atoms.push(Atom { residue, position: operation.apply(atom.position), ..atom.clone() });
            }
        }
        for (&[a, b], &order) in from.bonds.iter().zip(&from.orders) {
            let [a, b] = [a, b].map(|i| self.atom_at[i as usize]);
            if a != NONE && b != NONE {
                self.bonds.push([a.min(b), a.max(b)]);
                self.orders.push(order);
            }
        }
    }
}

#[cfg(test)]
mod tests;
