//! Levels of abstraction of cities.

use crate::work::{Ask, run};
use belvedere::output;
use belvedere::verbs::generalise::{self as verb, GeneraliseRequest, GeneraliseSettings};
use pyo3::prelude::*;
use serde_json::json;
use std::path::PathBuf;

/// Generalises a city and writes its levels into a folder; the answer as JSON.
#[pyfunction]
pub(crate) fn generalise(
    py: Python<'_>,
    city: PathBuf,
    roads: Vec<PathBuf>,
    out: PathBuf,
    margin_m: Option<f64>,
    overwrite: bool,
    ask: Ask,
) -> PyResult<String> {
    run(py, &ask, move |progress| {
        let inputs: Vec<PathBuf> = roads.iter().chain([&city]).cloned().collect();
        if out.exists() {
            for path in [None, Some(0)].iter().flat_map(|epsg| verb::files(&out, *epsg)) {
                output::check(&path, &inputs, overwrite)?;
            }
        }
        let mut settings = GeneraliseSettings::default();
        settings.margin_m = margin_m.unwrap_or(settings.margin_m);
        let found = verb::generalise(&GeneraliseRequest { city, roads, settings }, &progress)?;
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
