//! Films.

use crate::errors::raised;
use crate::request;
use crate::scene::NativeScene;
use crate::work::{Ask, run};
use belvedere::output;
use belvedere::print::Sheet;
use belvedere::request::Animate;
use belvedere::verbs::animate::{self as verb, Film};
use belvedere::verbs::asked::film;
use pyo3::prelude::*;
use serde_json::json;
use std::path::PathBuf;

/// Draws all missing frames, then encodes the film; the answer as JSON.
#[pyfunction]
pub(crate) fn animate(
    py: Python<'_>,
    scene: &NativeScene,
    out: PathBuf,
    asked: &str,
    overwrite: bool,
    ask: Ask,
) -> PyResult<String> {
    let asked: Animate = request::request("animate", asked)?;
    // With paper and pixels per inch no size is left open.
    let sheet = Sheet::of(&asked.paper.document(), None, [1, 1]).map_err(|e| raised(&e.into()))?;
    let mut request = film(&asked, sheet, out, overwrite).map_err(|e| raised(&e))?;
    let session = scene.session.clone().furnished(&asked.furnishing.wish());
    run(py, &ask, move |progress| {
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
