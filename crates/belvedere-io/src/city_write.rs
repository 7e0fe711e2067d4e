//! Cities as CityJSON 2.0: buildings as solids with semantic surfaces, land cover, ways.

use crate::IoError;
use crate::atomic::write_atomic;
use belvedere_scene::city::{Building, City, CityArea, LandCover, Polygon, StructureKind, Surface, Way, WayClass};
use glam::{DVec2, DVec3};
use serde_json::{Map, Value, json};
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Steps of the stored coordinates, metres.
const STEP_M: f64 = 0.001;

/// Figures that are written with a building, besides its height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockFigures {
    /// Share of its footprint that is built.
    pub coverage: f64,
    /// Number of buildings that it represents.
    pub count: usize,
}

/// Writes a city as CityJSON 2.0. The first buildings are blocks with these figures. Buildings without faces become prisms from
/// their base, 0 where they stand on the terrain, with a flat roof; ways lie at height 0.
///
/// # Errors
/// [`IoError`]: the file exists and may not be replaced, the system refuses; coordinates that are no numbers.
pub fn write_city_json(
    path: &Path,
    city: &City,
    blocks: &[BlockFigures],
    epsg: Option<u32>,
    overwrite: bool,
) -> Result<(), IoError> {
    let text = city_json(city, blocks, epsg).map_err(|reason| IoError::format(path, reason))?;
    write_atomic(path, overwrite, |out| out.write_all(text.as_bytes()))
}

/// The document.
///
/// # Errors
/// One sentence for coordinates that are not finite.
pub fn city_json(city: &City, blocks: &[BlockFigures], epsg: Option<u32>) -> Result<String, String> {
    let origin = origin(city);
    let mut vertices = Vertices { origin, places: HashMap::new(), list: Vec::new(), bad: 0 };
    let mut objects = Objects::default();
    for (number, building) in city.buildings.iter().enumerate() {
        objects.add(&building.id, "building", building_object(&mut vertices, building, blocks.get(number)));
    }
    for structure in &city.structures {
        let kind = match structure.kind {
            StructureKind::Bridge => "Bridge",
            StructureKind::Vegetation => "SolitaryVegetationObject",
            StructureKind::Other => "GenericCityObject",
        };
        // Only buildings and bridges may have walls and roofs.
        let surfaces: Vec<Face> = structure.faces.iter().map(|f| (f.rings.clone(), f.surface)).collect();
        let geometry = multi_surface(&mut vertices, &surfaces, kind == "Bridge");
        objects.add(&structure.id, "structure", object(kind, named(&structure.name), vec![geometry]));
    }
    for area in &city.areas {
        objects.add("", "area", area_object(&mut vertices, area));
    }
    for way in &city.ways {
        objects.add("", "way", way_object(&mut vertices, way));
    }
    if vertices.bad > 0 {
        return Err(format!(
            "{} corners of the city are no numbers, no file can hold them; correct them",
            vertices.bad
        ));
    }
    let [low, high] = vertices.extent();
    let mut metadata = json!({ "geographicalExtent": [low.x, low.y, low.z, high.x, high.y, high.z] });
    if let Some(code) = epsg {
        metadata["referenceSystem"] = json!(format!("https://www.opengis.net/def/crs/EPSG/0/{code}"));
    }
    let document = json!({
        "type": "CityJSON",
        "version": "2.0",
        "transform": { "scale": [STEP_M, STEP_M, STEP_M], "translate": origin.to_array() },
        "metadata": metadata,
        "CityObjects": objects.map,
        "vertices": vertices.list,
    });
    Ok(document.to_string() + "\n")
}

/// Whole metres near the least corner, so that the stored integers are small.
fn origin(city: &City) -> DVec3 {
    let corners = city.buildings.iter().flat_map(|b| &b.footprint).flat_map(|p| &p.outer).filter(|p| p.is_finite());
    let low = corners.fold(DVec2::MAX, |low, p| low.min(*p));
    if low == DVec2::MAX { DVec3::ZERO } else { low.floor().extend(0.0) }
}

type Face = (Vec<Vec<DVec3>>, Surface);

/// Vertices as integers, each once.
struct Vertices {
    origin: DVec3,
    places: HashMap<[i64; 3], usize>,
    list: Vec<[i64; 3]>,
    bad: usize,
}

impl Vertices {
    fn place(&mut self, p: DVec3) -> usize {
        self.bad += usize::from(!p.is_finite());
        let key = ((p - self.origin) / STEP_M).round().to_array().map(|v| v as i64);
        let next = self.list.len();
        let place = *self.places.entry(key).or_insert(next);
        if place == next {
            self.list.push(key);
        }
        place
    }

    /// A ring without vertices that coincide after rounding; `None` for fewer than three.
    fn ring(&mut self, points: &[DVec3]) -> Option<Value> {
        let places = self.ring_places(points);
        (places.len() >= 3).then(|| json!(places))
    }

    fn ring_places(&mut self, points: &[DVec3]) -> Vec<usize> {
        let mut places: Vec<usize> = points.iter().map(|p| self.place(*p)).collect();
        places.dedup();
        if places.len() > 1 && places.first() == places.last() {
            places.pop();
        }
        places
    }

    /// A surface: outer ring and holes; `None` without an area.
    fn surface(&mut self, rings: &[Vec<DVec3>]) -> Option<Value> {
        let outer = self.ring(rings.first()?)?;
        let holes = rings[1..].iter().filter_map(|hole| self.ring(hole)).collect::<Vec<_>>();
        Some(Value::Array(std::iter::once(outer).chain(holes).collect()))
    }

    fn extent(&self) -> [DVec3; 2] {
        let points = self.list.iter().map(|v| self.origin + DVec3::from(v.map(|c| c as f64)) * STEP_M);
        let found =
            points.fold(None, |found: Option<[DVec3; 2]>, p| Some(found.map_or([p; 2], |[a, b]| [a.min(p), b.max(p)])));
        found.unwrap_or([DVec3::ZERO; 2])
    }
}

/// Objects by id.
#[derive(Default)]
struct Objects {
    map: Map<String, Value>,
    known: BTreeSet<String>,
}

impl Objects {
    fn add(&mut self, id: &str, kind: &str, object: Value) {
        let mut name = if id.is_empty() { format!("{kind}-{}", self.map.len() + 1) } else { id.to_owned() };
        while !self.known.insert(name.clone()) {
            name += "-x";
        }
        self.map.insert(name, object);
    }
}

fn object(kind: &str, attributes: Map<String, Value>, geometry: Vec<Option<Value>>) -> Value {
    json!({ "type": kind, "attributes": attributes, "geometry": geometry.into_iter().flatten().collect::<Vec<_>>() })
}

fn named(name: &str) -> Map<String, Value> {
    let mut attributes = Map::new();
    if !name.is_empty() {
        attributes.insert("name".into(), json!(name));
    }
    attributes
}

fn building_object(vertices: &mut Vertices, building: &Building, figures: Option<&BlockFigures>) -> Value {
    let mut attributes = named(&building.name);
    attributes.insert("height".into(), json!(building.height_m));
    if let Some(base) = building.base_m {
        attributes.insert("base".into(), json!(base));
    }
    let is_block = figures.is_some();
    let figures = figures.copied().unwrap_or(BlockFigures { coverage: 1.0, count: 1 });
    attributes.insert("coverage".into(), json!(figures.coverage));
    attributes.insert("count".into(), json!(figures.count));
    if building.landmark {
        attributes.insert("landmark".into(), json!(true));
    }
    if !building.faces.is_empty() {
        let surfaces: Vec<Face> = building.faces.iter().map(|f| (f.rings.clone(), f.surface)).collect();
        if is_block && let Some(solids) = solids(vertices, &surfaces) {
            return object("Building", attributes, solids);
        }
        return object("Building", attributes, vec![multi_surface(vertices, &surfaces, true)]);
    }
    let solids = building.footprint.iter().map(|polygon| {
        let base = building.base_m.unwrap_or(0.0);
        solid(vertices, &prism(polygon, base, base + building.height_m))
    });
    let solids: Vec<Option<Value>> = solids.collect();
    object("Building", attributes, solids)
}

/// Surfaces of an upright prism, seen from outside counter-clockwise: ground, roof, walls.
fn prism(polygon: &Polygon, low: f64, high: f64) -> Vec<Face> {
    let rings: Vec<&Vec<DVec2>> = std::iter::once(&polygon.outer).chain(&polygon.holes).collect();
    let at = |height: f64, turned: bool| -> Vec<Vec<DVec3>> {
        let lift = |ring: &&Vec<DVec2>| {
            let mut lifted: Vec<DVec3> = ring.iter().map(|p| p.extend(height)).collect();
            if turned {
                lifted.reverse();
            }
            lifted
        };
        rings.iter().map(lift).collect()
    };
    let mut faces = vec![(at(low, true), Surface::Ground), (at(high, false), Surface::Roof)];
    for ring in &rings {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let wall = vec![a.extend(low), b.extend(low), b.extend(high), a.extend(high)];
            faces.push((vec![wall], Surface::Wall));
        }
    }
    faces
}

/// Boundaries and semantics of the surfaces that have an area.
fn boundaries(vertices: &mut Vertices, faces: &[Face]) -> (Vec<Value>, Vec<Option<usize>>) {
    let mut kept = (Vec::new(), Vec::new());
    for (rings, surface) in faces {
        if let Some(boundary) = vertices.surface(rings) {
            kept.0.push(boundary);
            kept.1.push(match surface {
                Surface::Ground => Some(0),
                Surface::Roof => Some(1),
                Surface::Wall => Some(2),
                Surface::Other => None,
            });
        }
    }
    kept
}

fn semantics() -> Value {
    json!([{ "type": "GroundSurface" }, { "type": "RoofSurface" }, { "type": "WallSurface" }])
}

fn solid(vertices: &mut Vertices, faces: &[Face]) -> Option<Value> {
    let (shell, values) = boundaries(vertices, faces);
    (shell.len() >= 4).then(|| {
        json!({ "type": "Solid", "lod": "1.2", "boundaries": [shell],
            "semantics": { "surfaces": semantics(), "values": [values] } })
    })
}

/// Faces as one solid per connected piece; `None` unless every piece is closed and its faces point outwards.
fn solids(vertices: &mut Vertices, faces: &[Face]) -> Option<Vec<Option<Value>>> {
    let rings: Vec<Vec<Vec<usize>>> =
        faces.iter().map(|(rings, _)| rings.iter().map(|ring| vertices.ring_places(ring)).collect()).collect();
    let edges = |rings: &[Vec<usize>]| {
        let of = |ring: &Vec<usize>| (0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()]]).collect::<Vec<_>>();
        rings.iter().filter(|ring| ring.len() >= 3).flat_map(of).collect::<Vec<_>>()
    };
    let mut face_left_of: HashMap<[usize; 2], usize> = HashMap::new();
    for (number, rings) in rings.iter().enumerate() {
        if edges(rings).into_iter().any(|edge| face_left_of.insert(edge, number).is_some()) {
            return None;
        }
    }
    let mut piece = vec![usize::MAX; faces.len()];
    let mut pieces = 0;
    for start in 0..faces.len() {
        let mut todo = vec![start];
        while let Some(face) = todo.pop().filter(|_| piece[start] == usize::MAX || piece[start] == pieces) {
            if piece[face] == usize::MAX {
                piece[face] = pieces;
                for [a, b] in edges(&rings[face]) {
                    todo.push(*face_left_of.get(&[b, a])?);
                }
            }
        }
        pieces += usize::from(piece[start] == pieces);
    }
    let of_piece = |number| faces.iter().zip(&piece).filter(move |(_, p)| **p == number).map(|(face, _)| face.clone());
    Some((0..pieces).map(|number| solid(vertices, &of_piece(number).collect::<Vec<_>>())).collect())
}

fn multi_surface(vertices: &mut Vertices, faces: &[Face], with_semantics: bool) -> Option<Value> {
    let (surfaces, values) = boundaries(vertices, faces);
    if surfaces.is_empty() {
        return None;
    }
    let mut geometry = json!({ "type": "MultiSurface", "lod": "2", "boundaries": surfaces });
    if with_semantics {
        geometry["semantics"] = json!({ "surfaces": semantics(), "values": values });
    }
    Some(geometry)
}

fn area_object(vertices: &mut Vertices, area: &CityArea) -> Value {
    let (kind, class) = match area.cover {
        LandCover::Water => ("WaterBody", "water"),
        LandCover::Green => ("PlantCover", "green"),
        LandCover::Forest => ("PlantCover", "forest"),
        LandCover::Road => ("Road", "road"),
        LandCover::Rail => ("Railway", "rail"),
        LandCover::Other => ("LandUse", "other"),
    };
    let lift = |ring: &Vec<DVec2>| ring.iter().map(|p| p.extend(0.0)).collect::<Vec<_>>();
    let face = |p: &Polygon| (std::iter::once(&p.outer).chain(&p.holes).map(lift).collect(), Surface::Other);
    let faces: Vec<Face> = area.polygons.iter().map(face).collect();
    let mut attributes = named(&area.name);
    attributes.insert("class".into(), json!(class));
    object(kind, attributes, vec![multi_surface(vertices, &faces, false)])
}

fn way_object(vertices: &mut Vertices, way: &Way) -> Value {
    let (kind, class) = match way.class {
        WayClass::Motorway => ("Road", "motorway"),
        WayClass::Primary => ("Road", "primary"),
        WayClass::Secondary => ("Road", "secondary"),
        WayClass::Tertiary => ("Road", "tertiary"),
        WayClass::Residential => ("Road", "residential"),
        WayClass::Service => ("Road", "service"),
        WayClass::Footway => ("Road", "footway"),
        WayClass::Rail => ("Railway", "rail"),
        WayClass::Waterway => ("Waterway", "river"),
    };
    let mut line: Vec<usize> = way.points.iter().map(|p| vertices.place(p.extend(0.0))).collect();
    line.dedup();
    let geometry = (line.len() >= 2).then(|| json!({ "type": "MultiLineString", "lod": "0", "boundaries": [line] }));
    let mut attributes = named(&way.name);
    attributes.insert("class".into(), json!(class));
    object(kind, attributes, vec![geometry])
}

#[cfg(test)]
mod tests;
