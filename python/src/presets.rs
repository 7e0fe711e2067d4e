//! Preset documents of spline bends.

use crate::errors::wrong;
use crate::work::{Ask, run};
use belvedere::core::presets::edit::PresetOperation;
use belvedere::verbs::preset as verb;
use belvedere::{BelvedereError, output};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;

fn in_json<T: serde::Serialize>(value: &T) -> Result<String, BelvedereError> {
    output::json(value)
}

/// The built-in documents, JSON.
#[pyfunction]
pub(crate) fn preset_list(py: Python<'_>) -> PyResult<String> {
    run(py, &Ask::default(), |_| in_json(&verb::list()?))
}

/// The document of a name or file, JSON.
#[pyfunction]
pub(crate) fn preset_text(py: Python<'_>, source: String) -> PyResult<String> {
    run(py, &Ask::default(), move |_| in_json(&verb::load(&source)?))
}

/// Usability of a document, JSON.
#[pyfunction]
pub(crate) fn preset_check(py: Python<'_>, source: String) -> PyResult<String> {
    run(py, &Ask::default(), move |_| in_json(&verb::check(&verb::load(&source)?)))
}

/// The document after all operations, and notes on limited values, JSON.
#[pyfunction]
pub(crate) fn preset_set(py: Python<'_>, source: String, operations: Vec<String>) -> PyResult<String> {
    let parsed = operations.iter().map(|text| text.parse().map_err(|e| wrong(&format!("{text:?}: {e}"))));
    let operations: Vec<PresetOperation> = parsed.collect::<PyResult<_>>()?;
    run(py, &Ask::default(), move |_| {
        let (document, clamped) = verb::set(&verb::load(&source)?, &operations)?;
        let note = |c: &belvedere::core::presets::edit::Clamped| json!({ "preset": c.preset, "what": c.what, "asked": c.asked, "got": c.got, "why": c.why });
        in_json(&json!({ "document": document, "limited": clamped.iter().map(note).collect::<Vec<_>>() }))
    })
}

/// A drawing of the curves: width and RGB bytes.
#[pyfunction]
pub(crate) fn preset_plot<'py>(
    py: Python<'py>,
    source: String,
    phi_deg: Option<f64>,
) -> PyResult<(usize, Bound<'py, PyBytes>)> {
    let plot = run(py, &Ask::default(), move |_| Ok(verb::plot(&verb::load(&source)?, phi_deg)))?;
    Ok((plot.width, PyBytes::new(py, plot.pixels.as_flattened())))
}
