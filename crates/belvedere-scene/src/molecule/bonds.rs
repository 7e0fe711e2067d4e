//! Bonds by distance.

use super::near::Cells;
use super::{Atom, Element};

/// Two atoms are bonded if their distance is below the sum of their covalent radii plus this, angstrom.
///
/// Bond lengths in good structures vary by less than 0.2 angstrom, atoms that are not bonded are more than 1 angstrom farther apart;
/// this value lies between, as in other programs. Atoms nearer than 0.4 angstrom are alternative positions of one atom.
pub const BOND_TOLERANCE: f64 = 0.45;

/// Atoms nearer than this, angstrom, are not bonded: they are alternative positions of one atom.
const TOO_NEAR: f64 = 0.4;

/// Bonds as pairs of indices, the smaller first. Elements that form ions, and unknown ones, are bonded to nothing; a hydrogen to its nearest
/// partner only. Time and memory are linear in the number of atoms.
pub(super) fn by_distance(atoms: &[Atom]) -> Vec<[u32; 2]> {
    let able: Vec<u32> = (0..atoms.len() as u32).filter(|&i| atoms[i as usize].element.shares_electrons()).collect();
    let atom = |k: usize| &atoms[able[k] as usize];
    let radius = able.iter().map(|&i| atoms[i as usize].element.covalent_radius()).fold(0.0, f64::max);
    if able.len() < 2 {
        return Vec::new();
    }
    let cells = Cells::new(able.iter().map(|&i| atoms[i as usize].position).collect(), 2.0 * radius + BOND_TOLERANCE);
    let mut out = Vec::new();
    for k in 0..able.len() {
        let a = atom(k);
        let mut nearest: Option<(f64, usize)> = None;
        cells.near(a.position, |other, squared| {
            let b = atom(other);
            let reach = a.element.covalent_radius() + b.element.covalent_radius() + BOND_TOLERANCE;
            if other == k || squared > reach * reach || squared < TOO_NEAR * TOO_NEAR {
                return;
            }
            if a.element == Element::H {
                if nearest.is_none_or(|best| (squared, other) < best) {
                    nearest = Some((squared, other));
                }
            } else if other < k && b.element != Element::H {
                out.push([able[other], able[k]]);
            }
        });
        if let Some((_, other)) = nearest {
            out.push([able[k.min(other)], able[k.max(other)]]);
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

#[cfg(test)]
mod tests;
