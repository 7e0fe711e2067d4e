//! Points to pixels and back, for arrays.

use crate::errors::wrong;
use crate::picture::filled;
use crate::scene::NativeScene;
use crate::work::{Ask, run};
use belvedere::core::{DVec3, View};
use belvedere::verbs::points::{self, ProjectedPoint};
use belvedere::{output, pick as picking};
use pyo3::prelude::*;
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

/// Images of points as columns.
#[derive(Default)]
struct Images {
    pixels: Vec<f64>,
    depths: Vec<f64>,
    segments: Vec<i32>,
    inside: Vec<u8>,
    misses: Vec<u8>,
}

impl Images {
    fn of(view: &View, points: &[[f64; 3]]) -> Self {
        let mut out = Self::default();
        for chunk in points.chunks(CHUNK) {
            points::project(view, chunk).points.iter().for_each(|point| out.push(point));
        }
        out
    }

    fn push(&mut self, point: &ProjectedPoint) {
        self.pixels.extend(point.pixel.unwrap_or([f64::NAN; 2]));
        self.depths.push(point.depth.unwrap_or(f64::NAN));
        self.segments.push(point.segment.map_or(-1, |segment| segment as i32));
        self.inside.push(u8::from(point.inside));
        self.misses.push(code(point.miss));
    }

    fn append(mut self, other: Self) -> Self {
        self.pixels.extend(other.pixels);
        self.depths.extend(other.depths);
        self.segments.extend(other.segments);
        self.inside.extend(other.inside);
        self.misses.extend(other.misses);
        self
    }
}

/// Columns `(pixels, depths, segments, inside, misses)` of points, 3 x f64 each.
#[pyfunction]
pub(crate) fn project<'py>(
    scene: &NativeScene,
    py: Python<'py>,
    points: &[u8],
    ask: Ask,
) -> PyResult<Bound<'py, PyTuple>> {
    let points = numbers::<3>("points", points)?;
    let session = scene.session.clone();
    let images = run(py, &ask, move |progress| {
        let view = session.view();
        let part = points.len().div_ceil(4 * rayon::current_num_threads()).max(CHUNK);
        let parts: Vec<Images> = points
            .par_chunks(part)
            .map(|chunk| progress.tick("project", 0.0).map(|()| Images::of(view, chunk)))
            .collect::<Result<_, _>>()?;
        Ok(parts.into_iter().fold(Images::default(), Images::append))
    })?;
    let Images { pixels, depths, segments, inside, misses } = images;
    let segments = filled(py, segments.iter().map(|v| v.to_ne_bytes()), segments.len())?;
    let [inside, misses] = [inside, misses].map(|flags| PyByteArray::new(py, &flags));
    (floats(py, &pixels)?, floats(py, &depths)?, segments, inside, misses).into_pyobject(py)
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
    let height =
        |[x, y]: &[f64; 2]| terrain.and_then(|t| t.surface_at(DVec3::new(*x, *y, 0.0).truncate())).unwrap_or(f64::NAN);
    floats(py, &points.iter().map(height).collect::<Vec<_>>())
}
