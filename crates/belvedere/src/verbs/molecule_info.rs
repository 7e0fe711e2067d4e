//! Description of a molecule file.

use crate::BelvedereError;
use belvedere_core::Warning;
use belvedere_io::molecule::Assembly;
use belvedere_io::{Limits, load_molecule};
use belvedere_scene::molecule::Secondary;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A molecule.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct MoleculeInfo {
    /// The file.
    pub path: String,
    /// Format.
    pub format: &'static str,
    /// Atoms of the first model; alternate positions count once.
    pub atoms: usize,
    /// Residues, waters included.
    pub residues: usize,
    /// Waters among them.
    pub waters: usize,
    /// Chains by name, each with its number of residues; `""` = without a name.
    pub chains: BTreeMap<String, usize>,
    /// Elements by symbol, each with its number of atoms; `X` = unknown.
    pub elements: BTreeMap<&'static str, usize>,
    /// Bonds, named by the file or found by distance.
    pub bonds: usize,
    /// Bonds that the file names.
    pub named_bonds: usize,
    /// Models in the file; the first is described.
    pub models: usize,
    /// Biological assemblies that the file describes.
    pub assemblies: Vec<AssemblyInfo>,
    /// Residues in helices and in strands, as the file states them; `null` = it does not.
    pub structure: Option<StructureInfo>,
    /// Alternate positions of lower occupancy, which are left out.
    pub alternates: usize,
    /// Smallest coordinates, angstrom.
    pub min: [f64; 3],
    /// Largest coordinates, angstrom.
    pub max: [f64; 3],
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// An assembly.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct AssemblyInfo {
    /// Its name, for `assembly`.
    pub id: String,
    /// What the file says of it, possibly empty.
    pub details: String,
    /// Copies of the chain that is copied most often.
    pub copies: u64,
    /// Atoms of all copies.
    pub atoms: u64,
}

/// Residues by structure.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct StructureInfo {
    /// In helices.
    pub helix: usize,
    /// In strands of sheets.
    pub strand: usize,
}

/// Reads and describes a molecule file.
pub(super) fn describe(path: &Path) -> Result<MoleculeInfo, BelvedereError> {
    let loaded = load_molecule(path, &Limits::default())?;
    let (file, m) = (&loaded.value, &loaded.value.molecule);
    let (mut chains, mut elements) = (BTreeMap::new(), BTreeMap::new());
    m.residues().iter().for_each(|r| *chains.entry(r.chain.clone()).or_insert(0) += 1);
    m.atoms().iter().for_each(|a| *elements.entry(a.element.symbol()).or_insert(0) += 1);
    let b = m.bounds();
    Ok(MoleculeInfo {
        path: path.display().to_string(),
        format: file.format,
        atoms: m.atoms().len(),
        residues: m.residues().len(),
        waters: m.residues().iter().filter(|r| r.is_water()).count(),
        chains,
        elements,
        bonds: m.bonds().len(),
        named_bonds: file.named_bonds,
        models: file.models,
        assemblies: file.assemblies.list().iter().map(described).collect(),
        structure: (!m.structure().is_empty()).then(|| StructureInfo {
            helix: m.structure().iter().filter(|s| **s == Secondary::Helix).count(),
            strand: m.structure().iter().filter(|s| **s == Secondary::Strand).count(),
        }),
        alternates: file.alternates,
        min: b.min.to_array(),
        max: b.max.to_array(),
        warnings: loaded.warnings,
    })
}

fn described(assembly: &Assembly) -> AssemblyInfo {
    let (id, details) = (assembly.id.clone(), assembly.details.clone());
    AssemblyInfo { id, details, copies: assembly.copies, atoms: assembly.atoms }
}
