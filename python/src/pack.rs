//! Web pages of scenes.

use crate::work::{Ask, run};
use belvedere::output;
use belvedere::verbs::pack::{self as verb, PackRequest};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes the page of a scene file into the folder `out`; the list of its files as JSON.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // those of the verb
pub(crate) fn pack(
    py: Python<'_>,
    scene: PathBuf,
    allowed: Vec<PathBuf>,
    application: PathBuf,
    remedy: String,
    out: PathBuf,
    overwrite: bool,
    ask: Ask,
) -> PyResult<String> {
    let files = vec![scene];
    let request =
        PackRequest { files, allowed, application, remedy, out, overwrite, threads: false, ..PackRequest::default() };
    run(py, &ask, move |progress| output::json(&verb::pack(&request, &progress)?))
}
