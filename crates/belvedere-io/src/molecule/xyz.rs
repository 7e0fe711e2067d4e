//! XYZ: the number of atoms, a comment, and an element with its coordinates on each line; frames one after the other.
//!
//! The extended form names its columns in the comment: `Properties=species:S:1:pos:R:3`.

use super::Models;
use super::sites::{Site, Sites};
use crate::formats::begins_as_atoms;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::molecule::{Element, Residue};
use glam::DVec3;
use std::iter::Peekable;
use std::str::Lines;

/// Bytes that tell such a file.
const HEAD: usize = 4096;

/// Whether the first bytes are of such a file.
pub(super) fn is_atoms(bytes: &[u8]) -> bool {
    begins_as_atoms(&String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]))
}

/// * `wanted`: frames whose atoms are read; `frames`: whether the places of all frames are read, too.
pub(super) fn read(text: &str, wanted: Models, frames: bool) -> Result<Sites, String> {
    let mut out = Sites::default();
    let mut reading = Reading { lines: text.lines().peekable(), at: 0, is_open: !text.ends_with('\n') };
    while let Some(count) = reading.count()? {
        let columns = Columns::of(reading.next().unwrap_or_default());
        out.models += 1;
        let model = out.models;
        for number in 1..=count {
            let line = reading.next().filter(|line| !line.trim().is_empty());
            let site = line.map(|line| columns.site(line, number as i64, model));
            let is_cut = reading.is_open && reading.lines.peek().is_none() && matches!(site, Some(Err(_)));
            let Some(site) = site.filter(|_| !is_cut) else {
                let text = format!(
                    "frame {model} should hold {count} atoms and ends after {}; the file is cut off, the atoms before are read",
                    number - 1
                );
                out.warnings.push(Warning::new(WarningKind::Repaired, text).with("atoms", number as f64 - 1.0));
                // A frame without atoms is none.
                out.models -= usize::from(number == 1 && model > 1);
                return Ok(out);
            };
            let site = site.map_err(|e| format!("line {}: {e}", reading.at))?;
            if frames {
                out.place(model, site.position);
            }
            if wanted.has(model) {
                out.sites.push(site);
            }
        }
    }
    Ok(out)
}

/// The lines of a file.
struct Reading<'t> {
    lines: Peekable<Lines<'t>>,
    /// Number of the last line.
    at: usize,
    /// Whether the last line has no end, so that it may be cut.
    is_open: bool,
}

impl<'t> Reading<'t> {
    fn next(&mut self) -> Option<&'t str> {
        self.at += 1;
        self.lines.next()
    }

    /// The number of atoms of the next frame; `None` at the end.
    fn count(&mut self) -> Result<Option<usize>, String> {
        loop {
            let Some(line) = self.next() else { return Ok(None) };
            let line = line.trim();
            if line.is_empty() {
                continue;
            }
            // A number that the end of the file cuts is not the number.
            if self.lines.peek().is_none() {
                return Ok(None);
            }
            let count = line.parse().map_err(|_| {
                let shown: String = line.chars().take(40).collect();
                format!("line {} is {shown:?}, the number of atoms of a frame is needed; it is damaged", self.at)
            });
            return count.map(Some);
        }
    }
}

/// Words of a line that are the element and the first coordinate.
struct Columns {
    element: usize,
    x: usize,
}

impl Columns {
    /// By the comment of a frame.
    fn of(comment: &str) -> Self {
        let plain = Self { element: 0, x: 1 };
        let Some((_, rest)) = comment.split_once("Properties=") else { return plain };
        let fields: Vec<&str> =
            rest.split_whitespace().next().unwrap_or_default().trim_matches('"').split(':').collect();
        let (mut at, mut element, mut x) = (0, None, None);
        for field in fields.chunks_exact(3) {
            match field[0] {
                "species" => element = Some(at),
                "pos" => x = Some(at),
                _ => {}
            }
            at += field[2].parse().unwrap_or(1);
        }
        element.zip(x).map_or(plain, |(element, x)| Self { element, x })
    }

    fn site(&self, line: &str, serial: i64, model: usize) -> Result<Site, String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let coordinate = |axis: usize| words.get(self.x + axis)?.parse::<f64>().ok().filter(|v| v.is_finite());
        let position = (|| Some(DVec3::new(coordinate(0)?, coordinate(1)?, coordinate(2)?)))();
        let (Some(word), Some(position)) = (words.get(self.element), position) else {
            let shown: String = line.trim().chars().take(40).collect();
            return Err(format!(
                "an atom is {shown:?}, an element and x, y and z in angstrom are needed; it is damaged"
            ));
        };
        let element = match word.parse::<usize>() {
            Ok(number) => Element::from_number(number),
            // Names such as C12 or O_3 say more than the element.
            Err(_) => word.split(|c: char| !c.is_ascii_alphabetic()).next().and_then(Element::from_symbol),
        };
        Ok(Site {
            serial,
            model,
            asym: String::new(),
            name: element.map_or_else(|| (*word).to_owned(), |element| element.symbol().to_owned()),
            element: element.unwrap_or(Element::UNKNOWN),
            residue: Residue { name: "MOL".into(), number: 1, ..Residue::default() },
            position,
            alternate: None,
            occupancy: 1.0,
        })
    }
}
