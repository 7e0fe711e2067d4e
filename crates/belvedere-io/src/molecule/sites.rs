//! Assembles a molecule from the atom lines of a file: residues, alternate locations, models.

use super::Models;
use super::assembly::{Assemblies, Described};
use super::structure::{self, Stretch};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Molecule;
use belvedere_scene::molecule::{Atom, Element, Residue};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};

const NO_ATOM: &str = "it holds no atom; a file of coordinates is needed";

/// One atom line of a file.
pub(super) struct Site {
    pub(super) serial: i64,
    /// Its model, from 1.
    pub(super) model: usize,
    /// Chain as the assemblies of the file name it.
    pub(super) asym: String,
    pub(super) name: String,
    pub(super) element: Element,
    pub(super) residue: Residue,
    pub(super) position: DVec3,
    /// Letter of the alternate location, if the atom has several.
    pub(super) alternate: Option<char>,
    pub(super) occupancy: f64,
}

/// All atom lines of the models that are read, named bonds, number of models and warnings.
#[derive(Default)]
pub(super) struct Sites {
    pub(super) sites: Vec<Site>,
    /// Bonds by numbers of atoms in the file.
    pub(super) bonds: Vec<[i64; 2]>,
    /// Orders of some bonds, by numbers of atoms.
    pub(super) orders: Vec<([i64; 2], u8)>,
    /// Orders of bonds in residues of a name, by names of atoms.
    pub(super) named_orders: Vec<(String, [String; 2], u8)>,
    pub(super) structure: Vec<Stretch>,
    pub(super) assemblies: Described,
    pub(super) models: usize,
    /// Places of the atoms of each model, if they were asked for.
    pub(super) frames: Vec<Vec<DVec3>>,
    /// One sentence each.
    pub(super) warnings: Vec<Warning>,
}

/// Figures and warnings of the assembly.
#[derive(Default)]
pub(super) struct Found {
    pub(super) models: usize,
    pub(super) alternates: usize,
    pub(super) named_bonds: usize,
    pub(super) assemblies: Assemblies,
    pub(super) frames: Vec<Vec<DVec3>>,
    pub(super) warnings: Vec<Warning>,
}

impl Sites {
    /// Adds the place of an atom of a model, from 1.
    pub(super) fn place(&mut self, model: usize, position: DVec3) {
        if self.frames.len() < model {
            self.frames.resize_with(model, Vec::new);
        }
        if let Some(frame) = self.frames.get_mut(model.saturating_sub(1)) {
            frame.push(position);
        }
    }

    /// Assembles the molecule of a model, or of all; of the first one with a warning if there are more.
    pub(super) fn finish(self, wanted: Models) -> Result<(Molecule, Found), String> {
        let models = self.models;
        if let Models::Number(model) = wanted
            && model > models
        {
            return Err(format!("it holds {models} models, there is no model {model}; name one in 1..={models}"));
        }
        if wanted == Models::All && models > 1 {
            return self.finish_all();
        }
        let is_silent = wanted != Models::First || !self.frames.is_empty();
        let (molecule, mut found) = self.finish_one()?;
        if models > 1 && !is_silent {
            let text = format!("it holds {models} models; the first is taken, model = \"all\" draws all of them");
            let warning = Warning::new(WarningKind::Ignored, text).with("models", models as f64);
            found.warnings.insert(0, warning.settled_by("model"));
        }
        Ok((molecule, found))
    }

    /// Every model on its own, so that models over one another share no bonds; what the file names is of each of them.
    fn finish_all(self) -> Result<(Molecule, Found), String> {
        let Self { sites, bonds, orders, named_orders, structure, models, mut warnings, .. } = self;
        let mut of_models: BTreeMap<usize, Vec<Site>> = BTreeMap::new();
        for site in sites {
            of_models.entry(site.model).or_default().push(site);
        }
        let (mut molecules, mut all) = (Vec::new(), Found { models, ..Found::default() });
        for sites in of_models.into_values() {
            let (bonds, orders) = (bonds.clone(), orders.clone());
            let (named_orders, structure) = (named_orders.clone(), structure.clone());
            let one = Self { sites, bonds, orders, named_orders, structure, models, ..Self::default() };
            let (molecule, found) = one.finish_one()?;
            molecules.push(molecule);
            all.alternates += found.alternates;
            all.named_bonds += found.named_bonds;
            for warning in found.warnings {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
        }
        if molecules.is_empty() {
            return Err(NO_ATOM.into());
        }
        all.warnings = warnings;
        Ok((Molecule::joined(molecules).map_err(|e| e.to_string())?, all))
    }

    /// The molecule of all sites, as of one model.
    fn finish_one(self) -> Result<(Molecule, Found), String> {
        let Self { sites, bonds, orders, named_orders, structure, assemblies, models, frames, mut warnings } = self;
        if sites.is_empty() {
            return Err(NO_ATOM.into());
        }
        let mut keep = likeliest(&sites);
        let alternates = keep.iter().filter(|k| !**k).count();
        let left_out = "atoms at alternate locations are left out; the likeliest stay";
        warnings.extend(Warning::counted(WarningKind::Ignored, alternates, left_out));
        warnings.extend(leave_out_unplaced(&sites, &mut keep)?);
        let frames = kept_places(frames, &keep)?;
        let (mut atoms, mut residues): (Vec<Atom>, Vec<Residue>) = (Vec::new(), Vec::new());
        let mut chains: Vec<String> = Vec::new();
        for (site, _) in sites.into_iter().zip(keep).filter(|(_, keep)| *keep) {
            if residues.last() != Some(&site.residue) {
                residues.push(site.residue);
                chains.push(site.asym);
            }
            let residue = residues.len() as u32 - 1;
            let Site { serial, name, element, position, .. } = site;
            atoms.push(Atom { serial, name, element, residue, position });
        }
        let unknown = atoms.iter().filter(|a| a.element == Element::UNKNOWN).count();
        if unknown > 0 {
            let first = atoms.iter().find(|a| a.element == Element::UNKNOWN).map_or("", |a| a.name.as_str());
            let what = format!("atoms are of no element (such as {first:?}); they are not drawn");
            warnings.extend(Warning::counted(WarningKind::Ignored, unknown, &what));
        }
        let number: HashMap<i64, u32> = atoms.iter().enumerate().map(|(i, a)| (a.serial, i as u32)).collect();
        // Serial numbers given twice cannot name atoms.
        let unique = number.len() == atoms.len();
        let at = |serial: &i64| number.get(serial).copied().filter(|_| unique);
        let pair = |[a, b]: &[i64; 2]| Some([at(a)?, at(b)?]).filter(|[a, b]| a != b);
        let mut named: Vec<[u32; 2]> = bonds.iter().filter_map(pair).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        named.sort_unstable();
        named.dedup();
        if !unique && !bonds.is_empty() {
            let text = "atoms share numbers, so the bonds that it names cannot be told; distances tell them";
            warnings.push(Warning::new(WarningKind::Fallback, text));
        }
        check_density(&atoms)?;
        let structure = structure::of(&structure, &residues);
        let molecule = Molecule::bonded(atoms, residues, &named).map_err(|e| e.to_string())?;
        let mut told = by_names(&molecule, &named_orders);
        told.extend(orders.iter().filter_map(|(bond, order)| Some((pair(bond)?, *order))));
        let molecule = molecule.with_orders(&told).with_structure(structure);
        let (assemblies, complaints) = assemblies.of(&molecule, &chains);
        warnings.extend(complaints.into_iter().take(3).map(|text| Warning::new(WarningKind::Ignored, text)));
        Ok((molecule, Found { models, alternates, named_bonds: named.len(), assemblies, frames, warnings }))
    }
}

/// Places of the atoms that are kept, of each model.
fn kept_places(frames: Vec<Vec<DVec3>>, keep: &[bool]) -> Result<Vec<Vec<DVec3>>, String> {
    let one = |(k, frame): (usize, Vec<DVec3>)| {
        let count = frame.len();
        if count != keep.len() {
            return Err(format!(
                "model {} has {count} atoms and the one that is read {}; models of a film have the same atoms",
                k + 1,
                keep.len()
            ));
        }
        if let Some(p) = frame.iter().find(|p| p.abs().max_element() > Molecule::FARTHEST) {
            return Err(format!("an atom of model {} lies at {p}, beyond {} angstrom", k + 1, Molecule::FARTHEST));
        }
        Ok(frame.into_iter().zip(keep).filter(|(_, keep)| **keep).map(|(p, _)| p).collect())
    };
    frames.into_iter().enumerate().map(one).collect()
}

/// Orders of the bonds within residues whose names a table of the file holds.
fn by_names(molecule: &Molecule, table: &[(String, [String; 2], u8)]) -> Vec<([u32; 2], u8)> {
    if table.is_empty() {
        return Vec::new();
    }
    let known: HashMap<(&str, &str, &str), u8> = table
        .iter()
        .flat_map(|(residue, [a, b], order)| {
            [((residue.as_str(), a.as_str(), b.as_str()), *order), ((residue.as_str(), b.as_str(), a.as_str()), *order)]
        })
        .collect();
    let atoms = molecule.atoms();
    let order = |&[a, b]: &[u32; 2]| {
        let (first, second) = (&atoms[a as usize], &atoms[b as usize]);
        let residue = molecule.residues()[first.residue as usize].name.as_str();
        let order = *known.get(&(residue, first.name.as_str(), second.name.as_str()))?;
        (first.residue == second.residue).then_some(([a, b], order))
    };
    molecule.bonds().iter().filter_map(order).collect()
}

/// Most atoms at exactly one place. Alternate locations without a letter are two or three; programs that know no place of an atom write 0 0 0.
const MOST_AT_A_PLACE: u32 = 10;

/// Leaves out atoms of which more stand at exactly one place than [`MOST_AT_A_PLACE`]: their places are not known. An error if no other is left.
fn leave_out_unplaced(sites: &[Site], keep: &mut [bool]) -> Result<Option<Warning>, String> {
    // 0 and -0 are one place.
    let place = |site: &Site| site.position.to_array().map(|x| (x + 0.0).to_bits());
    let mut counts: HashMap<[u64; 3], u32> = HashMap::new();
    for (site, _) in sites.iter().zip(&*keep).filter(|(_, keep)| **keep) {
        *counts.entry(place(site)).or_default() += 1;
    }
    let (mut count, mut first) = (0, None);
    for (site, keep) in sites.iter().zip(&mut *keep).filter(|(_, keep)| **keep) {
        if counts[&place(site)] > MOST_AT_A_PLACE {
            *keep = false;
            count += 1;
            first.get_or_insert(site.position + DVec3::ZERO);
        }
    }
    let [x, y, z] = first.unwrap_or_default().to_array();
    let all_at = format!("stand at exactly one place with more than {} others ({x} {y} {z})", MOST_AT_A_PLACE - 1);
    if count > 0 && !keep.contains(&true) {
        return Err(format!("all {count} atoms {all_at}; a file with coordinates is needed"));
    }
    Ok(Warning::counted(
        WarningKind::Ignored,
        count,
        &format!("atoms {all_at}: their places are not known, and they are left out"),
    ))
}

/// Most atoms in a cube of one angstrom. A diamond has 0.2; the search for bonds takes the square of them.
const MOST_IN_A_CUBE: u64 = 100;

/// Most atoms in a cube of four angstrom, on the average over the atoms. A diamond has 11, twenty models laid over one another have some 200.
const MOST_AROUND: u64 = 300;
const AROUND: f64 = 4.0;

/// Number of atoms in each cube of a side, angstrom.
fn cubes(atoms: &[Atom], side: f64) -> HashMap<[i64; 3], u64> {
    let mut cubes = HashMap::new();
    for atom in atoms {
        *cubes.entry((atom.position / side).floor().to_array().map(|x| x as i64)).or_default() += 1;
    }
    cubes
}

/// An error if more atoms lie at one place than any matter has.
fn check_density(atoms: &[Atom]) -> Result<(), String> {
    let damaged = "its coordinates are damaged or not in angstrom";
    let fullest = cubes(atoms, 1.0).into_iter().filter(|(_, count)| *count > MOST_IN_A_CUBE).min();
    if let Some(([x, y, z], _)) = fullest {
        return Err(format!(
            "more than {MOST_IN_A_CUBE} atoms lie in the cube of one angstrom at {x} {y} {z}; {damaged}"
        ));
    }
    let squares: u64 = cubes(atoms, AROUND).values().map(|count| count * count).sum();
    let around = squares / (atoms.len() as u64).max(1);
    if around > MOST_AROUND {
        return Err(format!(
            "an atom has {around} atoms in its cube of four angstrom on the average, at most {MOST_AROUND} are read; {damaged}, or models lie over one another"
        ));
    }
    Ok(())
}

/// Key of the residue in which alternate locations compete: chain, number and insertion letter of a residue.
type Place<'s> = (&'s str, i32, Option<char>);

fn place(s: &Site) -> Place<'_> {
    (&s.residue.chain, s.residue.number, s.residue.insertion)
}

/// Whether each atom is kept. Within a residue the letter of highest occupancy is taken, the first of equals, so that the kept atoms
/// fit together; an atom without a location of that letter keeps its own location of highest occupancy.
fn likeliest(sites: &[Site]) -> Vec<bool> {
    let mut of_place: HashMap<Place<'_>, Best<'_>> = HashMap::new();
    for s in sites.iter().filter(|s| s.alternate.is_some()) {
        Best::offer(&mut of_place, place(s), s);
    }
    // A residue may have another name at each location, a mutant: atoms of the other names are dropped.
    let fits = |s: &&Site| of_place.get(&place(s)).is_some_and(|b| b.residue == s.residue.name);
    let mut of_atom: HashMap<(Place<'_>, &str), Best<'_>> = HashMap::new();
    for s in sites.iter().filter(|s| s.alternate.is_some()).filter(fits) {
        let chosen = of_place.get(&place(s)).map(|b| b.letter);
        let occupancy = if s.alternate == chosen { f64::INFINITY } else { s.occupancy };
        Best::offer_at(&mut of_atom, (place(s), s.name.as_str()), s, occupancy);
    }
    let stays = |s: &Site| match s.alternate {
        None => true,
        Some(letter) => fits(&s) && of_atom.get(&(place(s), s.name.as_str())).is_some_and(|b| b.letter == letter),
    };
    sites.iter().map(stays).collect()
}

/// The letter of highest occupancy so far, and the name of its residue.
struct Best<'s> {
    letter: char,
    occupancy: f64,
    residue: &'s str,
}

impl<'s> Best<'s> {
    fn offer<K: Eq + std::hash::Hash>(all: &mut HashMap<K, Self>, key: K, site: &'s Site) {
        Self::offer_at(all, key, site, site.occupancy);
    }

    fn offer_at<K: Eq + std::hash::Hash>(all: &mut HashMap<K, Self>, key: K, site: &'s Site, occupancy: f64) {
        let Some(letter) = site.alternate else { return };
        let new = Self { letter, occupancy, residue: &site.residue.name };
        match all.get_mut(&key) {
            Some(best) if best.occupancy >= occupancy => {}
            Some(best) => *best = new,
            None => drop(all.insert(key, new)),
        }
    }
}
