//! Molecules: PDB, mmCIF and XYZ, plain or gzipped; their trajectories: XTC and DCD.

mod assembly;
mod categories;
mod cif;
mod mmcif;
mod pdb;
mod sites;
mod structure;
mod table;
mod trajectory;
mod xyz;

pub use assembly::{Assemblies, Assembly, MOST_COPIES};
pub use table::{AtomColumns, AtomTable};
pub use trajectory::{Trajectory, Wanted};

use crate::formats::Reader;
use crate::packed::content;
use crate::{InputFile, IoError, Limits, Loaded, budget, fs};
use belvedere_core::{DVec3, Warning, WarningKind};
use belvedere_scene::Molecule;
use sites::{Found, Sites};
use std::path::Path;

/// Bytes at the peak of reading per byte of text: 12 were measured on mmCIF, 10 on PDB; names of chains in assemblies take one more.
const PEAK: u64 = 13;

/// Which models of a file are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Models {
    /// The first; a warning says that there are more.
    #[default]
    First,
    /// One by its place in the file, from 1.
    Number(usize),
    /// All of them, side by side as one molecule: chain `A` of model k > 1 as `A-k`.
    All,
}

impl Models {
    /// Whether a model, from 1, is read.
    fn has(self, model: usize) -> bool {
        match self {
            Self::First => model == 1,
            Self::Number(number) => model == number,
            Self::All => true,
        }
    }
}

/// Content of a molecule file.
#[derive(Debug, Clone, PartialEq)]
pub struct MoleculeFile {
    /// Name of the format.
    pub format: &'static str,
    /// Atoms of the model or models that are read, each at its location of highest occupancy, and their bonds.
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
    load(path, Models::First, false, limits)
}

/// [`load_molecule`] with the places of the atoms in all models, which must hold the same atoms: [`MoleculeFile::frames`].
///
/// # Errors
/// As [`load_molecule`]; [`IoError::Format`] if the models differ in their number of atoms.
pub fn load_frames(path: &Path, limits: &Limits) -> Result<Loaded<MoleculeFile>, IoError> {
    load(path, Models::First, true, limits)
}

/// [`load_molecule`] of some of the models of a file.
///
/// # Errors
/// As [`load_molecule`]; [`IoError::Format`] if there are fewer models.
pub fn load_model(path: &Path, models: Models, limits: &Limits) -> Result<Loaded<MoleculeFile>, IoError> {
    load(path, models, false, limits)
}

/// Bytes of the place of an atom in a frame, as it is read and as it is kept.
const PER_PLACE: u64 = 36;

/// Reads the wanted frames of a trajectory.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a file that is damaged, no trajectory, or whose frames exceed `limits`.
pub fn load_trajectory(path: &Path, wanted: &Wanted, limits: &Limits) -> Result<Loaded<Trajectory>, IoError> {
    let bad = |reason: String| IoError::format(path, reason);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    let _work = budget::work_on(path);
    limits.ask("the trajectory", length).map_err(|e| bad(e.to_string()))?;
    let (bytes, file) = InputFile::read(path)?;
    let counted = trajectory::read(&bytes, &Wanted { most: 0, ..*wanted }).map_err(bad)?;
    let frames = counted.frames_in_file.saturating_sub(wanted.first).div_ceil(wanted.every.max(1)).min(wanted.most);
    let places = (frames as u64).saturating_mul(counted.atoms as u64).saturating_mul(PER_PLACE);
    limits.ask("the frames of the trajectory", length.saturating_add(places)).map_err(|e| bad(e.to_string()))?;
    let read = trajectory::read(&bytes, wanted).map_err(bad)?;
    let mut warnings = Vec::new();
    if read.cut_off {
        let note = format!("the file ends within a frame; the {} whole ones before it are read", read.frames_in_file);
        warnings.push(Warning::new(WarningKind::Repaired, note).in_file(path));
    }
    Ok(Loaded::new(read, warnings).with_file(file))
}

fn load(path: &Path, models: Models, frames: bool, limits: &Limits) -> Result<Loaded<MoleculeFile>, IoError> {
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
    let (format, read) = match () {
        () if xyz::is_atoms(&bytes) => ("XYZ", xyz::read(&text, models, frames)),
        () if is_cif => ("mmCIF", mmcif::read(&text, models, frames)),
        () => ("PDB", pdb::read(&text, models, frames)),
    };
    let read = read.and_then(|sites| MoleculeFile::of(sites, format, models, path));
    let loaded = read.map_err(|e| other_kind(path, bad(e)))?;
    Ok(loaded.with_file(file))
}

impl MoleculeFile {
    /// The content of atom lines that were read.
    fn of(sites: Sites, format: &'static str, models: Models, path: &Path) -> Result<Loaded<Self>, String> {
        let (molecule, found) = sites.finish(models)?;
        let Found { models, alternates, named_bonds, assemblies, frames, warnings } = found;
        let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
        Ok(Loaded::new(Self { format, molecule, models, assemblies, frames, alternates, named_bonds }, warnings))
    }
}

/// The error of a file, or that it holds no molecule but something else.
fn other_kind(path: &Path, error: IoError) -> IoError {
    let readable = crate::recognise::readable(path).ok().flatten();
    // What a name tells that grids share does not explain it.
    if readable.is_some_and(|format| format.name == "XYZ of atoms") {
        return error;
    }
    match readable.filter(|format| format.reader != Some(Reader::Molecule)) {
        Some(_) => crate::recognise::not_a(path, "a molecule: PDB, mmCIF or XYZ"),
        None => crate::recognise::explain(error),
    }
}
