//! GPX 1.0 and 1.1: tracks, routes and waypoints. Extensions and other elements are ignored.

use super::phantom::{self, Phantoms, Recorded};
use super::{Geometry, VectorFeature, Vectors, Vertex, shorten, vertex};
use crate::crs::CoordinateSystem;
use crate::{IoError, Loaded};
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;
use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::path::Path;

/// Deepest nesting accepted.
const MAX_DEPTH: usize = 200;
/// Least number of consecutive tracks of one point each that are one line.
const LEAST_ALONE: usize = 3;

/// State of the parser: the open elements and their content.
#[derive(Default)]
struct Parser {
    /// Local names of the open elements.
    open: Vec<String>,
    /// Text of the innermost element.
    text: String,
    name: String,
    properties: BTreeMap<String, String>,
    segments: Vec<Vec<Recorded>>,
    points: Vec<Recorded>,
    /// Position of the open point; `None` inside if it is not usable.
    point: Option<Option<Recorded>>,
    features: Vec<VectorFeature>,
    dropped_points: usize,
    empty_segments: usize,
    single_points: usize,
    /// Lines of equal points.
    one_position: usize,
    /// Segments, tracks and routes of one point each that were joined.
    joined: usize,
    /// Points of the last tracks or routes, each the only one of its own.
    alone: Vec<Recorded>,
    /// Name and properties of the first of them.
    alone_as: (String, BTreeMap<String, String>),
    phantoms: Phantoms,
    elements: [usize; 3],
    /// Where and why the file cannot be read further, although what is whole before that place is.
    broken: Option<String>,
    /// Longitude, latitude and time of every point of a track that has a time.
    timed: Vec<(DVec2, f64)>,
}

/// Longitude and latitude, degrees, and time, seconds from 1970 on, of the points of all tracks that have a time, in the order of the file.
///
/// # Errors
/// One sentence for text that is no GPX.
pub fn track_times(text: &str) -> Result<Vec<(DVec2, f64)>, String> {
    let mut parser = Parser::default();
    parser.read(text)?;
    Ok(parser.timed)
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let mut parser = Parser::default();
    parser.read(text).map_err(|reason| IoError::format(path, reason))?;
    let [tracks, routes, waypoints] = parser.elements;
    if parser.features.is_empty() && parser.one_position > 0 {
        return Err(IoError::format(path, parser.one_position_only()));
    }
    if parser.features.is_empty() {
        return Err(IoError::format(
            path,
            format!(
                "GPX holds {tracks} tracks, {routes} routes and {waypoints} waypoints, but none with a usable position (a line needs 2); choose another file"
            ),
        ));
    }
    let mut warnings = Vec::new();
    let mut warn = |kind: WarningKind, count: usize, what: &str| {
        warnings.extend(Warning::counted(kind, count, what).map(|w| w.in_file(path)));
    };
    warn(WarningKind::Ignored, parser.dropped_points, "points without a valid latitude and longitude were dropped");
    warn(WarningKind::Ignored, parser.empty_segments, "segments without points were dropped");
    warn(
        WarningKind::Ignored,
        parser.single_points,
        "tracks, segments or routes of a single point were dropped, a line needs 2",
    );
    warn(
        WarningKind::Ignored,
        parser.one_position,
        "tracks, segments or routes of one position only were dropped, a line needs 2",
    );
    warn(
        WarningKind::Repaired,
        parser.joined,
        "segments, tracks or routes of a single point each were joined to lines",
    );
    warnings.extend(parser.phantoms.say().map(|found| found.in_file(path)));
    warnings.extend(parser.broken.map(|damage| {
        let points: usize = parser.features.iter().map(|feature| feature.geometry.vertices().count()).sum();
        let text = format!("{damage}; what is whole before is drawn, {points} points");
        Warning::new(WarningKind::Repaired, text).with("points", points as f64).in_file(path)
    }));
    let crs = CoordinateSystem::wgs84().map_err(|e| IoError::format(path, e.to_string()))?;
    let value = Vectors {
        path: path.into(),
        format: "GPX",
        layer: String::new(),
        crs,
        crs_stated: true,
        features: parser.features,
    };
    Ok(Loaded::new(value, warnings))
}

impl Parser {
    /// Reads a file; of a damaged one what is whole before the damage.
    fn read(&mut self, text: &str) -> Result<(), String> {
        let damage = self.walk(text)?;
        if let Some(damage) = damage {
            // The open point is not whole; what it belongs to is, up to there.
            self.point = None;
            let is_point = |name: &String| matches!(name.as_str(), "trkpt" | "rtept" | "wpt");
            if let Some(first) = self.open.iter().position(is_point) {
                self.open.truncate(first);
            }
            while !self.open.is_empty() {
                self.end();
            }
            self.broken = Some(damage);
        }
        self.end_alone();
        match &self.broken {
            Some(damage) if self.features.is_empty() => Err(format!("{damage}, get it again")),
            _ => Ok(()),
        }
    }

    /// Reads all elements; why not all could be read, if some were.
    fn walk(&mut self, text: &str) -> Result<Option<String>, String> {
        let mut reader = Reader::from_str(text);
        // Names of places are written with a bare &.
        reader.config_mut().allow_dangling_amp = true;
        let mut root_seen = false;
        loop {
            let at = reader.buffer_position();
            let event = match reader.read_event() {
                Ok(event) => event,
                Err(e) => return Ok(Some(format!("is no well-formed XML near byte {at} ({e}); it is damaged"))),
            };
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
            Some(open) => Ok(Some(format!("ends inside <{open}>; the file is cut off"))),
            None if root_seen => Ok(None),
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
                    let is = |name: &str| name.eq_ignore_ascii_case(key);
                    number(&e.attributes().flatten().find(|a| is(a.key.local_name().as_ref()))?.value)
                };
                let position = degrees("lon").zip(degrees("lat")).and_then(|(lon, lat)| vertex(lon, lat, None));
                let on_earth = |v: &Vertex| v.xy.y.abs() <= 90.0 && v.xy.x.abs() <= 360.0;
                self.point = Some(position.filter(on_earth).map(|v| (v, None)));
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
                if let Some(Some((v, _))) = &mut self.point {
                    v.z = number(&text).filter(|z| z.is_finite());
                }
            }
            ("time", "trkpt") => {
                if let Some(Some((_, time))) = &mut self.point {
                    *time = seconds(&text);
                }
            }
            ("name", "trk" | "rte" | "wpt") => self.name = text,
            ("desc" | "cmt" | "type" | "sym", "trk" | "rte" | "wpt") if !text.is_empty() => {
                self.properties.insert(name, text);
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

    /// Segments of the open track or route as lines. Some programs put every point into a segment of its own.
    fn finish(&mut self, kind: &str) {
        let mut lines: Vec<Vec<Recorded>> = Vec::new();
        let mut single = false;
        for segment in std::mem::take(&mut self.segments) {
            self.timed.extend(segment.iter().filter_map(|(v, time)| Some((v.xy, (*time)?))));
            if segment.len() == 1 && single {
                self.joined += 1;
                if let Some(line) = lines.last_mut() {
                    self.joined += usize::from(line.len() == 1);
                    line.extend(segment);
                }
                continue;
            }
            single = segment.len() == 1;
            lines.push(segment);
        }
        let only = matches!(lines.as_slice(), [line] if line.len() == 1);
        if only {
            if self.alone.is_empty() {
                self.alone_as = (self.name.clone(), self.properties.clone());
            }
            self.alone.extend(lines.iter().flatten());
        } else {
            self.end_alone();
        }
        let mut kept = Vec::new();
        for line in lines {
            if line.is_empty() {
                self.empty_segments += 1;
                continue;
            }
            let runs = if kind == "track" { phantom::runs(&line, &mut self.phantoms) } else { vec![line] };
            let parted = runs.len() > 1;
            for run in runs {
                let run: Vec<Vertex> = run.into_iter().map(|(v, _)| v).collect();
                match run.as_slice() {
                    [_] if parted => {} // counted as a jump
                    [_] if only => {}   // kept in `alone`
                    [_] => self.single_points += 1,
                    [first, rest @ ..] if rest.iter().all(|v| v.xy == first.xy) => self.one_position += 1,
                    _ => kept.push(run),
                }
            }
        }
        if !kept.is_empty() {
            self.push(kind, Geometry::Lines(kept));
        }
    }

    /// Tracks or routes of one point each, which some programs write for every position, as one line; two or fewer are dropped.
    fn end_alone(&mut self) {
        let points = std::mem::take(&mut self.alone);
        if points.len() < LEAST_ALONE {
            self.single_points += points.len();
            return;
        }
        self.joined += points.len();
        let runs = phantom::runs(&points, &mut self.phantoms);
        let lines = runs.into_iter().map(|run| run.into_iter().map(|(v, _)| v).collect::<Vec<Vertex>>());
        let lines: Vec<_> = lines.filter(|run| run.iter().any(|v| v.xy != run[0].xy)).collect();
        if !lines.is_empty() {
            let own = (std::mem::take(&mut self.name), std::mem::take(&mut self.properties));
            (self.name, self.properties) = std::mem::take(&mut self.alone_as);
            self.push("track", Geometry::Lines(lines));
            (self.name, self.properties) = own;
        }
    }

    fn one_position_only(&self) -> String {
        format!(
            "GPX holds {} lines of one position only and nothing else; a line needs 2 that differ, choose another file",
            self.one_position
        )
    }

    fn push(&mut self, kind: &str, geometry: Geometry) {
        let mut properties = std::mem::take(&mut self.properties);
        properties.insert("kind".into(), kind.into());
        self.features.push(VectorFeature { style: None, name: std::mem::take(&mut self.name), properties, geometry });
    }
}

/// Seconds from 1970 on of a time such as `2024-07-06T10:00:00.5Z`; time zones are ignored, for only differences count.
fn seconds(text: &str) -> Option<f64> {
    let (date, time) = text.trim().split_once('T')?;
    let mut date = date.splitn(3, '-').map(|n| n.parse::<i64>().ok());
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    let clock: String = time.chars().take_while(|c| c.is_ascii_digit() || matches!(c, ':' | '.')).collect();
    let mut clock = clock.splitn(3, ':').map(|n| n.parse::<f64>().ok());
    let (hours, minutes, seconds) = (clock.next()??, clock.next()??, clock.next().flatten().unwrap_or(0.0));
    let fine = (1..=12).contains(&month) && (1..=31).contains(&day) && (0..=9999).contains(&year);
    // Days from the first of March of year 0 on: months from March have 30.6 days when rounded down.
    let (y, m) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days = 365 * y + y.div_euclid(4) - y.div_euclid(100) + y.div_euclid(400) + (153 * m + 2) / 5 + day;
    fine.then(|| 86_400.0 * (days - 719_469) as f64 + 3600.0 * hours + 60.0 * minutes + seconds)
}

/// A number, with a decimal point or comma.
fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    text.parse().ok().or_else(|| text.replacen(',', ".", 1).parse().ok())
}

fn other_root(root: &str) -> String {
    format!("is XML with the root <{root}>, not a GPX; convert it to GPX or GeoJSON")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_seconds() {
        for (text, want) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2024-03-01T00:00:00Z", 1_709_251_200.0),
            ("2024-02-29T23:59:59.5+02:00", 1_709_251_199.5),
            ("2000-12-31T12:00Z", 978_264_000.0),
        ] {
            assert_eq!(seconds(text), Some(want), "{text}");
        }
        for text in ["", "2024-03-01", "x-y-zT1:2:3", "2024-13-01T00:00:00Z"] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
