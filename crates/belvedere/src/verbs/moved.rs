//! Lines, areas and points where a view moves them, for other programs: GeoJSON and GeoPackage.

use crate::{Advice, BelvedereError, Session, output};
use belvedere_core::{DVec2, DVec3, Warning, WarningKind};
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_scene::{Crs, Layer, LayerKind, Scene};
use serde_json::{Value, json};
use std::path::Path;

/// Largest difference between the move of a segment's middle and the mean of those of its ends, as a share of its length.
const STRAIGHT: f64 = 0.01;
/// Most times that a segment is halved.
const HALVINGS: u32 = 8;
/// Ending of GeoPackages.
const GEOPACKAGE: &str = "gpkg";

/// A place that a view moves: the displaced point and the true one, scene coordinates.
type Moved = [DVec3; 2];

/// Kind of geometry of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Point,
    Line,
    Area,
}

/// One feature.
#[derive(Debug, Clone)]
struct MovedFeature {
    name: String,
    /// The point; the parts of a line; the rings of an area, outer first and closed.
    parts: Vec<Vec<Moved>>,
}

/// The features of one layer.
#[derive(Debug, Clone)]
struct MovedLayer {
    id: String,
    kind: Kind,
    features: Vec<MovedFeature>,
}

/// Features of a scene as a view shows them, and where they truly are.
#[derive(Debug, Clone)]
pub struct MovedFeatures {
    crs: Crs,
    layers: Vec<MovedLayer>,
    /// Points of lines, areas without such a point in them, and points that the view shows nowhere.
    lost: usize,
}

/// What moves features: the displaced point, `None` where there is none.
type Map<'a> = &'a dyn Fn(DVec3) -> Option<DVec3>;

/// Name of a feature and its parts.
type Named<'a> = (&'a String, Vec<Vec<Moved>>);

impl MovedFeatures {
    /// All lines, areas and points of a session, displaced by all stages of its view. Segments that a stage curves are divided.
    ///
    /// # Errors
    /// [`BelvedereError::Argument`] for a scene without such features.
    pub fn of_session(session: &Session) -> Result<Self, BelvedereError> {
        let view = session.view();
        let moved = |p: DVec3| view.displace(p).ok().map(|d| d.point).filter(|p| p.is_finite());
        let out = Self::new(session.scene(), &|_| true, &moved, true);
        if out.layers.is_empty() {
            let text = "the scene has no lines, areas or points to displace; add such a layer, or give {}";
            return Err(BelvedereError::Argument(Advice::new(text, &["points"])));
        }
        Ok(out)
    }

    /// The lines, areas and points of the layers that `wanted` names.
    ///
    /// * `divided`: whether segments are divided where the displacement differs along them.
    pub(super) fn new(scene: &Scene, wanted: &dyn Fn(&Layer) -> bool, moved: Map<'_>, divided: bool) -> Self {
        let ground = |xy: DVec2| xy.extend(scene.terrain().and_then(|t| t.surface_at(xy)).unwrap_or(0.0));
        let walk = Walk { moved, halvings: if divided { HALVINGS } else { 0 } };
        let (mut layers, mut lost) = (Vec::new(), 0);
        for layer in scene.layers.iter().filter(|layer| wanted(layer)) {
            let (kind, read): (Kind, Vec<Named<'_>>) = match &layer.kind {
                LayerKind::Line(l) => {
                    let mut parts = |points: &[DVec3]| walk.parts(points, &|p| p, &mut lost);
                    (Kind::Line, l.features.iter().map(|f| (&f.name, parts(&f.points))).collect())
                }
                LayerKind::Area(a) => {
                    let mut whole = |rings: &[Vec<DVec2>]| -> Vec<Vec<Moved>> {
                        let ring = |ring: &Vec<DVec2>| {
                            let closed: Vec<DVec3> = ring.iter().chain(ring.first()).map(|p| ground(*p)).collect();
                            let mut missed = 0;
                            let mut parts = walk.parts(&closed, &|p| ground(p.truncate()), &mut missed);
                            if missed == 0 && parts.len() == 1 { parts.pop() } else { None }
                        };
                        let found: Option<Vec<_>> = rings.iter().map(ring).collect();
                        lost += usize::from(found.is_none());
                        found.unwrap_or_default()
                    };
                    (Kind::Area, a.features.iter().map(|f| (&f.name, whole(&f.rings))).collect())
                }
                LayerKind::Point(p) => {
                    let mut one = |at: DVec3| -> Vec<Vec<Moved>> {
                        let now = moved(at);
                        lost += usize::from(now.is_none());
                        now.map(|now| vec![[now, at]]).into_iter().collect()
                    };
                    (Kind::Point, p.features.iter().map(|f| (&f.name, one(f.position))).collect())
                }
                LayerKind::Terrain(_)
                | LayerKind::Boxes(_)
                | LayerKind::Mesh(_)
                | LayerKind::Own(_)
                | LayerKind::Molecule(_)
                | LayerKind::Volume(_) => continue,
            };
            let shown = read.into_iter().filter(|(_, parts)| !parts.is_empty());
            let features = shown.map(|(name, parts)| MovedFeature { name: name.clone(), parts }).collect();
            layers.push(MovedLayer { id: layer.id.clone(), kind, features });
        }
        Self { crs: scene.crs, layers, lost }
    }

    /// Number of features.
    pub fn len(&self) -> usize {
        self.layers.iter().map(|layer| layer.features.len()).sum()
    }

    /// Whether there is no feature.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What was left out, in a sentence.
    pub fn warnings(&self) -> Vec<Warning> {
        let what = "places of features are shown nowhere by this view and were left out, areas with such places whole";
        Warning::counted(WarningKind::Ignored, self.lost, what).into_iter().collect()
    }

    /// Whether a file of this name is written as GeoPackage.
    pub fn is_geopackage(path: &Path) -> bool {
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case(GEOPACKAGE))
    }

    /// Writes a GeoPackage where the name ends in `.gpkg`, else GeoJSON.
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, path: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        if Self::is_geopackage(path) {
            return self.write_geopackage(path, overwrite);
        }
        output::write_text(path, &output::json(&self.geojson()?)?, overwrite)
    }

    /// GeoJSON in WGS 84 (scene coordinates without georeference): heights and positions as displaced, the true positions as property
    /// `true_coordinates`. Positions outside the domain of the coordinate system are left out.
    ///
    /// # Errors
    /// [`BelvedereError::Crs`].
    pub fn geojson(&self) -> Result<Value, BelvedereError> {
        let to_wgs84 = match self.crs {
            Crs::Local => None,
            crs => Some(Transform::new(&CoordinateSystem::from_scene(crs)?, &CoordinateSystem::wgs84()?)?),
        };
        let geographic = |p: DVec3| {
            let xy = to_wgs84.as_ref().map_or(Some(p.truncate()), |t| t.forward_one(p.truncate()))?;
            Some([xy.x, xy.y, p.z])
        };
        let both = |part: &Vec<Moved>| -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
            part.iter().filter_map(|[now, before]| Some((geographic(*now)?, geographic(*before)?))).unzip()
        };
        let mut features = Vec::new();
        for layer in &self.layers {
            for feature in &layer.features {
                let (now, before): (Vec<_>, Vec<_>) = feature.parts.iter().map(both).unzip();
                let (kind, now, before) = match (layer.kind, now.as_slice(), before.as_slice()) {
                    (Kind::Point, [now], [before]) => match (now.first(), before.first()) {
                        (Some(now), Some(before)) => ("Point", json!(now), json!(before)),
                        _ => continue,
                    },
                    (Kind::Point, ..) => continue,
                    (Kind::Line, [now], [before]) => ("LineString", json!(now), json!(before)),
                    (Kind::Line, ..) => ("MultiLineString", json!(now), json!(before)),
                    (Kind::Area, ..) => ("Polygon", json!(now), json!(before)),
                };
                features.push(json!({
                    "type": "Feature",
                    "geometry": { "type": kind, "coordinates": now },
                    "properties": { "name": feature.name, "layer": layer.id, "true_coordinates": before },
                }));
            }
        }
        Ok(json!({ "type": "FeatureCollection", "features": features }))
    }

    /// A table for each layer, in the scene's coordinate system; the true positions are a column of JSON text.
    fn write_geopackage(&self, path: &Path, overwrite: bool) -> Result<(), BelvedereError> {
        use belvedere_io::vector::{FeatureTable, write_geopackage};
        use belvedere_io::{Geometry, VectorFeature, Vertex};
        let vertex = |p: DVec3| Vertex { xy: p.truncate(), z: Some(p.z) };
        let now = |part: &Vec<Moved>| part.iter().map(|[now, _]| vertex(*now)).collect::<Vec<_>>();
        let feature = |layer: &MovedLayer, f: &MovedFeature| {
            let parts: Vec<Vec<Vertex>> = f.parts.iter().map(now).collect();
            let geometry = match layer.kind {
                Kind::Point => Geometry::Points(parts.into_iter().flatten().collect()),
                Kind::Line => Geometry::Lines(parts),
                Kind::Area => {
                    // Rings of this type are closed implicitly.
                    let open = |mut ring: Vec<Vertex>| {
                        ring.pop();
                        ring
                    };
                    Geometry::Polygons(vec![parts.into_iter().map(open).collect()])
                }
            };
            let before: Vec<Vec<[f64; 3]>> =
                f.parts.iter().map(|part| part.iter().map(|[_, before]| before.to_array()).collect()).collect();
            let properties = [("name", f.name.clone()), ("true_coordinates", json!(before).to_string())];
            let properties = properties.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
            VectorFeature { name: f.name.clone(), properties, style: None, geometry }
        };
        let table = |layer: &MovedLayer| FeatureTable {
            name: layer.id.clone(),
            features: layer.features.iter().map(|f| feature(layer, f)).collect(),
        };
        let crs = match self.crs {
            Crs::Local => CoordinateSystem::local(),
            crs => CoordinateSystem::from_scene(crs)?,
        };
        let tables: Vec<FeatureTable> = self.layers.iter().map(table).collect();
        Ok(write_geopackage(path, &tables, &crs, overwrite)?)
    }
}

/// Lines along which places move.
struct Walk<'a> {
    moved: Map<'a>,
    halvings: u32,
}

impl Walk<'_> {
    /// The parts of a line that are shown; `lost` counts its vertices that are not.
    ///
    /// * `laid`: takes a point between two vertices to where the line truly is.
    fn parts(&self, line: &[DVec3], laid: &dyn Fn(DVec3) -> DVec3, lost: &mut usize) -> Vec<Vec<Moved>> {
        let (mut out, mut part): (Vec<Vec<Moved>>, Vec<Moved>) = (Vec::new(), Vec::new());
        for at in line {
            let Some(now) = (self.moved)(*at) else {
                *lost += 1;
                out.extend(Some(std::mem::take(&mut part)).filter(|p| p.len() > 1));
                continue;
            };
            if let Some(last) = part.last().copied() {
                self.between(last, [now, *at], laid, self.halvings, &mut part);
            }
            part.push([now, *at]);
        }
        out.extend(Some(part).filter(|p| p.len() > 1));
        out
    }

    /// Adds points between two, where the line is curved.
    fn between(&self, a: Moved, b: Moved, laid: &dyn Fn(DVec3) -> DVec3, left: u32, out: &mut Vec<Moved>) {
        let Some(left) = left.checked_sub(1) else { return };
        let at = laid(a[1].midpoint(b[1]));
        let Some(now) = (self.moved)(at) else { return };
        let bend = (now - at) - (a[0] - a[1]).midpoint(b[0] - b[1]);
        if bend.length() <= STRAIGHT * a[0].distance(b[0]) {
            return;
        }
        self.between(a, [now, at], laid, left, out);
        out.push([now, at]);
        self.between([now, at], b, laid, left, out);
    }
}
