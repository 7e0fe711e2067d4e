//! The files of a picture in which something is visible: bent and straight picture, their record, figures, scene.

use crate::answers;
use crate::output::{self, document_toml};
use crate::picture::{self, Picture};
use crate::scene_file::Document;
use crate::{BelvedereError, Session};
use belvedere_io::atomic;
use belvedere_io::png::{self, Channels};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Output files.
#[derive(Debug, Clone, Default)]
pub struct RevealFiles {
    /// The bent picture, with its record and the pair beside it; empty: these are not written.
    pub out: PathBuf,
    /// The straight picture.
    pub before: Option<PathBuf>,
    /// Figures, JSON.
    pub report: Option<PathBuf>,
    /// Scene file of the same picture.
    pub scene: Option<PathBuf>,
}

impl RevealFiles {
    /// File of the two pictures side by side; written if they differ.
    pub fn pair(&self) -> PathBuf {
        self.out.with_extension("pair.png")
    }

    /// Every file that may be written.
    pub fn all(&self) -> Vec<PathBuf> {
        let mut record = self.out.as_os_str().to_owned();
        record.push(".json");
        let asked = [&self.before, &self.report, &self.scene].into_iter().flatten().cloned();
        let pictures = [self.out.clone(), PathBuf::from(record), self.pair()];
        pictures.into_iter().filter(|_| self.writes_pictures()).chain(asked).collect()
    }

    fn writes_pictures(&self) -> bool {
        !self.out.as_os_str().is_empty()
    }

    /// Writes the files of a picture, which get their names together; returns them.
    pub(super) fn write<R: Serialize>(
        &self,
        picture: &Picture,
        session: &Session,
        report: &dyn Fn() -> R,
        overwrite: bool,
    ) -> Result<Vec<PathBuf>, BelvedereError> {
        let written = atomic::together(|| self.write_each(picture, session, report, overwrite))?;
        if overwrite && self.writes_pictures() && !written.contains(&self.pair()) {
            remove_old(&self.pair())?;
        }
        Ok(written)
    }

    fn write_each<R: Serialize>(
        &self,
        picture: &Picture,
        session: &Session,
        report: &dyn Fn() -> R,
        overwrite: bool,
    ) -> Result<Vec<PathBuf>, BelvedereError> {
        let mut written = Vec::new();
        if let (Some(later), true) = (&picture.later, self.writes_pictures()) {
            written = picture::write_later(session, later, &self.out, overwrite)?;
        } else if self.writes_pictures() {
            written = Picture { straight: None, ..picture.clone() }.write(&self.out, overwrite)?;
        }
        if let (Some(path), Some(later)) = (&self.before, &picture.later) {
            picture::write_straight(session, later, path, overwrite)?;
            written.push(path.clone());
        }
        let title = [("Software", picture.sidecar.program.as_str()), ("Comment", "straight | bent")];
        let mut draw = |path: &Path, [width, height]: [usize; 2], pixels: &[[u8; 3]], title: &[(&str, &str)]| {
            png::write(path, overwrite, width, height, Channels::Rgb, pixels.as_flattened(), title)?;
            written.push(path.to_owned());
            Ok::<(), BelvedereError>(())
        };
        let differs = picture.straight.as_ref().is_some_and(|straight| straight.color != picture.frame.color);
        // A pair is one of pixels, and marks that are vectors have none.
        if differs && self.writes_pictures() && picture.vectors.is_none() {
            let (width, height, pixels) = picture.pixels();
            draw(&self.pair(), [width, height], &pixels, &title)?;
        }
        if let Some(path) = self.before.as_ref().filter(|_| picture.later.is_none()) {
            let frame = picture.straight.as_ref().unwrap_or(&picture.frame);
            draw(path, [frame.width, frame.height], &frame.color, &title[..1])?;
        }
        if let Some(path) = &self.scene
            && let Some((document, arrays)) = session.resolved_with_arrays(path, overwrite)?
        {
            written.extend(arrays);
            let document = Document { print: picture.sidecar.print.map(|sheet| sheet.document()), ..document };
            output::write_text(path, &document_toml(&document)?, overwrite)?;
            written.push(path.clone());
        }
        if let Some(path) = &self.report {
            written.push(path.clone());
            output::write_text(path, &answers::in_file("reveal", &written, &report())?, overwrite)?;
        }
        Ok(written)
    }
}

/// Removes the pair of an earlier picture of the same name, which does not belong to the new one.
fn remove_old(path: &Path) -> Result<(), BelvedereError> {
    if !path.exists() {
        return Ok(());
    }
    std::fs::remove_file(path)
        .map_err(|source| BelvedereError::Io(belvedere_io::IoError::Os { path: path.to_owned(), source }))
}
