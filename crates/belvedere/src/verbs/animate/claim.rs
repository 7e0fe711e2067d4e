//! What happens to the frames that a folder holds already.

use super::manifest::{Manifest, frame_name};
use super::{AnimateRequest, parts};
use crate::BelvedereError;
use std::path::{Path, PathBuf};

/// Decides whether existing frames of the folder are kept, replaced or refused.
pub(super) fn claim(manifest: &mut Manifest, folder: &Path, request: &AnimateRequest) -> Result<(), BelvedereError> {
    let refuse =
        |reason: String, resumable| Err(BelvedereError::FramesThere { folder: folder.to_owned(), reason, resumable });
    if std::fs::metadata(folder).is_ok_and(|m| !m.is_dir()) {
        let reason = "is a file; give a folder for the frames, or a film named .mp4".into();
        return Err(BelvedereError::Output { path: folder.to_owned(), reason });
    }
    if request.overwrite && !request.resume && request.part.is_none() {
        // Frames of a longer earlier animation would end up in this film.
        let earlier = Manifest::read(folder).ok().flatten().map_or(0, |m| m.frames.len());
        for frame in manifest.frames.len()..earlier {
            let _ = std::fs::remove_file(folder.join(frame_name(frame)));
        }
        parts::forget(folder);
        return Ok(());
    }
    let whole = Manifest::read(folder)?;
    if request.resume || request.part.is_some() {
        let own = parts::record_name(request.part.as_ref());
        let is_read = |path: &PathBuf| request.part.is_none() || path.ends_with(&own);
        let mut earlier = Vec::new();
        if request.resume || !request.overwrite {
            earlier.extend(whole.clone());
            for path in parts::records(folder).iter().filter(|path| is_read(path)) {
                earlier.extend(Manifest::read_file(path)?);
            }
        }
        for earlier in &earlier {
            if let Some(reason) = manifest.differs_from(earlier) {
                return refuse(format!("cannot be gone on with: {reason}"), false);
            }
            manifest.keep(earlier, folder);
        }
        if !earlier.is_empty() || request.part.is_some() {
            return Ok(());
        }
    }
    match whole {
        Some(earlier) => {
            refuse(format!("holds {} of {} frames of an animation", earlier.done, earlier.frames.len()), true)
        }
        None if !parts::records(folder).is_empty() => refuse("holds parts of an animation".into(), true),
        None if folder.join(frame_name(0)).exists() => refuse("holds frames without their record".into(), false),
        None => Ok(()),
    }
}
