//! Arrays that scenes read, held in the memory of this process.

use crate::errors::{raised, wrong};
use belvedere::BelvedereError;
use belvedere::core::DVec3;
use belvedere::io::arrays::{Content, HeightGrid, Triangles};
use belvedere::io::molecule::{AtomColumns, AtomTable};
use belvedere::io::vector::{FeatureArray, FeatureText, Shape};
use belvedere::io::volume::Voxels;
use belvedere::io::{Affine, Arrays, IoError, Number};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};

/// Arrays by name. Their bytes are those of Python, little-endian, and are not copied.
#[pyclass(frozen)]
#[derive(Default)]
pub(crate) struct NativeArrays(RwLock<Arrays>);

fn told<T>(result: Result<T, IoError>) -> PyResult<T> {
    result.map_err(|e| raised(&BelvedereError::Io(e)))
}

impl NativeArrays {
    /// The arrays as they are now.
    pub(crate) fn now(&self) -> Arrays {
        self.0.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Adds an array, which is hashed beside the interpreter.
    fn add(&self, py: Python<'_>, name: &str, content: Result<Content, String>) -> PyResult<()> {
        let content = content.map_err(|reason| wrong(&reason))?;
        told(py.detach(|| self.0.write().unwrap_or_else(PoisonError::into_inner).add(name, content)))
    }
}

#[pymethods]
impl NativeArrays {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Names in their order.
    fn names(&self) -> Vec<String> {
        self.now().names().map(str::to_owned).collect()
    }

    /// Heights.
    ///
    /// * `samples`: f32, `columns * rows` of them; `transform`: a, b, c, d, e, f of rasterio; `epsg`: `None` = local.
    #[pyo3(signature = (name, samples, columns, rows, transform, epsg))]
    #[allow(clippy::too_many_arguments)] // those of a raster
    fn add_heights(
        &self,
        py: Python<'_>,
        name: &str,
        samples: PyBackedBytes,
        columns: usize,
        rows: usize,
        transform: [f64; 6],
        epsg: Option<u32>,
    ) -> PyResult<()> {
        let grid = HeightGrid::new([columns, rows], Affine(transform), epsg, samples.into());
        self.add(py, name, grid.map(Content::Heights))
    }

    /// Voxels.
    ///
    /// * `dims`: along x, y, z, x fastest; `number`: type as NumPy names it.
    #[allow(clippy::too_many_arguments)] // those of a volume
    fn add_voxels(
        &self,
        py: Python<'_>,
        name: &str,
        values: PyBackedBytes,
        number: &str,
        dims: [usize; 3],
        spacing: [f64; 3],
        origin: [f64; 3],
    ) -> PyResult<()> {
        let number = Number::named(number).ok_or_else(|| wrong(&format!("voxels of type {number} are not drawn")))?;
        let [spacing, origin] = [spacing, origin].map(DVec3::from_array);
        let voxels = Voxels::new(dims, number, spacing, origin, values.into());
        self.add(py, name, voxels.map(Content::Voxels))
    }

    /// Triangles: vertices of 3 x f64, faces of 3 x u32, colours of 3 x u8 for each vertex.
    #[pyo3(signature = (name, vertices, faces, colors))]
    fn add_triangles(
        &self,
        py: Python<'_>,
        name: &str,
        vertices: PyBackedBytes,
        faces: PyBackedBytes,
        colors: Option<PyBackedBytes>,
    ) -> PyResult<()> {
        let triangles = Triangles::new(vertices.into(), faces.into(), colors.map(Into::into));
        self.add(py, name, triangles.map(Content::Triangles))
    }

    /// Atoms: positions of 3 x f64, and columns of elements, names, residues, chains, and numbers of residues.
    fn add_atoms(
        &self,
        py: Python<'_>,
        name: &str,
        positions: PyBackedBytes,
        words: [Vec<String>; 4],
        numbers: Vec<i32>,
    ) -> PyResult<()> {
        let [elements, names, residues, chains] = words;
        let table = AtomTable::new(AtomColumns { elements, names, residues, chains, numbers }, positions.into());
        self.add(py, name, table.map(Content::Atoms))
    }

    /// Features of one shape, `point`, `line` or `area`: positions of 2 x f64, and the number of those of each.
    #[pyo3(signature = (name, shape, positions, names, counts, epsg))]
    #[allow(clippy::too_many_arguments)] // those of features
    fn add_features(
        &self,
        py: Python<'_>,
        name: &str,
        shape: &str,
        positions: PyBackedBytes,
        names: Vec<String>,
        counts: Vec<usize>,
        epsg: Option<u32>,
    ) -> PyResult<()> {
        let shape = match shape {
            "point" => Shape::Point,
            "area" => Shape::Area,
            _ => Shape::Line,
        };
        let features = FeatureArray::new(shape, names, counts, epsg, positions.into());
        self.add(py, name, features.map(Content::Features))
    }

    /// Features of a GeoJSON text.
    fn add_collection(&self, py: Python<'_>, name: &str, text: String) -> PyResult<()> {
        self.add(py, name, Ok(Content::Collection(FeatureText::new(text))))
    }

    /// Names of the arrays, and of the files that they are written as.
    fn files(&self) -> Vec<(String, String)> {
        let arrays = self.now();
        arrays.names().filter_map(|name| Some((name.to_owned(), arrays.file_name(name)?))).collect()
    }

    /// Writes all arrays as files of a folder; returns their paths.
    fn write(&self, py: Python<'_>, folder: PathBuf, overwrite: bool) -> PyResult<Vec<PathBuf>> {
        let arrays = self.now();
        told(py.detach(|| arrays.write(&arrays.names().collect::<Vec<_>>(), &folder, overwrite)))
    }
}
