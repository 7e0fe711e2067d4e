//! What happens to the frames that a folder holds already.

use super::manifest::{Manifest, frame_name};
use super::{AnimateRequest, parts};
use crate::BelvedereError;
use std::path::{Path, PathBuf};

/// Decides whether existing frames of the folder are kept, replaced or refused.
pub(super) fn claim(manifest: &mut Manifest, folder: &Path, request: &AnimateRequest) -> Result<(), BelvedereError> {
    if std::fs::metadata(folder).is_ok_and(|m| !m.is_dir()) {
        let reason = "is a file; give a folder for the frames, or a film named .mp4".into();
        return Err(BelvedereError::Output { path: folder.to_owned(), reason });
    }
    if request.part.is_some() {
        return claim_part(manifest, folder, request);
    }
    if request.overwrite && !request.resume {
        // Frames of a longer earlier animation would end up in this film.
        let longest = earlier(folder).into_iter().flatten().map(|(_, m)| m.frames.len()).max().unwrap_or(0);
        for frame in manifest.frames.len()..longest {
            let _ = std::fs::remove_file(folder.join(frame_name(frame)));
        }
        parts::forget(folder);
        return Ok(());
    }
    let earlier = earlier(folder)?;
    if request.resume && !earlier.is_empty() {
        for (_, earlier) in &earlier {
            if let Some(reason) = manifest.differs_from(earlier) {
                return refuse(folder, format!("cannot be gone on with: {reason}"), false);
            }
            manifest.keep(earlier, folder);
        }
        return Ok(());
    }
    match earlier.first() {
        Some((_, earlier)) => {
            let reason = format!("holds {} of {} frames of an animation", earlier.done, earlier.frames.len());
            refuse(folder, reason, true)
        }
        None if folder.join(frame_name(0)).exists() => {
            refuse(folder, "holds frames without their record".into(), false)
        }
        None => Ok(()),
    }
}

/// Keeps the frames of all parts of the same film. Of another film nothing is replaced but with `overwrite`, which removes its records.
fn claim_part(manifest: &mut Manifest, folder: &Path, request: &AnimateRequest) -> Result<(), BelvedereError> {
    let earlier = earlier(folder)?;
    for (path, earlier) in &earlier {
        match manifest.differs_from(earlier) {
            Some(_) if request.overwrite => drop(std::fs::remove_file(path)),
            Some(reason) => return refuse(folder, format!("cannot be gone on with: {reason}"), false),
            None if request.overwrite && !request.resume => {}
            None => manifest.keep(earlier, folder),
        }
    }
    let mut asked = request.part.clone().into_iter().flatten();
    if earlier.is_empty() && !request.overwrite && asked.any(|frame| folder.join(frame_name(frame)).exists()) {
        return refuse(folder, "holds frames without their record".into(), false);
    }
    Ok(())
}

/// The records in a folder with their paths: that of a film, then those of parts.
fn earlier(folder: &Path) -> Result<Vec<(PathBuf, Manifest)>, BelvedereError> {
    let paths = [folder.join(parts::record_name(None))].into_iter().chain(parts::records(folder));
    let mut found = Vec::new();
    for path in paths {
        if let Some(manifest) = Manifest::read_file(&path)? {
            found.push((path, manifest));
        }
    }
    Ok(found)
}

fn refuse(folder: &Path, reason: String, resumable: bool) -> Result<(), BelvedereError> {
    Err(BelvedereError::FramesThere { folder: folder.to_owned(), reason, resumable })
}
