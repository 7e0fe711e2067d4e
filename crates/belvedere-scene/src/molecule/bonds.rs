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
mod tests {
    use super::*;
    use belvedere_core::DVec3;

    fn atoms(list: &[(&str, [f64; 3])]) -> Vec<Atom> {
        let atom = |(i, (symbol, p)): (usize, &(&str, [f64; 3]))| Atom {
            serial: i as i64,
            name: (*symbol).into(),
            element: Element::from_symbol(symbol).unwrap_or_default(),
            residue: 0,
            position: DVec3::from_array(*p),
        };
        list.iter().enumerate().map(atom).collect()
    }

    #[test]
    fn neighbours_within_their_radii_are_bonded() {
        // Two waters (0.96 angstrom, 104.5 degrees) with a hydrogen bond of 1.9 angstrom between them, and a sodium ion.
        let water = [("O", [0.0; 3]), ("H", [0.96, 0.0, 0.0]), ("H", [-0.24, 0.93, 0.0])];
        let other = [("O", [2.86, 0.0, 0.0]), ("H", [3.3, 0.85, 0.0]), ("H", [3.3, -0.85, 0.0])];
        let ion = [("Na", [0.0, -2.3, 0.0]), ("X", [0.2, 0.1, 0.0])];
        let all = atoms(&[&water[..], &other, &ion].concat());
        assert_eq!(by_distance(&all), [[0, 1], [0, 2], [3, 4], [3, 5]]);
    }

    #[test]
    fn length_decides_and_places_taken_twice_are_no_bonds() {
        // The iodine far away makes the search look farther than carbon reaches.
        let pair = |d: f64| {
            by_distance(&atoms(&[("C", [5.0, 0.0, 0.0]), ("C", [5.0 + d, 0.0, 0.0]), ("I", [99.0, 0.0, 0.0])])).len()
        };
        assert_eq!([0.2, 1.2, 1.54, 1.96, 1.98, 3.0].map(pair), [0, 1, 1, 1, 0, 0]);
        // A hydrogen between two carbons belongs to the nearer.
        let shared = atoms(&[("C", [0.0; 3]), ("H", [1.2, 0.0, 0.0]), ("C", [2.3, 0.0, 0.0])]);
        assert_eq!(by_distance(&shared), [[1, 2]]);
        assert_eq!(by_distance(&atoms(&[("O", [0.0; 3])])), [[0u32; 2]; 0]);
    }

    #[test]
    fn a_long_chain_takes_linear_time() {
        let n = 200_000;
        let list: Vec<(&str, [f64; 3])> = (0..n).map(|i| ("C", [1.5 * f64::from(i), 0.0, 0.0])).collect();
        let start = web_time::Instant::now();
        assert_eq!(by_distance(&atoms(&list)).len(), n as usize - 1);
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }
}
