//! `animate`: numbered frames of a moving camera, and a film of them.

mod claim;
mod clock;
mod film;
mod manifest;
mod names;
mod overlay;
mod parts;
mod plan;
mod tracking;

pub use film::Film;
pub use manifest::{FrameGround, FrameRecord, FrameTerrain, Manifest, Settings, frame_name};
pub use overlay::MarkerRecord;
pub use parts::Part;

use crate::camera_path::CameraPath;
use crate::film::{Adjustment, DrawnGround};
use crate::guard::guarded;
use crate::output;
use crate::picture::{self, PictureOptions};
use crate::record::ViewRecord;
use crate::scene_file::{AnimationDoc, Document};
use crate::{BelvedereError, Session};
use belvedere_composite::marks::NameMemory;
use belvedere_core::{Warning, WarningKind};
use belvedere_resolve::solving::{Memory, Solving};
use belvedere_scene::{Instant, Progress, Sky};
use names::{FilmNames, with_names};
use overlay::FilmOverlay;
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
    /// Draws these frames alone, and makes no film: one of several processes that draw a film into one folder. A run without it and with
    /// `resume` collects the parts. Frames of the same film that exist are kept unless `overwrite` is set.
    pub part: Option<Part>,
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
    /// Warnings about the film.
    pub warnings: Vec<Warning>,
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
/// [`BelvedereError::FramesThere`] if the folder holds another animation, [`BelvedereError::Animation`] for a part beyond the film, or of
/// a film along a route over ground that makes way or with rays that track a target: there each frame depends on those before it.
pub fn animate(session: &Session, request: &AnimateRequest, progress: &Progress) -> Result<Animation, BelvedereError> {
    guarded(|| animated(session, request, progress))
}

fn animated(session: &Session, request: &AnimateRequest, progress: &Progress) -> Result<Animation, BelvedereError> {
    let (folder, film) = outputs(&request.out)?;
    if let (Some(film), None) = (&film, &request.part) {
        output::check(film, &session.input_paths(), request.overwrite || request.resume)?;
    }
    if session.light().sky == Sky::Transparent {
        return Err(BelvedereError::Animation("films have a background; give the sky white, or a colour".into()));
    }
    let mut path = CameraPath::new(session, &request.animation)?;
    let mut manifest = Manifest::new(session, &path, &request.picture)?;
    if let Some(part) = &request.part {
        parts::check(part, path.len())?;
        if path.following.is_some() && (sinks(session, &path, request.picture.straight) || session.tracks()) {
            let reason = "along a route, with ground that makes way or rays that track a target, each frame depends on those before it; draw the film in one part";
            return Err(BelvedereError::Animation(reason.into()));
        }
    }
    claim::claim(&mut manifest, &folder, request)?;
    let record = parts::record_name(request.part.as_ref());
    if manifest.done < path.len() && !parts::read_plan(&folder, &manifest, &mut path)? {
        plan::plan(session, &mut path, request.picture.straight, progress)?;
        if request.part.is_some() {
            create(&folder)?;
            parts::write_plan(&folder, &manifest, &path)?;
        }
    }
    check_all(session, &path, progress)?;
    create(&folder)?;
    let interrupted = |manifest: &Manifest| BelvedereError::Interrupted {
        done: manifest.done,
        frames: manifest.frames.len(),
        folder: folder.clone(),
    };
    manifest.write(&folder, &record)?;
    let (overlay, mut warnings) = match &path.following {
        Some(following) => {
            let (overlay, warnings) = FilmOverlay::new(session, following, &path.animation);
            (Some(overlay), warnings)
        }
        None => (None, Vec::new()),
    };
    let drawing = Drawing { session, overlay, folder: &folder, record: &record, request, progress };
    let drawn = match drawing.missing(&mut path, &mut manifest) {
        Err(e) if e.is_cancelled() => return Err(interrupted(&manifest)),
        drawn => drawn?,
    };
    warnings.extend(seen_from_below(&manifest));
    if request.part.is_none() {
        parts::forget(&folder);
    }
    let film = match film.filter(|_| request.part.is_none()) {
        None => Film::Unwanted,
        Some(out) => match film::make(&out, &folder, path.len(), path.fps, progress) {
            Err(e) if e.is_cancelled() => return Err(interrupted(&manifest)),
            film => film?,
        },
    };
    Ok(Animation { manifest, folder, drawn, film, warnings })
}

/// Whether the ground under a walker may sink: bends keep him where he is, the terrain solver does not. Straight frames need no
/// solution, unless a constructor leads the camera along a path.
fn sinks(session: &Session, path: &CameraPath, straight: bool) -> bool {
    (!straight || path.is_previewed()) && session.resolved().is_some_and(Document::solves_terrain)
}

fn create(folder: &Path) -> Result<(), BelvedereError> {
    Ok(std::fs::create_dir_all(folder).map_err(|e| belvedere_io::IoError::os(folder, e))?)
}

/// Resolves the view of every frame.
fn check_all(session: &Session, path: &CameraPath, progress: &Progress) -> Result<(), BelvedereError> {
    for frame in 0..path.len() {
        progress.tick("checking the camera's path", frame as f64 / path.len() as f64)?;
        path.session(session, frame, None)?;
    }
    Ok(())
}

/// Warning that frames show the ground from below.
fn seen_from_below(manifest: &Manifest) -> Option<Warning> {
    let frames: Vec<usize> = manifest
        .frames
        .iter()
        .enumerate()
        .filter_map(|(i, f)| f.as_ref()?.ground.filter(|g| !g.is_clear()).map(|_| i))
        .collect();
    let first = frames.first()?;
    let (below, all) = (frames.len(), manifest.frames.len());
    let text = format!(
        "{below} of {all} frames, the first of them frame {first}, lie under the drawn ground or show it from below; lift the camera, or take a weaker bend"
    );
    Some(Warning::new(WarningKind::Suspect, text).with("frames", below as f64))
}

/// Most tries of a frame whose ground has to be solved before it is known.
const TRIES: usize = 8;
/// Lift of a frame that shows the ground from below without a bend, as a share of the height of the eye over the walker.
const LIFT: f64 = 0.25;

/// What every frame is drawn with.
struct Drawing<'a> {
    session: &'a Session,
    overlay: Option<FilmOverlay>,
    folder: &'a Path,
    /// Name of the record in it.
    record: &'a str,
    request: &'a AnimateRequest,
    progress: &'a Progress,
}

/// A frame that is drawn, and the ground that it shows.
struct DrawnFrame {
    session: Session,
    picture: picture::Picture,
    ground: Option<FrameGround>,
    /// Names that were placed with it.
    names: Option<NameMemory>,
}

impl Drawing<'_> {
    /// Draws the missing frames in order; returns their number.
    fn missing(&self, path: &mut CameraPath, manifest: &mut Manifest) -> Result<usize, BelvedereError> {
        let (session, progress, straight) = (self.session, self.progress, self.request.picture.straight);
        let asked = self.request.part.clone().unwrap_or(0..=path.len().saturating_sub(1));
        let missing: Vec<usize> = asked.filter(|&f| f < path.len() && manifest.frames[f].is_none()).collect();
        // The memory of a solver depends on all earlier frames: existing frames are solved again but not drawn.
        // Straight frames need no solution, unless a constructor leads the camera along a path.
        let solved = !straight || path.is_previewed();
        let sinks = sinks(session, path, straight);
        let solves = solved && (session.resolved().is_some_and(Document::solves_terrain) || session.tracks());
        let last = missing.last().map_or(0, |f| f + 1);
        let work: Vec<usize> = if solves { (0..last).collect() } else { missing.clone() };
        let mut memory = Memory::default();
        let options = &self.request.picture;
        let mut names = FilmNames::new(session, options, path.fps).filter(|_| !work.is_empty());
        if let Some(names) = names.as_mut().filter(|_| !solves) {
            let mut memory = Memory::default();
            let resolved = |frame| self.resolved(path, frame, solved, &mut memory);
            names.place_all((self.folder, &*manifest, options), progress, resolved)?;
        }
        let bends = if work.is_empty() { Vec::new() } else { tracking::plan(session, path, progress)? };
        let (started, mut turned) = (Instant::now(), 0.0);
        for (step, &frame) in work.iter().enumerate() {
            let share = match self.request.part {
                None => manifest.done as f64 / path.len() as f64,
                Some(_) => step as f64 / work.len() as f64,
            };
            progress.tick(&remaining(frame, path.len(), step, work.len(), started), share)?;
            memory.tracking.follow(bends.get(frame).copied());
            let known = manifest.frames[frame].as_ref().map(|f| f.ground);
            if let (Some(Some(ground)), Some(following)) = (known, &mut path.following) {
                let (lift, share, aim) = (ground.lifted_m, ground.bend_share, ground.aimed_m);
                following.adjustments[frame] = Adjustment { lift, share, aim };
                turned = if sinks { Adjustment::next_aim(aim, ground.walker_m) } else { 0.0 };
            } else if let Some(following) = &mut path.following {
                following.adjustments[frame].aim = turned;
            }
            if known.is_some() || self.request.part.as_ref().is_some_and(|part| !part.contains(&frame)) {
                let session = self.resolved(path, frame, solved, &mut memory)?;
                if let Some(names) = names.as_mut().filter(|names| solves && names.is_due(frame)) {
                    names.put(names.next(&session, options, &progress.unheard())?);
                }
                continue;
            }
            let drawn = self.frame(path, (frame, names.as_ref()), (solved, solves), (&mut memory, manifest))?;
            if let (Some(names), Some(placed)) = (&mut names, &drawn.names) {
                names.put(placed.clone());
            }
            turned = drawn.ground.filter(|_| sinks).map_or(0.0, |g| Adjustment::next_aim(g.aimed_m, g.walker_m));
            let record = self.write(path, frame, drawn)?;
            manifest.put(frame, record);
            manifest.write(self.folder, self.record)?;
        }
        Ok(missing.len())
    }

    fn resolved(
        &self,
        path: &CameraPath,
        frame: usize,
        solved: bool,
        memory: &mut Memory,
    ) -> Result<Session, BelvedereError> {
        let quiet = self.progress.unheard();
        let mut solving = Solving { memory, time_step_s: Some(1.0 / path.fps), progress: &quiet };
        path.session(self.session, frame, solved.then_some(&mut solving))
    }

    /// Draws a frame; along a route again with less bend, or from higher up, while it shows the ground from below.
    fn frame(
        &self,
        path: &mut CameraPath,
        (frame, names): (usize, Option<&FilmNames>),
        (solved, solves): (bool, bool),
        (memory, manifest): (&mut Memory, &Manifest),
    ) -> Result<DrawnFrame, BelvedereError> {
        let quiet = self.progress.unheard();
        let before = memory.clone();
        let (mut tries, mut aimed) = (0, false);
        loop {
            let session = self.resolved(path, frame, solved, memory)?;
            let steady_mark = path.has_stages() && !self.request.picture.straight;
            let asked = &self.request.picture;
            let due = names.filter(|names| solves && names.is_due(frame));
            let next = due.map(|names| names.next(&session, asked, &quiet)).transpose()?;
            let options = PictureOptions { steady_mark, ..asked.clone() };
            let options = with_names(options, names, (frame, next.as_ref()));
            let picture = picture::draw(&session, &options, manifest.inputs.clone(), &quiet)?;
            let adjusted = path.following.as_ref().map_or(Adjustment::NONE, |f| f.adjustments[frame]);
            let walker = path.following.as_ref().map(|f| f.walkers[frame]);
            let ground = DrawnGround::of(session.scene(), &picture.view).map(|ground| {
                let [pixels, from_below] = ground.seen_from_below(&picture.frame);
                FrameGround {
                    clearance_m: ground.clearance(),
                    needed_m: ground.needed(),
                    lifted_m: adjusted.lift,
                    bend_share: adjusted.share,
                    aimed_m: adjusted.aim,
                    walker_m: walker.map_or(0.0, |p| ground.rise(p.truncate())),
                    pixels,
                    from_below,
                }
            });
            tries += 1;
            if let (Some(ground), Some(following)) = (&ground, &mut path.following)
                && !aimed
                && session.resolved().is_some_and(Document::solves_terrain)
                && following.loses_walker(frame, &picture.view, ground.walker_m)
            {
                following.adjustments[frame].aim = ground.walker_m;
                (aimed, tries) = (true, 0);
                *memory = before.clone();
                continue;
            }
            let (Some(lacking), Some(following)) =
                (ground.filter(|g| !g.is_clear() && tries < TRIES), &mut path.following)
            else {
                return Ok(DrawnFrame { session, picture, ground, names: next });
            };
            let camera = following.camera(frame);
            let short = lacking.clearance_m.map_or(0.0, |c| lacking.needed_m - c);
            let step = LIFT * (camera.eye.z - camera.walker.z).abs();
            following.adjustments[frame] = match () {
                () if short > 0.0 && (short <= step || adjusted.share <= 0.0) => {
                    // A bend lifts part of the ground with the eye.
                    Adjustment { lift: adjusted.lift + 1.05 * tries as f64 * short, ..adjusted }
                }
                () if adjusted.share > 0.0 => Adjustment { share: (adjusted.share - 0.34).max(0.0), ..adjusted },
                () => Adjustment { lift: adjusted.lift + step, ..adjusted },
            };
            *memory = before.clone();
        }
    }

    /// Draws the overlays over a frame and writes it.
    fn write(&self, path: &CameraPath, frame: usize, drawn: DrawnFrame) -> Result<FrameRecord, BelvedereError> {
        let DrawnFrame { session, mut picture, ground, names: _ } = drawn;
        let mark = picture.sidecar.overlay.mark;
        let marker = match (&self.overlay, &path.following) {
            (Some(overlay), Some(following)) => {
                let view = picture.view.clone();
                overlay.draw(&mut picture.frame, (session.scene(), &view), (following, frame), mark)
            }
            _ => None,
        };
        let file = frame_name(frame);
        let out = self.folder.join(&file);
        picture.write_png(&out, true)?;
        Ok(FrameRecord {
            sha256: belvedere_io::sha256_of_file(&out)?,
            file,
            view: ViewRecord::of(session.view()),
            displacement: picture.sidecar.displacement,
            ground,
            marker,
            terrain: session.terrain_report().map(FrameTerrain::of),
            constructor: session.constructor_report().cloned(),
        })
    }
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
