//! Molecules: PDB and mmCIF, plain or gzipped.

mod assembly;
mod categories;
mod cif;
mod mmcif;
mod pdb;
mod sites;
mod structure;
mod table;

pub use assembly::{Assemblies, Assembly, MOST_COPIES};
pub use table::{AtomColumns, AtomTable};

use crate::formats::Reader;
use crate::packed::content;
use crate::{InputFile, IoError, Limits, Loaded, budget, fs};
use belvedere_core::DVec3;
use belvedere_scene::Molecule;
use sites::{Found, Sites};
use std::path::Path;

/// Bytes at the peak of reading per byte of text: 12 were measured on mmCIF, 10 on PDB; names of chains in assemblies take one more.
const PEAK: u64 = 13;

/// Content of a molecule file.
#[derive(Debug, Clone, PartialEq)]
pub struct MoleculeFile {
    /// Name of the format.
    pub format: &'static str,
    /// Atoms of the model that is read, each at its location of highest occupancy, and their bonds.
    pub molecule: Molecule,
    /// Models in the file.
    pub models: usize,
    /// Biological assemblies that the file describes; none of them is made.
    pub assemblies: Assemblies,
    /// Places of the atoms in each model, angstrom, where [`load_frames`] read them; else empty.
    pub frames: Vec<Vec<DVec3>>,
    /// Number of atoms at alternate locations that were left out.
    pub alternates: usize,
    /// Number of bonds that the file names.
    pub named_bonds: usize,
}

/// Reads a molecule. Of several models the first is taken; of alternate locations the one of highest occupancy, of equal ones the first.
/// Bonds are those that the file names and those found by distance, see [`belvedere_scene::molecule::BOND_TOLERANCE`].
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a file that is damaged, too large for `limits`, or has no atom.
pub fn load_molecule(path: &Path, limits: &Limits) -> Result<Loaded<MoleculeFile>, IoError> {
    load(path, None, false, limits)
}

/// [`load_molecule`] with the places of the atoms in all models, which must hold the same atoms: [`MoleculeFile::frames`].
///
/// # Errors
/// As [`load_molecule`]; [`IoError::Format`] if the models differ in their number of atoms.
pub fn load_frames(path: &Path, limits: &Limits) -> Result<Loaded<MoleculeFile>, IoError> {
    load(path, None, true, limits)
}

/// [`load_molecule`] of a model by its place in the file, from 1; `None` = the first.
///
/// # Errors
/// As [`load_molecule`]; [`IoError::Format`] if there are fewer models.
pub fn load_model(path: &Path, model: Option<usize>, limits: &Limits) -> Result<Loaded<MoleculeFile>, IoError> {
    load(path, model, false, limits)
}

fn load(path: &Path, model: Option<usize>, frames: bool, limits: &Limits) -> Result<Loaded<MoleculeFile>, IoError> {
    let path = &content(path, limits.max_bytes, &|p| Reader::Molecule.reads(p))?;
    let bad = |reason: String| IoError::format(path, reason);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    let _work = budget::work_on(path);
    // The text, and atoms, residues and bonds, which take some ten times the bytes of their lines.
    limits.ask("the molecule", length.saturating_mul(PEAK)).map_err(|e| IoError::format(path, e))?;
    let (bytes, file) = InputFile::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let is_cif = name.contains(".cif") || name.contains(".mmcif") || crate::recognise::ending(path) == "cif";
    let number = model.unwrap_or(1);
    let (format, read) =
        if is_cif { ("mmCIF", mmcif::read(&text, number, frames)) } else { ("PDB", pdb::read(&text, number, frames)) };
    let read = read.and_then(|sites| MoleculeFile::of(sites, format, model, path));
    let loaded = read.map_err(|e| other_kind(path, bad(e)))?;
    Ok(loaded.with_file(file))
}

impl MoleculeFile {
    /// The content of atom lines that were read.
    fn of(sites: Sites, format: &'static str, model: Option<usize>, path: &Path) -> Result<Loaded<Self>, String> {
        let (molecule, found) = sites.finish(model)?;
        let Found { models, alternates, named_bonds, assemblies, frames, warnings } = found;
        let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
        Ok(Loaded::new(Self { format, molecule, models, assemblies, frames, alternates, named_bonds }, warnings))
    }
}

/// The error of a file, or that it holds no molecule but something else.
fn other_kind(path: &Path, error: IoError) -> IoError {
    let readable = crate::recognise::readable(path).ok().flatten();
    match readable.filter(|format| format.reader != Some(Reader::Molecule)) {
        Some(_) => crate::recognise::not_a(path, "a molecule: PDB or mmCIF"),
        None => crate::recognise::explain(error),
    }
}
