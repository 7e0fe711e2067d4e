//! GeoJSON (RFC 7946, and the `crs` member of its 2008 draft).

use super::{Geometry, VectorFeature, Vectors, Vertex, name_of, not_degrees, shorten, vertex};
use crate::crs::{CoordinateSystem, CrsError};
use crate::{IoError, Loaded};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Deepest nesting of geometry collections.
const MAX_DEPTH: usize = 16;
const REMEDY: &str = "correct it, or export the file again";

#[derive(Default)]
struct Reader {
    features: Vec<VectorFeature>,
    without_geometry: usize,
    short_lines: usize,
    short_rings: usize,
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let root: Value =
        serde_json::from_str(text).map_err(|e| fail(format!("is no valid JSON ({e}); it is damaged or cut off")))?;
    let (crs, stated) = system_of(&root).map_err(fail)?;
    let mut reader = Reader::default();
    reader.read_root(&root).map_err(fail)?;
    let mut warnings = Vec::new();
    let mut warn = |count: usize, what: &str| {
        if count > 0 {
            warnings.push(format!("{}: {count} {what}", path.display()));
        }
    };
    warn(reader.without_geometry, "features without geometry were dropped");
    warn(reader.short_lines, "lines of fewer than 2 points were dropped");
    warn(reader.short_rings, "polygon rings of fewer than 3 points were dropped");
    if reader.features.is_empty() {
        return Err(fail(format!(
            "GeoJSON holds no usable geometry ({} features without any, {} lines and {} rings too short); choose another file",
            reader.without_geometry, reader.short_lines, reader.short_rings
        )));
    }
    if let Some(reason) = not_degrees(&reader.features).filter(|_| crs.is_geographic()) {
        let system = if stated { crs.name() } else { "longitude and latitude, the default" };
        return Err(fail(format!(
            "{reason}, but the file's system is {system}; add a \"crs\" member with its EPSG code"
        )));
    }
    let layer = root.get("name").and_then(Value::as_str).map(shorten).unwrap_or_default();
    let value = Vectors { path: path.into(), format: "GeoJSON", layer, crs, features: reader.features };
    Ok(Loaded::new(value, warnings))
}

/// The system, and whether the file states one.
fn system_of(root: &Value) -> Result<(CoordinateSystem, bool), String> {
    let default = || CoordinateSystem::wgs84().map_err(|e| e.to_string());
    let Some(crs) = root.get("crs").filter(|c| !c.is_null()) else {
        return Ok((default()?, false));
    };
    let properties = crs.get("properties");
    let name = properties.and_then(|p| p.get("name")).and_then(Value::as_str);
    let code = properties.and_then(|p| p.get("code")).and_then(Value::as_u64);
    let epsg = match (name, code) {
        (Some(name), _) if name.to_ascii_uppercase().contains("CRS84") => return Ok((default()?, true)),
        (Some(name), _) if name.to_ascii_uppercase().contains("EPSG") => {
            name.rsplit([':', '/']).next().and_then(|c| c.parse::<u32>().ok())
        }
        (None, Some(code)) => u32::try_from(code).ok(),
        _ => None,
    };
    let Some(epsg) = epsg else {
        return Err(format!("\"crs\" {} is not understood; name an EPSG code", shorten(&crs.to_string())));
    };
    let system = CoordinateSystem::from_epsg(epsg).map_err(|e: CrsError| e.to_string())?;
    Ok((system, true))
}

impl Reader {
    fn read_root(&mut self, root: &Value) -> Result<(), String> {
        match type_of(root) {
            Some("FeatureCollection") => {
                let features = root.get("features").and_then(Value::as_array);
                let features = features.ok_or("FeatureCollection has no array \"features\"; it is damaged")?;
                features
                    .iter()
                    .enumerate()
                    .try_for_each(|(k, f)| self.read_feature(f).map_err(|e| format!("feature {k}: {e}")))
            }
            Some("Feature") => self.read_feature(root),
            Some(_) => self.read_geometry(root, &BTreeMap::new(), 0),
            None => Err("JSON has no member \"type\", so it is no GeoJSON".into()),
        }
    }

    fn read_feature(&mut self, feature: &Value) -> Result<(), String> {
        if type_of(feature) != Some("Feature") {
            return Err(format!("type is {:?}, not \"Feature\"; {REMEDY}", type_of(feature).unwrap_or("missing")));
        }
        let mut properties = BTreeMap::new();
        if let Some(members) = feature.get("properties").and_then(Value::as_object) {
            for (key, value) in members {
                match value {
                    Value::Null => {}
                    Value::String(s) => drop(properties.insert(shorten(key), shorten(s))),
                    other => drop(properties.insert(shorten(key), shorten(&other.to_string()))),
                }
            }
        }
        match feature.get("geometry").filter(|g| !g.is_null()) {
            Some(geometry) => self.read_geometry(geometry, &properties, 0),
            None => {
                self.without_geometry += 1;
                Ok(())
            }
        }
    }

    fn read_geometry(&mut self, g: &Value, properties: &BTreeMap<String, String>, depth: usize) -> Result<(), String> {
        let kind = type_of(g).ok_or_else(|| format!("geometry has no member \"type\"; {REMEDY}"))?;
        if kind == "GeometryCollection" {
            let members = g
                .get("geometries")
                .and_then(Value::as_array)
                .ok_or_else(|| format!("GeometryCollection has no array \"geometries\"; {REMEDY}"))?;
            if depth >= MAX_DEPTH {
                return Err(format!("geometry collections nest deeper than {MAX_DEPTH}; {REMEDY}"));
            }
            return members.iter().try_for_each(|m| self.read_geometry(m, properties, depth + 1));
        }
        let c = g.get("coordinates").ok_or_else(|| format!("{kind} has no \"coordinates\"; {REMEDY}"))?;
        let geometry = match kind {
            "Point" if c.as_array().is_some_and(Vec::is_empty) => Geometry::Points(Vec::new()),
            "Point" => Geometry::Points(vec![position(c)?]),
            "MultiPoint" => Geometry::Points(positions(c)?),
            "LineString" => Geometry::Lines(self.lines([c])?),
            "MultiLineString" => Geometry::Lines(self.lines(array(c)?)?),
            "Polygon" => Geometry::Polygons(self.polygons([c])?),
            "MultiPolygon" => Geometry::Polygons(self.polygons(array(c)?)?),
            other => {
                return Err(format!("type {other:?} is no GeoJSON; convert the file to GeoJSON, GPX or a shapefile"));
            }
        };
        if geometry.vertices().next().is_none() {
            self.without_geometry += 1;
            return Ok(());
        }
        self.features.push(VectorFeature { name: name_of(properties), properties: properties.clone(), geometry });
        Ok(())
    }

    fn lines<'a>(&mut self, lines: impl IntoIterator<Item = &'a Value>) -> Result<Vec<Vec<Vertex>>, String> {
        let mut out = Vec::new();
        for line in lines {
            let line = positions(line)?;
            if line.len() >= 2 {
                out.push(line);
            } else {
                self.short_lines += 1;
            }
        }
        Ok(out)
    }

    fn polygons<'a>(&mut self, polygons: impl IntoIterator<Item = &'a Value>) -> Result<Vec<Vec<Vec<Vertex>>>, String> {
        let mut out = Vec::new();
        for polygon in polygons {
            let mut rings = Vec::new();
            for (k, ring) in array(polygon)?.iter().enumerate() {
                let mut ring = positions(ring)?;
                if ring.len() > 1 && ring.first().map(|v| v.xy) == ring.last().map(|v| v.xy) {
                    ring.pop();
                }
                if ring.len() >= 3 {
                    rings.push(ring);
                } else {
                    self.short_rings += 1;
                    if k == 0 {
                        break; // without an outer ring its holes mean nothing
                    }
                }
            }
            if !rings.is_empty() {
                out.push(rings);
            }
        }
        Ok(out)
    }
}

fn type_of(v: &Value) -> Option<&str> {
    v.get("type").and_then(Value::as_str)
}

fn array(v: &Value) -> Result<&Vec<Value>, String> {
    v.as_array().ok_or_else(|| format!("coordinates hold {} where a list is needed; {REMEDY}", shorten(&v.to_string())))
}

fn positions(v: &Value) -> Result<Vec<Vertex>, String> {
    array(v)?.iter().map(position).collect()
}

fn position(v: &Value) -> Result<Vertex, String> {
    let numbers: Option<Vec<f64>> = v.as_array().map(|a| a.iter().map_while(Value::as_f64).collect());
    match numbers.as_deref() {
        Some([x, y, rest @ ..]) => vertex(*x, *y, rest.first().copied()),
        _ => None,
    }
    .ok_or_else(|| format!("position {} is not two or three numbers; {REMEDY}", shorten(&v.to_string())))
}
