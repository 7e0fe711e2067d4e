//! Molecules: PDB and mmCIF, plain or gzipped.

mod mmcif;
mod pdb;
mod sites;

use crate::formats::Reader;
use crate::packed::content;
use crate::{InputFile, IoError, Limits, Loaded, budget, fs};
use belvedere_scene::Molecule;
use std::path::Path;

/// Bytes at the peak of reading per byte of text; 12 was measured on mmCIF, 10 on PDB.
const PEAK: u64 = 12;

/// Content of a molecule file.
#[derive(Debug, Clone, PartialEq)]
pub struct MoleculeFile {
    /// Name of the format.
    pub format: &'static str,
    /// Atoms of the first model, each at its location of highest occupancy, and their bonds.
    pub molecule: Molecule,
    /// Models in the file; the first is read.
    pub models: usize,
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
    let path = &content(path, limits.max_bytes, &|p| Reader::Molecule.reads(p))?;
    let bad = |reason: String| IoError::format(path, reason);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    let _work = budget::work_on(path);
    // The text, and atoms, residues and bonds, which take some ten times the bytes of their lines.
    limits.ask("the molecule", length.saturating_mul(PEAK)).map_err(bad)?;
    let (bytes, file) = InputFile::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let name = path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let is_cif = name.contains(".cif") || name.contains(".mmcif") || crate::recognise::ending(path) == "cif";
    let (format, read) = if is_cif { ("mmCIF", mmcif::read(&text)) } else { ("PDB", pdb::read(&text)) };
    let (molecule, found) = read.and_then(sites::Sites::finish).map_err(|e| other_kind(path, bad(e)))?;
    let warnings = found.warnings.into_iter().map(|w| w.in_file(path)).collect();
    let (models, alternates, named_bonds) = (found.models, found.alternates, found.named_bonds);
    let value = MoleculeFile { format, molecule, models, alternates, named_bonds };
    Ok(Loaded::new(value, warnings).with_file(file))
}

/// The error of a file, or that it holds no molecule but something else.
fn other_kind(path: &Path, error: IoError) -> IoError {
    let readable = crate::recognise::readable(path).ok().flatten();
    match readable.filter(|format| format.reader != Some(Reader::Molecule)) {
        Some(_) => crate::recognise::not_a(path, "a molecule: PDB or mmCIF"),
        None => crate::recognise::explain(error),
    }
}
