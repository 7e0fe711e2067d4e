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
mod tests {
    use super::*;
    use belvedere::scene::Unit;
    use belvedere::scene::molecule::{Atom, Element, ModelTransform, Molecule, MoleculeStyle};

    fn scene() -> Scene {
        let residue = |(chain, number, insertion, name): (&str, i32, Option<char>, &str)| Residue {
            name: name.into(),
            number,
            insertion,
            chain: chain.into(),
            hetero: name == "HOH",
        };
        let all = [
            ("A", 102, None, "ALA"),
            ("B", 102, None, "GLY"),
            ("B", 102, Some('A'), "SER"),
            ("B", -3, None, "DA"),
            ("", 7, None, "ZN"),
            ("B", 300, None, "HOH"),
        ];
        let atom = |i: usize| Atom {
            serial: i as i64,
            name: "CA".into(),
            element: Element::from_symbol("C").expect("carbon"),
            residue: i as u32,
            position: DVec3::new(20.0 * i as f64, 0.0, 0.0),
        };
        let molecule = Molecule::new((0..all.len()).map(atom).collect(), all.map(residue).to_vec(), &[]);
        let style = MoleculeStyle { selection: Selection::dry(), ..MoleculeStyle::default() };
        let layer = MoleculeLayer::new(molecule.expect("molecule"), &style, ModelTransform::default()).expect("layer");
        Scene { unit: Unit::Angstrom, ..Scene::default() }.with_layer("m", layer)
    }

    /// Residues that a selection means.
    fn meant(scene: &Scene, select: &str) -> Vec<String> {
        let (_, layer) = molecule(scene, "m").expect("molecule");
        let selection = Selection::parse(select).expect("a selection");
        let atoms = (0..layer.molecule.atoms().len()).filter(|&i| selection.holds(&layer.molecule, i));
        atoms.map(|i| name(layer.molecule.residue_of(i))).collect()
    }

    #[test]
    fn each_residue_that_is_drawn_is_listed_with_a_selection_that_means_it_alone() {
        let scene = scene();
        let all = residues(&scene, "m");
        let names: Vec<&str> = all.iter().map(|residue| residue.name.as_str()).collect();
        assert_eq!(names, ["A:102 ALA", "B:102 GLY", "B:102A SER", "B:-3 DA", "7 ZN"]);
        for residue in &all {
            assert_eq!(meant(&scene, &residue.select), [residue.name.as_str()], "{}", residue.select);
        }
        let (_, layer) = molecule(&scene, "m").expect("molecule");
        for (i, residue) in all.iter().enumerate() {
            let near = DVec3::new(20.0 * i as f64 + 0.4, 0.2, 0.0);
            assert_eq!(residue_at(layer, near).as_deref(), Some(residue.select.as_str()));
        }
    }

    #[test]
    fn what_is_typed_means_the_residue() {
        let scene = scene();
        for text in
            ["B 102A", "b:102a", "B102A", "SER 102A", "B 102A SER", "resn SER", "chain B and resi 102A", " B/102A "]
        {
            let select = read_residues(&scene, "m", text).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(meant(&scene, &select), ["B:102A SER"], "{text}: {select}");
        }
        for (text, count) in [("102", 3), ("b -3", 1), ("7", 1), ("resi 100-110", 3)] {
            let select = read_residues(&scene, "m", text).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(meant(&scene, &select).len(), count, "{text}");
        }
        for (text, said) in
            [("C 102", "B 102"), ("B 999", "no atom is meant"), ("B 300", "no atom is drawn"), ("", "write chain")]
        {
            let said_so = read_residues(&scene, "m", text).expect_err(text).to_string();
            assert!(said_so.contains(said), "{text}: {said_so}");
        }
        assert!(read_residues(&scene, "other", "B 102").is_err());
    }
}
