//! CityJSON 1.0 to 2.0, and CityJSONSeq.

use super::attributes::Attributes;
use super::collect::{Collector, Lod, Shown};
use super::pictures::{PictureList, wrap};
use super::plan;
use super::reference::Reference;
use super::{CityFile, IoError, Loaded};
use crate::{Limits, exchanged};
use belvedere_scene::{CityFace, Surface};
use glam::{DMat4, DVec2, DVec3, Vec2};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// Deepest nesting of parts.
const MAX_DEPTH: usize = 16;

impl Attributes for Map<String, Value> {
    fn text(&self, key: &str) -> Option<String> {
        let (_, value) = self.iter().find(|(k, _)| k.eq_ignore_ascii_case(key))?;
        match value {
            Value::String(text) => Some(text.trim().to_owned()).filter(|t| !t.is_empty()),
            Value::Number(number) => Some(number.to_string()),
            _ => None,
        }
    }

    fn all(&self) -> BTreeMap<String, String> {
        self.keys().filter_map(|key| Some((key.clone(), self.text(key)?))).collect()
    }
}

/// Vertices and templates to which indices refer.
struct Vertices {
    points: Vec<DVec3>,
    templates: Vec<Value>,
    template_points: Vec<DVec3>,
}

type Fail = String;

pub(super) fn load(path: &Path, text: &str, lod: Option<&str>, limits: &Limits) -> Result<Loaded<CityFile>, IoError> {
    let mut reader = Reader { out: Collector::new(lod), are_degrees: false };
    let (head, format) =
        reader.read(text.trim_start_matches('\u{feff}')).map_err(|reason| IoError::format(path, reason))?;
    // Coordinates of CityJSON are x, y, z for every system.
    reader.out.finish(path, format, Reference::of(system(&head)), limits)
}

struct Reader<'l> {
    out: Collector<'l>,
    /// Whether the system that the file names has longitude and latitude.
    are_degrees: bool,
}

impl Reader<'_> {
    /// Reads all documents of a text; the first, which says what holds for all, and the name of the format.
    fn read(&mut self, text: &str) -> Result<(Value, String), Fail> {
        if let Ok(whole) = serde_json::from_str::<Value>(text) {
            let version = version(&whole)?;
            self.document(&whole, &whole)?;
            return Ok((whole, format!("CityJSON {version}")));
        }
        let mut head: Option<Value> = None;
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).peekable();
        while let Some((i, line)) = lines.next() {
            let value: Value = match serde_json::from_str(line) {
                Ok(value) => value,
                Err(e) if e.is_eof() && lines.peek().is_none() && i > 1 => {
                    self.out.cut = Some(format!("its last line, {}, is not whole; what stands before is read", i + 1));
                    break;
                }
                Err(e) => {
                    let fault = crate::json_fault(&e);
                    return Err(format!("line {}: no valid JSON ({fault}); it is damaged or cut off", i + 1));
                }
            };
            if head.is_none() {
                version(&value).map_err(|e| format!("line {}: {e}", i + 1))?;
            }
            self.document(&value, head.as_ref().unwrap_or(&value)).map_err(|e| format!("line {}: {e}", i + 1))?;
            head.get_or_insert(value);
        }
        Ok((head.ok_or("is empty")?, "CityJSONSeq".into()))
    }

    /// * `head`: holds the transform of the vertices.
    fn document(&mut self, document: &Value, head: &Value) -> Result<(), Fail> {
        self.are_degrees = Reference::of(system(head)).crs.is_some_and(|crs| crs.is_geographic());
        let objects = document.get("CityObjects").and_then(Value::as_object);
        let objects = objects.ok_or("has no CityObjects; it is no CityJSON, or damaged")?;
        let mut vertices = Vertices::of(document, head)?;
        let positions = vertices.points.iter().map(|p| p.truncate());
        if let Some(reason) = exchanged::reason(positions, extent(document).or(extent(head)), self.are_degrees) {
            vertices.points.iter_mut().for_each(|p| *p = DVec3::new(p.y, p.x, p.z));
            self.out.exchanged.get_or_insert(reason);
        }
        let looks = Looks::of(document, head, &mut self.out.pictures);
        let mut shown: BTreeMap<&str, Shown> = BTreeMap::new();
        let fail = |id: &str, e: &str| format!("object \"{id}\": {e}; the file is damaged, export it again");
        for (id, object) in objects.iter().filter(|(_, object)| !object.is_null()) {
            let root = root(objects, id);
            let all = shown.entry(root).or_default();
            let geometries = match object.get("geometry") {
                Some(Value::Array(list)) => list.as_slice(),
                None | Some(Value::Null) if object.is_object() => &[],
                _ => return Err(fail(id, "its geometry is no list")),
            };
            let pictures = &mut self.out.pictures;
            let shapes = geometries.iter().filter(|g| !g.is_null());
            let read: Vec<_> = shapes.map(|g| (lod(g), vertices.faces(g, &looks, pictures))).collect();
            let other = read.iter().any(|(_, faces)| faces.as_ref().is_ok_and(|f| !f.is_empty()));
            for (lod, faces) in read {
                match faces {
                    Ok(faces) => all.faces.entry(lod).or_default().extend(faces),
                    // Another level of detail shows the object.
                    Err(_) if other => self.out.unread += 1,
                    Err(e) => return Err(fail(id, &e)),
                }
            }
        }
        for (id, shown) in shown {
            self.object(id, &objects[id], shown);
        }
        Ok(())
    }

    fn object(&mut self, id: &str, object: &Value, shown: Shown) {
        let kind = object.get("type").and_then(Value::as_str).unwrap_or_default().trim_start_matches('+');
        let empty = Map::new();
        let about = object.get("attributes").and_then(Value::as_object).unwrap_or(&empty);
        self.out.add(id, kind, about, shown);
    }
}

/// Version of a document, if it is one that is read.
fn version(document: &Value) -> Result<String, Fail> {
    if document.get("type").is_some_and(|t| t == "CityJSONFeature") {
        return Err("is a feature without the document that says its transform and system; put that (\"type\": \"CityJSON\") into the first line".into());
    }
    let version = match document.get("version") {
        Some(Value::String(text)) if !text.trim().is_empty() => text.trim().to_owned(),
        Some(Value::Number(number)) => number.to_string(),
        _ => "of no version".to_owned(),
    };
    let is = |known: &str| version.strip_prefix(known).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    if !["1.0", "1.1", "2.0"].into_iter().any(is) {
        return Err(format!("is CityJSON {version}; versions 1.0, 1.1 and 2.0 are read"));
    }
    Ok(version)
}

/// The extent that a document states, in plan.
fn extent(document: &Value) -> Option<[DVec2; 2]> {
    let stated = document.pointer("/metadata/geographicalExtent")?.as_array()?;
    let numbers = stated.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>()?;
    let [west, south, _, east, north, _] = numbers[..] else { return None };
    Some([DVec2::new(west, south), DVec2::new(east, north)])
}

/// The system that a document names.
fn system(document: &Value) -> &str {
    document.pointer("/metadata/referenceSystem").and_then(Value::as_str).unwrap_or_default()
}

/// The outermost object that an object is a part of.
fn root<'o>(objects: &'o Map<String, Value>, id: &'o str) -> &'o str {
    let mut at = id;
    for _ in 0..MAX_DEPTH {
        let parent = objects.get(at).and_then(|o| o.pointer("/parents/0")).and_then(Value::as_str);
        match parent.and_then(|p| objects.get_key_value(p)) {
            // Members of groups are objects of their own.
            Some((parent, object)) if object.get("type").is_none_or(|t| t != "CityObjectGroup") => at = parent,
            _ => break,
        }
    }
    at
}

impl Vertices {
    fn of(document: &Value, head: &Value) -> Result<Self, Fail> {
        let transform = document.get("transform").or(head.get("transform")).filter(|t| !t.is_null());
        let optional = head.get("version").and_then(Value::as_str).is_some_and(|v| v.starts_with("1.0"));
        if transform.is_none() && !optional {
            return Err("has no transform, so its vertices are nowhere; export it again".into());
        }
        let vector = |key: &str, default: f64| match transform.and_then(|t| t.get(key)) {
            Some(value) => point(value)
                .ok_or_else(|| format!("transform.{key} is not three finite numbers; export the file again")),
            None => Ok(DVec3::splat(default)),
        };
        let (scale, translate) = (vector("scale", 1.0)?, vector("translate", 0.0)?);
        if scale.min_element() <= 0.0 {
            return Err(format!("transform.scale is {scale}, its numbers must be above 0; export the file again"));
        }
        let list =
            document.get("vertices").and_then(Value::as_array).ok_or("has no list of vertices; it is damaged")?;
        let place = |(i, value): (usize, &Value)| {
            let p =
                point(value).ok_or_else(|| format!("vertex {i} is not three finite numbers; export the file again"))?;
            plan::position(scale * p + translate).map_err(|e| format!("vertex {i} {e}; correct it or the transform"))
        };
        let points = list.iter().enumerate().map(place).collect::<Result<_, _>>()?;
        let templates = head.get("geometry-templates").or(document.get("geometry-templates"));
        let array =
            |key: &str| templates.and_then(|t| t.get(key)).and_then(Value::as_array).cloned().unwrap_or_default();
        let template_points = array("vertices-templates");
        let template_points: Option<Vec<DVec3>> = template_points.iter().map(point).collect();
        let template_points = template_points.ok_or("a vertex of a template is not three finite numbers")?;
        Ok(Self { points, templates: array("templates"), template_points })
    }

    fn faces(&self, geometry: &Value, looks: &Looks<'_>, pictures: &mut PictureList) -> Result<Vec<CityFace>, Fail> {
        if geometry.get("type").is_some_and(|t| t == "GeometryInstance") {
            return self.instance(geometry, looks, pictures);
        }
        let mut faces = faces(geometry, &self.points)?;
        looks.dress(geometry, &mut faces, pictures);
        Ok(faces)
    }

    /// The faces of a template, moved to the position of its instance.
    fn instance(&self, geometry: &Value, looks: &Looks<'_>, pictures: &mut PictureList) -> Result<Vec<CityFace>, Fail> {
        let number = geometry.get("template").and_then(Value::as_u64).ok_or("an instance names no template")? as usize;
        let template = self.templates.get(number);
        let template =
            template.ok_or_else(|| format!("template {number} does not exist, there are {}", self.templates.len()))?;
        let at = geometry.pointer("/boundaries/0").and_then(Value::as_u64).ok_or("an instance has no place")?;
        let at = *self.points.get(at as usize).ok_or_else(|| missing(at, self.points.len()))?;
        let rows = geometry.get("transformationMatrix").and_then(Value::as_array);
        let rows: Vec<f64> = rows.into_iter().flatten().filter_map(Value::as_f64).collect();
        let rows: [f64; 16] = rows.try_into().map_err(|_| "the matrix of an instance is not 16 numbers")?;
        let matrix = DMat4::from_cols_array(&rows).transpose();
        let mut faces = faces(template, &self.template_points)?;
        looks.dress(template, &mut faces, pictures);
        for p in faces.iter_mut().flat_map(|f| &mut f.rings).flatten() {
            *p = plan::position(matrix.transform_point3(*p) + at).map_err(|e| format!("an instance {e}"))?;
        }
        Ok(faces)
    }
}

/// Textures of a document: its `appearance`.
struct Looks<'d> {
    /// Numbers of the pictures.
    pictures: Vec<u32>,
    places: Vec<Vec2>,
    theme: Option<&'d str>,
}

impl<'d> Looks<'d> {
    /// * `head`: document whose appearance is taken if `document` has none.
    fn of(document: &'d Value, head: &'d Value, pictures: &mut PictureList) -> Self {
        let appearance = document.get("appearance").or(head.get("appearance"));
        let list = |key: &str| appearance.and_then(|a| a.get(key)).and_then(Value::as_array).into_iter().flatten();
        let picture = |texture: &Value| {
            let text = |key: &str| texture.get(key).and_then(Value::as_str).unwrap_or_default();
            pictures.number(text("image"), wrap(text("wrapMode")))
        };
        let numbers = list("textures").map(picture).collect();
        let place = |uv: &Value| {
            let at = |k: usize| uv.get(k).and_then(Value::as_f64).unwrap_or(f64::NAN) as f32;
            Vec2::new(at(0), at(1))
        };
        let theme = appearance.and_then(|a| a.get("default-theme-texture")).and_then(Value::as_str);
        Self { pictures: numbers, places: list("vertices-texture").map(place).collect(), theme }
    }

    /// Gives the faces of a geometry, in their order, their pictures.
    fn dress(&self, geometry: &Value, faces: &mut [CityFace], pictures: &mut PictureList) {
        let Some(themes) = geometry.get("texture").and_then(Value::as_object) else { return };
        let theme = self.theme.and_then(|name| themes.get(name)).or_else(|| themes.values().next());
        let Some(values) = theme.and_then(|t| t.get("values")) else { return };
        let Some(boundaries) = geometry.get("boundaries") else { return };
        let mut of_faces = Vec::with_capacity(faces.len());
        pair(boundaries, Some(values), &mut of_faces);
        for (face, rings) in faces.iter_mut().zip(of_faces) {
            let Some(rings) = rings.and_then(Value::as_array) else { continue };
            let indices = |ring: &Value| ring.as_array().map(|list| list.iter().map(Value::as_u64).collect::<Vec<_>>());
            let rings: Vec<Vec<Option<u64>>> = rings.iter().filter_map(indices).collect();
            // A face without a number has no picture.
            let Some(Some(picture)) = rings.first().and_then(|ring| ring.first()) else { continue };
            let place = |i: &Option<u64>| i.and_then(|i| self.places.get(i as usize)).copied().unwrap_or(Vec2::NAN);
            let places = rings.iter().map(|ring| ring.iter().skip(1).map(place).collect()).collect();
            match self.pictures.get(*picture as usize) {
                Some(number) => face.picture = pictures.on(*number, places, face),
                None => pictures.odd += 1,
            }
        }
    }
}

/// The entry of `values` for each surface, in the order of [`gather`]: lists of lists of numbers are surfaces.
fn pair<'v>(boundaries: &Value, values: Option<&'v Value>, out: &mut Vec<Option<&'v Value>>) {
    let Some(list) = boundaries.as_array() else { return };
    let is_ring = |ring: &Value| ring.as_array().is_some_and(|ring| ring.iter().all(Value::is_u64));
    if !list.is_empty() && list.iter().all(is_ring) {
        out.push(values.filter(|v| v.is_array()));
        return;
    }
    for (i, part) in list.iter().enumerate() {
        pair(part, values.and_then(|v| v.get(i)), out);
    }
}

fn missing(index: u64, count: usize) -> Fail {
    format!("vertex {index} does not exist, there are {count}")
}

fn point(value: &Value) -> Option<DVec3> {
    let [x, y, z] = value.as_array()?.as_slice() else { return None };
    Some(DVec3::new(x.as_f64()?, y.as_f64()?, z.as_f64()?)).filter(|p| p.is_finite())
}

/// All surfaces of a geometry, at any depth of nesting.
fn faces(geometry: &Value, points: &[DVec3]) -> Result<Vec<CityFace>, Fail> {
    let depth = match geometry.get("type").and_then(Value::as_str).unwrap_or_default() {
        "MultiSurface" | "CompositeSurface" => 1,
        "Solid" => 2,
        "MultiSolid" | "CompositeSolid" => 3,
        // Points and lines have no surface.
        "MultiPoint" | "MultiLineString" => return Ok(Vec::new()),
        other => return Err(format!("geometry of type \"{other}\" is not known")),
    };
    let semantics: Vec<Surface> =
        geometry.pointer("/semantics/surfaces").and_then(Value::as_array).into_iter().flatten().map(semantic).collect();
    let mut out = Vec::new();
    let boundaries = geometry.get("boundaries").ok_or("a geometry has no boundaries")?;
    gather(boundaries, geometry.pointer("/semantics/values"), depth, &semantics, points, &mut out)?;
    Ok(out)
}

/// * `depth`: number of lists around a surface.
fn gather(
    boundaries: &Value,
    values: Option<&Value>,
    depth: usize,
    semantics: &[Surface],
    points: &[DVec3],
    out: &mut Vec<CityFace>,
) -> Result<(), Fail> {
    let list = boundaries.as_array().ok_or("boundaries are not nested as their type says")?;
    if depth > 0 {
        for (i, part) in list.iter().enumerate() {
            gather(part, values.and_then(|v| v.get(i)), depth - 1, semantics, points, out)?;
        }
        return Ok(());
    }
    let ring = |ring: &Value| -> Result<Vec<DVec3>, Fail> {
        let numbers = ring.as_array().ok_or("a ring is not a list of vertices")?;
        let vertex = |v: &Value| {
            let index = v.as_u64().ok_or_else(|| format!("{v} is no number of a vertex"))?;
            points.get(index as usize).copied().ok_or_else(|| missing(index, points.len()))
        };
        numbers.iter().map(vertex).collect()
    };
    let rings = list.iter().map(ring).collect::<Result<Vec<_>, _>>()?;
    let told = values.and_then(Value::as_u64).and_then(|i| semantics.get(i as usize)).copied();
    let surface = told.unwrap_or_else(|| plan::surface_of(&rings));
    out.push(CityFace { surface, rings, picture: None });
    Ok(())
}

fn semantic(surface: &Value) -> Surface {
    match surface.get("type").and_then(Value::as_str).unwrap_or_default() {
        "RoofSurface" | "OuterCeilingSurface" => Surface::Roof,
        "WallSurface" | "ClosureSurface" | "Window" | "Door" => Surface::Wall,
        "GroundSurface" | "OuterFloorSurface" => Surface::Ground,
        _ => Surface::Other,
    }
}

fn lod(geometry: &Value) -> Lod {
    match geometry.get("lod") {
        Some(Value::String(text)) => Lod::of_text(text),
        Some(Value::Number(number)) => Lod::of_text(&number.to_string()),
        _ => Lod::of_text("0"),
    }
}
