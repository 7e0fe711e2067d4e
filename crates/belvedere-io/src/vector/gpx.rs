//! GPX 1.0 and 1.1: tracks, routes and waypoints. Extensions and other elements are ignored.

use super::phantom::Recorded;
use super::tracks::{Tracks, number, on_earth, seconds};
use super::xml::{self, Elements};
use super::{Geometry, Vectors, Vertex, shorten};
use crate::{IoError, Loaded};
use glam::DVec2;
use quick_xml::events::BytesStart;
use std::collections::BTreeMap;
use std::path::Path;

/// State of the reader: content of the open elements.
#[derive(Default)]
struct Gpx {
    name: String,
    properties: BTreeMap<String, String>,
    segments: Vec<Vec<Recorded>>,
    points: Vec<Recorded>,
    /// Position of the open point; `None` inside if it is not usable.
    point: Option<Option<Recorded>>,
    tracks: Tracks,
    elements: [usize; 3],
}

/// Longitude and latitude, degrees, and time, seconds from 1970 on, of the points of all tracks that have a time, in the order of the file.
///
/// # Errors
/// A predicate for text that is no GPX.
pub(super) fn times(text: &str) -> Result<Vec<(DVec2, f64)>, String> {
    Ok(read(text)?.0.tracks.timed)
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let (gpx, damage) = read(text).map_err(|reason| IoError::format(path, reason))?;
    let [tracks, routes, waypoints] = gpx.elements;
    let held = format!("{tracks} tracks, {routes} routes and {waypoints} waypoints");
    gpx.tracks.loaded(path, "GPX", &held, damage)
}

fn read(text: &str) -> Result<(Gpx, Option<String>), String> {
    let mut gpx = Gpx::default();
    let damage = xml::read(text, "GPX", "gpx", &mut gpx)?;
    gpx.tracks.end_alone();
    Ok((gpx, damage))
}

fn in_extensions(open: &[String]) -> bool {
    open.iter().any(|n| n == "extensions")
}

fn is_point(name: &str) -> bool {
    matches!(name, "trkpt" | "rtept" | "wpt")
}

impl Elements for Gpx {
    fn start(&mut self, open: &[String], name: &str, element: &BytesStart<'_>) {
        if in_extensions(open) {
            return;
        }
        match name {
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
        if is_point(name) {
            let degrees = |key: &str| {
                let is = |name: &str| name.eq_ignore_ascii_case(key);
                number(&element.attributes().flatten().find(|a| is(a.key.local_name().as_ref()))?.value)
            };
            let position = degrees("lon").zip(degrees("lat")).and_then(|(lon, lat)| on_earth(lon, lat, None));
            self.point = Some(position.map(|v| (v, None)));
        }
    }

    fn end(&mut self, open: &[String], name: &str, text: &str) {
        if in_extensions(open) {
            return;
        }
        let parent = open.last().map_or("", String::as_str);
        match (name, parent) {
            ("ele", parent) if is_point(parent) => {
                if let Some(Some((v, _))) = &mut self.point {
                    v.z = number(text).filter(|z| z.is_finite());
                }
            }
            ("time", "trkpt") => {
                if let Some(Some((_, time))) = &mut self.point {
                    *time = seconds(text);
                }
            }
            ("name", "trk" | "rte" | "wpt") => self.name = shorten(text),
            ("desc" | "cmt" | "type" | "sym", "trk" | "rte" | "wpt") if !text.trim().is_empty() => {
                self.properties.insert(name.into(), shorten(text));
            }
            ("trkpt" | "rtept", _) => self.end_point(),
            ("trkseg", _) => {
                let segment = std::mem::take(&mut self.points);
                self.segments.push(segment);
            }
            ("trk", _) => {
                // Points that stand outside of segments.
                let loose = std::mem::take(&mut self.points);
                self.segments.extend((!loose.is_empty()).then_some(loose));
                self.finish("track");
            }
            ("rte", _) => {
                let route = std::mem::take(&mut self.points);
                self.segments.push(route);
                self.finish("route");
            }
            ("wpt", _) => {
                self.end_point();
                let points: Vec<Vertex> = std::mem::take(&mut self.points).into_iter().map(|(v, _)| v).collect();
                if !points.is_empty() {
                    let (name, properties) = self.own();
                    self.tracks.push("waypoint", name, properties, Geometry::Points(points));
                }
            }
            _ => {}
        }
    }

    /// The open point is not whole; what it belongs to is, up to there.
    fn broken(&mut self, open: &mut Vec<String>, text: &mut String) {
        self.point = None;
        if let Some(first) = open.iter().position(|name| is_point(name)) {
            open.truncate(first);
            text.clear();
        }
    }
}

impl Gpx {
    fn end_point(&mut self) {
        match self.point.take() {
            Some(Some(v)) => self.points.push(v),
            _ => self.tracks.dropped_points += 1,
        }
    }

    fn finish(&mut self, kind: &str) {
        let segments = std::mem::take(&mut self.segments);
        let (name, properties) = self.own();
        self.tracks.add(kind, name, properties, segments);
    }

    /// Name and properties of the open element.
    fn own(&mut self) -> (String, BTreeMap<String, String>) {
        (std::mem::take(&mut self.name), std::mem::take(&mut self.properties))
    }
}
