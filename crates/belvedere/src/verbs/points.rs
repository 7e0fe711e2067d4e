//! Points to pixels and back: `project`, `rays`, `displace`.

use crate::places::Place;
use crate::scene_file::DocumentKind;
use crate::scene_file::{Node, Value, json_points, other_kind};
use crate::{BelvedereError, Session};
use belvedere_core::{DVec2, DVec3, Miss, View, Warning};
use schemars::JsonSchema;
use serde::Serialize;
use std::io::Read;
use std::path::Path;

/// Most samples of all rays together.
pub const MAX_SAMPLES: usize = 50_000_000;

/// Largest file of points or pixels, bytes.
pub const MAX_POINT_BYTES: u64 = 512 << 20;

/// Answer of [`project`].
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct ProjectReport {
    /// One per input point, in input order.
    pub points: Vec<ProjectedPoint>,
}

/// Image of one point.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, Serialize)]
pub struct ProjectedPoint {
    /// Pixel, origin at the outer corner of the top-left pixel.
    pub pixel: Option<[f64; 2]>,
    /// Forward distance of the displaced point, scene units.
    pub depth: Option<f64>,
    /// Segment of the curved ray: `2k` straight part of viewpoint `k`, `2j-1` transition of turn `j`.
    pub segment: Option<u32>,
    /// Whether the pixel lies on the image.
    pub inside: bool,
    /// Why the point has no image.
    pub miss: Option<&'static str>,
}

/// Answer of [`rays`].
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct RaysReport {
    /// Samples of each pixel's ray, in input order.
    pub rays: Vec<Vec<RaySample>>,
}

/// One sample of a ray.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, Serialize)]
pub struct RaySample {
    /// World point; null where the ray leaves the domain of the stages.
    pub point: Option<[f64; 3]>,
    /// Depth at which the pixel sees it.
    pub depth: f64,
    /// Segment of the ray.
    pub segment: Option<u32>,
    /// Why there is no point; left out if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub miss: Option<&'static str>,
}

/// Answer of [`displace`].
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct DisplaceReport {
    /// One per input point, in input order.
    pub points: Vec<DisplacedPoint>,
}

/// One displaced point.
#[derive(Debug, Clone, Copy, PartialEq, JsonSchema, Serialize)]
pub struct DisplacedPoint {
    /// The point after all stages, before the pinhole, scene coordinates.
    pub displaced: Option<[f64; 3]>,
    /// Whether a stage folds space there.
    pub folded: bool,
    /// Why there is no displaced point.
    pub miss: Option<&'static str>,
}

fn name(miss: Miss) -> &'static str {
    match miss {
        Miss::BehindEye => "behind_eye",
        Miss::OutsideDomain => "outside_domain",
    }
}

/// Pixel and depth of each point.
pub fn project(view: &View, points: &[[f64; 3]]) -> ProjectReport {
    let one = |p: &[f64; 3]| match view.project(DVec3::from_array(*p)) {
        Ok(image) if image.pixel.is_finite() && image.depth.is_finite() => ProjectedPoint {
            pixel: Some(image.pixel.to_array()),
            depth: Some(image.depth),
            segment: Some(image.segment),
            inside: view.pinhole().contains(image.pixel),
            miss: None,
        },
        other => {
            let miss = other.err().unwrap_or(Miss::OutsideDomain);
            ProjectedPoint { pixel: None, depth: None, segment: None, inside: false, miss: Some(name(miss)) }
        }
    };
    ProjectReport { points: points.iter().map(one).collect() }
}

impl Session {
    /// Pixel and depth of each point, by the session's view.
    pub fn project(&self, points: &[[f64; 3]]) -> Vec<ProjectedPoint> {
        project(self.view(), points).points
    }
}

/// Displaced position of each point, before the pinhole.
pub fn displace(view: &View, points: &[[f64; 3]]) -> DisplaceReport {
    let one = |p: &[f64; 3]| match view.displace(DVec3::from_array(*p)) {
        Ok(d) if d.point.is_finite() => {
            DisplacedPoint { displaced: Some(d.point.to_array()), folded: d.folded, miss: None }
        }
        other => {
            let miss = other.err().unwrap_or(Miss::OutsideDomain);
            DisplacedPoint { displaced: None, folded: false, miss: Some(name(miss)) }
        }
    };
    DisplaceReport { points: points.iter().map(one).collect() }
}

/// `samples` world points of each pixel's ray, equidistant in depth from the near depth to `far`.
///
/// # Errors
/// [`BelvedereError::RayEnd`] if `far` does not lie beyond the near depth, [`BelvedereError::RaySamples`].
pub fn rays(view: &View, pixels: &[[f64; 2]], samples: usize, far: f64) -> Result<RaysReport, BelvedereError> {
    let near = view.pinhole().near;
    if !(far > near && far.is_finite()) {
        return Err(BelvedereError::RayEnd { far, near });
    }
    if samples == 0 || samples.saturating_mul(pixels.len().max(1)) > MAX_SAMPLES {
        return Err(BelvedereError::RaySamples { samples, rays: pixels.len(), most: MAX_SAMPLES });
    }
    let last = (samples - 1).max(1) as f64;
    let one = |pixel: &[f64; 2]| {
        let ray = view.ray(DVec2::from_array(*pixel));
        let sample = |i: usize| {
            let depth = if i + 1 == samples && samples > 1 { far } else { near + (far - near) * i as f64 / last };
            match ray.at(depth) {
                Ok(p) if p.point.is_finite() => {
                    RaySample { point: Some(p.point.to_array()), depth, segment: Some(p.segment), miss: None }
                }
                other => {
                    let miss = other.err().unwrap_or(Miss::OutsideDomain);
                    RaySample { point: None, depth, segment: None, miss: Some(name(miss)) }
                }
            }
        };
        (0..samples).map(sample).collect()
    };
    Ok(RaysReport { rays: pixels.iter().map(one).collect() })
}

/// Reads `[[x, y, z], ...]` or `[[x, y], ...]`: `N` finite numbers per element.
///
/// # Errors
/// [`BelvedereError::Points`] with the index of the first bad element.
pub fn read_points<const N: usize>(path: &Path) -> Result<Vec<[f64; N]>, BelvedereError> {
    let shape = if N == 3 { "[x, y, z]" } else { "[x, y]" };
    read_list(path, shape, &|item| {
        numbers::<N>(item).ok_or_else(|| {
            format!("{shape} of finite numbers was expected, found {} on line {}", found(item, N), item.line)
        })
    })
}

/// A point of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WrittenPoint {
    /// Scene coordinates.
    Scene([f64; 3]),
    /// A place in words, such as `"46.5N,11.3E,+20"`.
    Place(Place),
}

/// Reads a list of points: `[x, y, z]` in scene coordinates, or texts as [`crate::places`] reads them.
///
/// # Errors
/// [`BelvedereError::Points`] with the index of the first bad element.
pub fn read_written_points(path: &Path) -> Result<Vec<WrittenPoint>, BelvedereError> {
    let shape = "[x, y, z]";
    read_list(path, shape, &|item| match &item.value {
        Value::Text(text) => text.parse().map(WrittenPoint::Place).map_err(|e: String| format!("\"{text}\": {e}")),
        _ => numbers::<3>(item).map(WrittenPoint::Scene).ok_or_else(|| {
            format!("{shape} of finite numbers was expected, found {} on line {}", found(item, 3), item.line)
        }),
    })
}

impl Session {
    /// The scene coordinates of points of a file, and warnings about those that were not read as they are written.
    ///
    /// # Errors
    /// [`BelvedereError::Position`] for a place that is not on the map, or needs a height that there is no ground for.
    pub fn find_points(&self, points: &[WrittenPoint]) -> Result<(Vec<[f64; 3]>, Vec<Warning>), BelvedereError> {
        let (mut out, mut warnings) = (Vec::with_capacity(points.len()), Vec::new());
        for point in points {
            out.push(match point {
                WrittenPoint::Scene(p) => *p,
                WrittenPoint::Place(place) => {
                    let (p, said) = self.find_place(place, "point")?;
                    warnings.extend(said);
                    p.to_array()
                }
            });
        }
        Ok((out, warnings))
    }
}

/// Reads a JSON list of elements of a `shape`.
fn read_list<T>(path: &Path, shape: &str, read: &dyn Fn(&Node) -> Result<T, String>) -> Result<Vec<T>, BelvedereError> {
    let what = if shape.contains('z') { "points" } else { "pixels" };
    let wanted = || DocumentKind::List(format!("a list of {what} [{shape}, ...]"));
    list(path, shape, read).map_err(|e| match e {
        BelvedereError::Points { .. } => other_kind::instead(path, wanted()).map_or(e, Into::into),
        _ => e,
    })
}

fn list<T>(path: &Path, shape: &str, read: &dyn Fn(&Node) -> Result<T, String>) -> Result<Vec<T>, BelvedereError> {
    let fail = |reason: String| BelvedereError::Points { path: path.to_owned(), reason };
    let mut text = Vec::new();
    // Named by the user, who may send them by a pipe.
    std::fs::File::open(path)
        .and_then(|f| f.take(MAX_POINT_BYTES + 1).read_to_end(&mut text))
        .map_err(|e| belvedere_io::IoError::os(path, e))?;
    if text.len() as u64 > MAX_POINT_BYTES {
        return Err(fail(format!("it has more than {MAX_POINT_BYTES} bytes, the most that is read; split it")));
    }
    let text = String::from_utf8(text)
        .map_err(|e| fail(format!("byte {} is not UTF-8 text; give JSON", e.utf8_error().valid_up_to())))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let root = json_points(text).map_err(|e| fail(format!("line {}: {e}", e.line.unwrap_or(1))))?;
    let items =
        root.list().ok_or_else(|| fail(format!("a list of {shape} was expected, found {}", root.describe())))?;
    let one = |(i, item)| read(item).map_err(|e| fail(format!("element {i}: {e}")));
    items.iter().enumerate().map(one).collect()
}

fn numbers<const N: usize>(node: &Node) -> Option<[f64; N]> {
    let values: Option<Vec<f64>> = node.list()?.iter().map(number).collect();
    values?.try_into().ok()
}

fn number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Int(i) => Some(i as f64),
        Value::Float(f) => Some(f),
        _ => None,
    }
}

fn found(item: &Node, count: usize) -> String {
    let wrong = item.list().filter(|l| l.len() == count).and_then(|l| l.iter().find(|n| number(n).is_none()));
    wrong.map_or_else(|| item.describe(), Node::describe)
}
