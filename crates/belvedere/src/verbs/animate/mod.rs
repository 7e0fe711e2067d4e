//! `animate`: numbered frames of a moving camera, and a film of them.

mod film;
mod manifest;
mod tracking;

pub use film::Film;
pub use manifest::{FrameRecord, FrameTerrain, Manifest, Settings, frame_name};

use crate::camera_path::CameraPath;
use crate::output;
use crate::picture::{self, PictureOptions};
use crate::record::ViewRecord;
use crate::resolve::solving::Memory;
use crate::resolve::solving::Solving;
use crate::scene_file::{AnimationDoc, Document};
use crate::{BelvedereError, Session};
use belvedere_scene::Instant;
use belvedere_scene::Progress;
use std::path::{Path, PathBuf};

/// Request for an animation.
#[derive(Debug, Clone, Default)]
pub struct AnimateRequest {
    /// Motion of the camera where it differs from the scene's `[animation]`. A sweep of zeros, a turntable at 0 degrees per second, and
    /// a step of 0 stand for the scene's own values or the defaults.
    pub animation: AnimationDoc,
    /// How each frame is drawn; buffers are not written.
    pub picture: PictureOptions,
    /// A film (`.mp4`), with its frames in the folder beside it, or a folder of frames.
    pub out: PathBuf,
    /// Resumes from existing frames.
    pub resume: bool,
    /// Replaces existing frames and films.
    pub overwrite: bool,
}

/// Result of an animation.
#[derive(Debug, Clone)]
pub struct Animation {
    /// The record of the frames.
    pub manifest: Manifest,
    /// Folder of the frames.
    pub folder: PathBuf,
    /// Frames drawn by this call; the others existed.
    pub drawn: usize,
    /// The film.
    pub film: Film,
}

/// The folder of the frames of an output, and the film if it names one.
///
/// # Errors
/// [`BelvedereError::Output`] for films of other kinds.
pub fn outputs(out: &Path) -> Result<(PathBuf, Option<PathBuf>), BelvedereError> {
    let ending = out.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "mp4" => Ok((out.with_extension("frames"), Some(out.to_owned()))),
        "mov" | "mkv" | "avi" | "webm" | "gif" | "m4v" | "mpg" | "mpeg" | "png" | "jpg" | "jpeg" => {
            Err(BelvedereError::Output {
                path: out.to_owned(),
                reason: format!(
                    "films are written as .mp4, not .{ending}; name the output .mp4, or give a folder for the frames"
                ),
            })
        }
        _ => Ok((out.to_owned(), None)),
    }
}

/// Draws all missing frames, then encodes the film.
///
/// All views are resolved before the first frame is drawn, so that an impossible one is reported at once. Each frame is written
/// atomically, followed by the manifest; a cancelled animation is resumed with `resume`, to the same bytes as an uninterrupted one.
///
/// # Errors
/// [`BelvedereError::Interrupted`] if cancelled, [`BelvedereError::Frame`] for a frame that cannot be drawn,
/// [`BelvedereError::FramesThere`] if the folder holds another animation.
pub fn animate(session: &Session, request: &AnimateRequest, progress: &Progress) -> Result<Animation, BelvedereError> {
    let (folder, film) = outputs(&request.out)?;
    if let Some(film) = &film {
        output::check(film, &session.input_paths(), request.overwrite || request.resume)?;
    }
    let path = CameraPath::new(session, &request.animation)?;
    let mut manifest = Manifest::new(session, &path, &request.picture)?;
    claim(&mut manifest, &folder, request)?;
    check_all(session, &path, progress)?;
    std::fs::create_dir_all(&folder).map_err(|e| belvedere_io::IoError::os(&folder, e))?;
    let interrupted = |manifest: &Manifest| BelvedereError::Interrupted {
        done: manifest.done,
        frames: manifest.frames.len(),
        folder: folder.clone(),
    };
    manifest.write(&folder)?;
    let drawn = match draw_missing(session, &path, &mut manifest, &folder, request, progress) {
        Err(e) if e.is_cancelled() => return Err(interrupted(&manifest)),
        drawn => drawn?,
    };
    let film = match film {
        None => Film::Unwanted,
        Some(out) => match film::make(&out, &folder, path.len(), path.fps, progress) {
            Err(e) if e.is_cancelled() => return Err(interrupted(&manifest)),
            film => film?,
        },
    };
    Ok(Animation { manifest, folder, drawn, film })
}

/// Decides whether existing frames of the folder are kept, replaced or refused.
fn claim(manifest: &mut Manifest, folder: &Path, request: &AnimateRequest) -> Result<(), BelvedereError> {
    let refuse =
        |reason: String, resumable| Err(BelvedereError::FramesThere { folder: folder.to_owned(), reason, resumable });
    if std::fs::metadata(folder).is_ok_and(|m| !m.is_dir()) {
        let reason = "is a file; give a folder for the frames, or a film named .mp4".into();
        return Err(BelvedereError::Output { path: folder.to_owned(), reason });
    }
    if request.overwrite && !request.resume {
        // Frames of a longer earlier animation would end up in this film.
        let earlier = Manifest::read(folder).ok().flatten().map_or(0, |m| m.frames.len());
        for frame in manifest.frames.len()..earlier {
            let _ = std::fs::remove_file(folder.join(frame_name(frame)));
        }
        return Ok(());
    }
    match (Manifest::read(folder)?, request.resume) {
        (Some(earlier), true) => match manifest.differs_from(&earlier) {
            Some(reason) => refuse(format!("cannot be gone on with: {reason}"), false),
            None => {
                manifest.keep(&earlier, folder);
                Ok(())
            }
        },
        (Some(earlier), false) => {
            refuse(format!("holds {} of {} frames of an animation", earlier.done, earlier.frames.len()), true)
        }
        (None, _) if folder.join(frame_name(0)).exists() => refuse("holds frames without their record".into(), false),
        (None, _) => Ok(()),
    }
}

/// Resolves the view of every frame.
fn check_all(session: &Session, path: &CameraPath, progress: &Progress) -> Result<(), BelvedereError> {
    for frame in 0..path.len() {
        progress.tick("checking the camera's path", frame as f64 / path.len() as f64)?;
        path.session(session, frame, None)?;
    }
    Ok(())
}

/// Draws the missing frames in order; returns their number.
fn draw_missing(
    session: &Session,
    path: &CameraPath,
    manifest: &mut Manifest,
    folder: &Path,
    request: &AnimateRequest,
    progress: &Progress,
) -> Result<usize, BelvedereError> {
    let missing: Vec<usize> = (0..path.len()).filter(|&f| manifest.frames[f].is_none()).collect();
    // The memory of a solver depends on all earlier frames: existing frames are solved again but not drawn.
    // Straight frames need no solution, unless a constructor leads the camera along a path.
    let solved = !request.picture.straight || path.is_previewed();
    let solves = solved && (session.resolved().is_some_and(Document::solves_terrain) || session.tracks());
    let last = missing.last().map_or(0, |f| f + 1);
    let work: Vec<usize> = if solves { (0..last).collect() } else { missing.clone() };
    let quiet = progress.unheard();
    let mut memory = Memory::default();
    let bends = if work.is_empty() { Vec::new() } else { tracking::plan(session, path, progress)? };
    let started = Instant::now();
    for (step, &frame) in work.iter().enumerate() {
        let share = manifest.done as f64 / path.len() as f64;
        progress.tick(&remaining(frame, path.len(), step, work.len(), started), share)?;
        memory.tracking.follow(bends.get(frame).copied());
        let mut solving = Solving { memory: &mut memory, time_step_s: Some(1.0 / path.fps), progress: &quiet };
        let session = path.session(session, frame, solved.then_some(&mut solving))?;
        if manifest.frames[frame].is_some() {
            continue;
        }
        let picture = picture::draw(&session, &request.picture, manifest.inputs.clone(), &quiet)?;
        let file = frame_name(frame);
        let out = folder.join(&file);
        picture.write_png(&out, true)?;
        let record = FrameRecord {
            sha256: belvedere_io::sha256_of_file(&out)?,
            file,
            view: ViewRecord::of(session.view()),
            displacement: picture.sidecar.displacement,
            terrain: session.terrain_report().map(FrameTerrain::of),
            constructor: session.constructor_report().cloned(),
        };
        manifest.put(frame, record);
        manifest.write(folder)?;
    }
    Ok(missing.len())
}

/// `frame 12 of 250, 3 min left`.
fn remaining(frame: usize, frames: usize, drawn: usize, missing: usize, started: Instant) -> String {
    let left = started.elapsed().as_secs_f64() * (missing - drawn) as f64 / drawn.max(1) as f64;
    let left = match left {
        _ if drawn == 0 => String::new(),
        s if s < 90.0 => format!(", {s:.0} s left"),
        s if s < 5400.0 => format!(", {:.0} min left", s / 60.0),
        s => format!(", {:.1} h left", s / 3600.0),
    };
    format!("frame {} of {frames}{left}", frame + 1)
}
