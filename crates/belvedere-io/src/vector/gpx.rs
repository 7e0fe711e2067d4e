//! GPX 1.0 and 1.1: tracks, routes and waypoints. Extensions and everything else are passed over.

use super::{Geometry, VectorFeature, Vectors, Vertex, shorten, vertex};
use crate::crs::CoordinateSystem;
use crate::{IoError, Loaded};
use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::path::Path;

/// Deepest nesting accepted.
const MAX_DEPTH: usize = 200;

/// What is open at the moment.
#[derive(Default)]
struct Parser {
    /// Local names of the open elements.
    open: Vec<String>,
    /// Text of the innermost element.
    text: String,
    name: String,
    properties: BTreeMap<String, String>,
    segments: Vec<Vec<Vertex>>,
    points: Vec<Vertex>,
    /// Position of the open point; `None` inside if it is not usable.
    point: Option<Option<Vertex>>,
    features: Vec<VectorFeature>,
    dropped_points: usize,
    empty_segments: usize,
    single_points: usize,
    elements: [usize; 3],
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let mut parser = Parser::default();
    parser.read(text).map_err(|reason| IoError::format(path, reason))?;
    let [tracks, routes, waypoints] = parser.elements;
    if parser.features.is_empty() {
        return Err(IoError::format(
            path,
            format!(
                "GPX holds {tracks} tracks, {routes} routes and {waypoints} waypoints, but none with a usable position (a line needs 2); choose another file"
            ),
        ));
    }
    let mut warnings = Vec::new();
    let mut warn = |count: usize, what: &str| {
        if count > 0 {
            warnings.push(format!("{}: {count} {what}", path.display()));
        }
    };
    warn(parser.dropped_points, "points without a valid latitude and longitude were dropped");
    warn(parser.empty_segments, "segments without points were dropped");
    warn(parser.single_points, "tracks, segments or routes of a single point were dropped, a line needs 2");
    let crs = CoordinateSystem::wgs84().map_err(|e| IoError::format(path, e.to_string()))?;
    let value = Vectors { path: path.into(), format: "GPX", layer: String::new(), crs, features: parser.features };
    Ok(Loaded::new(value, warnings))
}

impl Parser {
    fn read(&mut self, text: &str) -> Result<(), String> {
        let mut reader = Reader::from_str(text);
        let mut root_seen = false;
        loop {
            let at = reader.buffer_position();
            let event = reader
                .read_event()
                .map_err(|e| format!("is no well-formed XML near byte {at} ({e}); it is damaged"))?;
            match event {
                Event::Start(e) => {
                    if !root_seen && e.local_name().as_ref() != "gpx" {
                        return Err(other_root(e.local_name().as_ref()));
                    }
                    root_seen = true;
                    self.start(&e);
                    if self.open.len() > MAX_DEPTH {
                        return Err(format!("nests elements deeper than {MAX_DEPTH} near byte {at}; it is no GPX"));
                    }
                }
                Event::Empty(e) => {
                    if !root_seen && e.local_name().as_ref() != "gpx" {
                        return Err(other_root(e.local_name().as_ref()));
                    }
                    root_seen = true;
                    self.start(&e);
                    self.end();
                }
                Event::End(_) => self.end(),
                Event::Text(t) => self.text.push_str(&t.xml10_content()),
                Event::CData(t) => self.text.push_str(&t.xml10_content()),
                Event::GeneralRef(r) => match r.resolve_char_ref() {
                    Ok(Some(c)) => self.text.push(c),
                    _ => self.text.push_str(resolve_predefined_entity(&r).unwrap_or("")),
                },
                Event::Eof => break,
                _ => {}
            }
        }
        match self.open.last() {
            Some(open) => Err(format!("ends inside <{open}>; the file is cut off, get it again")),
            None if root_seen => Ok(()),
            None => Err("holds no XML element; it is no GPX".into()),
        }
    }

    fn start(&mut self, e: &BytesStart<'_>) {
        let name = e.local_name().as_ref().to_owned();
        self.text.clear();
        if !self.in_extensions() {
            match name.as_str() {
                "trk" | "rte" | "wpt" => {
                    self.elements[["trk", "rte", "wpt"].iter().position(|n| *n == name).unwrap_or(0)] += 1;
                    self.name.clear();
                    self.properties.clear();
                    self.points.clear();
                    self.segments.clear();
                }
                "trkseg" => self.points.clear(),
                _ => {}
            }
            if matches!(name.as_str(), "trkpt" | "rtept" | "wpt") {
                let degrees = |key: &str| {
                    let value = e.attributes().flatten().find(|a| a.key.local_name().as_ref() == key)?;
                    value.value.trim().parse::<f64>().ok()
                };
                let position = degrees("lon").zip(degrees("lat")).and_then(|(lon, lat)| vertex(lon, lat, None));
                self.point = Some(position.filter(|v| v.xy.y.abs() <= 90.0 && v.xy.x.abs() <= 360.0));
            }
        }
        self.open.push(name);
    }

    fn in_extensions(&self) -> bool {
        self.open.iter().any(|n| n == "extensions")
    }

    fn end(&mut self) {
        let Some(name) = self.open.pop() else { return };
        if self.in_extensions() {
            return;
        }
        let text = shorten(&self.text);
        let parent = self.open.last().map_or("", String::as_str);
        match (name.as_str(), parent) {
            ("ele", "trkpt" | "rtept" | "wpt") => {
                if let Some(Some(v)) = &mut self.point {
                    v.z = text.parse().ok().filter(|z: &f64| z.is_finite());
                }
            }
            ("name", "trk" | "rte" | "wpt") => self.name = text,
            ("desc" | "cmt" | "type" | "sym", "trk" | "rte" | "wpt") if !text.is_empty() => {
                self.properties.insert(name, text);
            }
            ("trkpt" | "rtept", _) => self.end_point(),
            ("trkseg", _) => {
                let segment = std::mem::take(&mut self.points);
                self.add_segment(segment);
            }
            ("trk", _) => self.finish("track"),
            ("rte", _) => {
                let route = std::mem::take(&mut self.points);
                self.add_segment(route);
                self.finish("route");
            }
            ("wpt", _) => {
                self.end_point();
                let points = std::mem::take(&mut self.points);
                if !points.is_empty() {
                    self.push("waypoint", Geometry::Points(points));
                }
            }
            _ => {}
        }
        self.text.clear();
    }

    fn end_point(&mut self) {
        match self.point.take() {
            Some(Some(v)) => self.points.push(v),
            _ => self.dropped_points += 1,
        }
    }

    fn add_segment(&mut self, segment: Vec<Vertex>) {
        match segment.len() {
            0 => self.empty_segments += 1,
            1 => self.single_points += 1,
            _ => self.segments.push(segment),
        }
    }

    fn finish(&mut self, kind: &str) {
        let segments = std::mem::take(&mut self.segments);
        if !segments.is_empty() {
            self.push(kind, Geometry::Lines(segments));
        }
    }

    fn push(&mut self, kind: &str, geometry: Geometry) {
        let mut properties = std::mem::take(&mut self.properties);
        properties.insert("kind".into(), kind.into());
        self.features.push(VectorFeature { name: std::mem::take(&mut self.name), properties, geometry });
    }
}

fn other_root(root: &str) -> String {
    format!("is XML with the root <{root}>, not a GPX; convert it to GPX or GeoJSON")
}
