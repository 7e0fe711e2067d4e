//! Chains of amino acids and of nucleotides as lines through their alpha carbons and phosphorus atoms.

use super::secondary::by_places;
use super::{Element, Molecule, Secondary};
use belvedere_core::DVec3;

/// Kind of a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Protein,
    Nucleic,
}

/// A residue of a chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Link {
    pub(super) residue: u32,
    /// The atom that it stands at: alpha carbon, phosphorus, or the first of the sugar where there is no phosphorus.
    pub(super) atom: u32,
    pub(super) at: DVec3,
    /// Of a protein the direction of the double bond to oxygen, of a nucleotide that to the first carbon of the sugar.
    pub(super) side: Option<DVec3>,
    pub(super) structure: Secondary,
    pub(super) base: Option<Base>,
}

/// The base of a nucleotide.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Base {
    /// The nitrogen at the sugar.
    pub(super) atom: u32,
    /// Atoms of the rings.
    pub(super) rings: Vec<DVec3>,
    /// Across the plane of the rings, unit.
    pub(super) normal: DVec3,
}

/// A piece of a chain without gaps: two residues and more.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trace {
    pub(super) kind: Kind,
    pub(super) links: Vec<Link>,
}

/// Farthest apart that neighbours in a chain stand, angstrom: alpha carbons (3.8, cis 2.9), and phosphorus atoms (5 to 7.5).
const REACH: [f64; 2] = [4.6, 8.6];

/// Atoms of the rings of bases.
const RINGS: [&str; 9] = ["N1", "C2", "N3", "C4", "C5", "C6", "N7", "C8", "N9"];

/// Indices of the atoms of each residue, in the order of the file.
pub(super) struct ByResidue {
    first: Vec<u32>,
    order: Vec<u32>,
}

impl ByResidue {
    pub(super) fn of(molecule: &Molecule) -> Self {
        let mut first = vec![0u32; molecule.residues().len() + 1];
        molecule.atoms().iter().for_each(|a| first[a.residue as usize + 1] += 1);
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let (mut next, mut order) = (first.clone(), vec![0; molecule.atoms().len()]);
        for (i, a) in molecule.atoms().iter().enumerate() {
            let at = &mut next[a.residue as usize];
            order[*at as usize] = i as u32;
            *at += 1;
        }
        Self { first, order }
    }

    pub(super) fn atoms(&self, residue: usize) -> &[u32] {
        &self.order[self.first[residue] as usize..self.first[residue + 1] as usize]
    }
}

/// All traces of a molecule through atoms that are drawn.
pub(super) fn traces(molecule: &Molecule, drawn: &[bool], by_residue: &ByResidue) -> Vec<Trace> {
    let mut out: Vec<Trace> = Vec::new();
    let mut last: Option<(Kind, u32)> = None;
    for r in 0..molecule.residues().len() {
        let Some((kind, link)) = link(molecule, drawn, by_residue.atoms(r), r as u32) else { continue };
        let goes_on = last.is_some_and(|(before, residue)| {
            before == kind && molecule.residues()[residue as usize].chain == molecule.residues()[r].chain
        });
        let reach = REACH[usize::from(kind == Kind::Nucleic)];
        match out.last_mut().filter(|_| goes_on) {
            Some(trace) if trace.links.last().is_some_and(|l| l.at.distance(link.at) < reach) => trace.links.push(link),
            _ => out.push(Trace { kind, links: vec![link] }),
        }
        last = Some((kind, r as u32));
    }
    out.retain(|trace| trace.links.len() > 1);
    let stated = !molecule.structure().is_empty();
    for trace in out.iter_mut().filter(|trace| trace.kind == Kind::Protein) {
        let found = if stated {
            trace.links.iter().map(|l| molecule.structure()[l.residue as usize]).collect()
        } else {
            by_places(&trace.links.iter().map(|l| l.at).collect::<Vec<_>>())
        };
        trace.links.iter_mut().zip(found).for_each(|(link, structure)| link.structure = structure);
    }
    out
}

/// The link that a residue is, if it is one of a chain.
fn link(molecule: &Molecule, drawn: &[bool], atoms: &[u32], residue: u32) -> Option<(Kind, Link)> {
    let all = molecule.atoms();
    let find = |names: &[&str]| {
        names.iter().find_map(|n| atoms.iter().copied().find(|&i| drawn[i as usize] && all[i as usize].name == *n))
    };
    let place = |i: u32| all[i as usize].position;
    let hetero = molecule.residues()[residue as usize].hetero;
    let carbon = find(&["CA"]).filter(|&i| all[i as usize].element == Element::C);
    if let Some(atom) = carbon {
        let (n, c) = (find(&["N"]), find(&["C"]));
        // A ligand with a carbon of that name has no such neighbours.
        let is_acid = if hetero { n.is_some() && c.is_some() } else { true };
        let side = c.zip(find(&["O", "OT1", "O1"])).map(|(c, o)| place(o) - place(c));
        let at = place(atom);
        let link = Link { residue, atom, at, side, structure: Secondary::Coil, base: None };
        return is_acid.then_some((Kind::Protein, link));
    }
    let sugar = find(&["C1'", "C1*"])?;
    let atom = find(&["P", "O5'", "O5*", "C5'", "C5*"])?;
    let rings: Vec<DVec3> = RINGS.iter().filter_map(|name| Some(place(find(&[name])?))).collect();
    let plane = [find(&["N1"]), find(&["C2"]), find(&["C4"])].map(|i| i.map(place));
    let base = match plane {
        [Some(a), Some(b), Some(c)] => {
            let normal = (b - a).cross(c - a).try_normalize();
            normal.zip(find(&["N9", "N1"])).map(|(normal, atom)| Base { atom, rings, normal })
        }
        _ => None,
    };
    let side = Some(place(sugar) - place(atom));
    Some((Kind::Nucleic, Link { residue, atom, at: place(atom), side, structure: Secondary::Coil, base }))
}

#[cfg(test)]
mod tests;
