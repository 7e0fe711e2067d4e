//! The objects of an OpenStreetMap file as features with their tags.

use super::{Map, Tags, class, is_area, is_tunnel};
use crate::city::attributes;
use crate::city::parts::is_underground;
use crate::city::plan::Repairs;
use crate::crs::CoordinateSystem;
use crate::vector::{Geometry, VectorFeature, Vectors, Vertex};
use crate::{IoError, Loaded};
use glam::DVec2;
use std::path::Path;

/// Buildings and land cover as polygons, streets, railways and rivers as lines; properties are the tags, and `id` (`way/12`). What lies
/// underground is left out.
///
/// # Errors
/// [`IoError::Format`]: damaged, or without such objects.
pub(crate) fn vectors(path: &Path, bytes: &[u8], format: &'static str) -> Result<Loaded<Vectors>, IoError> {
    let map = Map::of_file(path, bytes, format)?;
    let features = map.features();
    if let Some(why) = map.cut.as_ref().filter(|_| features.is_empty()) {
        return Err(super::read::damaged(path, format, why));
    }
    if features.is_empty() {
        return Err(IoError::format(
            path,
            format!("{format} holds no building, way or land cover; choose another extract"),
        ));
    }
    let crs = CoordinateSystem::wgs84().map_err(|e| IoError::format(path, e.to_string()))?;
    let value = Vectors { path: path.into(), format, layer: String::new(), crs, crs_stated: true, features };
    Ok(Loaded::new(value, map.said_of_cut(format).into_iter().map(|w| w.in_file(path)).collect()))
}

impl Map {
    fn features(&self) -> Vec<VectorFeature> {
        let mut out = Vec::new();
        for relation in self.relations.iter().filter(|r| !is_underground(&r.tags)) {
            let polygons = self.polygons(&relation.ways, &mut Repairs::default());
            let rings = |p: &belvedere_scene::Polygon| {
                std::iter::once(&p.outer).chain(&p.holes).map(|ring| flat(ring)).collect::<Vec<_>>()
            };
            let polygons: Vec<_> = polygons.iter().map(rings).collect();
            if !polygons.is_empty() {
                out.push(feature(format!("relation/{}", relation.id), &relation.tags, Geometry::Polygons(polygons)));
            }
        }
        for (id, line) in &self.ways {
            if is_underground(&line.tags) || is_tunnel(&line.tags) {
                continue;
            }
            let closed = line.nodes.len() > 3 && line.nodes.first() == line.nodes.last();
            let geometry = if closed && is_area(&line.tags) {
                self.places(&line.nodes).map(|ring| Geometry::Polygons(vec![vec![flat(&ring[1..])]]))
            } else {
                let pieces = class(&line.tags).map(|_| self.pieces(&line.nodes)).filter(|pieces| !pieces.is_empty());
                pieces.map(|pieces| Geometry::Lines(pieces.iter().map(|piece| flat(piece)).collect()))
            };
            out.extend(geometry.map(|geometry| feature(format!("way/{id}"), &line.tags, geometry)));
        }
        out
    }
}

fn flat(points: &[DVec2]) -> Vec<Vertex> {
    points.iter().map(|&xy| Vertex { xy, z: None }).collect()
}

fn feature(id: String, tags: &Tags, geometry: Geometry) -> VectorFeature {
    let mut properties = tags.clone();
    properties.insert("id".into(), id);
    VectorFeature { style: None, name: attributes::name(tags), properties, geometry }
}
