//! Levels of abstraction of cities.

use crate::request::request;
use crate::work::{Ask, run};
use belvedere::output;
use belvedere::request::Generalise;
use belvedere::verbs::generalise as verb;
use pyo3::prelude::*;
use serde_json::json;
use std::path::PathBuf;

/// Generalises a city and writes its levels into a folder; the answer as JSON.
#[pyfunction]
pub(crate) fn generalise(py: Python<'_>, asked: &str, out: PathBuf, overwrite: bool, ask: Ask) -> PyResult<String> {
    let asked: Generalise = request("generalise", asked)?;
    run(py, &ask, move |progress| {
        let inputs: Vec<PathBuf> = asked.roads.iter().chain([&asked.city]).map(PathBuf::from).collect();
        if out.exists() {
            for path in [None, Some(0)].iter().flat_map(|epsg| verb::files(&out, *epsg)) {
                output::check(&path, &inputs, overwrite)?;
            }
        }
        let found = verb::generalise(&asked, &progress)?;
        let files = found.write(&out, overwrite, &progress)?;
        let warnings = [found.warnings.clone(), found.generalised.report.notes.clone(), found.failing()].concat();
        let answer = json!({
            "files": files,
            "summary": found.summary(),
            "missed": found.missed(),
            "warnings": warnings,
            "report": found.document(),
        });
        output::json(&answer)
    })
}
