//! GeoJSON (RFC 7946, and the `crs` member of its 2008 draft).

use super::collected::Collected;
use super::{Geometry, Vectors, Vertex, shorten, vertex};
use crate::crs::{CoordinateSystem, CrsError};
use crate::{IoError, Loaded};
use glam::DVec2;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Deepest nesting of geometry collections.
const MAX_DEPTH: usize = 16;
const REMEDY: &str = "correct it, or export the file again";

#[derive(Default)]
struct Reader {
    found: Collected,
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let records = records(text).map_err(fail)?;
    let (crs, stated) = system_of(&records).map_err(fail)?;
    let mut reader = Reader::default();
    for (k, record) in records.iter().enumerate() {
        let place = |e: String| if records.len() > 1 { format!("record {k}: {e}") } else { e };
        reader.read_root(record).map_err(|e| fail(place(e)))?;
    }
    let mut warnings = reader.found.told(path, "GeoJSON holds").map_err(fail)?;
    let exchanged = reader.found.exchange(records.first().and_then(extent), crs.is_geographic());
    warnings.extend(exchanged.map(|w| w.in_file(path)));
    let (crs, stated) = reader.found.system(crs, stated).map_err(fail)?;
    let layer = records.first().and_then(|r| r.get("name")).and_then(Value::as_str).map(shorten).unwrap_or_default();
    let format = if records.len() > 1 { "GeoJSONSeq" } else { "GeoJSON" };
    let value = Vectors { path: path.into(), format, layer, crs, crs_stated: stated, features: reader.found.features };
    Ok(Loaded::new(value, warnings))
}

/// The JSON values of a file: one, or as many as a sequence has (RFC 8142, or one per line), or the members of a list.
fn records(text: &str) -> Result<Vec<Value>, String> {
    let broken =
        |e: serde_json::Error| format!("is no valid JSON ({}); it is damaged or cut off", crate::json_fault(&e));
    let text = if text.contains('\u{1e}') { text.replace('\u{1e}', " ").into() } else { std::borrow::Cow::from(text) };
    let parse = |text: &str| serde_json::Deserializer::from_str(text).into_iter().collect::<Result<Vec<Value>, _>>();
    // Some programs write numbers that are none as NaN and Infinity, which JSON does not have.
    let mut records = match parse(&text) {
        Err(e) => parse(&without_odd_numbers(&text)).map_err(|_| broken(e))?,
        Ok(records) => records,
    };
    if let [Value::Array(list)] = records.as_mut_slice() {
        records = std::mem::take(list);
    }
    if records.is_empty() { Err("holds no JSON value; it is empty or cut off".into()) } else { Ok(records) }
}

/// The extent that a document states: its member `bbox`, of two or three axes.
fn extent(document: &Value) -> Option<[DVec2; 2]> {
    let numbers = document.get("bbox")?.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>()?;
    match numbers[..] {
        [west, south, east, north] | [west, south, _, east, north, _] => {
            Some([DVec2::new(west, south), DVec2::new(east, north)])
        }
        _ => None,
    }
}

/// The text with `NaN` and `Infinity` outside of strings as null.
fn without_odd_numbers(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (k, part) in strings_apart(text).into_iter().enumerate() {
        if k % 2 == 1 {
            out.push_str(part);
        } else {
            out.push_str(&part.replace("-Infinity", "null").replace("Infinity", "null").replace("NaN", "null"));
        }
    }
    out
}

/// Parts of a JSON text, in turn outside and inside of strings; quotes belong to the strings.
fn strings_apart(text: &str) -> Vec<&str> {
    let (mut parts, mut from, mut inside, mut escaped) = (Vec::new(), 0, false, false);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if inside => escaped = true,
            b'"' => {
                let end = at + usize::from(inside);
                parts.push(&text[from..end]);
                (from, inside) = (end, !inside);
            }
            _ => {}
        }
    }
    parts.push(&text[from..]);
    parts
}

/// The system, and whether the file states one.
fn system_of(records: &[Value]) -> Result<(CoordinateSystem, bool), String> {
    let default = || CoordinateSystem::wgs84().map_err(|e| e.to_string());
    let Some(crs) = records.iter().filter_map(|r| r.get("crs")).find(|c| !c.is_null()) else {
        return Ok((default()?, false));
    };
    let properties = crs.get("properties");
    let text = |key: &str| properties.and_then(|p| p.get(key)).and_then(Value::as_str);
    // Links to registers end in the code.
    let link = || text("href").map(|h| h.trim_end_matches('/')).filter(|h| h.ends_with(|c: char| c.is_ascii_digit()));
    let name = text("name").or_else(|| crs.as_str()).or_else(link);
    let code = properties.and_then(|p| p.get("code"));
    let code = code.and_then(|c| c.as_u64().map(|n| n.to_string()).or_else(|| c.as_str().map(str::to_owned)));
    match (name, code) {
        (Some(name), _) if name.to_ascii_uppercase().contains("CRS84") => return Ok((default()?, true)),
        (Some(name), _) if name.eq_ignore_ascii_case("local") => return Ok((CoordinateSystem::local(), true)),
        (Some(name), _) => CoordinateSystem::from_text(name),
        (None, Some(code)) => CoordinateSystem::from_text(&code),
        _ => return Err(format!("\"crs\" {} is not understood; name an EPSG code", shorten(&crs.to_string()))),
    }
    .map(|system| (system, true))
    .map_err(|e: CrsError| e.to_string())
}

impl Reader {
    fn read_root(&mut self, root: &Value) -> Result<(), String> {
        match type_of(root) {
            Some("FeatureCollection") => {
                let features = root.get("features").and_then(Value::as_array);
                let features = features.ok_or("FeatureCollection has no array \"features\"; it is damaged")?;
                self.found.null_members += features.iter().filter(|f| f.is_null()).count();
                let there = features.iter().enumerate().filter(|(_, f)| !f.is_null());
                there.into_iter().try_for_each(|(k, f)| self.read_feature(f).map_err(|e| format!("feature {k}: {e}")))
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
        let is_nothing = |g: &Value| g.is_null() || g.as_object().is_some_and(serde_json::Map::is_empty);
        match feature.get("geometry").filter(|g| !is_nothing(g)) {
            Some(geometry) => self.read_geometry(geometry, &properties, 0),
            None => {
                self.found.without_geometry += 1;
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
            self.found.null_members += members.iter().filter(|m| m.is_null()).count();
            let mut there = members.iter().filter(|m| !m.is_null());
            return there.try_for_each(|m| self.read_geometry(m, properties, depth + 1));
        }
        if g.get("coordinates").is_some_and(Value::is_null) {
            self.found.without_geometry += 1;
            return Ok(());
        }
        let c = g.get("coordinates").ok_or_else(|| format!("{kind} has no \"coordinates\"; {REMEDY}"))?;
        let geometry = match kind {
            "Point" if c.as_array().is_some_and(Vec::is_empty) => Geometry::Points(Vec::new()),
            "Point" => Geometry::Points(vec![position(c)?]),
            "MultiPoint" => Geometry::Points(self.positions(c)?),
            "LineString" => Geometry::Lines(self.lines([c])?),
            "MultiLineString" => Geometry::Lines(self.lines(array(c)?)?),
            "Polygon" => Geometry::Polygons(self.polygons([c])?),
            "MultiPolygon" => Geometry::Polygons(self.polygons(array(c)?)?),
            other => {
                return Err(format!("type {other:?} is no GeoJSON; convert the file to GeoJSON, GPX or a shapefile"));
            }
        };
        self.found.add(geometry, properties.clone());
        Ok(())
    }

    /// Positions that are there; those that are null, or of nulls, are counted.
    fn positions(&mut self, v: &Value) -> Result<Vec<Vertex>, String> {
        let is_null = |p: &Value| {
            p.is_null() || p.as_array().is_some_and(|a| a.iter().take(2).any(Value::is_null) && !a.is_empty())
        };
        let list = array(v)?;
        self.found.null_members += list.iter().filter(|p| is_null(p)).count();
        list.iter().filter(|p| !is_null(p)).map(position).collect()
    }

    fn lines<'a>(&mut self, lines: impl IntoIterator<Item = &'a Value>) -> Result<Vec<Vec<Vertex>>, String> {
        let mut out = Vec::new();
        for line in lines {
            if line.is_null() {
                self.found.null_members += 1;
                continue;
            }
            let line = self.positions(line)?;
            out.extend(self.found.line(line));
        }
        Ok(out)
    }

    fn polygons<'a>(&mut self, polygons: impl IntoIterator<Item = &'a Value>) -> Result<Vec<Vec<Vec<Vertex>>>, String> {
        let mut out = Vec::new();
        for polygon in polygons {
            let mut rings = Vec::new();
            if polygon.is_null() {
                self.found.null_members += 1;
                continue;
            }
            for (k, ring) in array(polygon)?.iter().enumerate() {
                let ring = if ring.is_null() { Vec::new() } else { self.positions(ring)? };
                match self.found.ring(ring) {
                    Some(ring) => rings.push(ring),
                    None if k == 0 => break, // without an outer ring its holes mean nothing
                    None => {}
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

fn position(v: &Value) -> Result<Vertex, String> {
    // Some programs write coordinates as texts.
    let number = |v: &Value| v.as_f64().or_else(|| v.as_str()?.trim().parse().ok());
    let numbers: Option<Vec<f64>> = v.as_array().map(|a| a.iter().map_while(number).collect());
    match numbers.as_deref() {
        Some([x, y, rest @ ..]) => vertex(*x, *y, rest.first().copied()),
        _ => None,
    }
    .ok_or_else(|| format!("position {} is not two or three numbers; {REMEDY}", shorten(&v.to_string())))
}
