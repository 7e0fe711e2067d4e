//! KML 2.0 to 2.3, and the tracks of Google's extensions: placemarks in folders of any depth, with their names and data. Links lead to
//! documents of the same archive, and no further.
//!
//! Heights count where a placemark states that they are absolute, or states nothing and has some. Links, overlays, models and tours are left
//! out and counted.

use super::collected::Collected;
use super::phantom::Recorded;
use super::tracks::{Tracks, on_earth, salvaged, seconds};
use super::xml::{self, Elements};
use super::{Geometry, TIMES, VectorFeature, Vectors, Vertex, name_of, shorten};
use crate::crs::CoordinateSystem;
use crate::text::text_of;
use crate::{InputFile, IoError, Loaded, budget, fs};
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;
use quick_xml::events::BytesStart;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What is left out: names of elements, and words for them.
const LEFT_OUT: [(&[&str], &str); 4] = [
    (&["NetworkLink"], "links to other files were not followed; give those files themselves"),
    (&["GroundOverlay", "ScreenOverlay", "PhotoOverlay"], "pictures over the map were left out"),
    (&["Model"], "models were left out; give their files as layers of kind mesh"),
    (&["Tour"], "tours were left out"),
];
/// Place of links among these.
const LINKS: usize = 0;

/// State of the reader: content of the open placemark.
#[derive(Default)]
struct Kml {
    /// Name of the first document or folder.
    layer: Option<String>,
    name: String,
    properties: BTreeMap<String, String>,
    /// Name of the open value of the data.
    key: String,
    points: Vec<Vertex>,
    lines: Vec<Vec<Vertex>>,
    polygons: Vec<Vec<Vec<Vertex>>>,
    segments: Vec<Vec<Recorded>>,
    /// Rings of the open polygon; `None` = without an outer one.
    rings: Option<Vec<Vec<Vertex>>>,
    /// Of the open geometry.
    coordinates: Vec<Vertex>,
    mode: String,
    whens: Vec<Option<f64>>,
    coords: Vec<Option<Vertex>>,
    found: Collected,
    tracks: Tracks,
    bad_positions: usize,
    left_out: [usize; LEFT_OUT.len()],
    /// Where links lead that were not followed yet.
    links: Vec<String>,
    placemarks: usize,
}

/// As [`super::track_times`].
pub(super) fn times(text: &str) -> Result<Vec<(DVec2, f64)>, String> {
    let mut kml = Kml::default();
    xml::read(text, "KML", "kml", &mut kml)?;
    Ok(kml.tracks.timed)
}

pub(super) fn load(path: &Path, text: &str) -> Result<Loaded<Vectors>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let mut kml = Kml::default();
    let mut damage = xml::read(text, "KML", "kml", &mut kml).map_err(fail)?;
    let packed = packed_beside(path)?;
    let mut files = Vec::new();
    while let Some(link) = kml.links.pop() {
        let linked = path.with_file_name(link.trim());
        if !packed.contains(&linked) || files.iter().any(|file: &InputFile| file.path == linked) {
            continue;
        }
        let size = fs::metadata(&linked).map_err(|e| IoError::os(&linked, e))?.len();
        budget::ask("the file", size.saturating_mul(TIMES)).map_err(|reason| IoError::format(&linked, reason))?;
        let (bytes, file) = InputFile::read(&linked)?;
        let read = xml::read(&text_of(&bytes, &mut Vec::new()), "KML", "kml", &mut kml);
        damage = damage.or(read.map_err(|reason| IoError::format(&linked, reason))?);
        kml.left_out[LINKS] = kml.left_out[LINKS].saturating_sub(1);
        files.push(file);
    }
    kml.tracks.end_alone();
    let in_tracks = std::mem::take(&mut kml.tracks.features);
    kml.found.features.extend(in_tracks);
    let left_out = kml.left_out();
    if let Some(damage) = damage.as_ref().filter(|_| kml.found.features.is_empty()) {
        return Err(fail(format!("{damage}, get it again")));
    }
    let what = format!("KML holds {} placemarks{}, but", kml.placemarks, kml.others());
    let mut warnings = kml.found.told(path, &what).map_err(fail)?;
    let damage = damage.map(|damage| salvaged(&damage, &kml.found.features));
    let more = kml.tracks.warnings().into_iter().chain(left_out).chain(damage);
    warnings.extend(more.map(|w| w.in_file(path)));
    let crs = CoordinateSystem::wgs84().map_err(|e| fail(e.to_string()))?;
    let (layer, features) = (kml.layer.unwrap_or_default(), kml.found.features);
    let value = Vectors { path: path.into(), format: "KML", layer, crs, crs_stated: true, features };
    Ok(files.into_iter().fold(Loaded::new(value, warnings), Loaded::with_file))
}

/// The other documents of the archive in which a document lies: links to them are followed.
fn packed_beside(path: &Path) -> Result<Vec<PathBuf>, IoError> {
    let Some(archive) = path.parent().filter(|parent| fs::metadata(parent).is_ok_and(|m| m.is_file())) else {
        return Ok(Vec::new());
    };
    let names = fs::names_in(archive).map_err(|e| IoError::os(archive, e))?.unwrap_or_default();
    Ok(names.iter().map(|name| archive.join(name)).filter(|other| other != path).collect())
}

impl Elements for Kml {
    fn start(&mut self, open: &[String], name: &str, element: &BytesStart<'_>) {
        let attribute = |key: &str| {
            let found = element.attributes().flatten().find(|a| a.key.local_name().as_ref() == key)?;
            Some(shorten(&found.value))
        };
        if let Some(k) = LEFT_OUT.iter().position(|(names, _)| names.contains(&name)) {
            self.left_out[k] += 1;
        }
        match name {
            "Placemark" => {
                self.placemarks += 1;
                self.name.clear();
                self.properties.clear();
            }
            "Data" | "SimpleData" => self.key = attribute("name").unwrap_or_default(),
            "Point" | "LineString" | "LinearRing" => {
                self.coordinates.clear();
                // A ring of a polygon has the mode of the polygon.
                if !open.iter().any(|n| n == "Polygon") {
                    self.mode.clear();
                }
            }
            "Polygon" => {
                self.rings = Some(Vec::new());
                self.mode.clear();
            }
            "Track" => {
                self.whens.clear();
                self.coords.clear();
                self.mode.clear();
            }
            _ => {}
        }
    }

    fn end(&mut self, open: &[String], name: &str, text: &str) {
        let parent = open.last().map_or("", String::as_str);
        match (name, parent) {
            ("name", "Placemark") => self.name = shorten(text),
            ("name", "Document" | "Folder") if self.layer.is_none() => self.layer = Some(shorten(text)),
            ("description" | "address" | "phoneNumber", "Placemark") if !text.trim().is_empty() => {
                self.properties.insert(name.into(), shorten(text));
            }
            ("value", "Data") | ("SimpleData", _) if !text.trim().is_empty() => {
                let key = std::mem::take(&mut self.key);
                self.properties.insert(key, shorten(text));
            }
            ("href", _) if open.iter().any(|name| name == "NetworkLink") => self.links.push(text.to_owned()),
            ("altitudeMode", _) => self.mode = text.trim().to_owned(),
            ("coordinates", _) => self.read_coordinates(text),
            ("when", "Track") => self.whens.push(seconds(text)),
            ("coord", "Track") => self.coords.push(position(text.split_whitespace())),
            ("Track", _) => self.end_track(),
            ("Point" | "LineString" | "LinearRing" | "Polygon", _) => self.end_geometry(name, open),
            ("Placemark", _) => self.end_placemark(),
            _ => {}
        }
    }

    /// Areas count whole; of lines what is whole counts, without the last position, whose digits may be cut.
    fn broken(&mut self, open: &mut Vec<String>, text: &mut String) {
        let is_whole = |name: &String| matches!(name.as_str(), "Polygon" | "Point" | "when" | "coord" | "name");
        if let Some(first) = open.iter().position(is_whole) {
            open.truncate(first);
            text.clear();
        } else if open.last().is_some_and(|name| name == "coordinates") {
            text.truncate(text.rfind(char::is_whitespace).unwrap_or(0));
        }
    }
}

impl Kml {
    fn read_coordinates(&mut self, text: &str) {
        // Some programs set blanks around commas, which are between positions, too.
        let dense = text.split(',').map(str::trim).collect::<Vec<_>>().join(",");
        for tuple in dense.split_whitespace() {
            match position(tuple.split(',')) {
                Some(vertex) => self.coordinates.push(vertex),
                None => self.bad_positions += 1,
            }
        }
    }

    /// Positions with their heights, if these count.
    fn placed(&self, mut positions: Vec<Vertex>) -> Vec<Vertex> {
        let counts = match self.mode.as_str() {
            "absolute" => true,
            "" => positions.iter().any(|v| v.z.is_some_and(|z| z != 0.0)),
            _ => false,
        };
        positions.iter_mut().filter(|_| !counts).for_each(|v| v.z = None);
        positions
    }

    fn end_geometry(&mut self, name: &str, open: &[String]) {
        let positions = std::mem::take(&mut self.coordinates);
        let within = |name: &str| open.iter().any(|n| n == name);
        match name {
            "Point" => {
                let points = self.placed(positions);
                self.points.extend(points);
            }
            "Polygon" => {
                let rings = self.rings.take().unwrap_or_default();
                let rings: Vec<_> = rings.into_iter().map(|ring| self.placed(ring)).collect();
                self.polygons.extend((!rings.is_empty()).then_some(rings));
            }
            "LinearRing" if within("Polygon") => {
                let ring = self.found.ring(positions);
                let Some(rings) = &mut self.rings else { return };
                match ring {
                    Some(ring) if within("innerBoundaryIs") && !rings.is_empty() => rings.push(ring),
                    Some(ring) if rings.is_empty() && !within("innerBoundaryIs") => rings.push(ring),
                    // Without an outer ring its holes mean nothing.
                    _ => {}
                }
            }
            _ => {
                let mut line = self.placed(positions);
                let is_open = line.first().zip(line.last()).is_some_and(|(a, b)| a.xy != b.xy);
                if name == "LinearRing" && is_open {
                    line.extend(line.first().copied());
                }
                let line = self.found.line(line);
                self.lines.extend(line);
            }
        }
    }

    fn end_track(&mut self) {
        let (coords, whens) = (std::mem::take(&mut self.coords), std::mem::take(&mut self.whens));
        self.bad_positions += coords.iter().filter(|c| c.is_none()).count();
        let times = whens.into_iter().chain(std::iter::repeat(None));
        let (points, times): (Vec<Vertex>, Vec<Option<f64>>) =
            coords.into_iter().zip(times).filter_map(|(c, time)| Some((c?, time))).unzip();
        let points = self.placed(points);
        self.segments.push(points.into_iter().zip(times).collect());
    }

    fn end_placemark(&mut self) {
        let mut properties = std::mem::take(&mut self.properties);
        let mut name = std::mem::take(&mut self.name);
        if name.is_empty() {
            name = name_of(&properties);
        } else {
            properties.entry("name".into()).or_insert_with(|| name.clone());
        }
        let (points, lines) = (std::mem::take(&mut self.points), std::mem::take(&mut self.lines));
        let (polygons, segments) = (std::mem::take(&mut self.polygons), std::mem::take(&mut self.segments));
        let geometries = [Geometry::Points(points), Geometry::Lines(lines), Geometry::Polygons(polygons)];
        let mut is_empty = segments.is_empty();
        for geometry in geometries.into_iter().filter(|g| g.vertices().next().is_some()) {
            is_empty = false;
            let (name, properties) = (name.clone(), properties.clone());
            self.found.features.push(VectorFeature { style: None, name, properties, geometry });
        }
        self.found.without_geometry += usize::from(is_empty);
        if !segments.is_empty() {
            self.tracks.add("track", name, properties, segments);
        }
    }

    /// What was left out, with a word for each kind.
    fn left_out(&self) -> Vec<Warning> {
        let counted = LEFT_OUT
            .iter()
            .zip(self.left_out)
            .filter_map(|((_, words), count)| Warning::counted(WarningKind::Ignored, count, words));
        let what = "positions that are no longitude and latitude were dropped";
        counted.chain(Warning::counted(WarningKind::Ignored, self.bad_positions, what)).collect()
    }

    /// What else the file holds, in words, for the error of one without a usable geometry.
    fn others(&self) -> String {
        let words = ["links to other files", "pictures over the map", "models", "tours"];
        let some = words.iter().zip(self.left_out).filter(|(_, count)| *count > 0);
        some.map(|(word, count)| format!(", {count} {word}")).collect()
    }
}

/// A position of two or three numbers: longitude, latitude, height.
fn position<'t>(numbers: impl Iterator<Item = &'t str>) -> Option<Vertex> {
    let numbers: Vec<Option<f64>> = numbers.map(|number| number.parse().ok()).collect();
    match numbers.as_slice() {
        [Some(lon), Some(lat), rest @ ..] => on_earth(*lon, *lat, rest.first().copied().flatten()),
        _ => None,
    }
}
