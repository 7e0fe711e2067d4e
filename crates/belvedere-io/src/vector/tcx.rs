//! TCX of Garmin: the tracks of activities and courses, and the points of courses. Laps are segments; workouts and extensions are ignored.

use super::phantom::Recorded;
use super::tracks::{Tracks, number, on_earth, seconds};
use super::xml::{self, Elements};
use super::{Geometry, Vectors, shorten};
use crate::{IoError, Loaded};
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;
use quick_xml::events::BytesStart;
use std::collections::BTreeMap;
use std::path::Path;

/// Local name of the root.
pub(super) const ROOT: &str = "TrainingCenterDatabase";

/// State of the reader: content of the open elements.
#[derive(Default)]
struct Tcx {
    name: String,
    properties: BTreeMap<String, String>,
    segments: Vec<Vec<Recorded>>,
    points: Vec<Recorded>,
    /// Name and properties of the open point of a course.
    place: (String, BTreeMap<String, String>),
    longitude: Option<f64>,
    latitude: Option<f64>,
    height: Option<f64>,
    time: Option<f64>,
    has_position: bool,
    /// Points without a position, where the receiver had none.
    unplaced: usize,
    elements: [usize; 2],
    tracks: Tracks,
}

/// As [`super::track_times`].
pub(super) fn times(text: &str) -> Result<Vec<(DVec2, f64)>, String> {
    Ok(read(text)?.0.tracks.timed)
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let (tcx, damage) = read(text).map_err(|reason| IoError::format(path, reason))?;
    let [activities, courses] = tcx.elements;
    let unplaced = tcx.unplaced;
    let held = format!("{activities} activities and {courses} courses with {unplaced} points without a position");
    let mut loaded = tcx.tracks.loaded(path, "TCX", &held, damage)?;
    let what = "points without a position, as a watch without reception writes them, were passed over";
    loaded.warnings.extend(Warning::counted(WarningKind::Ignored, unplaced, what).map(|w| w.in_file(path)));
    Ok(loaded)
}

fn read(text: &str) -> Result<(Tcx, Option<String>), String> {
    let mut tcx = Tcx::default();
    let damage = xml::read(text, "TCX", ROOT, &mut tcx)?;
    tcx.tracks.end_alone();
    Ok((tcx, damage))
}

impl Elements for Tcx {
    fn start(&mut self, _: &[String], name: &str, element: &BytesStart<'_>) {
        match name {
            "Activity" | "Course" => {
                self.elements[usize::from(name == "Course")] += 1;
                self.name.clear();
                self.properties.clear();
                self.segments.clear();
                let sport = element.attributes().flatten().find(|a| a.key.local_name().as_ref() == "Sport");
                self.properties.extend(sport.map(|a| ("sport".to_owned(), shorten(&a.value))));
            }
            "Track" => self.points.clear(),
            "Trackpoint" | "CoursePoint" => {
                (self.longitude, self.latitude, self.height, self.time) = (None, None, None, None);
                self.has_position = false;
                self.place = Default::default();
            }
            _ => {}
        }
    }

    fn end(&mut self, open: &[String], name: &str, text: &str) {
        let parent = open.last().map_or("", String::as_str);
        match (name, parent) {
            ("LongitudeDegrees", "Position") => self.longitude = number(text),
            ("LatitudeDegrees", "Position") => self.latitude = number(text),
            ("Position", _) => self.has_position = true,
            ("AltitudeMeters", _) => self.height = number(text),
            ("Time", "Trackpoint") => self.time = seconds(text),
            ("Name", "Course") => self.name = shorten(text),
            ("Name", "CoursePoint") => self.place.0 = shorten(text),
            ("PointType" | "Notes", "CoursePoint") if !text.trim().is_empty() => {
                self.place.1.insert(name.to_lowercase(), shorten(text));
            }
            ("Id" | "Notes", "Activity" | "Course") if !text.trim().is_empty() => {
                self.properties.insert(name.to_lowercase(), shorten(text));
            }
            ("Trackpoint", _) => {
                let point = self.point();
                self.points.extend(point);
            }
            ("CoursePoint", _) => {
                if let Some((vertex, _)) = self.point() {
                    let (name, properties) = std::mem::take(&mut self.place);
                    self.tracks.push("waypoint", name, properties, Geometry::Points(vec![vertex]));
                }
            }
            ("Track", _) => {
                let segment = std::mem::take(&mut self.points);
                self.segments.push(segment);
            }
            ("Activity", _) => self.finish("track"),
            ("Course", _) => self.finish("route"),
            _ => {}
        }
    }

    /// The open point is not whole; what it belongs to is, up to there.
    fn broken(&mut self, open: &mut Vec<String>, text: &mut String) {
        if let Some(first) = open.iter().position(|name| matches!(name.as_str(), "Trackpoint" | "CoursePoint")) {
            open.truncate(first);
            text.clear();
        }
    }
}

impl Tcx {
    /// The point that ends; one that is not usable is counted.
    fn point(&mut self) -> Option<Recorded> {
        if !self.has_position {
            self.unplaced += 1;
            return None;
        }
        let point = self.longitude.zip(self.latitude).and_then(|(lon, lat)| on_earth(lon, lat, self.height));
        self.tracks.dropped_points += usize::from(point.is_none());
        Some((point?, self.time))
    }

    fn finish(&mut self, kind: &str) {
        let (name, properties) = (std::mem::take(&mut self.name), std::mem::take(&mut self.properties));
        // Laps without any position say nothing of the ground.
        let segments = std::mem::take(&mut self.segments).into_iter().filter(|segment| !segment.is_empty()).collect();
        self.tracks.add(kind, name, properties, segments);
    }
}
