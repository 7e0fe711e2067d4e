//! Lines, areas and points in memory, by their positions.

use super::collected::Collected;
use super::{Geometry, Vectors, Vertex, without_phantoms};
use crate::crs::CoordinateSystem;
use crate::shared_bytes::{SharedBytes, f64s};
use crate::{IoError, Loaded, budget};
use glam::DVec2;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Bytes of a position at the peak of making features.
const PEAK: u64 = 100;

/// What positions stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Each feature is one point.
    Point,
    /// Each feature is one line.
    Line,
    /// Each feature is the outline of one area.
    Area,
}

/// Features of one shape, by the positions of all.
#[derive(Clone)]
pub struct FeatureArray {
    shape: Shape,
    names: Vec<String>,
    counts: Vec<usize>,
    epsg: Option<u32>,
    positions: SharedBytes,
}

impl FeatureArray {
    /// * `names`: of the features, possibly empty; `counts`: numbers of their positions.
    /// * `epsg`: system of the positions; `None` = local.
    /// * `positions`: f64 x, y of each, finite, feature after feature.
    ///
    /// # Errors
    /// A sentence if lengths contradict one another, a point has not one position, or a position is not finite.
    pub fn new(
        shape: Shape,
        names: Vec<String>,
        counts: Vec<usize>,
        epsg: Option<u32>,
        positions: SharedBytes,
    ) -> Result<Self, String> {
        let bytes = positions.len();
        let all = counts.iter().try_fold(0usize, |sum, n| sum.checked_add(*n)).and_then(|n| n.checked_mul(16));
        if all != Some(bytes) || names.len() != counts.len() {
            let [n, m] = [names.len(), counts.len()];
            return Err(format!("{n} names and {m} counts of positions do not suit {bytes} bytes of x, y"));
        }
        if shape == Shape::Point && counts.iter().any(|n| *n != 1) {
            return Err("a point has one position".into());
        }
        if f64s(&positions).any(|v| !v.is_finite()) {
            return Err("a coordinate is not finite; leave such points out".into());
        }
        Ok(Self { shape, names, counts, epsg, positions })
    }

    /// Positions of each feature.
    fn each(&self) -> impl Iterator<Item = (&str, Vec<Vertex>)> {
        let (mut rest, _) = self.positions.as_chunks::<16>();
        self.names.iter().zip(&self.counts).map(move |(name, count)| {
            let (own, next) = rest.split_at(*count);
            rest = next;
            let vertex = |b: &[u8; 16]| {
                let mut xy = f64s(b);
                Vertex { xy: DVec2::from_array(std::array::from_fn(|_| xy.next().unwrap_or_default())), z: None }
            };
            (name.as_str(), own.iter().map(vertex).collect())
        })
    }

    /// The features, as [`crate::load_vectors`] reads them from a file.
    ///
    /// # Errors
    /// [`IoError::Format`] as those of a file.
    pub fn vectors(&self, path: &Path) -> Result<Loaded<Vectors>, IoError> {
        let fail = |reason: String| IoError::format(path, reason);
        let peak = (self.positions.len() as u64 / 16).saturating_mul(PEAK);
        budget::ask("the features", peak).map_err(|reason| IoError::format(path, reason))?;
        let crs = self.epsg.map_or_else(|| Ok(CoordinateSystem::local()), CoordinateSystem::from_epsg);
        let mut found = Collected::default();
        for (name, positions) in self.each() {
            let geometry = match self.shape {
                Shape::Point => Geometry::Points(positions),
                Shape::Line => Geometry::Lines(found.line(positions).into_iter().collect()),
                Shape::Area => Geometry::Polygons(found.ring(positions).map(|ring| vec![ring]).into_iter().collect()),
            };
            let named = Some(name).filter(|name| !name.is_empty());
            found.add(
                geometry,
                named.map(|name| ("name".to_owned(), super::shorten(name))).into_iter().collect::<BTreeMap<_, _>>(),
            );
        }
        let warnings = found.told(path, "holds").map_err(fail)?;
        let (crs, crs_stated) = found.system(crs.map_err(|e| fail(e.to_string()))?, true).map_err(fail)?;
        let (layer, features) = (String::new(), found.features);
        let value = Vectors { path: path.into(), format: "array", layer, crs, crs_stated, features };
        without_phantoms(path, Loaded::new(value, warnings))
    }

    pub(crate) fn layout(&self) -> (Value, Vec<&[u8]>) {
        let shape = match self.shape {
            Shape::Point => "point",
            Shape::Line => "line",
            Shape::Area => "area",
        };
        let header = json!({
            "array": "features", "counts": self.counts, "epsg": self.epsg, "names": self.names, "shape": shape,
        });
        (header, vec![&*self.positions])
    }

    /// The features as GeoJSON.
    pub(crate) fn geojson(&self) -> String {
        let features = self.each().map(|(name, positions)| {
            let mut rows: Vec<Value> = positions.iter().map(|v| json!(v.xy.to_array())).collect();
            let geometry = match self.shape {
                Shape::Point => json!({ "type": "Point", "coordinates": rows.pop() }),
                Shape::Line => json!({ "type": "LineString", "coordinates": rows }),
                Shape::Area => {
                    let first = rows.first().filter(|first| rows.last() != Some(first)).cloned();
                    rows.extend(first);
                    json!({ "type": "Polygon", "coordinates": [rows] })
                }
            };
            let properties = if name.is_empty() { json!({}) } else { json!({ "name": name }) };
            json!({ "type": "Feature", "properties": properties, "geometry": geometry })
        });
        let features: Vec<Value> = features.collect();
        let system = self.epsg.map_or_else(|| "local".to_owned(), |code| format!("urn:ogc:def:crs:EPSG::{code}"));
        let crs = json!({ "type": "name", "properties": { "name": system } });
        json!({ "type": "FeatureCollection", "features": features, "crs": crs }).to_string()
    }
}
