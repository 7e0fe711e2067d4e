//! Films drawn in parts by several processes in one folder. Each part keeps a record of its own frames, so that no process
//! replaces what another wrote; a run over the whole film collects the records and removes them.

use super::manifest::Manifest;
use crate::camera_path::CameraPath;
use crate::film::Adjustment;
use crate::{BelvedereError, output};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// First and last frame of a part, counted from 0.
pub type Part = RangeInclusive<usize>;

/// Name of the record of a film.
const WHOLE: &str = "animation.json";
/// What names of records of parts begin with.
const PART: &str = "animation.part_";
/// Name of the plan that the parts share.
const PLAN: &str = "animation.plan.json";
/// Name of the file of the names of a film, which is kept until the film is finished.
pub(super) const NAMES: &str = "animation.names.json";

/// Name of the record that a run writes.
pub(super) fn record_name(part: Option<&Part>) -> String {
    part.map_or_else(|| WHOLE.to_owned(), |part| format!("{PART}{:05}_{:05}.json", part.start(), part.end()))
}

/// Checks a part against the number of frames.
pub(super) fn check(part: &Part, frames: usize) -> Result<(), BelvedereError> {
    if part.start() <= part.end() && *part.end() < frames {
        return Ok(());
    }
    Err(BelvedereError::Animation(format!(
        "the part {}:{} is not in 0:{}; frames are counted from 0",
        part.start(),
        part.end(),
        frames.saturating_sub(1)
    )))
}

/// Paths of the records of parts in a folder, in order.
pub(super) fn records(folder: &Path) -> Vec<PathBuf> {
    let is_record = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name.starts_with(PART) && name.ends_with(".json")
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut records: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_record).collect();
    records.sort();
    records
}

/// Removes the records of the parts, their plan, and the names that are kept while a film is drawn.
pub(super) fn forget(folder: &Path) {
    for path in records(folder).into_iter().chain([PLAN, NAMES].map(|name| folder.join(name))) {
        let _ = std::fs::remove_file(path);
    }
}

/// Lifts and strengths of all frames, which are the same in every process: the first that has planned them spares it the others.
#[derive(Serialize, Deserialize)]
struct Plan {
    /// sha256 of the record of the film without frames.
    film: String,
    /// Lift in scene units, and share of the bends.
    frames: Vec<[f64; 2]>,
}

/// What tells films apart: sha256 of the record of a film without its frames.
pub(super) fn key(manifest: &Manifest) -> Result<String, BelvedereError> {
    let film = Manifest { frames: vec![None; manifest.frames.len()], done: 0, ..manifest.clone() };
    Ok(belvedere_io::sha256(output::json(&film)?.as_bytes()))
}

/// Takes over a plan that another process made for the same film; whether there is one.
pub(super) fn read_plan(folder: &Path, manifest: &Manifest, path: &mut CameraPath) -> Result<bool, BelvedereError> {
    let Some(following) = &mut path.following else { return Ok(false) };
    let text = belvedere_io::fs::read_to_string(folder.join(PLAN)).unwrap_or_default();
    let Ok(plan) = serde_json::from_str::<Plan>(&text) else { return Ok(false) };
    if plan.film != key(manifest)? || plan.frames.len() != following.adjustments.len() {
        return Ok(false);
    }
    for (adjustment, [lift, share]) in following.adjustments.iter_mut().zip(plan.frames) {
        *adjustment = Adjustment { lift, share, aim: 0.0 };
    }
    Ok(true)
}

/// Keeps a plan for the other parts.
pub(super) fn write_plan(folder: &Path, manifest: &Manifest, path: &CameraPath) -> Result<(), BelvedereError> {
    let Some(following) = &path.following else { return Ok(()) };
    let frames = following.adjustments.iter().map(|a| [a.lift, a.share]).collect();
    output::write_text(&folder.join(PLAN), &output::json(&Plan { film: key(manifest)?, frames })?, true)
}
