//! Scenes: opened, drawn, measured.

use crate::arrays::NativeArrays;
use crate::errors::{raised, wrong};
use crate::picture::NativePicture;
use crate::request::{self, Opening};
use crate::work::{Ask, run};
use belvedere::picture::PictureOptions;
use belvedere::request::{Measure, Paper, Render};
use belvedere::scene::Progress;
use belvedere::scene_file;
use belvedere::vectors::VectorContent;
use belvedere::verbs::asked;
use belvedere::verbs::measure;
use belvedere::verbs::open_files::scene_or_data;
use belvedere::{Session, answers, output};
use pyo3::prelude::*;
use std::path::PathBuf;

/// JSON Schema of scene files.
#[pyfunction]
pub(crate) fn schema() -> PyResult<String> {
    output::schema_json().map_err(|e| raised(&e))
}

/// The paper that a caller (`asked`, JSON) and a scene file ask for: its document, JSON, and the size of the picture, pixels.
///
/// * `text`: of the scene, instead of that of the file at `path`.
#[pyfunction]
pub(crate) fn sheet(
    path: PathBuf,
    text: Option<&str>,
    asked: &str,
    size: Option<[u32; 2]>,
) -> PyResult<Option<(String, [u32; 2])>> {
    let asked: Paper = request::request("paper", asked)?;
    let source = text.map_or_else(
        || scene_or_data(std::slice::from_ref(&path), &Default::default()),
        |text| Ok(scene_file::parse(&path, text)?),
    );
    let document = source.map_err(|e| raised(&e))?.document;
    let (sheet, _) = asked::paper((&asked, size), &document).map_err(|e| raised(&e))?;
    sheet.map(|s| Ok((output::json(&s.document()).map_err(|e| raised(&e))?, s.pixels()))).transpose()
}

/// An opened scene.
#[pyclass(frozen)]
pub(crate) struct NativeScene {
    pub(crate) session: Session,
}

#[pymethods]
impl NativeScene {
    /// Opens a scene file, or data that can be drawn without one.
    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf, options: &str, arrays: &NativeArrays, ask: Ask) -> PyResult<Self> {
        let mut opening: Opening = request::read("options", options)?;
        let (said, arrays) = (std::mem::take(&mut opening.data), arrays.now());
        let session = run(py, &ask, move |progress| {
            Session::from_document(
                scene_or_data(std::slice::from_ref(&path), &said)?,
                &opening.options(arrays, progress),
            )
        })?;
        Ok(Self { session })
    }

    /// Opens a scene of a text; `path` is the scene file that it would be.
    #[staticmethod]
    fn from_text(
        py: Python<'_>,
        path: PathBuf,
        text: String,
        options: &str,
        arrays: &NativeArrays,
        ask: Ask,
    ) -> PyResult<Self> {
        let (opening, arrays): (Opening, _) = (request::read("options", options)?, arrays.now());
        let session =
            run(py, &ask, move |progress| Session::from_text(&path, &text, &opening.options(arrays, progress)))?;
        Ok(Self { session })
    }

    /// Whether the camera fits the size of the picture alone, so that another size is opened anew.
    fn is_framed(&self) -> bool {
        self.session.is_framed()
    }

    /// The same in another size, pixels.
    fn resized(&self, py: Python<'_>, size: [u32; 2], ask: Ask) -> PyResult<Self> {
        let session = self.session.clone();
        Ok(Self { session: run(py, &ask, move |progress| session.resized(size, &progress))? })
    }

    /// Draws a picture.
    ///
    /// * `vectors`: marks that become shapes: `over_raster` or `alone`.
    #[pyo3(signature = (asked, vectors, ask))]
    fn render(&self, py: Python<'_>, asked: &str, vectors: Option<&str>, ask: Ask) -> PyResult<NativePicture> {
        let asked: Render = request::request("render", asked)?;
        let vectors = match vectors {
            Some("alone") => VectorContent::Alone,
            Some(_) => VectorContent::OverRaster,
            None => VectorContent::Nothing,
        };
        let session = self.session.clone().furnished(&asked.air.furnishing.wish());
        // Mistakes are told before the work begins.
        request::picture(&asked, &session, Progress::silent())?;
        run(py, &ask, move |progress| {
            // Checked above.
            let options = request::picture(&asked, &session, progress).unwrap_or_default();
            Ok(NativePicture::of(&session, session.render(&PictureOptions { vectors, ..options })?))
        })
    }

    /// Visible shares, JSON, as the program writes them into a file.
    fn measure(&self, py: Python<'_>, asked: &str, ask: Ask) -> PyResult<String> {
        let asked: Measure = request::request("measure", asked)?;
        if let Some(given) = asked.spacing.filter(|s| !(*s > 0.0 && s.is_finite())) {
            return Err(wrong(&format!("spacing_m={given} is not a distance; give a number above 0, or None")));
        }
        let session = self.session.clone();
        run(py, &ask, move |progress| {
            let report = measure::measure(&session, &asked, &progress)?;
            answers::in_file("measure", &[], &report)
        })
    }

    /// Size of the picture, pixels.
    #[getter]
    fn size(&self) -> [u32; 2] {
        self.session.view().pinhole().image
    }

    /// `EPSG:n` or `local`.
    #[getter]
    fn crs(&self) -> String {
        self.session.scene().crs.to_string()
    }

    /// Ids of the layers, in the order of their numbers.
    #[getter]
    fn layers(&self) -> Vec<String> {
        self.session.scene().layers.iter().map(|layer| layer.id.clone()).collect()
    }

    /// Smallest and largest coordinates of all layers; `None` for a scene without any.
    #[getter]
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let bounds = self.session.scene().bounds();
        (!bounds.is_empty()).then(|| [bounds.min.to_array(), bounds.max.to_array()])
    }

    /// Files that were read.
    #[getter]
    fn input_paths(&self) -> Vec<PathBuf> {
        self.session.input_paths()
    }

    /// Warnings, JSON.
    fn warnings(&self) -> PyResult<String> {
        output::json(&self.session.warnings()).map_err(|e| raised(&e))
    }

    /// The document with every default filled in, JSON; for a scene file at `path`, if that is given.
    fn resolved(&self, path: Option<PathBuf>) -> PyResult<Option<String>> {
        let document = match path {
            Some(path) => self.session.resolved_for(&path),
            None => self.session.resolved().cloned(),
        };
        document.map(|d| output::document_json(&d)).transpose().map_err(|e| raised(&e))
    }
}
