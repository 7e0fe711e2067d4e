//! FlatGeobuf 3: the features in the order of the file, with heights and properties. The index of places is passed over.

mod buffer;
mod feature;

use super::collected::Collected;
use super::tracks::salvaged;
use super::{Vectors, not_degrees, shorten};
use crate::crs::{CoordinateSystem, CrsError};
use crate::{IoError, Loaded};
use belvedere_core::{Warning, WarningKind};
use buffer::Table;
use feature::{Column, Features};
use std::path::Path;

/// First bytes of the files.
pub(super) const MAGIC: &[u8] = b"fgb\x03";
/// Bytes before the length of the header.
const MARK: usize = 8;
/// Bytes of a node of the index.
const NODE: u64 = 40;

/// What the header says.
struct Header {
    name: String,
    kind: u8,
    columns: Vec<Column>,
    /// Number of features; 0 = not known.
    count: u64,
    /// First byte of the features.
    start: u64,
    system: Option<Result<CoordinateSystem, CrsError>>,
}

pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<Loaded<Vectors>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let header = Header::of(bytes).map_err(fail)?;
    let rest = usize::try_from(header.start).ok().and_then(|start| bytes.get(start..));
    let mut features = Features::new(header.kind, &header.columns);
    let damage = features.read(rest.unwrap_or_default(), header.count);
    let damage = if rest.is_some() { damage } else { Some("is cut off before its first feature".into()) };
    let found = features.found;
    if let Some(damage) = damage.as_ref().filter(|_| found.features.is_empty()) {
        return Err(fail(format!("{damage}, get it again")));
    }
    if found.features.is_empty() && features.curves > 0 {
        return Err(fail(format!(
            "FlatGeobuf holds {} curves or surfaces and nothing else; {STRAIGHT}",
            features.curves
        )));
    }
    let mut warnings = found.told(path, "FlatGeobuf holds").map_err(fail)?;
    let (crs, crs_stated) = system_of(header.system, &found).map_err(fail)?;
    let what = format!("features that are curves or surfaces were left out; {STRAIGHT}");
    let curves = Warning::counted(WarningKind::Ignored, features.curves, &what);
    let odd =
        Warning::counted(WarningKind::Ignored, features.odd, "features whose positions are not finite were dropped");
    let damage = damage.map(|damage| salvaged(&damage, &found.features));
    warnings.extend([curves, odd, damage].into_iter().flatten().map(|w| w.in_file(path)));
    let (path, format, features) = (path.into(), "FlatGeobuf", found.features);
    Ok(Loaded::new(Vectors { path, format, layer: header.name, crs, crs_stated, features }, warnings))
}

/// Advice for curves.
const STRAIGHT: &str = "ogr2ogr -nlt CONVERT_TO_LINEAR makes straight ones of them";

/// The system, and whether the file states it.
fn system_of(
    stated: Option<Result<CoordinateSystem, CrsError>>,
    found: &Collected,
) -> Result<(CoordinateSystem, bool), String> {
    let Some(stated) = stated else {
        return found.system(CoordinateSystem::wgs84().map_err(|e| e.to_string())?, false);
    };
    let crs = stated.map_err(|e| format!("is in a system that is not known: {e}"))?;
    match not_degrees(&found.features).filter(|_| crs.is_geographic()) {
        Some(reason) => Err(format!("{reason}, but the file's system is {crs}; set it, as by ogr2ogr -a_srs EPSG:n")),
        None => Ok((crs, true)),
    }
}

impl Header {
    fn of(bytes: &[u8]) -> Result<Self, String> {
        let cut = || "is cut off inside of its header, get it again".to_owned();
        let size = bytes.get(MARK..MARK + 4).and_then(|b| b.first_chunk()).ok_or_else(cut)?;
        let start = MARK + 4;
        let end = start + u32::from_le_bytes(*size) as usize;
        let header = bytes.get(start..end).ok_or_else(cut)?;
        let table = Table::root(header).ok_or("has a damaged header, get it again")?;
        let count = table.bytes(8).map_or(0, u64::from_le_bytes);
        let node = table.bytes(9).map_or(16, u16::from_le_bytes);
        let index = index_size(count, node).ok_or_else(|| {
            format!("says that it holds {count} features, more than a file can; it is damaged, get it again")
        })?;
        Ok(Self {
            name: table.text(0).map(|name| shorten(&name)).unwrap_or_default(),
            kind: table.bytes(2).map_or(0, |[kind]| kind),
            columns: Column::of(&table, 7),
            count,
            start: end as u64 + index,
            system: table.table(10).and_then(|crs| system(&crs)),
        })
    }
}

/// The system that the header states, if it does.
fn system(crs: &Table<'_>) -> Option<Result<CoordinateSystem, CrsError>> {
    let organization = crs.text(0).unwrap_or_default();
    let is_epsg = organization.is_empty() || organization.eq_ignore_ascii_case("EPSG");
    let code = crs.bytes(1).map(i32::from_le_bytes).and_then(|code| u32::try_from(code).ok()).filter(|code| *code > 0);
    let by_code = code.filter(|_| is_epsg).map(CoordinateSystem::from_epsg);
    let by_text = || crs.text(4).filter(|text| !text.is_empty()).map(|text| CoordinateSystem::from_text(&text));
    let by_name = || Some(CoordinateSystem::from_text(&format!("{organization}:{}", code?)));
    match by_code {
        Some(Ok(crs)) => Some(Ok(crs)),
        Some(Err(e)) => by_text().filter(Result::is_ok).or(Some(Err(e))),
        None => by_text().or_else(by_name),
    }
}

/// Bytes of the index of a number of features; `None` if no file is so large.
fn index_size(count: u64, node: u16) -> Option<u64> {
    if count == 0 || node == 0 {
        return Some(0);
    }
    let node = u64::from(node.max(2));
    let (mut level, mut nodes) = (count, count);
    while level > 1 {
        level = level.div_ceil(node);
        nodes = nodes.checked_add(level)?;
    }
    // A single feature has a root beside its leaf.
    let nodes = if count == 1 { 2 } else { nodes };
    nodes.checked_mul(NODE)
}
