//! Reading of OpenStreetMap's files: PBF, XML and the JSON of Overpass.

use super::pbf::{Blobs, Broken};
use super::{Line, Map, Relation, Tags, is_wanted};
use crate::IoError;
use crate::text::text_of;
use belvedere_core::{Warning, WarningKind};
use glam::DVec2;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use serde::Deserialize;
use std::collections::HashSet;
use std::path::Path;

impl Map {
    /// Reads a file of a format by its name in the list of formats.
    ///
    /// # Errors
    /// [`IoError::Format`]: damaged.
    pub(super) fn of_file(path: &Path, bytes: &[u8], format: &str) -> Result<Self, IoError> {
        let read = match format {
            "OSM PBF" => Self::of_pbf(bytes),
            "OSM XML" => Objects::of_xml(&text_of(bytes, &mut Vec::new())).map(Objects::map).map_err(Broken::Damaged),
            _ => Objects::of_json(bytes).map(Objects::map).map_err(Broken::Damaged),
        };
        read.map_err(|broken| match broken {
            Broken::Memory(refusal) => IoError::format(path, refusal),
            Broken::Unknown(what) => {
                IoError::format(path, format!("{format} cannot be read: {what}; write it anew (osmium cat, with zlib)"))
            }
            Broken::Damaged(why) => damaged(path, format, &why),
        })
    }

    /// What is said of a file that ends too early.
    pub(super) fn said_of_cut(&self, format: &str) -> Option<Warning> {
        let why = self.cut.as_ref()?;
        let [nodes, ways, relations] = self.counts;
        let text = format!(
            "{format} is damaged or cut off ({why}); the {nodes} nodes, {ways} ways and {relations} relations before are read"
        );
        Some(Warning::new(WarningKind::Repaired, text).with("nodes", nodes as f64).with("ways", ways as f64))
    }

    /// Relations come after ways and ways after nodes, so the file is read three times and only what is used is kept.
    fn of_pbf(bytes: &[u8]) -> Result<Self, Broken> {
        let blobs = Blobs::of_file(bytes)?;
        let mut map = Self { cut: blobs.cut.clone(), ..Self::default() };
        let take = |found: Vec<Relation>| found.into_iter().for_each(|relation| map.relation(relation));
        blobs.each(|block| block.relations().map(|(id, tags, ways)| Relation { id, tags, ways }).collect(), take)?;
        let members = map.members();
        let take = |found: Vec<_>| found.into_iter().for_each(|(id, line)| map.way(id, line, &members));
        blobs.each(|block| block.ways().map(|(id, tags, nodes)| (id, Line { tags, nodes })).collect(), take)?;
        let wanted = map.corners();
        let take = |found: Vec<_>| found.into_iter().for_each(|(id, at)| map.node(id, at, &wanted));
        blobs.each(|block| block.nodes().collect(), take)?;
        Ok(map)
    }

    fn members(&self) -> HashSet<i64> {
        self.relations.iter().flat_map(|r| &r.ways).copied().collect()
    }

    fn corners(&self) -> HashSet<i64> {
        self.ways.values().flat_map(|w| &w.nodes).copied().collect()
    }

    fn relation(&mut self, relation: Relation) {
        self.counts[2] += 1;
        if relation.tags.get("type").is_some_and(|t| t == "multipolygon") && is_wanted(&relation.tags) {
            self.relations.push(relation);
        }
    }

    fn way(&mut self, id: i64, line: Line, members: &HashSet<i64>) {
        self.counts[1] += 1;
        if members.contains(&id) || is_wanted(&line.tags) {
            self.ways.insert(id, line);
        }
    }

    fn node(&mut self, id: i64, at: DVec2, wanted: &HashSet<i64>) {
        self.counts[0] += 1;
        if at.x.abs() <= 180.0 && at.y.abs() <= 90.0 && wanted.contains(&id) {
            self.nodes.insert(id, at);
        }
    }
}

/// The error of a file that gives nothing.
pub(super) fn damaged(path: &Path, format: &str, why: &str) -> IoError {
    IoError::format(path, format!("{format} is damaged or cut off ({why}); fetch it again"))
}

/// Everything that a text holds.
#[derive(Default)]
struct Objects {
    cut: Option<String>,
    nodes: Vec<(i64, DVec2)>,
    ways: Vec<(i64, Line)>,
    relations: Vec<Relation>,
}

/// The object that is being read.
enum Open {
    Way(i64, Line),
    Relation(Relation),
    Other,
}

impl Objects {
    fn map(self) -> Map {
        let mut map = Map { cut: self.cut, ..Map::default() };
        self.relations.into_iter().for_each(|relation| map.relation(relation));
        let members = map.members();
        self.ways.into_iter().for_each(|(id, line)| map.way(id, line, &members));
        let wanted = map.corners();
        self.nodes.into_iter().for_each(|(id, at)| map.node(id, at, &wanted));
        map
    }

    /// Source: OpenStreetMap Wiki, "OSM XML".
    fn of_xml(text: &str) -> Result<Self, String> {
        let mut reader = Reader::from_str(text);
        let (mut objects, mut open, mut depth) = (Self::default(), Open::Other, 0usize);
        loop {
            let event = match reader.read_event() {
                Ok(event) => event,
                Err(e) => return objects.cut_off(e.to_string()),
            };
            match event {
                Event::Start(e) => {
                    objects.element(&e, &mut open);
                    depth += 1;
                }
                Event::Empty(e) => {
                    objects.element(&e, &mut open);
                    if is_object(&e) {
                        objects.close(&mut open);
                    }
                }
                Event::End(e) => {
                    depth = depth.saturating_sub(1);
                    if matches!(e.local_name().as_ref(), "node" | "way" | "relation") {
                        objects.close(&mut open);
                    }
                }
                Event::Eof if depth > 0 => return objects.cut_off("it ends within an element".into()),
                Event::Eof => return Ok(objects),
                _ => {}
            }
        }
    }

    /// What is whole, unless there is nothing.
    fn cut_off(mut self, why: String) -> Result<Self, String> {
        if self.nodes.is_empty() && self.ways.is_empty() {
            return Err(why);
        }
        self.cut = Some(why);
        Ok(self)
    }

    fn element(&mut self, e: &BytesStart<'_>, open: &mut Open) {
        let value = |key: &str| {
            let found = e.attributes().flatten().find(|a| a.key.local_name().as_ref() == key)?;
            Some(plain(&found.value))
        };
        let number = |key: &str| value(key)?.trim().parse::<i64>().ok();
        let degrees = |key: &str| value(key)?.trim().parse::<f64>().ok();
        match e.local_name().as_ref() {
            "node" => {
                *open = Open::Other;
                if let (Some(id), Some(lon), Some(lat)) = (number("id"), degrees("lon"), degrees("lat")) {
                    self.nodes.push((id, DVec2::new(lon, lat)));
                }
            }
            "way" => {
                let line = Line { tags: Tags::new(), nodes: Vec::new() };
                *open = number("id").map_or(Open::Other, |id| Open::Way(id, line));
            }
            "relation" => {
                let relation = |id| Relation { id, tags: Tags::new(), ways: Vec::new() };
                *open = number("id").map_or(Open::Other, |id| Open::Relation(relation(id)));
            }
            "nd" => {
                if let (Open::Way(_, line), Some(id)) = (open, number("ref")) {
                    line.nodes.push(id);
                }
            }
            "member" => {
                if let (Open::Relation(relation), Some(id)) = (open, number("ref"))
                    && value("type").is_some_and(|t| t == "way")
                {
                    relation.ways.push(id);
                }
            }
            "tag" => {
                let tags = match open {
                    Open::Way(_, line) => &mut line.tags,
                    Open::Relation(relation) => &mut relation.tags,
                    Open::Other => return,
                };
                tags.extend(value("k").zip(value("v")));
            }
            _ => {}
        }
    }

    fn close(&mut self, open: &mut Open) {
        match std::mem::replace(open, Open::Other) {
            Open::Way(id, line) => self.ways.push((id, line)),
            Open::Relation(relation) => self.relations.push(relation),
            Open::Other => {}
        }
    }

    /// The answer of Overpass with `out:json`; the positions of ways may stand in the ways themselves (`out geom`).
    fn of_json(bytes: &[u8]) -> Result<Self, String> {
        let answer: Answer = serde_json::from_slice(bytes).map_err(|e| e.to_string())?;
        let mut objects = Self::default();
        for element in answer.elements {
            let JsonElement { kind, id, lat, lon, nodes, geometry, members, tags } = element;
            match kind.as_str() {
                "node" => objects.nodes.extend(lon.zip(lat).map(|(x, y)| (id, DVec2::new(x, y)))),
                "way" => {
                    for (node, at) in nodes.iter().zip(&geometry) {
                        objects.nodes.extend(at.as_ref().map(|at| (*node, DVec2::new(at.lon, at.lat))));
                    }
                    objects.ways.push((id, Line { tags, nodes }));
                }
                "relation" => {
                    let ways = members.iter().filter(|m| m.kind == "way").map(|m| m.id).collect();
                    objects.relations.push(Relation { id, tags, ways });
                }
                _ => {}
            }
        }
        Ok(objects)
    }
}

fn is_object(e: &BytesStart<'_>) -> bool {
    matches!(e.local_name().as_ref(), "node" | "way" | "relation")
}

/// A value without the entities of XML.
fn plain(value: &str) -> String {
    quick_xml::escape::unescape(value).map_or_else(|_| value.to_owned(), |text| text.into_owned())
}

/// An answer of Overpass.
#[derive(Deserialize)]
struct Answer {
    elements: Vec<JsonElement>,
}

#[derive(Deserialize)]
struct JsonElement {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    id: i64,
    lat: Option<f64>,
    lon: Option<f64>,
    #[serde(default)]
    nodes: Vec<i64>,
    #[serde(default)]
    geometry: Vec<Option<Place>>,
    #[serde(default)]
    members: Vec<Member>,
    #[serde(default)]
    tags: Tags,
}

#[derive(Deserialize)]
struct Place {
    lat: f64,
    lon: f64,
}

#[derive(Deserialize)]
struct Member {
    #[serde(rename = "type")]
    kind: String,
    #[serde(rename = "ref", default)]
    id: i64,
}
