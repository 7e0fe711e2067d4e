//! `reveal`: terrain and features, or a part of models and cities, to a picture in which they are visible.

use crate::arrays::NativeArrays;
use crate::errors::wrong;
use crate::picture::NativePicture;
use crate::request::{self, Opening};
use crate::scene::NativeScene;
use crate::work::{Ask, run};
use belvedere::io::Arrays;
use belvedere::picture::PictureOptions;
use belvedere::request::Reveal;
use belvedere::verbs;
use belvedere::verbs::reveal::{RevealAnswer, RevealFiles, Setting};
use belvedere::{answers, output};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;

/// A request, and how scenes are opened.
fn asked_for(what: &str, asked: &str, open: &str) -> PyResult<(Reveal, Opening)> {
    Ok((request::request(what, asked)?, request::read("options", open)?))
}

fn setting(open: Opening, arrays: Arrays, progress: belvedere::scene::Progress) -> Setting {
    Setting { open: open.options(arrays, progress), picture: PictureOptions::default(), to_file: None }
}

/// Views from several sides: their numbers and warnings as JSON, and width and colours (RGB) of the sheet.
#[pyfunction]
pub(crate) fn drafts(
    py: Python<'_>,
    asked: &str,
    open: &str,
    arrays: &NativeArrays,
    count: usize,
    ask: Ask,
) -> PyResult<(String, usize, Py<PyBytes>)> {
    let ((asked, open), arrays) = (asked_for("drafts", asked, open)?, arrays.now());
    let (numbers, width, colors) = run(py, &ask, move |progress| {
        let found = verbs::reveal::drafts(&asked, count, &setting(open, arrays, progress))?;
        let (width, _, colors) = found.sheet();
        let numbers = serde_json::json!({ "drafts": found.drafts, "warnings": found.warnings });
        Ok((output::json(&numbers)?, width, colors))
    })?;
    Ok((numbers, width, PyBytes::new(py, colors.as_flattened()).unbind()))
}

/// Result of [`reveal`].
#[pyclass(frozen)]
pub(crate) struct NativeReveal {
    answer: std::sync::Arc<RevealAnswer>,
    report: String,
}

#[pymethods]
impl NativeReveal {
    /// Scene and bent view.
    fn scene(&self) -> NativeScene {
        NativeScene { session: self.answer.session.clone() }
    }

    /// Both pictures.
    fn picture(&self) -> NativePicture {
        NativePicture::of(&self.answer.session, self.answer.picture.clone())
    }

    /// The report, JSON.
    #[getter]
    fn report(&self) -> &str {
        &self.report
    }

    /// The paper of the picture, JSON; null without one.
    fn paper(&self) -> PyResult<String> {
        let sheet = self.answer.picture.sidecar.print.map(|sheet| sheet.document());
        output::json(&sheet).map_err(|e| crate::errors::raised(&e))
    }

    /// One sentence.
    fn summary(&self) -> String {
        self.answer.summary()
    }

    /// Goals that were missed, one sentence each.
    fn missed(&self) -> Vec<String> {
        self.answer.missed()
    }

    /// Writes the picture with its record and the pair, and the other files that are named; returns their paths.
    fn save(
        &self,
        py: Python<'_>,
        out: PathBuf,
        before: Option<PathBuf>,
        report: Option<PathBuf>,
        scene: Option<PathBuf>,
        overwrite: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let answer = self.answer.clone();
        let files = RevealFiles { out, before, report, scene };
        run(py, &Ask::default(), move |_| {
            output::check_all(&files.all(), &answer.session.input_paths(), overwrite)?;
            answer.write(&files, overwrite)
        })
    }
}

/// Chooses a view (unless it is given) and a bend, and draws the picture.
#[pyfunction]
pub(crate) fn reveal(
    py: Python<'_>,
    asked: &str,
    open: &str,
    arrays: &NativeArrays,
    ask: Ask,
) -> PyResult<NativeReveal> {
    let ((asked, open), arrays) = (asked_for("reveal", asked, open)?, arrays.now());
    let (answer, report) = run(py, &ask, move |progress| {
        let answer = verbs::reveal::reveal(&asked, &setting(open, arrays, progress))?;
        let report = answers::in_file("reveal", &[], &answer.document())?;
        Ok((answer, report))
    })?;
    Ok(NativeReveal { answer: answer.into(), report })
}

/// The JSON Schema of the request of a verb.
#[pyfunction]
pub(crate) fn request_schema(verb: &str) -> PyResult<String> {
    belvedere::request::schema(verb).ok_or_else(|| wrong(&format!("{verb} has no request with a schema")))
}
