//! Footprints and streets from vector files, in metres.

use crate::BelvedereError;
use belvedere_core::DVec2;
use belvedere_io::crs::{CoordinateSystem, Transform, utm_epsg};
use belvedere_io::vector::{Geometry, VectorFeature, Vectors, Vertex, load_vectors};
use belvedere_io::{InputFile, IoError};
use belvedere_scene::city::{Building, City, CityArea, HeightSource, LandCover, Polygon, Way, WayClass};
use std::path::{Path, PathBuf};

/// A city in metres and where it is from.
pub(super) struct Read {
    pub city: City,
    /// Code of the metric system; `None` for files without one.
    pub epsg: Option<u32>,
    pub inputs: Vec<InputFile>,
    pub warnings: Vec<String>,
}

/// Values of OpenStreetMap's `building`, `amenity`, `man_made` and `historic` that make a landmark.
const LANDMARKS: &[&str] = &[
    "church",
    "cathedral",
    "chapel",
    "mosque",
    "synagogue",
    "temple",
    "place_of_worship",
    "tower",
    "monument",
    "castle",
    "townhall",
    "water_tower",
    "lighthouse",
    "windmill",
];
/// Height of a storey and of a building of unknown height, metres.
const STOREY_M: f64 = 3.0;
const UNKNOWN_M: f64 = 9.0;

/// Reads the buildings and land cover of `city`, and streets of it and of `roads`.
///
/// # Errors
/// [`BelvedereError::Io`]: unreadable files, no building among the shapes, no metric system for them.
pub(super) fn read(city: &Path, roads: &[PathBuf]) -> Result<Read, BelvedereError> {
    let loaded = load_vectors(city)?;
    let target = metric_system(&loaded.value)?;
    let mut out = Read { city: City::default(), epsg: target.epsg(), inputs: loaded.files, warnings: loaded.warnings };
    add(&mut out, &loaded.value, &target, true)?;
    if out.city.buildings.is_empty() {
        let reason = "holds no polygon that is a building; give building footprints first, then files of streets";
        return Err(IoError::format(city, reason).into());
    }
    for path in roads {
        let loaded = load_vectors(path)?;
        out.warnings.extend(loaded.warnings);
        out.inputs.extend(loaded.files);
        add(&mut out, &loaded.value, &target, false)?;
    }
    Ok(out)
}

fn metric_system(vectors: &Vectors) -> Result<CoordinateSystem, BelvedereError> {
    if vectors.crs.suits_scenes() {
        return Ok(vectors.crs.clone());
    }
    let [low, high] = vectors.extent().unwrap_or([DVec2::ZERO; 2]);
    let to_degrees = Transform::new(&vectors.crs, &CoordinateSystem::wgs84()?)?;
    let middle = to_degrees.forward_one(0.5 * (low + high));
    let zone = middle.and_then(|m| utm_epsg(m.x, m.y)).ok_or_else(|| {
        let reason = format!("lies around {}, {}, where no UTM zone is; project it to metres first", low.x, low.y);
        IoError::format(&vectors.path, reason)
    })?;
    Ok(CoordinateSystem::from_epsg(zone)?)
}

/// Shapes in metres; those that cannot be transformed are left out and counted.
struct Metric {
    transform: Transform,
    lost: usize,
}

impl Metric {
    fn line(&mut self, vertices: &[Vertex]) -> Option<Vec<DVec2>> {
        let found: Option<Vec<DVec2>> = vertices.iter().map(|v| self.transform.forward_one(v.xy)).collect();
        self.lost += usize::from(found.is_none());
        found
    }

    fn polygons(&mut self, polygons: &[Vec<Vec<Vertex>>]) -> Vec<Polygon> {
        let polygon = |rings: &Vec<Vec<Vertex>>| {
            let outer = oriented(self.line(rings.first()?)?, true);
            let holes = rings[1..].iter().filter_map(|ring| Some(oriented(self.line(ring)?, false))).collect();
            Some(Polygon { outer, holes })
        };
        polygons.iter().filter_map(polygon).collect()
    }
}

fn oriented(mut ring: Vec<DVec2>, left: bool) -> Vec<DVec2> {
    let twice: f64 =
        ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| (*a - ring[0]).perp_dot(*b - ring[0])).sum();
    if (twice > 0.0) != left {
        ring.reverse();
    }
    ring
}

fn add(out: &mut Read, vectors: &Vectors, target: &CoordinateSystem, buildings: bool) -> Result<(), BelvedereError> {
    let mut metric = Metric { transform: Transform::new(&vectors.crs, target)?, lost: 0 };
    for feature in &vectors.features {
        match &feature.geometry {
            Geometry::Polygons(polygons) => {
                let polygons = metric.polygons(polygons);
                if polygons.is_empty() {
                    continue;
                }
                match cover_of(feature) {
                    Some(cover) => out.city.areas.push(CityArea { name: feature.name.clone(), cover, polygons }),
                    None if buildings => out.city.buildings.push(building(feature, polygons)),
                    None => {
                        out.city.areas.push(CityArea { name: feature.name.clone(), cover: LandCover::Road, polygons })
                    }
                }
            }
            Geometry::Lines(lines) => {
                let class = class_of(feature);
                for line in lines {
                    if let Some(points) = metric.line(line) {
                        out.city.ways.push(Way { name: feature.name.clone(), class, points });
                    }
                }
            }
            Geometry::Points(_) => {}
        }
    }
    if metric.lost > 0 {
        out.warnings.push(format!(
            "{}: {} rings and lines lie outside {target} and are left out",
            vectors.path.display(),
            metric.lost
        ));
    }
    Ok(())
}

fn value<'a>(feature: &'a VectorFeature, key: &str) -> Option<&'a str> {
    feature.properties.get(key).map(String::as_str)
}

fn number(feature: &VectorFeature, keys: &[&str]) -> Option<f64> {
    let text = keys.iter().find_map(|key| value(feature, key))?;
    text.trim().trim_end_matches('m').trim().parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0 && *v < 1000.0)
}

fn building(feature: &VectorFeature, footprint: Vec<Polygon>) -> Building {
    let stated = number(feature, &["height", "building:height", "Height", "HEIGHT"]);
    let levels = number(feature, &["building:levels", "levels"]).filter(|levels| *levels <= 200.0);
    let (height_m, height_source) = match (stated, levels) {
        (Some(height), _) => (height, HeightSource::Stated),
        (None, Some(levels)) => (STOREY_M * levels + 1.0, HeightSource::Levels),
        (None, None) => (UNKNOWN_M, HeightSource::Assumed),
    };
    let tags = ["building", "amenity", "man_made", "historic"];
    Building {
        id: ["osm_id", "id", "uID"].iter().find_map(|key| value(feature, key)).unwrap_or_default().to_owned(),
        name: feature.name.clone(),
        landmark: tags.iter().any(|key| value(feature, key).is_some_and(|v| LANDMARKS.contains(&v))),
        footprint,
        base_m: None,
        height_m,
        height_source,
        faces: Vec::new(),
    }
}

/// Land cover that the properties state.
fn cover_of(feature: &VectorFeature) -> Option<LandCover> {
    let is = |key: &str, values: &[&str]| value(feature, key).is_some_and(|v| values.contains(&v));
    if value(feature, "building").is_some() {
        None
    } else if value(feature, "waterway").is_some() || is("natural", &["water", "bay", "wetland"]) {
        Some(LandCover::Water)
    } else if is("landuse", &["forest"]) || is("natural", &["wood", "scrub"]) {
        Some(LandCover::Forest)
    } else if is("landuse", &["grass", "meadow", "cemetery", "recreation_ground", "village_green"])
        || is("leisure", &["park", "garden", "pitch", "golf_course"])
    {
        Some(LandCover::Green)
    } else if is("landuse", &["railway"]) {
        Some(LandCover::Rail)
    } else if value(feature, "highway").is_some() || is("amenity", &["parking"]) {
        Some(LandCover::Road)
    } else if value(feature, "landuse").is_some() {
        Some(LandCover::Other)
    } else {
        None
    }
}

/// Class of a line: of `waterway`, `railway`, `highway`; a street where nothing is stated.
fn class_of(feature: &VectorFeature) -> WayClass {
    if value(feature, "waterway").is_some() {
        return WayClass::Waterway;
    }
    if value(feature, "railway").is_some() {
        return WayClass::Rail;
    }
    match value(feature, "highway").map(|v| v.trim_end_matches("_link")) {
        Some("motorway" | "trunk") => WayClass::Motorway,
        Some("primary") => WayClass::Primary,
        Some("secondary") => WayClass::Secondary,
        Some("tertiary") => WayClass::Tertiary,
        Some("service" | "track") => WayClass::Service,
        Some("footway" | "path" | "steps" | "cycleway" | "pedestrian" | "bridleway") => WayClass::Footway,
        _ => WayClass::Residential,
    }
}
