//! A city as it is mapped: buildings, ways and land cover; plain data that pictures and generalisation start from.

use crate::Texture;
use belvedere_core::{DVec2, DVec3};
use glam::Vec2;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A city. Coordinates are those of the file after loading, and those of the scene once it is placed there.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct City {
    /// Buildings.
    pub buildings: Vec<Building>,
    /// Solids that are not buildings.
    pub structures: Vec<Structure>,
    /// Centre lines of streets, railways and rivers.
    pub ways: Vec<Way>,
    /// Land cover.
    pub areas: Vec<CityArea>,
    /// Pictures on faces.
    pub pictures: Vec<Arc<Texture>>,
}

/// What blocks of a level of abstraction keep of their buildings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// Their mean height, weighted by area.
    #[default]
    Height,
    /// Their volume: blocks are lower where they cover more ground than their buildings.
    Volume,
}

/// A polygon in plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polygon {
    /// Outer ring, counter-clockwise, closed implicitly, at least 3 vertices.
    pub outer: Vec<DVec2>,
    /// Holes, clockwise, closed implicitly.
    pub holes: Vec<Vec<DVec2>>,
}

/// Source of the height of a building.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum HeightSource {
    /// The shape itself: median of the roof over the ground.
    Shape,
    /// A height attribute.
    Stated,
    /// Number of storeys times 3 m, plus 1 m.
    Levels,
    /// Unknown: 9 m.
    Assumed,
}

/// A building.
#[derive(Debug, Clone, PartialEq)]
pub struct Building {
    /// Id in the file, possibly empty.
    pub id: String,
    /// Name, possibly empty.
    pub name: String,
    /// Whether the file's attributes make it a landmark (church, tower, monument and the like).
    pub landmark: bool,
    /// Outline in plan, one polygon or several.
    pub footprint: Vec<Polygon>,
    /// Height of its ground, metres over the file's datum; `None` = it stands on the terrain.
    pub base_m: Option<f64>,
    /// Height over its ground, metres, > 0.
    pub height_m: f64,
    /// Source of the height.
    pub height_source: HeightSource,
    /// Its surfaces; empty = the footprint extruded to its height under a flat roof. Their heights are over the file's datum, or over the
    /// ground where it stands on the terrain (`base_m` is `None`).
    pub faces: Vec<CityFace>,
}

/// A solid that is no building.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// Id in the file, possibly empty.
    pub id: String,
    /// Name, possibly empty.
    pub name: String,
    /// Kind of the solid.
    pub kind: StructureKind,
    /// Its surfaces, at least one.
    pub faces: Vec<CityFace>,
}

/// Kinds of solids that are no buildings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum StructureKind {
    /// Bridges.
    Bridge,
    /// Trees and hedges.
    Vegetation,
    /// Tunnels, installations, furniture and the rest.
    Other,
}

/// A plane surface in space.
#[derive(Debug, Clone, PartialEq)]
pub struct CityFace {
    /// Role of the face in its solid.
    pub surface: Surface,
    /// Rings, outer first, then holes, closed implicitly; the outer one counter-clockwise seen from outside.
    pub rings: Vec<Vec<DVec3>>,
    /// Picture on the face, if it has one.
    pub picture: Option<FacePicture>,
}

/// A picture on a face.
#[derive(Debug, Clone, PartialEq)]
pub struct FacePicture {
    /// Its number in [`City::pictures`].
    pub number: u32,
    /// Position in it of every vertex of the face's rings: (0, 0) is its top left corner, (1, 1) its bottom right.
    pub rings: Vec<Vec<Vec2>>,
}

/// Semantics of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Surface {
    /// Roof.
    Roof,
    /// Wall, closure surface.
    Wall,
    /// Ground, underside.
    Ground,
    /// Not stated in the file.
    Other,
}

/// A centre line.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// Name, possibly empty.
    pub name: String,
    /// Class of the road, railway or river.
    pub class: WayClass,
    /// Vertices, at least 2.
    pub points: Vec<DVec2>,
}

/// Classes of ways, of OpenStreetMap's `highway`, `railway` and `waterway`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum WayClass {
    /// Motorway, trunk road and their ramps.
    Motorway,
    /// Primary road.
    Primary,
    /// Secondary road.
    Secondary,
    /// Tertiary road.
    Tertiary,
    /// Residential and unclassified streets.
    Residential,
    /// Service roads, yards, tracks.
    Service,
    /// Footways, paths, steps, cycleways.
    Footway,
    /// Railways and trams.
    Rail,
    /// Rivers, canals, streams.
    Waterway,
}

/// A piece of land cover.
#[derive(Debug, Clone, PartialEq)]
pub struct CityArea {
    /// Name, possibly empty.
    pub name: String,
    /// Kind of land cover.
    pub cover: LandCover,
    /// Outline in plan, at least one polygon.
    pub polygons: Vec<Polygon>,
}

/// Kinds of land cover.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LandCover {
    /// Lakes, rivers, canals, basins.
    Water,
    /// Parks, gardens, meadows, cemeteries.
    Green,
    /// Forest and scrub.
    Forest,
    /// Streets, squares, parking.
    Road,
    /// Railway land.
    Rail,
    /// Everything else.
    Other,
}
