//! The terrain solver alone.

use crate::arrays::NativeArrays;
use crate::errors::{raised, wrong};
use crate::picture::filled;
use crate::request::{self, Opening};
use crate::scene::NativeScene;
use crate::work::{Ask, run};
use belvedere::answers;
use belvedere::io::raster::Raster;
use belvedere::output;
use belvedere::request::Disocclude;
use belvedere::verbs::disocclude::{self as verb, DisoccludeFiles, Disoccluded};
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use std::path::PathBuf;
use std::sync::Arc;

/// Displaced ground.
#[pyclass(frozen)]
pub(crate) struct NativeGround {
    found: Arc<Disoccluded>,
    report: String,
}

#[pymethods]
impl NativeGround {
    /// Terrain and features in the view of the solver.
    fn scene(&self) -> NativeScene {
        NativeScene { session: self.found.session.clone() }
    }

    /// The report, JSON.
    #[getter]
    fn report(&self) -> &str {
        &self.report
    }

    /// One sentence.
    fn summary(&self) -> String {
        self.found.summary()
    }

    /// Goals that were missed, one sentence each.
    fn missed(&self) -> Vec<String> {
        self.found.missed()
    }

    /// Warnings, JSON.
    fn warnings(&self) -> PyResult<String> {
        output::json(&self.found.session.warnings()).map_err(|e| raised(&e))
    }

    /// Rows and columns of the written grid.
    #[getter]
    fn shape(&self) -> [usize; 2] {
        let info = &self.found.rasters()[0].info;
        [info.height, info.width]
    }

    /// The affine map from corners of pixels (column, row) to x, y: a, b, c, d, e, f.
    #[getter]
    fn transform(&self) -> Option<[f64; 6]> {
        self.found.rasters()[0].info.pixel_to_model.map(|map| map.0)
    }

    /// Coordinate system of the written grid.
    #[getter]
    fn crs(&self) -> String {
        self.found.rasters()[0].info.crs.to_string()
    }

    /// Displaced heights, metres, f64; NaN in holes.
    fn heights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyByteArray>> {
        values(py, &self.found.rasters()[0])
    }

    /// Displacement, metres, f64; NaN in holes.
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyByteArray>> {
        values(py, &self.found.rasters()[1])
    }

    /// Writes the elevation model and the other files that are named; returns their paths.
    #[allow(clippy::too_many_arguments)] // one for each file
    fn save(
        &self,
        py: Python<'_>,
        out: PathBuf,
        report: Option<PathBuf>,
        displacement: Option<PathBuf>,
        features: Option<PathBuf>,
        picture: Option<PathBuf>,
        certificate: Option<PathBuf>,
        overwrite: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let tiff = |path: &PathBuf| {
            let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
            ending == "tif" || ending == "tiff"
        };
        if let Some(path) = [Some(&out), displacement.as_ref()].into_iter().flatten().find(|path| !tiff(path)) {
            let text = format!("{}: elevation models are written as GeoTIFF; name the file .tif", path.display());
            return Err(wrong(&text));
        }
        let found = self.found.clone();
        let files = DisoccludeFiles { out, report, displacement, features, picture, certificate };
        run(py, &Ask::default(), move |progress| {
            output::check_all(&files.all(), &found.session.input_paths(), overwrite)?;
            found.write(&files, overwrite, &progress)
        })
    }
}

fn values<'py>(py: Python<'py>, raster: &Raster) -> PyResult<Bound<'py, PyByteArray>> {
    let (width, height) = (raster.info.width, raster.info.height);
    let value = |i: usize| raster.sample_f64(0, i % width, i / width).unwrap_or(f64::NAN);
    filled(py, (0..width * height).map(|i| value(i).to_ne_bytes()), width * height)
}

/// Moves ground so that features are visible from the eye.
#[pyfunction]
pub(crate) fn disocclude(py: Python<'_>, asked: &str, arrays: &NativeArrays, ask: Ask) -> PyResult<NativeGround> {
    let (asked, arrays): (Disocclude, _) = (request::request("disocclude", asked)?, arrays.now());
    let (found, report) = run(py, &ask, move |progress| {
        let found = verb::disocclude(&asked, &Opening::default().options(arrays, progress))?;
        let report = answers::in_file("disocclude", &[], &found.document())?;
        Ok((found, report))
    })?;
    Ok(NativeGround { found: found.into(), report })
}
