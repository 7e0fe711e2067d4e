//! B-DNA: two strands of random sequence wound about the z axis, built from the position of each atom in a base pair.

use super::{BuiltinError, SuggestedCamera};
use crate::noise::seeded;
use belvedere_core::DVec3;
use belvedere_scene::molecule::{Atom, Element, ModelTransform, Residue};
use belvedere_scene::{Crs, Layer, Molecule, MoleculeLayer, MoleculeStyle, Scene, Unit};

/// Turn and rise from one base pair to the next: ten pairs to a turn.
const TWIST_DEG: f64 = 36.0;
const RISE: f64 = 3.38;

/// Least and greatest number of base pairs.
pub(super) const PAIRS: [usize; 2] = [2, 5000];

/// An atom's name and its position in the frame of its base pair, angstrom: x to the major groove, y to the strand, z along it.
type Placed = (&'static str, [f64; 3]);

/// Phosphate and sugar. Ours: the mean positions in entry 1BNA of the Protein Data Bank, then moved as little as needed for the bond lengths and
/// angles that are usual in nucleic acids, the bond from each O3' to the next phosphate included.
const BACKBONE: [Placed; 11] = [
    ("P", [0.202, 9.377, -1.331]),
    ("OP1", [0.020, 10.828, -1.588]),
    ("OP2", [1.268, 8.927, -0.400]),
    ("O5'", [-1.195, 8.787, -0.844]),
    ("C5'", [-2.156, 8.300, -1.799]),
    ("C4'", [-3.108, 7.317, -1.160]),
    ("O4'", [-2.578, 5.976, -1.282]),
    ("C3'", [-3.359, 7.540, 0.331]),
    ("O3'", [-4.729, 7.260, 0.635]),
    ("C2'", [-2.444, 6.526, 0.993]),
    ("C1'", [-2.479, 5.375, 0.0]),
];

/// Number of atoms of the phosphate, the first of the backbone; the first residue of a strand lacks them.
const PHOSPHATE: usize = 3;

/// A base: name of its residue, its partner, its atoms.
struct Base {
    residue: &'static str,
    partner: usize,
    atoms: &'static [Placed],
}

/// The bases in the plane of their pair: the standard reference frame of Olson et al. 2001.
const BASES: [Base; 4] = [
    Base {
        residue: "DA",
        partner: 3,
        atoms: &[
            ("N9", [-1.291, 4.498, 0.0]),
            ("C8", [0.024, 4.897, 0.0]),
            ("N7", [0.877, 3.902, 0.0]),
            ("C5", [0.071, 2.771, 0.0]),
            ("C6", [0.369, 1.398, 0.0]),
            ("N6", [1.611, 0.909, 0.0]),
            ("N1", [-0.668, 0.532, 0.0]),
            ("C2", [-1.912, 1.023, 0.0]),
            ("N3", [-2.320, 2.290, 0.0]),
            ("C4", [-1.267, 3.124, 0.0]),
        ],
    },
    Base {
        residue: "DC",
        partner: 2,
        atoms: &[
            ("N1", [-1.285, 4.542, 0.0]),
            ("C2", [-1.472, 3.158, 0.0]),
            ("O2", [-2.628, 2.709, 0.0]),
            ("N3", [-0.391, 2.344, 0.0]),
            ("C4", [0.837, 2.868, 0.0]),
            ("N4", [1.875, 2.027, 0.0]),
            ("C5", [1.056, 4.275, 0.0]),
            ("C6", [-0.023, 5.068, 0.0]),
        ],
    },
    Base {
        residue: "DG",
        partner: 1,
        atoms: &[
            ("N9", [-1.289, 4.551, 0.0]),
            ("C8", [0.023, 4.962, 0.0]),
            ("N7", [0.870, 3.969, 0.0]),
            ("C5", [0.071, 2.833, 0.0]),
            ("C6", [0.424, 1.460, 0.0]),
            ("O6", [1.554, 0.955, 0.0]),
            ("N1", [-0.700, 0.641, 0.0]),
            ("C2", [-1.999, 1.087, 0.0]),
            ("N2", [-2.949, 0.139, 0.0]),
            ("N3", [-2.342, 2.364, 0.0]),
            ("C4", [-1.265, 3.177, 0.0]),
        ],
    },
    Base {
        residue: "DT",
        partner: 0,
        atoms: &[
            ("N1", [-1.284, 4.500, 0.0]),
            ("C2", [-1.462, 3.135, 0.0]),
            ("O2", [-2.562, 2.608, 0.0]),
            ("N3", [-0.298, 2.407, 0.0]),
            ("C4", [0.994, 2.897, 0.0]),
            ("O4", [1.944, 2.119, 0.0]),
            ("C5", [1.106, 4.338, 0.0]),
            ("C7", [2.466, 4.961, 0.0]),
            ("C6", [-0.024, 5.057, 0.0]),
        ],
    },
];

/// A double helix of `pairs` base pairs about the z axis, its middle at the origin; chain A runs upwards, chain B down.
///
/// # Errors
/// [`BuiltinError::Pairs`].
pub fn dna(seed: u64, pairs: usize) -> Result<(Scene, SuggestedCamera), BuiltinError> {
    let molecule = helix(seed, pairs)?;
    let height = RISE * pairs as f64;
    let style = MoleculeStyle::default();
    let layer = MoleculeLayer::new(molecule, &style, ModelTransform::default())?;
    let layers = vec![Layer { id: "dna".into(), must_see: false, kind: layer.into() }];
    let title = format!("B-DNA, {pairs} base pairs");
    let eye = DVec3::new(0.0, -1.7 * height.max(24.0), 0.0);
    let camera = SuggestedCamera { title: title.clone(), eye, look_at: DVec3::ZERO, fov_y: 40f64.to_radians() };
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Angstrom, layers, ..Scene::default() }, camera))
}

fn helix(seed: u64, pairs: usize) -> Result<Molecule, BuiltinError> {
    if !(PAIRS[0]..=PAIRS[1]).contains(&pairs) {
        return Err(BuiltinError::Pairs { pairs });
    }
    let mut random = seeded(seed);
    let sequence: Vec<usize> = (0..pairs).map(|_| (4.0 * random.unit()).min(3.0) as usize).collect();
    let mut builder = Builder { pairs, atoms: Vec::new(), residues: Vec::new() };
    for (k, &base) in sequence.iter().enumerate() {
        builder.residue(&BASES[base], k, k == 0, "A");
    }
    for (n, (k, &base)) in sequence.iter().enumerate().rev().enumerate() {
        builder.residue(&BASES[BASES[base].partner], k, n == 0, "B");
    }
    Ok(Molecule::bonded(builder.atoms, builder.residues, &[])?)
}

struct Builder {
    pairs: usize,
    atoms: Vec<Atom>,
    residues: Vec<Residue>,
}

impl Builder {
    /// Adds the nucleotide of a strand in pair `k`.
    fn residue(&mut self, base: &Base, k: usize, first: bool, chain: &str) {
        let number = self.residues.len() as i32 + 1;
        let (name, chain) = (base.residue.to_owned(), chain.to_owned());
        let down = chain == "B";
        self.residues.push(Residue { name, number, insertion: None, chain, hetero: false });
        let skip = if first { PHOSPHATE } else { 0 };
        for (name, p) in BACKBONE[skip..].iter().chain(base.atoms) {
            let serial = self.atoms.len() as i64 + 1;
            let element = Element::from_symbol(&name[..1]).unwrap_or_default();
            let position = self.place(DVec3::from_array(*p), k, down);
            let residue = self.residues.len() as u32 - 1;
            self.atoms.push(Atom { serial, name: (*name).to_owned(), element, residue, position });
        }
    }

    /// Scene position of a point in the frame of pair `k`; strand B is turned by half a turn about the frame's x axis.
    fn place(&self, p: DVec3, k: usize, down: bool) -> DVec3 {
        let p = if down { DVec3::new(p.x, -p.y, -p.z) } else { p };
        let (sin, cos) = (k as f64 * TWIST_DEG.to_radians()).sin_cos();
        let up = RISE * (k as f64 - 0.5 * (self.pairs as f64 - 1.0));
        DVec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z + up)
    }
}

#[cfg(test)]
mod tests;
