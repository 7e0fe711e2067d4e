//! Tables of text with coordinates, one feature in each row: two columns of numbers, or one of well-known text, found by their names.

use super::collected::Collected;
use super::tracks::number;
use super::{Geometry, Vectors, beside, not_degrees, shorten, vertex, wkt};
use crate::columns::{self, LOOKED_FOR, Layout, Place, Record, Records};
use crate::crs::CoordinateSystem;
use crate::{IoError, Loaded, budget};
use belvedere_core::{Warning, WarningKind};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Most names that an error lists.
const LISTED: usize = 12;
/// Bytes that a feature takes, and each of its properties.
const ROW_BYTES: usize = 900;
const COLUMN_BYTES: usize = 100;

/// Rows as features, and counts of what is left out.
#[derive(Default)]
struct Rows {
    found: Collected,
    /// Rows without usable coordinates.
    dropped: usize,
    count: usize,
    /// Numbers of systems that well-known texts name.
    srids: BTreeSet<u32>,
    is_open: bool,
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let layout = columns::layout(text).ok_or_else(|| fail("holds no line of text".into()))?;
    let place = layout.place.ok_or_else(|| fail(without_columns(&layout.names)))?;
    // Short rows take more room as features than as text.
    let peak = text.lines().count().saturating_mul(ROW_BYTES + COLUMN_BYTES * layout.names.len());
    budget::ask("the table", peak as u64).map_err(|reason| IoError::format(path, reason))?;
    let mut rows = Rows::default();
    let mut records = Records::new(text, layout.sign).skip(1).peekable();
    let mut cut = None;
    while let Some(record) = records.next() {
        let is_last = records.peek().is_none() && !text.ends_with(['\n', '\r']);
        if is_last && record.fields.len() < layout.names.len() && rows.count > 0 {
            let (fields, names) = (record.fields.len(), layout.names.len());
            let text = format!("its last row has {fields} of {names} fields and no end; it is cut off, and left out");
            cut = Some(Warning::new(WarningKind::Repaired, text));
            break;
        }
        rows.add(&layout, place, &record);
    }
    if rows.found.features.is_empty() && rows.dropped > 0 {
        let count = rows.dropped;
        let reason = format!("none of its {count} rows has coordinates in {}; correct them", words(&layout, place));
        return Err(fail(reason));
    }
    let mut warnings = rows.found.told(path, &format!("CSV holds {} rows, but", rows.count)).map_err(fail)?;
    let mut warn = |warning: Option<Warning>| warnings.extend(warning.map(|w| w.in_file(path)));
    let what =
        format!("of {} rows were dropped, for they have no coordinates in {}", rows.count, words(&layout, place));
    warn(Warning::counted(WarningKind::Ignored, rows.dropped, &what));
    warn(cut);
    let open = "its last quote is not closed, so the last row may hold others; close it, or get the file again";
    warn(rows.is_open.then(|| Warning::new(WarningKind::Suspect, open)));
    let mut assumed = Vec::new();
    let (crs, crs_stated) = system_of(path, &rows, place, &mut assumed)?;
    warnings.extend(assumed.into_iter().map(|w| w.in_file(path)));
    let (layer, features) = (String::new(), rows.found.features);
    Ok(Loaded::new(Vectors { path: path.into(), format: "CSV", layer, crs, crs_stated, features }, warnings))
}

fn without_columns(names: &[String]) -> String {
    let more = if names.len() > LISTED { ", …" } else { "" };
    let names: Vec<String> = names.iter().take(LISTED).map(|name| format!("\"{}\"", shorten(name))).collect();
    format!("has no columns of coordinates in its first line ({}{more}); name them {LOOKED_FOR}", names.join(", "))
}

/// The columns of coordinates, in words.
fn words(layout: &Layout, place: Place) -> String {
    let name = |at: usize| format!("\"{}\"", shorten(&layout.names[at]));
    match place {
        Place::Numbers { x, y, .. } => format!("the columns {} and {}", name(x), name(y)),
        Place::Text(at) => format!("the column {}", name(at)),
    }
}

/// The system, and whether the file, its columns or a .prj beside it state it.
fn system_of(
    path: &Path,
    rows: &Rows,
    place: Place,
    warnings: &mut Vec<Warning>,
) -> Result<(CoordinateSystem, bool), IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let srids: Vec<String> = rows.srids.iter().map(u32::to_string).collect();
    let features = &rows.found.features;
    let are_degrees = matches!(place, Place::Numbers { are_degrees: true, .. });
    let crs = match (rows.srids.iter().next(), are_degrees) {
        (Some(srid), _) if rows.srids.len() == 1 => CoordinateSystem::from_epsg(*srid),
        (Some(_), _) => {
            return Err(fail(format!("is in several systems, SRID {}; give each its own file", srids.join(", "))));
        }
        (None, true) => CoordinateSystem::wgs84(),
        (None, false) => return beside::system_of(path, features, warnings),
    };
    let crs = crs.map_err(|e| fail(e.to_string()))?;
    match not_degrees(features).filter(|_| crs.is_geographic()) {
        Some(reason) if are_degrees => Err(fail(format!(
            "{reason}, but its columns are named so; name them x and y, and add a .prj with their system"
        ))),
        Some(reason) => Err(fail(format!("{reason}, but its SRID says {crs}; correct one of them"))),
        None => Ok((crs, true)),
    }
}

impl Rows {
    fn add(&mut self, layout: &Layout, place: Place, record: &Record) {
        self.count += 1;
        self.is_open |= record.is_open;
        let field = |at: usize| record.fields.get(at).map_or("", String::as_str);
        let geometries = match place {
            Place::Numbers { x, y, z, .. } => {
                let xy = number(field(x)).zip(number(field(y)));
                let point = xy.and_then(|(x, y)| vertex(x, y, z.and_then(|z| number(field(z)))));
                point.map(|point| vec![Geometry::Points(vec![point])])
            }
            Place::Text(at) => wkt::read(field(at), &mut self.found).map(|shapes| {
                self.srids.extend(shapes.srid);
                shapes.geometries
            }),
        };
        let Some(geometries) = geometries else {
            self.dropped += 1;
            return;
        };
        let is_own = |at: &usize| matches!(place, Place::Text(text) if text == *at);
        let named = layout.names.iter().zip(&record.fields).enumerate().filter(|(at, _)| !is_own(at));
        let filled = named.filter(|(_, (name, value))| !name.is_empty() && !value.is_empty());
        let properties: BTreeMap<String, String> =
            filled.map(|(_, (name, value))| (shorten(name), shorten(value))).collect();
        for geometry in geometries {
            self.found.add(geometry, properties.clone());
        }
    }
}
