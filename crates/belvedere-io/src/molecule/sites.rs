//! Assembles a molecule from the atom lines of a file: residues, alternate locations, models.

use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Molecule;
use belvedere_scene::molecule::{Atom, Element, Residue};
use glam::DVec3;
use std::collections::HashMap;

/// One atom line of a file.
pub(super) struct Site {
    pub(super) serial: i64,
    pub(super) name: String,
    pub(super) element: Element,
    pub(super) residue: Residue,
    pub(super) position: DVec3,
    /// Letter of the alternate location, if the atom has several.
    pub(super) alternate: Option<char>,
    pub(super) occupancy: f64,
}

/// All atom lines of the first model, named bonds, number of models and warnings.
#[derive(Default)]
pub(super) struct Sites {
    pub(super) sites: Vec<Site>,
    /// Bonds by numbers of atoms in the file.
    pub(super) bonds: Vec<[i64; 2]>,
    pub(super) models: usize,
    /// One sentence each.
    pub(super) warnings: Vec<Warning>,
}

/// Figures and warnings of the assembly.
#[derive(Default)]
pub(super) struct Found {
    pub(super) models: usize,
    pub(super) alternates: usize,
    pub(super) named_bonds: usize,
    pub(super) warnings: Vec<Warning>,
}

impl Sites {
    /// Assembles the molecule.
    pub(super) fn finish(self) -> Result<(Molecule, Found), String> {
        let Self { sites, bonds, models, mut warnings } = self;
        if sites.is_empty() {
            return Err("it holds no atom; a file of coordinates is needed".into());
        }
        if models > 1 {
            let text = format!("it holds {models} models; the first is taken");
            warnings.push(Warning::new(WarningKind::Ignored, text).with("models", models as f64));
        }
        let mut keep = likeliest(&sites);
        let alternates = keep.iter().filter(|k| !**k).count();
        let left_out = "atoms at alternate locations are left out; the likeliest stay";
        warnings.extend(Warning::counted(WarningKind::Ignored, alternates, left_out));
        warnings.extend(leave_out_unplaced(&sites, &mut keep)?);
        let (mut atoms, mut residues): (Vec<Atom>, Vec<Residue>) = (Vec::new(), Vec::new());
        for (site, _) in sites.into_iter().zip(keep).filter(|(_, keep)| *keep) {
            if residues.last() != Some(&site.residue) {
                residues.push(site.residue);
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
        let molecule = Molecule::bonded(atoms, residues, &named).map_err(|e| e.to_string())?;
        Ok((molecule, Found { models, alternates, named_bonds: named.len(), warnings }))
    }
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
