//! Towns to generalise: a generated one, and real ones read from GeoJSON.

use belvedere_core::DVec2;
use belvedere_io::crs::{CoordinateSystem, Transform, utm_epsg};
use belvedere_io::load_vectors;
use belvedere_io::vector::{Geometry, Vectors, Vertex};
use belvedere_scene::city::{Building, City, HeightSource, Polygon, Way, WayClass};
use belvedere_testkit::Random;
use std::path::Path;

/// A building with a flat roof.
pub(crate) fn building(footprint: Vec<DVec2>, height_m: f64) -> Building {
    Building {
        id: String::new(),
        name: String::new(),
        landmark: false,
        footprint: vec![Polygon { outer: footprint, holes: Vec::new() }],
        base_m: None,
        height_m,
        height_source: HeightSource::Stated,
        faces: Vec::new(),
    }
}

/// A rectangle turned by `angle` radians.
pub(crate) fn rectangle(middle: DVec2, size: DVec2, angle: f64) -> Vec<DVec2> {
    let turn = DVec2::from_angle(angle);
    [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|c| middle + turn.rotate(DVec2::from(c) * size)).to_vec()
}

pub(crate) fn way(class: WayClass, points: &[DVec2]) -> Way {
    Way { name: String::new(), class, points: points.to_vec() }
}

/// A town of `blocks` x `blocks` street blocks of 100 m with 12 houses each; every fourth street is a main one.
pub(crate) fn town(blocks: usize, seed: u64) -> City {
    let mut random = Random::new(seed);
    let mut city = City::default();
    let span = 100.0 * blocks as f64;
    for i in 0..=blocks {
        let class = if i % 4 == 0 { WayClass::Secondary } else { WayClass::Residential };
        let at = 100.0 * i as f64;
        city.ways.push(way(class, &[DVec2::new(at, 0.0), DVec2::new(at + 5.0, span)]));
        city.ways.push(way(class, &[DVec2::new(0.0, at), DVec2::new(span, at - 3.0)]));
    }
    for block in 0..blocks * blocks {
        let corner = 100.0 * DVec2::new((block % blocks) as f64, (block / blocks) as f64);
        for house in 0..12 {
            let middle = corner + DVec2::new(18.0 + 22.0 * (house % 4) as f64, 22.0 + 27.0 * (house / 4) as f64);
            let size = DVec2::new(random.range(9.0, 20.0), random.range(9.0, 22.0));
            let outline = rectangle(middle, size, random.range(-0.15, 0.15));
            city.buildings.push(building(outline, random.range(6.0, 12.0)));
        }
    }
    city
}

struct Metric(Transform);

impl Metric {
    fn of(vectors: &Vectors) -> Self {
        let [low, high] = vectors.extent().expect("vertices");
        let middle = 0.5 * (low + high);
        let zone = utm_epsg(middle.x, middle.y).expect("a zone");
        let to = CoordinateSystem::from_epsg(zone).expect("UTM");
        Self(Transform::new(&vectors.crs, &to).expect("a transform"))
    }

    fn points(&self, vertices: &[Vertex]) -> Vec<DVec2> {
        vertices.iter().map(|v| self.0.forward_one(v.xy).expect("in the zone")).collect()
    }
}

fn class_of(highway: Option<&str>) -> WayClass {
    match highway {
        Some("trunk" | "trunk_link" | "motorway") => WayClass::Motorway,
        Some("primary") => WayClass::Primary,
        Some("secondary") => WayClass::Secondary,
        Some("tertiary") => WayClass::Tertiary,
        Some("service" | "track") => WayClass::Service,
        Some("path" | "footway") => WayClass::Footway,
        _ => WayClass::Residential,
    }
}

/// Buildings and streets of two GeoJSON files in degrees.
pub(crate) fn read(buildings: &Path, roads: &Path) -> City {
    let (buildings, roads) =
        (load_vectors(buildings).expect("buildings").value, load_vectors(roads).expect("roads").value);
    let metric = Metric::of(&buildings);
    let mut city = City::default();
    for feature in &buildings.features {
        let Geometry::Polygons(polygons) = &feature.geometry else { continue };
        let footprint = polygons.iter().map(|rings| Polygon {
            outer: metric.points(&rings[0]),
            holes: rings[1..].iter().map(|r| metric.points(r)).collect(),
        });
        let levels = feature.properties.get("building:levels").and_then(|l| l.parse::<f64>().ok());
        city.buildings.push(Building {
            landmark: feature.properties.get("building").is_some_and(|b| b == "church"),
            footprint: footprint.collect(),
            ..building(Vec::new(), levels.map_or(9.0, |l| 3.0 * l + 1.0))
        });
    }
    for feature in &roads.features {
        let Geometry::Lines(lines) = &feature.geometry else { continue };
        let class = class_of(feature.properties.get("highway").map(String::as_str));
        city.ways.extend(lines.iter().map(|line| way(class, &metric.points(line))));
    }
    city
}
