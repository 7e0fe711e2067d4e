//! CityGML 1 and 2: buildings and their parts by the surfaces that bound them, bridges, water, vegetation, streets.

use super::collect::{Collector, Lod, Shown};
use super::gml::{self, Node};
use super::looks::Looks;
use super::pictures::PictureList;
use super::plan;
use super::reference::Reference;
use super::{CityFile, IoError, Loaded};
use crate::Limits;
use belvedere_scene::{CityFace, Surface};
use glam::{DMat4, DVec3};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// Longest chain of references.
const MAX_HOPS: usize = 8;

pub(super) fn load(path: &Path, text: &str, lod: Option<&str>, limits: &Limits) -> Result<Loaded<CityFile>, IoError> {
    let fail = |reason: String| IoError::format(path, format!("CityGML: {reason}"));
    let root = gml::parse(text.trim_start_matches('\u{feff}')).map_err(fail)?;
    if root.name != "CityModel" {
        return Err(fail(format!("its root is <{}>, not <CityModel>; choose another file", root.name)));
    }
    if text.contains("opengis.net/citygml/3.") {
        return Err(fail("is version 3; 1.0 and 2.0 are read, citygml-tools or FME turn it into 2.0".into()));
    }
    let version = if text.contains("opengis.net/citygml/2.0") { "2.0" } else { "1.0" };
    let mut document = Document::of(&root);
    let reference = Reference::of(document.srs);
    document.north_first = reference.north_first;
    let mut collector = Collector::new(lod);
    document.looks = Looks::of(&root, &mut collector.pictures);
    for object in document.objects() {
        let about = attributes(object);
        let shown = document.shown(object, &mut collector.pictures).map_err(|e| {
            fail(format!("{} \"{}\": {e}; correct it, or export the file again", object.name, object.id))
        })?;
        collector.add(&object.id, kind(&object.name), &about, shown);
    }
    collector.finish(path, format!("CityGML {version}"), reference, limits)
}

/// A document and the targets of its references.
struct Document<'n> {
    root: &'n Node,
    ids: HashMap<&'n str, &'n Node>,
    srs: &'n str,
    north_first: bool,
    looks: Looks<'n>,
}

/// Context of gathering within an element: values inherited by its children.
#[derive(Clone)]
struct At {
    lod: String,
    surface: Option<Surface>,
    dimension: Option<usize>,
    reversed: bool,
    hops: usize,
}

/// Faces of an object gathered so far.
struct Gathered<'n> {
    /// Level of detail and face.
    faces: Vec<(String, NamedFace<'n>)>,
    /// Ids within the object: references to them would show a face twice.
    own: HashSet<&'n str>,
    /// References that lead nowhere.
    lost: usize,
}

/// The ids of the rings of a face, possibly empty, whether they are reversed, and the face.
type NamedFace<'n> = (Vec<(&'n str, bool)>, CityFace);

impl<'n> Document<'n> {
    fn of(root: &'n Node) -> Self {
        let (mut ids, mut srs) = (HashMap::new(), "");
        root.walk(&mut |node| {
            if !node.id.is_empty() {
                ids.insert(node.id.as_str(), node);
            }
            if srs.is_empty() {
                srs = &node.srs;
            }
        });
        Self { root, ids, srs, north_first: false, looks: Looks::default() }
    }

    fn objects(&self) -> impl Iterator<Item = &'n Node> + use<'n> {
        let members = self.root.children.iter();
        let members =
            members.filter(|c| matches!(c.name.as_str(), "cityObjectMember" | "featureMember" | "featureMembers"));
        members.flat_map(|member| &member.children)
    }

    fn shown(&self, object: &'n Node, pictures: &mut PictureList) -> Result<Shown, String> {
        let mut gathered = Gathered { faces: Vec::new(), own: HashSet::new(), lost: 0 };
        object.walk(&mut |node| {
            gathered.own.insert(&node.id);
        });
        let at = At { lod: "0".into(), surface: None, dimension: None, reversed: false, hops: 0 };
        self.gather(object, &at, &mut gathered)?;
        let mut shown = Shown { lost: gathered.lost, ..Shown::default() };
        for (lod, (rings, mut face)) in gathered.faces {
            self.looks.dress(&rings, &mut face, pictures);
            shown.faces.entry(Lod::of_text(&lod)).or_default().push(face);
        }
        Ok(shown)
    }

    fn gather(&self, node: &'n Node, at: &At, out: &mut Gathered<'n>) -> Result<(), String> {
        let mut at = at.clone();
        at.dimension = node.dimension.or(at.dimension);
        at.reversed ^= node.reversed;
        if let Some(lod) =
            node.name.strip_prefix("lod").and_then(|rest| rest.get(..1)).filter(|d| *d <= "4" && *d >= "0")
        {
            at.lod = lod.to_owned();
        }
        match node.name.as_str() {
            "RoofSurface" | "OuterCeilingSurface" => at.surface = Some(Surface::Roof),
            "WallSurface" | "ClosureSurface" | "Window" | "Door" => at.surface = Some(Surface::Wall),
            "GroundSurface" | "OuterFloorSurface" => at.surface = Some(Surface::Ground),
            // Rooms are not visible; roof edges repeat the outline.
            "interiorRoom" | "appearance" | "lod0RoofEdge" => return Ok(()),
            "ImplicitGeometry" => return self.implicit(node, &at, out),
            "Polygon" | "PolygonPatch" | "Triangle" | "Rectangle" => {
                let face = self.face(node, &at)?;
                out.faces.extend(face.map(|face| (at.lod.clone(), face)));
                return Ok(());
            }
            _ => {}
        }
        self.follow(node, &at, out)?;
        node.children.iter().try_for_each(|child| self.gather(child, &at, out))
    }

    /// Gathers the target of a reference, unless it belongs to the object itself.
    fn follow(&self, node: &'n Node, at: &At, out: &mut Gathered<'n>) -> Result<(), String> {
        let geometry = matches!(node.name.as_str(), "surfaceMember" | "baseSurface" | "relativeGMLGeometry");
        if !geometry || node.href.is_empty() || out.own.contains(node.href.as_str()) || at.hops >= MAX_HOPS {
            return Ok(());
        }
        match self.ids.get(node.href.as_str()) {
            Some(target) => self.gather(target, &At { hops: at.hops + 1, ..at.clone() }, out),
            None => {
                out.lost += 1;
                Ok(())
            }
        }
    }

    /// Gathers a shape that is used at several positions, moved to its position.
    fn implicit(&self, node: &'n Node, at: &At, out: &mut Gathered<'n>) -> Result<(), String> {
        let Some(shape) = node.child("relativeGMLGeometry") else { return Ok(()) };
        let mut there = Gathered { faces: Vec::new(), own: HashSet::new(), lost: 0 };
        let plain = At { dimension: None, ..at.clone() };
        Self { north_first: false, ids: self.ids.clone(), looks: Looks::default(), ..*self }
            .gather(shape, &plain, &mut there)?;
        out.lost += there.lost;
        let matrix = match node.child("transformationMatrix") {
            Some(matrix) => numbers(matrix)?,
            None => DMat4::IDENTITY.to_cols_array().to_vec(),
        };
        let rows: [f64; 16] = matrix
            .try_into()
            .map_err(|m: Vec<f64>| format!("line {}: a matrix of {} numbers, not 16", node.line, m.len()))?;
        let matrix = DMat4::from_cols_array(&rows).transpose();
        let place = match node.child("referencePoint") {
            Some(place) => self.positions(place, at.dimension)?.first().copied(),
            None => None,
        };
        let place = place.ok_or_else(|| format!("line {}: a shape without a place", node.line))?;
        for (lod, (rings, mut face)) in there.faces {
            for p in face.rings.iter_mut().flatten() {
                let there = plan::position(matrix.transform_point3(*p) + place);
                *p = there.map_err(|e| format!("line {}: a shape {e}", node.line))?;
            }
            out.faces.push((lod, (rings, face)));
        }
        Ok(())
    }

    fn face(&self, node: &'n Node, at: &At) -> Result<Option<NamedFace<'n>>, String> {
        let dimension = node.dimension.or(at.dimension);
        let of = |names: [&'static str; 2]| node.children.iter().filter(move |c| names.contains(&c.name.as_str()));
        let bounds = of(["exterior", "outerBoundaryIs"]).take(1).chain(of(["interior", "innerBoundaryIs"]));
        let bounds: Vec<&Node> = bounds.collect();
        let name = |bound: &&'n Node| {
            let ring = bound.children.iter().find(|c| matches!(c.name.as_str(), "LinearRing" | "Ring"));
            (ring.map_or("", |ring| ring.id.as_str()), at.reversed)
        };
        let names = bounds.iter().map(name).collect();
        let mut rings = bounds.iter().map(|ring| self.positions(ring, dimension)).collect::<Result<Vec<_>, _>>()?;
        if at.reversed {
            rings.iter_mut().for_each(|ring| ring.reverse());
        }
        if rings.is_empty() {
            return Ok(None);
        }
        let surface = at.surface.unwrap_or_else(|| plan::surface_of(&rings));
        Ok(Some((names, CityFace { surface, rings, picture: None })))
    }

    /// All positions within an element.
    fn positions(&self, node: &Node, dimension: Option<usize>) -> Result<Vec<DVec3>, String> {
        let (mut points, mut failure) = (Vec::new(), None);
        node.walk(&mut |n| {
            if matches!(n.name.as_str(), "posList" | "pos" | "coordinates") && failure.is_none() {
                match placed(n, n.dimension.or(dimension)) {
                    Ok(some) => points.extend(some),
                    Err(e) => failure = Some(e),
                }
            }
        });
        if self.north_first {
            points.iter_mut().for_each(|p: &mut DVec3| *p = DVec3::new(p.y, p.x, p.z));
        }
        failure.map_or(Ok(points), Err)
    }
}

fn placed(node: &Node, dimension: Option<usize>) -> Result<Vec<DVec3>, String> {
    let values = numbers(node)?;
    let dimension = dimension.unwrap_or(3);
    if !(2..=3).contains(&dimension) || values.len() % dimension != 0 {
        let (line, name, count) = (node.line, &node.name, values.len());
        return Err(format!("line {line}: {name} of {count} numbers does not divide into positions of {dimension}"));
    }
    let place = |v: &[f64]| plan::position(DVec3::new(v[0], v[1], v.get(2).copied().unwrap_or(0.0)));
    let places: Result<_, String> = values.chunks_exact(dimension).map(place).collect();
    places.map_err(|e| format!("line {}: a position {e}", node.line))
}

fn numbers(node: &Node) -> Result<Vec<f64>, String> {
    let words = node.text.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty());
    let number = |word: &str| {
        let value = word.parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| format!("line {}: \"{}\" in {} is no finite number", node.line, short(word), node.name))
    };
    words.map(number).collect()
}

fn short(word: &str) -> String {
    word.chars().take(24).collect()
}

/// Attributes of an object, by lower-case names: its own, and generic ones.
fn attributes(object: &Node) -> BTreeMap<String, String> {
    let mut about = BTreeMap::new();
    for child in &object.children {
        if let (false, Some(value)) = (child.label.is_empty(), child.child("value")) {
            about.insert(child.label.to_lowercase(), value.text.clone());
        } else if child.children.is_empty() && !child.text.is_empty() && child.text != object.id {
            about.entry(child.name.to_lowercase()).or_insert_with(|| child.text.clone());
        }
    }
    about
}

/// The kind under the name that CityJSON has for it.
fn kind(name: &str) -> &str {
    match name {
        "TransportationComplex" => "Road",
        "Square" => "TransportSquare",
        other => other,
    }
}
