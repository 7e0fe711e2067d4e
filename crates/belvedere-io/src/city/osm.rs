//! OpenStreetMap: buildings, streets, railways, rivers and land cover from tagged ways and multipolygons.

mod features;
mod pbf;
mod read;

pub(crate) use features::vectors;

use super::attributes;
use super::footprints::{cover, way_class};
use super::parts::{self, Tagged};
use super::plan::{self, Repairs};
use super::{CityAbout, CityFile, IoError, Loaded};
use crate::crs::CoordinateSystem;
use belvedere_core::polygon::{doubled_area, is_inside};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{City, CityArea, Polygon, Way, WayClass};
use glam::DVec2;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

type Tags = BTreeMap<String, String>;

/// Values of tags for which an object is not a way, or not a visible one.
const NOT_WAYS: [(&str, &[&str]); 3] = [
    ("highway", &["proposed", "construction", "platform", "rest_area", "services", "abandoned", "razed", "raceway"]),
    (
        "railway",
        &["proposed", "construction", "platform", "station", "abandoned", "razed", "disused", "subway", "dismantled"],
    ),
    ("waterway", &["dam", "weir", "riverbank", "dock", "boatyard", "fuel", "lock_gate", "dam_section"]),
];
/// Land forms that are lines, even where they close.
const NOT_AREAS: [&str; 7] = ["coastline", "cliff", "ridge", "arete", "tree_row", "valley", "earth_bank"];

/// A way of interest: its tags, and the numbers of its nodes.
struct Line {
    tags: Tags,
    nodes: Vec<i64>,
}

/// A multipolygon of interest.
struct Relation {
    id: i64,
    tags: Tags,
    ways: Vec<i64>,
}

/// The ways and relations of a file, and the positions of their nodes.
#[derive(Default)]
struct Map {
    relations: Vec<Relation>,
    ways: BTreeMap<i64, Line>,
    nodes: HashMap<i64, DVec2>,
    counts: [usize; 3],
    /// Why the file ends too early.
    cut: Option<String>,
}

/// Numbers of objects that were left out.
#[derive(Default)]
struct Lost {
    nodes: usize,
    polygons: usize,
    relations: usize,
    underground: usize,
}

pub(super) fn load(path: &Path, bytes: &[u8], format: &'static str) -> Result<Loaded<CityFile>, IoError> {
    let map = Map::of_file(path, bytes, format)?;
    let (mut lost, mut repairs) = (Lost::default(), Repairs::default());
    let city = map.city(&mut lost, &mut repairs);
    if let Some(why) = map.cut.as_ref().filter(|_| city == City::default()) {
        return Err(read::damaged(path, format, why));
    }
    if city == City::default() {
        let [nodes, ways, relations] = map.counts;
        let reason = format!(
            "{format} of {nodes} nodes, {ways} ways and {relations} relations holds no building, way or land cover; choose another extract"
        );
        return Err(IoError::format(path, reason));
    }
    let say = |count: usize, what: &str| Warning::counted(WarningKind::Ignored, count, what);
    let warnings = map
        .said_of_cut(format)
        .into_iter()
        .chain(repairs.warnings())
        .chain(say(lost.nodes, "vertices of ways are not in the file; their ways are cut there"))
        .chain(say(lost.polygons, "polygons with vertices that are not in the file were left out"))
        .chain(say(lost.underground, "buildings and ways that lie underground were left out"))
        .chain(say(lost.relations, "multipolygons do not close in the file and were left out"))
        .map(|w| w.in_file(path))
        .collect();
    let crs = CoordinateSystem::wgs84().map_err(|e| IoError::format(path, e.to_string()))?;
    let (format, reference) = (format.into(), crs.name().to_owned());
    let (crs, lods, about) = (Some(crs), vec!["0".into()], map.about());
    let file = CityFile { path: path.into(), format, crs, reference, lods, city, about };
    Ok(Loaded::new(file, warnings))
}

impl Map {
    /// What the tags say of buildings.
    fn about(&self) -> Vec<CityAbout> {
        let of_ways = self.ways.iter().map(|(id, line)| (format!("way/{id}"), &line.tags));
        let of_relations = self.relations.iter().map(|r| (format!("relation/{}", r.id), &r.tags));
        let buildings = of_ways.chain(of_relations).filter(|(_, tags)| is_building(tags));
        buildings.map(|(id, tags)| CityAbout { id, name: attributes::name(tags), attributes: tags.clone() }).collect()
    }

    fn city(&self, lost: &mut Lost, repairs: &mut Repairs) -> City {
        let mut city = City::default();
        let mut buildings = Vec::new();
        for relation in &self.relations {
            if is_building(&relation.tags) && parts::is_underground(&relation.tags) {
                lost.underground += 1;
                continue;
            }
            let polygons = self.polygons(&relation.ways, repairs);
            if polygons.is_empty() {
                lost.relations += 1;
            } else {
                let id = format!("relation/{}", relation.id);
                add(&mut city, &mut buildings, id, &relation.tags, polygons, repairs);
            }
        }
        let of_building = |r: &&Relation| is_building(&r.tags);
        let drawn: HashSet<i64> = self.relations.iter().filter(of_building).flat_map(|r| &r.ways).copied().collect();
        for (id, line) in self.ways.iter().filter(|(_, line)| is_wanted(&line.tags)) {
            if is_building(&line.tags) && drawn.contains(id) {
                continue; // tagged twice: the outline of a building with courtyards
            }
            if is_building(&line.tags) && parts::is_underground(&line.tags) || is_tunnel(&line.tags) {
                lost.underground += 1;
                continue;
            }
            let closed = line.nodes.len() > 3 && line.nodes.first() == line.nodes.last();
            if closed && is_area(&line.tags) {
                match self.places(&line.nodes) {
                    Some(ring) => {
                        let polygon = plan::polygon([ring], repairs);
                        let polygons = polygon.into_iter().collect();
                        add(&mut city, &mut buildings, format!("way/{id}"), &line.tags, polygons, repairs);
                    }
                    None => lost.polygons += 1,
                }
            } else if let Some(class) = class(&line.tags) {
                lost.nodes += line.nodes.iter().filter(|n| !self.nodes.contains_key(n)).count();
                for points in self.pieces(&line.nodes) {
                    city.ways.push(Way { name: attributes::name(&line.tags), class, points });
                }
            }
        }
        city.buildings = parts::assembled(buildings).0;
        city
    }

    fn places(&self, nodes: &[i64]) -> Option<Vec<DVec2>> {
        nodes.iter().map(|n| self.nodes.get(n).copied()).collect()
    }

    /// Runs of at least two nodes whose positions are known.
    fn pieces(&self, nodes: &[i64]) -> Vec<Vec<DVec2>> {
        let known = nodes.split(|n| !self.nodes.contains_key(n)).filter_map(|run| self.places(run));
        known.filter(|run| run.len() >= 2).collect()
    }

    /// Polygons of the rings that the ways of a multipolygon form; roles are ignored: a ring within an odd number of
    /// others is a hole of the smallest of them.
    fn polygons(&self, ways: &[i64], repairs: &mut Repairs) -> Vec<Polygon> {
        let lines: Vec<&[i64]> = ways.iter().filter_map(|id| self.ways.get(id)).map(|l| l.nodes.as_slice()).collect();
        let mut rings: Vec<(f64, Vec<DVec2>)> = closed_rings(&lines)
            .iter()
            .filter_map(|nodes| self.places(nodes))
            .map(|ring| (doubled_area(&ring).abs(), ring))
            .collect();
        rings.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut groups: Vec<Option<Vec<Vec<DVec2>>>> = Vec::new();
        for (k, (_, ring)) in rings.iter().enumerate() {
            let around: Vec<usize> = (0..k).filter(|&j| contains(&rings[j].1, ring)).collect();
            let hole_of = around.last().filter(|_| around.len() % 2 == 1).and_then(|&j| groups[j].as_mut());
            match hole_of {
                Some(group) => {
                    group.push(ring.clone());
                    groups.push(None);
                }
                None => groups.push(Some(vec![ring.clone()])),
            }
        }
        groups.into_iter().flatten().filter_map(|rings| plan::polygon(rings, repairs)).collect()
    }
}

fn is_building(tags: &Tags) -> bool {
    tags.get("building").is_some_and(|b| b != "no") || is_part(tags)
}

fn is_part(tags: &Tags) -> bool {
    tags.get("building:part").is_some_and(|b| b != "no") && tags.get("building").is_none_or(|b| b == "no")
}

/// Whether it is a street or railway under the ground; passages through buildings do not count.
fn is_tunnel(tags: &Tags) -> bool {
    let dug =
        tags.get("tunnel").is_some_and(|t| t == "yes") || tags.get("location").is_some_and(|l| l == "underground");
    dug && !is_building(tags) && (tags.contains_key("highway") || tags.contains_key("railway"))
}

fn is_area(tags: &Tags) -> bool {
    let line = tags.get("natural").is_some_and(|n| NOT_AREAS.contains(&n.as_str()));
    let ring_road = tags.contains_key("highway") && tags.get("area").is_none_or(|a| a != "yes");
    is_building(tags) || (!line && !ring_road && cover(tags).is_some())
}

fn class(tags: &Tags) -> Option<WayClass> {
    let hidden = NOT_WAYS.iter().any(|(key, values)| tags.get(*key).is_some_and(|v| values.contains(&v.as_str())));
    let under = tags.get("tunnel").is_some_and(|t| t == "yes" || t == "culvert");
    way_class(tags).filter(|_| !(hidden || under && tags.contains_key("waterway")))
}

fn is_wanted(tags: &Tags) -> bool {
    is_area(tags) || class(tags).is_some()
}

fn add(
    city: &mut City,
    buildings: &mut Vec<Tagged>,
    id: String,
    tags: &Tags,
    polygons: Vec<Polygon>,
    repairs: &mut Repairs,
) {
    if polygons.is_empty() {
        return;
    }
    if is_building(tags) {
        buildings.push(Tagged::new(id, tags, polygons, is_part(tags), repairs));
    } else if let Some(cover) = cover(tags) {
        city.areas.push(CityArea { name: attributes::name(tags), cover, polygons });
    }
}

/// Rings of ways that are joined end to end; open rings are dropped.
fn closed_rings(lines: &[&[i64]]) -> Vec<Vec<i64>> {
    let mut left: Vec<&[i64]> = lines.iter().copied().filter(|l| l.len() > 1).collect();
    let mut rings = Vec::new();
    while let Some(first) = left.pop() {
        let mut ring = first.to_vec();
        while ring.first() != ring.last() {
            let end = ring[ring.len() - 1];
            let Some(next) = left.iter().position(|l| l[0] == end || l[l.len() - 1] == end) else { break };
            let line = left.swap_remove(next);
            if line[0] == end {
                ring.extend(&line[1..]);
            } else {
                ring.extend(line.iter().rev().skip(1));
            }
        }
        if ring.len() > 3 && ring.first() == ring.last() {
            rings.push(ring);
        }
    }
    rings
}

/// Whether a ring lies within another that it does not cross.
fn contains(outer: &[DVec2], ring: &[DVec2]) -> bool {
    // A vertex that both share does not decide.
    let Some(p) = ring.iter().find(|p| !outer.contains(p)) else { return false };
    is_inside([outer], *p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_join_into_rings_whatever_their_direction() {
        assert_eq!(closed_rings(&[&[1, 2, 3], &[5, 4, 3], &[5, 1]]).len(), 1);
        assert_eq!(closed_rings(&[&[1, 2, 3], &[3, 4]]).len(), 0, "stays open");
        assert_eq!(closed_rings(&[&[1, 2, 3, 1], &[7, 8, 9, 7], &[4], &[]]).len(), 2);
    }

    #[test]
    fn holes_and_islands_are_told_by_where_they_lie() {
        let mut map = Map::default();
        for (k, half) in [8.0, 4.0, 2.0].into_iter().enumerate() {
            let k = k as i64;
            for (j, (x, y)) in [(-half, -half), (half, -half), (half, half), (-half, half)].into_iter().enumerate() {
                map.nodes.insert(10 * k + j as i64, DVec2::new(x, y));
            }
            let nodes = vec![10 * k, 10 * k + 1, 10 * k + 2, 10 * k + 3, 10 * k];
            map.ways.insert(k, Line { tags: Tags::new(), nodes });
        }
        let polygons = map.polygons(&[2, 0, 1], &mut Repairs::default());
        assert_eq!(polygons.iter().map(|p| p.holes.len()).collect::<Vec<_>>(), [1, 0]);
        assert_eq!(doubled_area(&polygons[0].outer), 512.0);
        assert_eq!(doubled_area(&polygons[0].holes[0]), -128.0);
    }
}
