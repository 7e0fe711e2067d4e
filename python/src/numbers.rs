//! Points to pixels and back, for arrays.

use crate::errors::wrong;
use crate::picture::filled;
use crate::scene::NativeScene;
use crate::work::{Ask, run};
use belvedere::core::{DVec2, View};
use belvedere::verbs::points::{self, ProjectedPoint};
use belvedere::{BelvedereError, output, pick as picking};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::{PyByteArray, PyTuple};
use rayon::prelude::*;

/// Points that are worked on at a time.
const CHUNK: usize = 4096;

/// `N` numbers for each point, of their bytes.
fn numbers<const N: usize>(what: &str, bytes: &[u8]) -> PyResult<Vec<[f64; N]>> {
    let (values, rest) = bytes.as_chunks::<8>();
    let (points, odd) = values.as_chunks::<N>();
    if !rest.is_empty() || !odd.is_empty() {
        return Err(wrong(&format!("{what}: {} bytes are not a whole number of points", bytes.len())));
    }
    Ok(points.iter().map(|p| p.map(f64::from_ne_bytes)).collect())
}

/// Codes of misses: 0 = none, 1 = behind the eye, 2 = outside the domain.
fn code(miss: Option<&str>) -> u8 {
    match miss {
        None => 0,
        Some("behind_eye") => 1,
        Some(_) => 2,
    }
}

fn floats<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
    filled(py, values.iter().map(|v| v.to_ne_bytes()), values.len())
}

/// Images of some points as columns.
struct Images {
    pixels: Vec<[f64; 2]>,
    depths: Vec<f64>,
    segments: Vec<i32>,
    inside: Vec<u8>,
    misses: Vec<u8>,
}

impl Images {
    fn of(view: &View, points: &[[u8; 24]]) -> Self {
        let count = points.len();
        let (pixels, depths, segments) =
            (Vec::with_capacity(count), Vec::with_capacity(count), Vec::with_capacity(count));
        let (inside, misses) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut out = Self { pixels, depths, segments, inside, misses };
        let mut some = Vec::with_capacity(CHUNK.min(count));
        for chunk in points.chunks(CHUNK) {
            some.clear();
            some.extend(chunk.iter().map(coordinates));
            points::project(view, &some).points.iter().for_each(|point| out.push(point));
        }
        out
    }

    fn push(&mut self, point: &ProjectedPoint) {
        self.pixels.push(point.pixel.unwrap_or([f64::NAN; 2]));
        self.depths.push(point.depth.unwrap_or(f64::NAN));
        self.segments.push(point.segment.map_or(-1, |segment| segment as i32));
        self.inside.push(u8::from(point.inside));
        self.misses.push(code(point.miss));
    }
}

/// The coordinates of a point of their bytes.
fn coordinates(point: &[u8; 24]) -> [f64; 3] {
    let (values, _) = point.as_chunks::<8>();
    std::array::from_fn(|i| f64::from_ne_bytes(values[i]))
}

/// One column of all parts.
fn joined<'py, T: Copy, const N: usize>(
    py: Python<'py>,
    parts: &[Images],
    column: impl Fn(&Images) -> &[T],
    bytes: impl Fn(T) -> [u8; N],
) -> PyResult<Bound<'py, PyByteArray>> {
    let count: usize = parts.iter().map(|part| column(part).len()).sum();
    PyByteArray::new_with(py, N * count, |all| {
        let (mut rest, _) = all.as_chunks_mut::<N>();
        for part in parts.iter().map(&column) {
            let (own, next) = rest.split_at_mut(part.len());
            own.iter_mut().zip(part).for_each(|(to, value)| *to = bytes(*value));
            rest = next;
        }
        Ok(())
    })
}

/// Columns `(pixels, depths, segments, inside, misses)` of points, 3 x f64 each; `straight`: without bends.
#[pyfunction]
pub(crate) fn project<'py>(
    py: Python<'py>,
    scene: &NativeScene,
    points: PyBackedBytes,
    straight: bool,
    ask: Ask,
) -> PyResult<Bound<'py, PyTuple>> {
    let session = scene.session.clone();
    let parts = run(py, &ask, move |progress| {
        let view = if straight { session.view().straightened() } else { session.view().clone() };
        let (points, _) = points.as_chunks::<24>();
        let part = points.len().div_ceil(4 * rayon::current_num_threads()).max(CHUNK);
        let images = |chunk: &[[u8; 24]]| {
            progress.tick("project", 0.0)?;
            Ok::<_, BelvedereError>(Images::of(&view, chunk))
        };
        points.par_chunks(part).map(images).collect::<Result<Vec<_>, _>>()
    })?;
    let pixel = |[x, y]: [f64; 2]| {
        let mut bytes = [0; 16];
        bytes[..8].copy_from_slice(&x.to_ne_bytes());
        bytes[8..].copy_from_slice(&y.to_ne_bytes());
        bytes
    };
    let pixels = joined(py, &parts, |part| &part.pixels, pixel)?;
    let depths = joined(py, &parts, |part| &part.depths, f64::to_ne_bytes)?;
    let segments = joined(py, &parts, |part| &part.segments, i32::to_ne_bytes)?;
    let inside = joined(py, &parts, |part| &part.inside, |flag| [flag])?;
    let misses = joined(py, &parts, |part| &part.misses, |flag| [flag])?;
    (pixels, depths, segments, inside, misses).into_pyobject(py)
}

/// Columns `(displaced, folded, misses)` of points, 3 x f64 each.
#[pyfunction]
pub(crate) fn displace<'py>(
    scene: &NativeScene,
    py: Python<'py>,
    points: &[u8],
    ask: Ask,
) -> PyResult<Bound<'py, PyTuple>> {
    let points = numbers::<3>("points", points)?;
    let session = scene.session.clone();
    let (places, folded, misses) = run(py, &ask, move |progress| {
        let view = session.view();
        let mut columns = (Vec::with_capacity(3 * points.len()), Vec::new(), Vec::new());
        for chunk in points.chunks(CHUNK) {
            progress.tick("displace", columns.1.len() as f64 / points.len() as f64)?;
            for point in points::displace(view, chunk).points {
                columns.0.extend(point.displaced.unwrap_or([f64::NAN; 3]));
                columns.1.push(u8::from(point.folded));
                columns.2.push(code(point.miss));
            }
        }
        Ok(columns)
    })?;
    let [folded, misses] = [folded, misses].map(|flags| PyByteArray::new(py, &flags));
    (floats(py, &places)?, folded, misses).into_pyobject(py)
}

/// Columns `(points, depths, segments)` of `samples` along the ray of each pixel, 2 x f64 each.
#[pyfunction]
pub(crate) fn rays<'py>(
    scene: &NativeScene,
    py: Python<'py>,
    pixels: &[u8],
    samples: usize,
    far: Option<f64>,
    ask: Ask,
) -> PyResult<Bound<'py, PyTuple>> {
    let pixels = numbers::<2>("pixels", pixels)?;
    let session = scene.session.clone();
    let rays = run(py, &ask, move |_| points::rays(session.view(), &pixels, samples, session.ray_end(far)?))?.rays;
    let all = || rays.iter().flatten();
    let places: Vec<f64> = all().flat_map(|s| s.point.unwrap_or([f64::NAN; 3])).collect();
    let depths: Vec<f64> = all().map(|s| s.depth).collect();
    let segments = all().map(|s| s.segment.map_or(-1, |k| k as i32).to_ne_bytes());
    (floats(py, &places)?, floats(py, &depths)?, filled(py, segments, depths.len())?).into_pyobject(py)
}

/// What is seen at pixels, 2 x f64 each: a JSON list.
#[pyfunction]
pub(crate) fn pick(scene: &NativeScene, py: Python<'_>, pixels: &[u8], ask: Ask) -> PyResult<String> {
    let pixels = numbers::<2>("pixels", pixels)?;
    let session = scene.session.clone();
    run(py, &ask, move |progress| output::json(&picking::pick(&session, &pixels, &progress)?.pixels))
}

/// Height of the undeformed ground under points, x and y of 2 x f64 each; NaN where there is none.
#[pyfunction]
pub(crate) fn ground<'py>(scene: &NativeScene, py: Python<'py>, points: &[u8]) -> PyResult<Bound<'py, PyByteArray>> {
    let points = numbers::<2>("points", points)?;
    let terrain = scene.session.scene().terrain();
    let height = |[x, y]: &[f64; 2]| terrain.and_then(|t| t.surface_at(DVec2::new(*x, *y))).unwrap_or(f64::NAN);
    floats(py, &points.iter().map(height).collect::<Vec<_>>())
}
