//! PDB: lines of fixed columns.
//!
//! Format: wwPDB, version 3.3, and its variants by simulation programs: no chains, no elements, numbers that overflow their columns.

use super::sites::{Site, Sites};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::molecule::{Element, Residue};
use glam::DVec3;

/// Columns of a line of an atom up to its coordinates.
const NEEDED: usize = 54;

pub(super) fn read(text: &str) -> Result<Sites, String> {
    let mut out = Sites::default();
    let (mut guessed, mut renumbered) = (0, 0);
    for (i, line) in text.lines().enumerate() {
        let record = columns(line, 0, 6).trim_end();
        match record {
            "MODEL" => out.models += 1,
            "ATOM" | "HETATM" if out.models <= 1 => {
                let number = out.sites.len() as i64 + 1;
                let (site, odd) = site(line, record == "HETATM", number).map_err(|e| format!("line {}: {e}", i + 1))?;
                guessed += usize::from(odd.element);
                renumbered += usize::from(odd.serial);
                out.sites.push(site);
            }
            "CONECT" => out.bonds.extend(bonds(line)),
            "END" => break,
            _ => {}
        }
    }
    out.models = out.models.max(1);
    let from_names = "atoms name no element; it is taken from their names";
    out.warnings.extend(Warning::counted(WarningKind::Assumed, guessed, from_names));
    let counted = "atoms have no readable number; they are counted instead";
    out.warnings.extend(Warning::counted(WarningKind::Repaired, renumbered, counted));
    Ok(out)
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
