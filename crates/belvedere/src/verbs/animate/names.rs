//! Names of a film, placed frame by frame from the first on before they are drawn, so that they stay in their places.

use super::manifest::Manifest;
use super::parts;
use crate::picture::{PictureOptions, film_names};
use crate::{BelvedereError, Session, output};
use belvedere_composite::marks::{NameMemory, Patience};
use belvedere_scene::{PlacedName, Progress, RenderOptions};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// How long a name stays whose point is hidden, and one that went stays away, seconds.
const PATIENCE_S: f64 = 0.3;
/// How often names are placed, times per second of a film: between, each keeps its place while it is free.
const PER_SECOND: f64 = 8.0;

/// The names of the frames of a film from the first on.
pub(super) struct FilmNames {
    /// Frames from one placing to the next.
    every: usize,
    /// Placings for which names stay or stay away.
    patience: Patience,
    /// Of the last placing.
    memory: NameMemory,
    /// Names, and the number of the first placing that has them.
    changes: Vec<(usize, Arc<[PlacedName]>)>,
    /// Placings that are done.
    done: usize,
}

/// Names of a film as they are kept in a file.
#[derive(Serialize, Deserialize)]
struct Kept {
    /// As of the plan of parts.
    film: String,
    changes: Vec<(usize, Vec<PlacedName>)>,
}

impl FilmNames {
    /// Before any frame is placed; `None` for films without names, or with names that cannot be placed beforehand.
    pub(super) fn new(session: &Session, options: &PictureOptions, fps: f64) -> Option<Self> {
        let every = (fps / PER_SECOND).round().clamp(1.0, 1e6);
        let patience = Patience((PATIENCE_S * fps / every).round().clamp(1.0, 1e6) as u32);
        let every = every as usize;
        let none = Self { every, patience, memory: NameMemory::default(), changes: Vec::new(), done: 0 };
        film_names::are_placed(session, options).then_some(none)
    }

    /// Whether names are placed in a frame.
    pub(super) fn is_due(&self, frame: usize) -> bool {
        frame.is_multiple_of(self.every)
    }

    /// The names of the next frame in which they are placed.
    /// * `session`: in that frame.
    pub(super) fn next(
        &self,
        session: &Session,
        options: &PictureOptions,
        progress: &Progress,
    ) -> Result<NameMemory, BelvedereError> {
        film_names::placed(session, options, (&self.memory, self.patience), progress)
    }

    /// Takes over names that are placed.
    pub(super) fn put(&mut self, memory: NameMemory) {
        let names = memory.names();
        if self.changes.last().is_none_or(|(_, last)| **last != names[..]) {
            self.changes.push((self.done, names.into()));
        }
        (self.memory, self.done) = (memory, self.done + 1);
    }

    /// The names of a frame that is placed.
    fn of(&self, frame: usize) -> Option<Arc<[PlacedName]>> {
        let placing = frame / self.every;
        let after = self.changes.partition_point(|(first, _)| *first <= placing);
        Some(self.changes[after.checked_sub(1)?].1.clone()).filter(|_| placing < self.done)
    }

    /// Places the names of a film all of whose frames can be resolved by themselves, or takes them over from its folder.
    /// * `resolved`: the session in a frame.
    pub(super) fn place_all(
        &mut self,
        (folder, manifest, options): (&Path, &Manifest, &PictureOptions),
        progress: &Progress,
        mut resolved: impl FnMut(usize) -> Result<Session, BelvedereError>,
    ) -> Result<(), BelvedereError> {
        let (film, frames) = (parts::key(manifest)?, manifest.frames.len());
        let text = belvedere_io::fs::read_to_string(folder.join(parts::NAMES)).unwrap_or_default();
        if let Some(kept) = serde_json::from_str::<Kept>(&text).ok().filter(|kept| kept.film == film) {
            self.changes = kept.changes.into_iter().map(|(first, names)| (first, names.into())).collect();
            self.done = frames.div_ceil(self.every);
            return Ok(());
        }
        let quiet = progress.unheard();
        for frame in (0..frames).step_by(self.every) {
            progress.tick("placing names", frame as f64 / frames as f64)?;
            let names = self.next(&resolved(frame)?, options, &quiet)?;
            self.put(names);
        }
        let changes = self.changes.iter().map(|(first, names)| (*first, names.to_vec())).collect();
        output::write_text(&folder.join(parts::NAMES), &output::json(&Kept { film, changes })?, true)
    }
}

/// The options of a frame: with names that were placed before, or those of `next`.
pub(super) fn with_names(
    options: PictureOptions,
    names: Option<&FilmNames>,
    (frame, next): (usize, Option<&NameMemory>),
) -> PictureOptions {
    let names = next.map(|memory| memory.names().into()).or_else(|| names?.of(frame));
    PictureOptions { quality: RenderOptions { names, ..options.quality }, ..options }
}
