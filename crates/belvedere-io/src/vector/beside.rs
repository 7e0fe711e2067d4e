//! Files beside one of features, and the coordinate system that one of them states.

use super::{TIMES, VectorFeature, certainly_not_degrees, not_degrees};
use crate::crs::CoordinateSystem;
use crate::fs::{metadata, read_sidecar, sidecar};
use crate::text::text_of;
use crate::{IoError, budget};
use belvedere_core::{Warning, WarningKind};
use std::path::{Path, PathBuf};

/// Largest file of a coordinate system or code page, bytes.
pub(super) const SMALL: u64 = 1 << 20;

/// Path and bytes of the file beside one of features that has this ending, if there is one.
pub(super) fn beside(path: &Path, ending: &str, most: u64) -> Result<Option<(PathBuf, Vec<u8>)>, IoError> {
    let Some(file) = sidecar(path, ending) else { return Ok(None) };
    let size = metadata(&file).map_or(0, |m| m.len()).min(most);
    let asked = budget::ask(&format!("its .{ending}"), size.saturating_mul(TIMES));
    // About the file itself: a table alone is a file of another kind, and would be told to be one.
    asked.map_err(|reason| IoError::format(path, reason))?;
    read_sidecar(path, &file, most).map(|bytes| Some((file, bytes)))
}

/// The system of a file that states none itself, and whether a .prj beside it states it.
pub(super) fn system_of(
    path: &Path,
    features: &[VectorFeature],
    warnings: &mut Vec<Warning>,
) -> Result<(CoordinateSystem, bool), IoError> {
    let bad = not_degrees(features);
    let stated = beside(path, "prj", SMALL)?.map(|(prj, bytes)| (prj, text_of(&bytes, &mut Vec::new())));
    if let Some((prj, text)) = stated.filter(|(_, text)| !text.trim().is_empty()) {
        let crs = CoordinateSystem::from_text(&text).map_err(|e| IoError::format(&prj, e.to_string()))?;
        return match bad.filter(|_| crs.is_geographic()) {
            Some(reason) => {
                Err(IoError::format(path, format!("{reason}, but the .prj says {crs}; correct one of them")))
            }
            None => Ok((crs, true)),
        };
    }
    if let Some(reason) = bad {
        if !certainly_not_degrees(features) {
            return Err(IoError::format(
                path,
                format!("has no .prj file and {reason}; add the .prj with its coordinate system"),
            ));
        }
        return Ok((CoordinateSystem::local(), false));
    }
    let text = "has no .prj file; taken as longitude and latitude on WGS 84";
    warnings.push(Warning::new(WarningKind::Assumed, text));
    CoordinateSystem::wgs84().map(|crs| (crs, false)).map_err(|e| IoError::format(path, e.to_string()))
}
