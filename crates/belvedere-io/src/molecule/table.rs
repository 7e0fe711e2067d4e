//! Atoms in memory.

use super::sites::{Site, Sites};
use super::{Models, MoleculeFile};
use crate::shared_bytes::{SharedBytes, positions};
use crate::{IoError, Limits, Loaded};
use belvedere_scene::molecule::{Element, Residue};
use serde_json::json;
use std::fmt::Write;
use std::path::Path;

/// Bytes of an atom at the peak of making a molecule, as of its line in a file.
const PEAK: u64 = 800;

/// One entry of each column for each atom.
#[derive(Debug, Clone, Default)]
pub struct AtomColumns {
    /// Symbols.
    pub elements: Vec<String>,
    /// Names of the atoms in their residues.
    pub names: Vec<String>,
    /// Names of the residues.
    pub residues: Vec<String>,
    /// Names of the chains.
    pub chains: Vec<String>,
    /// Numbers of the residues.
    pub numbers: Vec<i32>,
}

/// Atoms with their places.
#[derive(Clone)]
pub struct AtomTable {
    columns: AtomColumns,
    positions: SharedBytes,
}

impl AtomTable {
    /// * `positions`: f64 x, y, z of each atom, angstrom, finite.
    ///
    /// # Errors
    /// A sentence if columns differ in length, or a word is empty, holds white space, or begins like a sign of mmCIF.
    pub fn new(columns: AtomColumns, positions: SharedBytes) -> Result<Self, String> {
        let made = Self { columns, positions };
        let count = made.positions.len() / 24;
        if !made.positions.len().is_multiple_of(24) || made.places().any(|p| !p.is_finite()) {
            return Err("the positions are no finite x, y, z of each atom".into());
        }
        let columns = &made.columns;
        let words = [
            ("elements", &columns.elements),
            ("names", &columns.names),
            ("residues", &columns.residues),
            ("chains", &columns.chains),
        ];
        let lengths = words.map(|(what, words)| (what, words.len()));
        if let Some((what, n)) =
            lengths.into_iter().chain([("numbers", columns.numbers.len())]).find(|(_, n)| *n != count)
        {
            return Err(format!("{what} has {n} entries for {count} positions; give one for each atom"));
        }
        let is_word = |word: &String| !word.starts_with(['\'', '"', '#', '_', ';', '$', '[', ']']) && is_plain(word);
        for (what, words) in words {
            if let Some(word) = words.iter().find(|word| !is_word(word)) {
                return Err(format!("{what} holds {word:?}; give words of letters and digits"));
            }
        }
        Ok(made)
    }

    fn places(&self) -> impl Iterator<Item = glam::DVec3> + '_ {
        positions(&self.positions)
    }

    /// The molecule, with bonds by distance.
    ///
    /// * `models`: there is one model. `frames`: as of [`super::load_frames`].
    ///
    /// # Errors
    /// [`IoError::Format`] for atoms that no molecule has, or too many for `limits`.
    pub fn molecule(
        &self,
        path: &Path,
        (models, frames): (Models, bool),
        limits: &Limits,
    ) -> Result<Loaded<MoleculeFile>, IoError> {
        let columns = &self.columns;
        let peak = (columns.elements.len() as u64).saturating_mul(PEAK);
        limits.ask("the molecule", peak).map_err(|reason| IoError::format(path, reason))?;
        let site = |(i, position): (usize, glam::DVec3)| Site {
            serial: i as i64 + 1,
            model: 1,
            asym: columns.chains[i].clone(),
            name: columns.names[i].clone(),
            element: Element::from_symbol(&columns.elements[i]).unwrap_or(Element::UNKNOWN),
            residue: Residue {
                name: columns.residues[i].clone(),
                number: columns.numbers[i],
                insertion: None,
                chain: columns.chains[i].clone(),
                hetero: false,
            },
            position,
            alternate: None,
            occupancy: 1.0,
        };
        let mut sites = Sites { sites: self.places().enumerate().map(site).collect(), models: 1, ..Sites::default() };
        if frames {
            sites.frames = vec![self.places().collect()];
        }
        MoleculeFile::of(sites, "array", models, path).map_err(|reason| IoError::format(path, reason))
    }

    pub(crate) fn layout(&self) -> (serde_json::Value, Vec<&[u8]>) {
        let AtomColumns { elements, names, residues, chains, numbers } = &self.columns;
        let header = json!({
            "array": "atoms", "chains": chains, "elements": elements, "names": names, "numbers": numbers, "residues": residues,
        });
        (header, vec![&*self.positions])
    }

    /// The atoms as mmCIF.
    pub(crate) fn mmcif(&self) -> String {
        const KEYS: &str =
            "group_PDB id type_symbol label_atom_id label_comp_id label_asym_id label_seq_id Cartn_x Cartn_y Cartn_z";
        let AtomColumns { elements, names, residues, chains, numbers } = &self.columns;
        let mut out = "data_atoms\nloop_\n".to_owned();
        KEYS.split(' ').for_each(|key| out.extend(["_atom_site.", key, "\n"]));
        for (i, p) in self.places().enumerate() {
            let (element, name, residue, chain) = (&elements[i], &names[i], &residues[i], &chains[i]);
            let (number, [x, y, z]) = (numbers[i], p.to_array());
            // A text takes all that is written.
            let _ = writeln!(out, "ATOM {} {element} {name} {residue} {chain} {number} {x:?} {y:?} {z:?}", i + 1);
        }
        out + "#\n"
    }
}

fn is_plain(word: &str) -> bool {
    !word.is_empty() && !word.chars().any(|c| c.is_whitespace() || c.is_control()) && word != "." && word != "?"
}
