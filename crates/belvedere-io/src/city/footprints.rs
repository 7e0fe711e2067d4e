//! Footprints, ways and land cover from map features.

use super::about::{CityAbout, IDS};
use super::attributes::{self, Attributes};
use super::plan::{self, Repairs};
use super::{CityFile, IoError, Loaded};
use crate::vector::{Geometry, VectorFeature, Vectors, Vertex};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Building, City, CityArea, LandCover, Polygon, Way, WayClass};
use std::collections::BTreeMap;

impl Attributes for BTreeMap<String, String> {
    fn text(&self, key: &str) -> Option<String> {
        let (_, value) = self.iter().find(|(k, _)| k.eq_ignore_ascii_case(key))?;
        Some(value.trim().to_owned()).filter(|t| !t.is_empty())
    }

    fn all(&self) -> BTreeMap<String, String> {
        self.clone()
    }
}

/// The city that the features of a file make. If no polygon of the file has a known kind, all are buildings; if no line has a known
/// class, all are residential streets.
pub(super) fn city(vectors: Vectors) -> Result<Loaded<CityFile>, IoError> {
    let (mut city, mut about) = (City::default(), Vec::new());
    let (mut repairs, mut unknown, mut points) = (Repairs::default(), 0, 0);
    let told = vectors.features.iter().any(|f| is_building(f) || cover(&f.properties).is_some());
    let told_ways = vectors.features.iter().any(|f| way_class(&f.properties).is_some());
    for (number, feature) in vectors.features.iter().enumerate() {
        match &feature.geometry {
            Geometry::Points(_) => points += 1,
            Geometry::Lines(lines) => {
                let usual = (!told_ways).then_some(WayClass::Residential);
                let Some(class) = way_class(&feature.properties).or(usual) else {
                    unknown += 1;
                    continue;
                };
                let flat = |line: &Vec<Vertex>| line.iter().map(|v| v.xy).collect();
                let name = feature.name.clone();
                city.ways.extend(lines.iter().map(|line| Way { name: name.clone(), class, points: flat(line) }));
            }
            Geometry::Polygons(polygons) => {
                let flat = |rings: &Vec<Vec<Vertex>>| {
                    plan::polygon(rings.iter().map(|ring| ring.iter().map(|v| v.xy).collect()), &mut repairs)
                };
                let polygons: Vec<Polygon> = polygons.iter().filter_map(flat).collect();
                match cover(&feature.properties) {
                    _ if polygons.is_empty() => {}
                    Some(cover) if !is_building(feature) => {
                        city.areas.push(CityArea { name: feature.name.clone(), cover, polygons });
                    }
                    _ if is_building(feature) || !told => {
                        let building = building(feature, number, polygons, &mut repairs);
                        let (id, name) = (building.id.clone(), building.name.clone());
                        about.push(CityAbout { id, name, attributes: feature.properties.clone() });
                        city.buildings.push(building);
                    }
                    _ => unknown += 1,
                }
            }
        }
    }
    let path = vectors.path.clone();
    if city == City::default() {
        let count = vectors.features.len();
        let reason = format!(
            "none of its {count} features is a building, way or land cover; they need properties such as building, highway or landuse"
        );
        return Err(IoError::format(&path, reason));
    }
    let say = |count: usize, what: &str| Warning::counted(WarningKind::Ignored, count, what);
    let warnings = repairs
        .warnings()
        .chain(say(unknown, "features that are neither buildings, ways nor land cover were left out"))
        .chain(say(points, "points were left out"))
        .map(|w| w.in_file(&path));
    let (warnings, reference) = (warnings.collect(), vectors.crs.name().to_owned());
    let crs = Some(vectors.crs).filter(|crs| !crs.is_local());
    let file =
        CityFile { path, format: vectors.format.to_owned(), crs, reference, lods: vec!["0".into()], city, about };
    Ok(Loaded::new(file, warnings))
}

fn is_building(feature: &VectorFeature) -> bool {
    let p = &feature.properties;
    let building = p.text("building").is_some_and(|b| !b.eq_ignore_ascii_case("no"));
    building
        || ["building:levels", "building:height", "measuredheight", "building_height"]
            .iter()
            .any(|k| p.text(k).is_some())
        || (cover(p).is_none() && ["height", "levels"].iter().any(|k| p.text(k).is_some()))
}

fn building(feature: &VectorFeature, number: usize, footprint: Vec<Polygon>, repairs: &mut Repairs) -> Building {
    let about = &feature.properties;
    let (height_m, height_source) = attributes::height(about, repairs);
    let id = IDS.iter().find_map(|k| about.text(k)).unwrap_or_else(|| format!("feature/{}", number + 1));
    let name = if feature.name.is_empty() { attributes::name(about) } else { feature.name.clone() };
    let landmark = attributes::is_landmark(about);
    Building { id, name, landmark, footprint, base_m: None, height_m, height_source, faces: Vec::new() }
}

/// The class of a way, by OpenStreetMap's keys.
pub(super) fn way_class(about: &impl Attributes) -> Option<WayClass> {
    if about.text("waterway").is_some() {
        return Some(WayClass::Waterway);
    }
    if about.text("railway").is_some() {
        return Some(WayClass::Rail);
    }
    let highway = about.text("highway").or_else(|| about.text("fclass")).or_else(|| about.text("roadclass"))?;
    Some(match highway.trim_end_matches("_link") {
        "motorway" | "trunk" => WayClass::Motorway,
        "primary" => WayClass::Primary,
        "secondary" => WayClass::Secondary,
        "tertiary" => WayClass::Tertiary,
        "service" | "track" | "driveway" | "alley" => WayClass::Service,
        "footway" | "path" | "steps" | "cycleway" | "pedestrian" | "bridleway" | "corridor" => WayClass::Footway,
        _ => WayClass::Residential,
    })
}

/// The land cover of a polygon, by OpenStreetMap's keys.
pub(super) fn cover(about: &impl Attributes) -> Option<LandCover> {
    let of = |key: &str| about.text(key).unwrap_or_default();
    let (natural, landuse, leisure) = (of("natural"), of("landuse"), of("leisure"));
    let is = |value: &str, any: &[&str]| any.contains(&value);
    if is(&natural, &["water", "bay", "strait"])
        || is(&landuse, &["reservoir", "basin"])
        || !of("water").is_empty()
        || of("waterway") == "riverbank"
    {
        return Some(LandCover::Water);
    }
    if is(&natural, &["wood", "scrub"]) || landuse == "forest" {
        return Some(LandCover::Forest);
    }
    if !leisure.is_empty()
        || is(
            &landuse,
            &[
                "grass",
                "meadow",
                "cemetery",
                "recreation_ground",
                "village_green",
                "allotments",
                "orchard",
                "vineyard",
                "farmland",
            ],
        )
        || is(&natural, &["grassland", "heath", "wetland"])
    {
        return Some(LandCover::Green);
    }
    if landuse == "railway" {
        return Some(LandCover::Rail);
    }
    if !of("area:highway").is_empty()
        || of("amenity") == "parking"
        || (!of("highway").is_empty() && of("area") == "yes")
    {
        return Some(LandCover::Road);
    }
    (!landuse.is_empty() || !natural.is_empty()).then_some(LandCover::Other)
}
