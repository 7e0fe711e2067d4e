//! Pictures as bytes.

use crate::errors::{raised, wrong};
use crate::work::{Ask, run};
use belvedere::picture::{AuxBuffer, AuxFormat, PictureOptions, outputs};
use belvedere::scene::Frame;
use belvedere::{Picture, Session, output};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};
use std::path::PathBuf;

/// A finished picture with its record.
#[pyclass(frozen)]
pub(crate) struct NativePicture {
    picture: Picture,
    /// Files that its scene reads, which it never replaces.
    inputs: Vec<PathBuf>,
}

impl NativePicture {
    /// A picture of the session's scene.
    pub(crate) fn of(session: &Session, picture: Picture) -> Self {
        Self { picture, inputs: session.input_paths() }
    }
}

#[pymethods]
impl NativePicture {
    /// Width and height of one picture, pixels.
    #[getter]
    fn size(&self) -> [usize; 2] {
        [self.picture.frame.width, self.picture.frame.height]
    }

    /// Opaque sRGB with alpha, row-major.
    fn rgba<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyByteArray>> {
        let frame = &self.picture.frame;
        match &self.picture.alpha {
            Some(alpha) => {
                let pixels = frame.color.iter().zip(alpha).map(|([r, g, b], a)| [*r, *g, *b, *a]);
                filled(py, pixels, frame.color.len())
            }
            None => rgba(py, frame),
        }
    }

    /// The straight picture of a pair.
    fn straight_rgba<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyByteArray>>> {
        self.picture.straight.as_ref().map(|frame| rgba(py, frame)).transpose()
    }

    /// Depths, f32; infinite where only sky is seen.
    fn depth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyByteArray>> {
        let depth = &self.picture.frame.depth;
        filled(py, depth.iter().map(|v| v.to_ne_bytes()), depth.len())
    }

    /// 1 + index of the layer, u32; 0 where only sky is seen.
    fn id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyByteArray>> {
        let id = &self.picture.frame.id;
        filled(py, id.iter().map(|v| v.to_ne_bytes()), id.len())
    }

    /// World positions, 3 x f64; `None` if the picture was drawn without.
    fn world<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyByteArray>>> {
        let world = self.picture.frame.world.as_ref();
        let bytes =
            |world: &Vec<[f64; 3]>| filled(py, world.as_flattened().iter().map(|v| v.to_ne_bytes()), 3 * world.len());
        world.map(bytes).transpose()
    }

    /// The record, JSON.
    fn record(&self) -> PyResult<String> {
        output::json(&self.picture.sidecar).map_err(|e| raised(&e))
    }

    /// Wall time of drawing, milliseconds.
    #[getter]
    fn render_ms(&self) -> f64 {
        self.picture.sidecar.render_ms
    }

    /// The bytes of the PNG.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let picture = self.picture.clone();
        Ok(PyBytes::new(py, &run(py, &Ask::default(), move |_| picture.to_png())?))
    }

    /// The same with the depths and world positions of another drawing of it.
    fn with_buffers_of(&self, drawn: &Self) -> Self {
        let mut picture = self.picture.clone();
        picture.frame.depth.clone_from(&drawn.picture.frame.depth);
        picture.frame.world.clone_from(&drawn.picture.frame.world);
        Self { picture, inputs: self.inputs.clone() }
    }

    /// Writes picture, record and buffers; returns their paths.
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        buffers: Vec<String>,
        exr: bool,
        overwrite: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let aux = buffers.iter().map(|name| buffer(name)).collect::<PyResult<Vec<_>>>()?;
        let aux_format = if exr { AuxFormat::Exr } else { AuxFormat::Npy };
        let picture = self.picture.clone().with_buffers(aux.clone(), aux_format);
        let options = PictureOptions { aux, aux_format, ..PictureOptions::default() };
        let (files, inputs) = (outputs(&path, &options, false), self.inputs.clone());
        run(py, &Ask::default(), move |_| {
            output::check_all(&files, &inputs, overwrite)?;
            picture.write(&path, overwrite)
        })
    }
}

fn buffer(name: &str) -> PyResult<AuxBuffer> {
    let all = [AuxBuffer::Depth, AuxBuffer::Id, AuxBuffer::World, AuxBuffer::Displacement];
    all.into_iter()
        .find(|buffer| buffer.name() == name)
        .ok_or_else(|| wrong(&format!("buffers: {name:?} is not a buffer; possible: depth, id, world, displacement")))
}

fn rgba<'py>(py: Python<'py>, frame: &Frame) -> PyResult<Bound<'py, PyByteArray>> {
    filled(py, frame.color.iter().map(|[r, g, b]| [*r, *g, *b, 255]), frame.color.len())
}

/// A byte array of `count` values of `N` bytes.
pub(crate) fn filled<const N: usize>(
    py: Python<'_>,
    values: impl Iterator<Item = [u8; N]>,
    count: usize,
) -> PyResult<Bound<'_, PyByteArray>> {
    PyByteArray::new_with(py, N * count, |bytes| {
        bytes.as_chunks_mut::<N>().0.iter_mut().zip(values).for_each(|(to, value)| *to = value);
        Ok(())
    })
}
