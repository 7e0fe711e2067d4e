//! Residues of a molecule: listed, read from what a user types, found under the pointer. Each is told as a selection of atoms.

use belvedere::BelvedereError;
use belvedere::construct::rays::Target;
use belvedere::core::DVec3;
use belvedere::scene::molecule::{Residue, Selection};
use belvedere::scene::{MoleculeLayer, Scene};
use std::collections::HashSet;

/// A residue that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedResidue {
    /// `B:102 ALA`, as [`super::NameIndex`] names it.
    pub name: String,
    /// The selection that means it, such as `chain B and resi 102`.
    pub select: String,
}

/// The residues of a molecule of the scene of which something is drawn, in the order of the file; none for other layers.
pub fn residues(scene: &Scene, layer: &str) -> Vec<NamedResidue> {
    let Some((_, molecule)) = molecule(scene, layer) else { return Vec::new() };
    let mut drawn = vec![false; molecule.molecule.residues().len()];
    for atom in drawn_atoms(molecule) {
        drawn[molecule.molecule.atoms()[atom].residue as usize] = true;
    }
    let all = molecule.molecule.residues().iter().zip(drawn);
    all.filter(|(_, drawn)| *drawn)
        .map(|(residue, _)| NamedResidue { name: name(residue), select: selection(molecule, residue) })
        .collect()
}

/// The selection that a text means in a molecule: a selection as scene files have it, or chain, number and name of a residue in short, such as
/// `B 102`, `B:102-105`, `B102`, `102`, `ALA 102`.
///
/// # Errors
/// [`BelvedereError::Target`] if the text is neither, or if no atom that is drawn is meant.
pub fn read_residues(scene: &Scene, layer: &str, text: &str) -> Result<String, BelvedereError> {
    let Some((index, molecule)) = molecule(scene, layer) else {
        return Err(BelvedereError::Target(format!("layer \"{layer}\" is no molecule")));
    };
    // The reason of the reading that comes nearest to atoms, the likeliest of them.
    let (mut refused, mut near) = (String::new(), 0);
    // Letters of numbers are large in most files.
    let short = [text, &text.to_uppercase()].map(|text| short_forms(molecule, text)).concat();
    let written = std::iter::once(text.trim().to_owned()).chain(short);
    for (i, text) in written.enumerate() {
        match Selection::parse(&text) {
            Ok(selection) => {
                let atoms: Vec<usize> =
                    (0..molecule.molecule.atoms().len()).filter(|&i| selection.holds(&molecule.molecule, i)).collect();
                if Target::atoms(scene, index, &atoms).is_some() {
                    return Ok(text);
                }
                let (what, nearer) = match atoms.is_empty() {
                    true => ("no atom is meant by", 1),
                    false => ("no atom is drawn of those meant by", 2),
                };
                if nearer > near {
                    (refused, near) = (format!("{what} \"{text}\""), nearer);
                }
            }
            Err(e) if i == 0 => refused = e.to_string(),
            Err(_) => {}
        }
    }
    Err(BelvedereError::Target(format!("{refused}; write chain and number, as B 102, or a selection, as resn ALA")))
}

/// The selection of the residue whose drawn atom is nearest to a point of the scene.
pub(super) fn residue_at(layer: &MoleculeLayer, point: DVec3) -> Option<String> {
    let off = |&atom: &usize| (layer.center(atom).distance(point) - layer.radius(atom)).abs();
    let nearest = drawn_atoms(layer).into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    Some(selection(layer, layer.molecule.residue_of(nearest)))
}

fn molecule<'s>(scene: &'s Scene, id: &str) -> Option<(usize, &'s MoleculeLayer)> {
    scene
        .layers
        .iter()
        .enumerate()
        .find_map(|(index, layer)| layer.kind.molecule().filter(|_| layer.id == id).map(|molecule| (index, molecule)))
}

fn drawn_atoms(layer: &MoleculeLayer) -> Vec<usize> {
    let mesh = &layer.surface.mesh;
    let atoms: HashSet<usize> = (0..mesh.triangles().len()).filter_map(|t| Some(mesh.part(t)? as usize)).collect();
    let mut atoms: Vec<usize> = atoms.into_iter().filter(|&atom| atom < layer.molecule.atoms().len()).collect();
    atoms.sort_unstable();
    atoms
}

fn number(residue: &Residue) -> String {
    format!("{}{}", residue.number, residue.insertion.map(String::from).unwrap_or_default())
}

/// Name of a residue: `B:102 ALA`, without a chain `102 ALA`.
pub(super) fn name(residue: &Residue) -> String {
    let chain = if residue.chain.is_empty() { String::new() } else { format!("{}:", residue.chain) };
    format!("{chain}{} {}", number(residue), residue.name)
}

/// The selection that means a residue and no other.
fn selection(layer: &MoleculeLayer, residue: &Residue) -> String {
    let chain = if residue.chain.is_empty() { "\"\"" } else { &residue.chain };
    let mut text = format!("chain {chain} and resi {}", number(residue));
    // A number without a letter means those with one, too.
    let is_like = |other: &&Residue| (&other.chain, other.number) == (&residue.chain, residue.number);
    let others: Vec<&Residue> = layer.molecule.residues().iter().filter(is_like).collect();
    let lettered: Vec<String> = others.iter().filter(|r| r.insertion.is_some()).map(|r| number(r)).collect();
    if residue.insertion.is_none() && !lettered.is_empty() {
        text += &format!(" and not resi {}", lettered.join(","));
    }
    if others.iter().any(|other| other.insertion == residue.insertion && other.name != residue.name) {
        text += &format!(" and resn {}", residue.name);
    }
    text
}

/// Selections that a short form may mean, likeliest first.
fn short_forms(layer: &MoleculeLayer, text: &str) -> Vec<String> {
    let residues = layer.molecule.residues();
    let chain_of = |name: &str| {
        let same = residues.iter().find(|r| r.chain == name);
        let alike = || residues.iter().find(|r| r.chain.eq_ignore_ascii_case(name));
        same.or_else(alike).map(|r| r.chain.clone())
    };
    let is_number = |text: &str| Selection::parse(&format!("resi {text}")).is_ok();
    let parts: Vec<&str> =
        text.split(|c: char| c.is_whitespace() || ":/".contains(c)).filter(|p| !p.is_empty()).collect();
    let mut out = Vec::new();
    match parts[..] {
        [number] if is_number(number) => out.push(format!("resi {number}")),
        [one] => {
            let split = one.char_indices().nth(1).map(|(at, _)| one.split_at(at));
            if let Some((chain, number)) = split.filter(|(_, number)| is_number(number))
                && let Some(chain) = chain_of(chain)
            {
                out.push(format!("chain {chain} and resi {number}"));
            }
        }
        [first, number] if is_number(number) => {
            out.extend(chain_of(first).map(|chain| format!("chain {chain} and resi {number}")));
            out.push(format!("resn {first} and resi {number}"));
        }
        [number, name] if is_number(number) => out.push(format!("resi {number} and resn {name}")),
        [chain, number, name] if is_number(number) => {
            out.extend(chain_of(chain).map(|chain| format!("chain {chain} and resi {number} and resn {name}")));
        }
        _ => {}
    }
    out
}

#[cfg(test)]
mod tests;
