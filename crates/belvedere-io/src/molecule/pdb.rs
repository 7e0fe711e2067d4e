//! PDB: lines of fixed columns.
//!
//! Format: wwPDB, version 3.3, and its variants by simulation programs: no chains, no elements, numbers that overflow their columns.

use super::Models;
use super::assembly::Described;
use super::sites::{Site, Sites};
use super::structure::{Place, Stretch};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::molecule::{Element, Residue, Secondary};
use glam::DVec3;
use std::collections::HashMap;

/// Columns of a line of an atom up to its coordinates.
const NEEDED: usize = 54;

/// * `models`: those whose atoms are read; `frames`: whether the places of all models are read, too.
pub(super) fn read(text: &str, models: Models, frames: bool) -> Result<Sites, String> {
    let mut out = Sites::default();
    let mut remarks = Remarks::default();
    let (mut guessed, mut renumbered, mut before) = (0, 0, 0);
    let mut lines = text.lines().enumerate().peekable();
    while let Some((i, line)) = lines.next() {
        let record = columns(line, 0, 6).trim_end();
        if matches!(record, "ATOM" | "HETATM") {
            // The end of the file may have cut the last line, but for blanks.
            let is_last = lines.peek().is_none() && !text.ends_with('\n');
            if is_last && line.len() < before && !out.sites.is_empty() {
                let count = out.sites.len();
                let text = format!("its last line, {}, is not whole; the {count} atoms before are read", i + 1);
                out.warnings.push(Warning::new(WarningKind::Repaired, text).with("atoms", count as f64));
                break;
            }
            before = line.trim_end().len();
        }
        match record {
            "MODEL" => out.models += 1,
            "ATOM" | "HETATM" if models.has(out.models.max(1)) => {
                let number = out.sites.len() as i64 + 1;
                let (mut site, odd) =
                    site(line, record == "HETATM", number).map_err(|e| format!("line {}: {e}", i + 1))?;
                site.model = out.models.max(1);
                guessed += usize::from(odd.element);
                renumbered += usize::from(odd.serial);
                if frames {
                    out.place(out.models.max(1), site.position);
                }
                out.sites.push(site);
            }
            "ATOM" | "HETATM" if frames => {
                let (site, _) = site(line, false, 0).map_err(|e| format!("line {}: {e}", i + 1))?;
                out.place(out.models, site.position);
            }
            "HELIX" => out.structure.extend(stretch(line, Secondary::Helix)),
            "SHEET" => out.structure.extend(stretch(line, Secondary::Strand)),
            "REMARK" if columns(line, 7, 10) == "350" => remarks.read(line),
            "CONECT" => out.bonds.extend(bonds(line)),
            "END" => break,
            _ => {}
        }
    }
    out.models = out.models.max(1);
    out.assemblies = remarks.described;
    // A partner that is named twice shares four electrons, one that is named three times six.
    out.orders = orders(&out.bonds);
    let from_names = "atoms name no element; it is taken from their names";
    out.warnings.extend(Warning::counted(WarningKind::Assumed, guessed, from_names));
    let counted = "atoms have no readable number; they are counted instead";
    out.warnings.extend(Warning::counted(WarningKind::Repaired, renumbered, counted));
    Ok(out)
}

/// Bonds that one of their atoms names more than once.
fn orders(bonds: &[[i64; 2]]) -> Vec<([i64; 2], u8)> {
    let mut counts: HashMap<[i64; 2], u8> = HashMap::new();
    for bond in bonds {
        let count = counts.entry(*bond).or_default();
        *count = count.saturating_add(1);
    }
    let mut out: Vec<([i64; 2], u8)> = counts.into_iter().filter(|(_, count)| *count > 1).collect();
    out.sort_unstable();
    out
}

/// The helix or strand of a line.
fn stretch(line: &str, kind: Secondary) -> Option<Stretch> {
    let place = |chain: usize, number: usize| -> Option<Place> {
        let letter = columns(line, number + 4, number + 5).chars().next().filter(|c| c.is_ascii_alphanumeric());
        let number = whole(columns(line, number, number + 4).trim(), 4)?;
        Some((columns(line, chain, chain + 1).trim().to_owned(), i32::try_from(number).ok()?, letter))
    };
    let (from, to) = match kind {
        Secondary::Helix => (place(19, 21)?, place(31, 33)?),
        _ => (place(21, 22)?, place(32, 33)?),
    };
    Some(Stretch { kind, from, to })
}

/// The lines of REMARK 350: assemblies, their chains, and the rows of their matrices.
#[derive(Default)]
struct Remarks {
    described: Described,
    id: String,
    chains: Vec<String>,
    /// Whether the list of chains ended, so that the next one belongs to other matrices.
    has_matrices: bool,
}

impl Remarks {
    fn read(&mut self, line: &str) {
        let text = columns(line, 10, 80).trim();
        let after = |label: &str| text.strip_prefix(label).map(|t| t.trim().to_owned());
        if let Some(id) = after("BIOMOLECULE:") {
            self.id = id.split(',').next().unwrap_or_default().trim().to_owned();
            self.chains.clear();
            self.has_matrices = false;
        } else if let Some(said) = text.split_once("BIOLOGICAL UNIT:").map(|(_, said)| said.trim()) {
            self.described.details.entry(self.id.clone()).or_insert_with(|| said.to_owned());
        } else if let Some(list) = after("APPLY THE FOLLOWING TO CHAINS:").or_else(|| after("AND CHAINS:")) {
            if self.has_matrices {
                self.chains.clear();
                self.has_matrices = false;
            }
            let names = list.split(',').map(str::trim).filter(|name| !name.is_empty());
            // A chain without a name is called so.
            self.chains.extend(names.map(|name| if name == "NULL" { String::new() } else { name.to_owned() }));
        } else if let Some(row) = text.strip_prefix("BIOMT") {
            self.row(row);
        }
    }

    fn row(&mut self, text: &str) {
        let mut words = text.split_whitespace();
        let row = words.next().and_then(|k| k.parse::<usize>().ok()).filter(|k| (1..=3).contains(k));
        let (Some(row), Some(number)) = (row, words.next()) else { return };
        let mut values = [f64::NAN; 4];
        values.iter_mut().zip(words).for_each(|(v, word)| *v = word.parse().unwrap_or(f64::NAN));
        // Numbers may begin anew with other chains of an assembly.
        let part = self.described.parts.iter().filter(|(id, ..)| *id == self.id).count();
        if !self.has_matrices {
            self.described.parts.push((self.id.clone(), String::new(), self.chains.clone()));
            self.has_matrices = true;
            return self.row_of(row, values, &format!("{}.{}.{number}", self.id, part + 1));
        }
        self.row_of(row, values, &format!("{}.{part}.{number}", self.id));
    }

    fn row_of(&mut self, row: usize, values: [f64; 4], name: &str) {
        self.described.operations.entry(name.to_owned()).or_insert([[f64::NAN; 4]; 3])[row - 1] = values;
        if let Some((_, expression, _)) = self.described.parts.last_mut().filter(|_| row == 1) {
            if !expression.is_empty() {
                expression.push(',');
            }
            expression.push_str(name);
        }
    }
}

/// Properties of an atom that had to be guessed.
struct Odd {
    element: bool,
    serial: bool,
}

/// The characters of some columns, from 0; fewer at the end of a line. Columns are bytes.
fn columns(line: &str, from: usize, to: usize) -> &str {
    line.get(from..to.min(line.len())).unwrap_or("")
}

fn site(line: &str, hetero: bool, running: i64) -> Result<(Site, Odd), String> {
    if line.len() < NEEDED || !line.is_ascii() {
        let what = if line.is_ascii() { format!("{} columns", line.len()) } else { "letters beyond ASCII".into() };
        return Err(format!(
            "the line of an atom has {what}, {NEEDED} plain ones are needed; it is truncated or no PDB file"
        ));
    }
    let field = |from: usize, to: usize| columns(line, from, to).trim();
    let coordinate = |from: usize, axis: char| {
        let text = field(from, from + 8);
        text.parse::<f64>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| format!("{axis} is {text:?}, a number is needed in columns {} to {}", from + 1, from + 8))
    };
    let position = DVec3::new(coordinate(30, 'x')?, coordinate(38, 'y')?, coordinate(46, 'z')?);
    let (serial, number) = (whole(field(6, 11), 5), whole(field(22, 26), 4).unwrap_or(0));
    // Simulations write names of four letters into the column after.
    let residue_name = field(17, 21);
    let residue = Residue {
        name: residue_name.split_whitespace().next().unwrap_or("").to_owned(),
        number: number as i32,
        insertion: columns(line, 26, 27).chars().next().filter(|c| c.is_ascii_alphanumeric()),
        chain: field(21, 22).to_owned(),
        hetero,
    };
    let stated = Element::from_symbol(field(76, 78)).filter(|_| !field(76, 78).is_empty());
    let element = stated.or_else(|| by_name(columns(line, 12, 16), &residue)).unwrap_or(Element::UNKNOWN);
    let odd = Odd { element: stated.is_none(), serial: serial.is_none() };
    let site = Site {
        serial: serial.unwrap_or(running),
        model: 1,
        asym: residue.chain.clone(),
        name: field(12, 16).to_owned(),
        element,
        residue,
        position,
        alternate: columns(line, 16, 17).chars().next().filter(|c| *c != ' '),
        occupancy: field(54, 60).parse().ok().filter(|o: &f64| o.is_finite()).unwrap_or(1.0),
    };
    Ok((site, odd))
}

/// A number; beyond the width of its columns as programs write it: hybrid-36 (upper case, then lower case letters first).
fn whole(text: &str, width: u32) -> Option<i64> {
    if let Ok(n) = text.parse() {
        return Some(n);
    }
    let first = text.chars().next()?;
    if text.len() != width as usize || !text.chars().all(|c| c.is_ascii_alphanumeric()) || !first.is_ascii_alphabetic()
    {
        return None;
    }
    let value = i64::from_str_radix(text, 36).ok()?;
    let (all, from) = (10i64.pow(width), 10 * 36i64.pow(width - 1));
    Some(if first.is_ascii_uppercase() { value - from + all } else { value + 16 * 36i64.pow(width - 1) + all })
}

/// The element by the name of an atom: symbols end in its second column, but names of four letters begin in the first.
fn by_name(name: &str, residue: &Residue) -> Option<Element> {
    let letters: String = name.chars().filter(char::is_ascii_alphabetic).collect();
    let ion: String = residue.name.chars().filter(char::is_ascii_alphabetic).collect();
    // An ion is a residue of its own, named as the atom is.
    if letters.len() <= 2 && letters.eq_ignore_ascii_case(&ion) {
        return Element::from_symbol(&letters);
    }
    let two = columns(name, 0, 2);
    let full = name.trim().len() == 4;
    let symbol = two.bytes().all(|b| b.is_ascii_alphabetic()).then(|| Element::from_symbol(two)).flatten();
    if residue.hetero && !full && symbol.is_some() {
        return symbol;
    }
    let first = letters.get(..1)?;
    // The massless site of four-point water is called M.
    Element::from_symbol(first).filter(|_| !"M".eq_ignore_ascii_case(first))
}

/// The partners that a line names.
fn bonds(line: &str) -> Vec<[i64; 2]> {
    let number = |k: usize| whole(columns(line, 6 + 5 * k, 11 + 5 * k).trim(), 5);
    let Some(from) = number(0) else { return Vec::new() };
    (1..5).filter_map(number).map(|to| [from, to]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beyond_their_columns() {
        for (text, width, value) in [
            ("1234", 4, Some(1234)),
            ("-12", 4, Some(-12)),
            ("A000", 4, Some(10_000)),
            ("A00Z", 4, Some(10_035)),
            ("ZZZZ", 4, Some(1_223_055)),
            ("a000", 4, Some(1_223_056)),
            ("A0000", 5, Some(100_000)),
            ("*****", 5, None),
            ("", 5, None),
        ] {
            assert_eq!(whole(text, width), value, "{text}");
        }
    }

    #[test]
    fn names_tell_elements() {
        let of = |name: &str, residue: &str, hetero: bool| {
            let residue = Residue { name: residue.into(), hetero, ..Residue::default() };
            by_name(name, &residue).map_or("X", Element::symbol)
        };
        for (name, residue, hetero, symbol) in [
            (" CA ", "ALA", false, "C"),
            ("CA  ", "CA", true, "Ca"),
            ("HG11", "VAL", false, "H"),
            ("1HB ", "ALA", false, "H"),
            (" NA ", "NA+", false, "Na"),
            (" OW ", "SOL", false, "O"),
            (" MW ", "SOL", false, "X"),
            ("FE  ", "HEM", true, "Fe"),
            (" N A", "HEM", true, "N"),
            ("    ", "ALA", false, "X"),
        ] {
            assert_eq!(of(name, residue, hetero), symbol, "{name} {residue}");
        }
    }
}
