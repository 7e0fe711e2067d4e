//! ESRI shapefiles: points, multipoints, polylines and polygons, with Z and M, names from the .dbf, system from the .prj.

use super::beside::{SMALL, beside, system_of};
use super::{Geometry, MAX_BYTES, VectorFeature, Vectors, Vertex, name_of, rings, shorten, vertex};
use crate::text::table_encoding;
use crate::{IoError, Loaded};
use belvedere_core::{Warning, WarningKind};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::Path;

/// File code 9994, big-endian.
pub(super) const MAGIC: [u8; 4] = [0, 0, 0x27, 0x0a];

pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Loaded<Vectors>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let mut warnings = Vec::new();
    let index = beside(path, "shx", MAX_BYTES)?.and_then(|(_, bytes)| read_index(&bytes));
    let shapes = read_shapes(bytes, index.as_deref(), &mut warnings).map_err(fail)?;
    let count = shapes.len();
    let code_page = beside(path, "cpg", SMALL)?.map(|(_, bytes)| String::from_utf8_lossy(&bytes).into_owned());
    let table = match beside(path, "dbf", MAX_BYTES)? {
        Some((p, bytes)) => read_dbf(&bytes, code_page.as_deref(), &mut warnings).unwrap_or_else(|reason| {
            let text = format!("{}: {reason}; features stay without names", p.display());
            warnings.push(Warning::new(WarningKind::Ignored, text));
            Vec::new()
        }),
        None => Vec::new(),
    };
    if !table.is_empty() && table.len() != count {
        let rows = table.len();
        let text = format!("the table (.dbf) has {rows} rows for {count} shapes; names may belong to other shapes");
        warnings.push(Warning::new(WarningKind::Suspect, text).with("rows", rows as f64).with("shapes", count as f64));
    }
    let mut table = table.into_iter();
    let mut features = Vec::new();
    for shape in shapes {
        let properties = table.next().unwrap_or_default();
        if let Some(geometry) = shape {
            features.push(VectorFeature { style: None, name: name_of(&properties), properties, geometry });
        }
    }
    if features.is_empty() {
        return Err(fail(format!("shapefile holds {count} shapes, none with a usable position; choose another file")));
    }
    if features.len() < count {
        let lost = count - features.len();
        let text = format!("{lost} of {count} shapes are empty and were dropped");
        warnings.push(Warning::new(WarningKind::Ignored, text).with("count", lost as f64).with("of", count as f64));
    }
    let (crs, crs_stated) = system_of(path, &features, &mut warnings)?;
    let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
    let value = Vectors { path: path.into(), format: "shapefile", layer: String::new(), crs, crs_stated, features };
    Ok(Loaded::new(value, warnings))
}

/// Numbers at byte offsets; `None` past the end.
#[derive(Clone, Copy)]
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn array<const N: usize>(self, at: usize) -> Option<[u8; N]> {
        self.0.get(at..at.checked_add(N)?)?.try_into().ok()
    }
    fn be_i32(self, at: usize) -> Option<i32> {
        self.array(at).map(i32::from_be_bytes)
    }
    fn le_i32(self, at: usize) -> Option<i32> {
        self.array(at).map(i32::from_le_bytes)
    }
    fn f64(self, at: usize) -> Option<f64> {
        self.array(at).map(f64::from_le_bytes)
    }
    /// A count; `None` if it is negative.
    fn count(self, at: usize) -> Option<usize> {
        usize::try_from(self.le_i32(at)?).ok()
    }
}

/// Offsets of the records by the index (.shx), bytes from the beginning of the .shp; `None` if the index is incomplete.
fn read_index(bytes: &[u8]) -> Option<Vec<usize>> {
    let file = Bytes(bytes);
    if !bytes.starts_with(&MAGIC) || bytes.len() < 100 || !(bytes.len() - 100).is_multiple_of(8) {
        return None;
    }
    let word = |at: usize| file.be_i32(at).and_then(|w| usize::try_from(w).ok()).map(|w| w * 2);
    (100..bytes.len()).step_by(8).map(word).collect()
}

/// One geometry per record; `None` for null and empty shapes. Records are read at the offsets of `index` if it is valid, for there may
/// be other bytes between and after them.
fn read_shapes(
    bytes: &[u8],
    index: Option<&[usize]>,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Option<Geometry>>, String> {
    let file = Bytes(bytes);
    let stated = file.be_i32(24).map(|words| i64::from(words) * 2);
    if bytes.len() < 100 {
        return Err(format!(
            "is {} bytes long, a shapefile has a header of 100; the file is cut off, get it again",
            bytes.len()
        ));
    }
    if stated.is_some_and(|n| n > bytes.len() as i64) {
        let n = stated.unwrap_or(0);
        return Err(format!("is {} bytes long, its header says {n}; the file is cut off, get it again", bytes.len()));
    }
    let end = stated.and_then(|n| usize::try_from(n).ok()).filter(|n| *n >= 100).unwrap_or(bytes.len());
    if end < bytes.len() {
        let rest = bytes.len() - end;
        let text = format!("{rest} bytes after the end stated in the header were ignored");
        warnings.push(Warning::new(WarningKind::Ignored, text).with("bytes", rest as f64));
    }
    let mut odd = 0usize;
    let shapes = match in_order(bytes, end, &mut odd) {
        Ok(shapes) if index.is_none_or(|i| i.len() == shapes.len()) => shapes,
        found => {
            let mut odd_there = 0;
            let by_index = index.and_then(|index| by_index(bytes, index, &mut odd_there));
            match (by_index, found) {
                (Some(shapes), _) => {
                    odd = odd_there;
                    shapes
                }
                (None, found) => found?,
            }
        }
    };
    let parts = "parts with too few points, of one position only or with positions that are not finite were dropped";
    warnings.extend(Warning::counted(WarningKind::Ignored, odd, parts));
    Ok(shapes)
}

/// Records one behind the other.
fn in_order(bytes: &[u8], end: usize, odd: &mut usize) -> Result<Vec<Option<Geometry>>, String> {
    let (mut shapes, mut at) = (Vec::new(), 100usize);
    while at + 8 <= end {
        let number = shapes.len() + 1;
        let broken = |what: &str| format!("record {number} at byte {at} {what}; the file is damaged, get it again");
        let content = content_at(bytes, at).ok_or_else(|| broken("claims more bytes than the file has"))?;
        shapes.push(read_shape(content, odd).map_err(|e| broken(&e))?);
        at += 8 + content.len();
    }
    Ok(shapes)
}

/// Records where the index says; `None` if one of them is invalid.
fn by_index(bytes: &[u8], index: &[usize], odd: &mut usize) -> Option<Vec<Option<Geometry>>> {
    index.iter().map(|&at| read_shape(content_at(bytes, at)?, odd).ok()).collect()
}

/// Content of the record whose header begins at a byte.
fn content_at(bytes: &[u8], at: usize) -> Option<&[u8]> {
    let from = at.checked_add(8)?;
    let length = Bytes(bytes).be_i32(at + 4).and_then(|w| usize::try_from(w).ok())? * 2;
    bytes.get(from..from.checked_add(length)?)
}

fn read_shape(content: &[u8], odd: &mut usize) -> Result<Option<Geometry>, String> {
    let c = Bytes(content);
    let short = || "is shorter than its own counts demand".to_owned();
    let kind = c.le_i32(0).ok_or_else(short)?;
    match kind {
        0 => Ok(None),
        1 | 11 | 21 => {
            let z = if kind == 11 { c.f64(20) } else { None };
            let v = vertex(c.f64(4).ok_or_else(short)?, c.f64(12).ok_or_else(short)?, z);
            *odd += usize::from(v.is_none());
            Ok(v.map(|v| Geometry::Points(vec![v])))
        }
        8 | 18 | 28 => {
            let count = c.count(36).ok_or_else(short)?;
            let points = read_points(c, 40, count, kind == 18).ok_or_else(short)?;
            *odd += points.iter().filter(|p| p.is_none()).count();
            let points: Vec<Vertex> = points.into_iter().flatten().collect();
            Ok((!points.is_empty()).then_some(Geometry::Points(points)))
        }
        3 | 13 | 23 | 5 | 15 | 25 => {
            let parts = read_parts(c, kind == 13 || kind == 15).ok_or_else(short)?;
            let area = kind % 10 == 5;
            Ok(shape_of_parts(parts, area, odd))
        }
        31 => Err("is a multipatch, which is not supported".into()),
        other => Err(format!("has the unknown shape type {other}")),
    }
}

/// `count` points from byte `at`, with the Z array behind them if there is one; `None` if the content is too short.
fn read_points(c: Bytes<'_>, at: usize, count: usize, with_z: bool) -> Option<Vec<Option<Vertex>>> {
    let z_at = at.checked_add(count.checked_mul(16)?)?;
    if z_at > c.0.len() {
        return None; // before anything is allocated
    }
    (0..count)
        .map(|k| {
            let z = if with_z { c.f64(z_at + 16 + 8 * k) } else { None };
            Some(vertex(c.f64(at + 16 * k)?, c.f64(at + 16 * k + 8)?, z))
        })
        .collect()
}

fn read_parts(c: Bytes<'_>, with_z: bool) -> Option<Vec<Vec<Option<Vertex>>>> {
    let (parts, count) = (c.count(36)?, c.count(40)?);
    let points_at = 44usize.checked_add(parts.checked_mul(4)?)?;
    if points_at > c.0.len() {
        return None;
    }
    let points = read_points(c, points_at, count, with_z)?;
    let mut starts = (0..parts).map(|k| c.count(44 + 4 * k)).collect::<Option<Vec<usize>>>()?;
    starts.push(count);
    starts.windows(2).map(|w| points.get(w[0]..w[1]).map(<[_]>::to_vec)).collect()
}

fn shape_of_parts(parts: Vec<Vec<Option<Vertex>>>, area: bool, odd: &mut usize) -> Option<Geometry> {
    let mut kept = Vec::new();
    for part in parts {
        let total = part.len();
        let mut part: Vec<Vertex> = part.into_iter().flatten().collect();
        *odd += usize::from(part.len() < total);
        if area && part.len() > 1 && part.first().map(|v| v.xy) == part.last().map(|v| v.xy) {
            part.pop();
        }
        if part.len() >= if area { 3 } else { 2 } {
            kept.push(part);
        } else {
            *odd += 1;
        }
    }
    if !area {
        let before = kept.len();
        kept.retain(|line| line.iter().any(|v| v.xy != line[0].xy));
        *odd += before - kept.len();
    }
    if kept.is_empty() {
        return None;
    }
    if !area {
        return Some(Geometry::Lines(kept));
    }
    let flat: Vec<_> = kept.iter().map(|r| r.iter().map(|v| v.xy).collect::<Vec<_>>()).collect();
    let nested = rings::nest(&flat);
    Some(Geometry::Polygons(nested.into_iter().map(|p| p.into_iter().map(|k| kept[k].clone()).collect()).collect()))
}

/// Rows of a dBASE table as text, deleted ones included (shapes count them too).
fn read_dbf(
    bytes: &[u8],
    code_page: Option<&str>,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<BTreeMap<String, String>>, String> {
    let file = Bytes(bytes);
    let short = || format!("table of {} bytes is cut off", bytes.len());
    let rows = file.count(4).ok_or_else(short)?;
    let word = |at: usize| file.array(at).map(u16::from_le_bytes).map(usize::from);
    let (header, width) = (word(8).ok_or_else(short)?, word(10).ok_or_else(short)?);
    let encoding = table_encoding(code_page, bytes.get(29).copied().unwrap_or(0));
    let misread = Cell::new(0usize);
    let text = |bytes: &[u8]| match encoding.map(|encoding| encoding.decode_without_bom_handling(bytes)) {
        Some((text, false)) => text.into_owned(),
        _ => {
            // Another encoding than the stated one, or one that is not known.
            let is_known = encoding.is_none() && code_page.is_none();
            misread.set(misread.get() + usize::from(!bytes.is_ascii() && !is_known));
            latin1_or_utf8(bytes)
        }
    };
    let mut fields: Vec<(String, usize, usize)> = Vec::new();
    let (mut at, mut column) = (32, 1);
    while at + 32 <= header.min(bytes.len()) && bytes.get(at) != Some(&0x0d) {
        let name: Vec<u8> = bytes[at..at + 11].iter().copied().take_while(|b| *b != 0).collect();
        let length = usize::from(bytes[at + 16]);
        fields.push((text(&name), column, length));
        column += length;
        at += 32;
    }
    if width == 0 || header.saturating_add(width.saturating_mul(rows)) > bytes.len() {
        return Err(short());
    }
    let row = |r: usize| -> BTreeMap<String, String> {
        let record = bytes.get(header + r * width..header + (r + 1) * width).unwrap_or_default();
        let value = |column: usize, length: usize| text(record.get(column..column + length).unwrap_or_default());
        fields
            .iter()
            .map(|(name, column, length)| (name.clone(), shorten(value(*column, *length).trim_matches('\0'))))
            .filter(|(_, v)| !v.is_empty())
            .collect()
    };
    let table = (0..rows).map(row).collect();
    let stated = encoding.map(|encoding| encoding.name()).or(code_page.map(str::trim)).unwrap_or_default();
    let text = format!(
        "texts of the table (.dbf) are not in the encoding {:?} that is stated, or it is not known; they are read as UTF-8 or Latin-1",
        shorten(stated)
    );
    warnings.extend(Warning::counted(WarningKind::Suspect, misread.get(), &text));
    Ok(table)
}

fn latin1_or_utf8(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect(), str::to_owned)
}
