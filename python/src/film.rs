//! Films.

use crate::request::{self, Drawing};
use crate::scene::NativeScene;
use crate::work::{Ask, run};
use belvedere::output;
use belvedere::verbs::animate::{self as verb, AnimateRequest, Film};
use pyo3::prelude::*;
use serde_json::json;
use std::path::PathBuf;

/// Draws all missing frames, then encodes the film; the answer as JSON.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // those of the verb
pub(crate) fn animate(
    py: Python<'_>,
    scene: &NativeScene,
    out: PathBuf,
    animation: &str,
    drawing: &str,
    resume: bool,
    overwrite: bool,
    part: Option<[usize; 2]>,
    ask: Ask,
) -> PyResult<String> {
    let animation = request::read("animation", animation)?;
    let drawing: Drawing = request::read("animate", drawing)?;
    let picture = drawing.options(Default::default())?;
    let session = scene.session.clone().furnished(&drawing.furniture()?);
    run(py, &ask, move |progress| {
        let mut request =
            AnimateRequest { animation, picture, out, resume, overwrite, part: part.map(|[first, last]| first..=last) };
        request.picture.progress = progress.clone();
        let made = verb::animate(&session, &request, &progress)?;
        let (film, missing) = match &made.film {
            Film::Made(path) => (Some(path), None),
            Film::Missing { reason, command } => (None, Some(format!("{reason}; by hand: {command}"))),
            Film::Unwanted => (None, None),
        };
        let warnings = [session.warnings(), made.warnings.clone()].concat();
        let answer = json!({
            "folder": made.folder,
            "film": film,
            "film_missing": missing,
            "frames": made.manifest.frames.len(),
            "drawn": made.drawn,
            "fps": made.manifest.settings.fps,
            "warnings": warnings,
            "manifest": made.manifest,
        });
        output::json(&answer)
    })
}
