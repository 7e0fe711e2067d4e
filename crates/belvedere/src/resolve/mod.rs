//! From a document to a scene and a view.

mod boxes;
pub(crate) mod builtin;
mod camera;
pub(crate) mod delta;
mod dem;
mod drape;
mod layers;
mod light;
mod mesh;
mod rays;
pub(crate) mod stages;
pub(crate) mod terrain;
pub(crate) mod validate;
pub(crate) mod vectors;

use crate::scene_file::paths::Roots;
use crate::scene_file::{
    ConstructorKind, Document, EarthDoc, LayerDoc, MapPointDoc, PointDoc, SourceDocument, StageDoc, UnitDoc,
};
use crate::{BelvedereError, Needs, OpenOptions, Session};
use belvedere_core::{DVec2, EarthCurvature, Stage, View};
use belvedere_disocclusion::{TerrainMemory, TerrainReport};
use belvedere_io::crs::{CoordinateSystem, Transform, gaussian_radius_m, utm_epsg};
use belvedere_scene::{Crs, Heightfield, Layer, LayerKind, Light, Scene, Unit};
use std::path::PathBuf;
use std::sync::Arc;
use terrain::Solving;

/// Mean radius of the earth for scenes without georeference, metres.
const MEAN_EARTH_RADIUS_M: f64 = 6_371_008.8;

/// Resolves everything.
pub(crate) fn session(
    mut source: SourceDocument,
    roots: &Roots,
    options: &OpenOptions,
) -> Result<Session, BelvedereError> {
    validate::document(&source)?;
    refuse_constructor(&source)?;
    let mut loader = layers::Loader {
        source: &source,
        roots,
        options,
        builtins: builtin::Builtins::default(),
        inputs: vec![source.path().to_owned()],
        warnings: Vec::new(),
    };
    let scene = load(&mut loader)?;
    let layers::Loader { inputs, warnings, .. } = loader;
    layers::fill_surfaces(&mut source.document, &scene);
    let mut memory = TerrainMemory::default();
    let mut solving = Solving { memory: &mut memory, time_step_s: None, progress: &options.progress };
    let looked = look(&source, roots, &scene, (!options.unsolved).then_some(&mut solving))?;
    Ok(Session {
        document: looked.document,
        path: source.path().to_owned(),
        source,
        roots: roots.clone(),
        scene,
        view: looked.view,
        light: looked.light,
        terrain: looked.terrain,
        warnings: warnings.into_iter().chain(looked.warnings).collect(),
        inputs: inputs.into_iter().chain(looked.inputs).collect(),
        rasteriser: Arc::default(),
    })
}

/// The session's scene by another document of the same layers: everything that depends on camera and stages is resolved again.
/// Without `solving` an intent of terrain disocclusion is left out.
pub(crate) fn look_again(
    session: &mut Session,
    document: Document,
    solving: Option<&mut Solving<'_>>,
) -> Result<(), BelvedereError> {
    let mut source = session.source.clone();
    source.document = document;
    let looked = look(&source, &session.roots, &session.scene, solving)?;
    (session.document, session.view, session.light) = (looked.document, looked.view, looked.light);
    session.terrain = looked.terrain;
    Ok(())
}

/// What depends on camera and stages.
struct Looked {
    document: Document,
    view: View,
    light: Light,
    terrain: Option<TerrainReport>,
    inputs: Vec<PathBuf>,
    warnings: Vec<String>,
}

fn look(
    source: &SourceDocument,
    roots: &Roots,
    scene: &Scene,
    mut solving: Option<&mut Solving<'_>>,
) -> Result<Looked, BelvedereError> {
    let (mut inputs, mut warnings) = (Vec::new(), Vec::new());
    let ground = Ground { crs: scene.crs, terrain: scene.terrain() };
    let mut camera = camera::resolve(source, &ground, stages::plane_normal(&source.document))?;
    if let Some(solving) = solving.as_deref_mut() {
        let before = earth(source, &ground, camera.pinhole.eye, &mut Vec::new());
        terrain::adjust(source, scene, &mut camera, before, solving, &mut warnings)?;
    }
    let mut chain = earth(source, &ground, camera.pinhole.eye, &mut warnings);
    let mut document = source.document.clone();
    let context = stages::StageContext { source, roots, scene, ground: &ground, camera: &camera, earth: &chain };
    let resolved = stages::resolve(&context, solving, &mut inputs, &mut warnings)?;
    chain.extend(resolved.stages);
    let view = View::new(resolved.pinhole, chain).map_err(|e| source.error(&["stage"], e))?;
    let light = light::resolve(source, &ground, view.pinhole().eye, &mut warnings)?;
    document.crs = scene.crs.to_string();
    document.camera = camera.document;
    document.stage = resolved.documents;
    Ok(Looked { document, view, light, terrain: resolved.terrain, inputs, warnings })
}

/// A picture without what the scene asks for would mislead.
fn refuse_constructor(source: &SourceDocument) -> Result<(), BelvedereError> {
    match &source.document.constructor {
        Some(doc) if doc.kind != ConstructorKind::Manual => Err(source.error(
            &["constructor", "kind"],
            "this version has no constructors; give the stages themselves and remove [constructor], or set kind = \"manual\"",
        )),
        _ => Ok(()),
    }
}

/// The layers that are needed, in file order.
fn load(loader: &mut layers::Loader<'_>) -> Result<Scene, BelvedereError> {
    let source = loader.source;
    let doc = &source.document;
    let mut crs = crs_wanted(source)?;
    let mut layers: Vec<Option<Layer>> = doc.layer.iter().map(|_| None).collect();
    let solves = !loader.options.unsolved && doc.solves_terrain();
    let needs = if solves { Needs::Everything } else { loader.options.needs };
    let with_ground = needs != Needs::View || ground_is_needed(source, crs);
    for (i, layer) in doc.layer.iter().enumerate().filter(|_| with_ground) {
        if let LayerDoc::Terrain(terrain) = layer {
            let (terrain, found) = loader.terrain(i, terrain, crs)?;
            crs.get_or_insert(found);
            layers[i] = Some(Layer { id: layer.id().to_owned(), must_see: false, kind: LayerKind::Terrain(terrain) });
        }
    }
    let crs = crs.or_else(|| crs_of_eye(source)).unwrap_or_default();
    if needs == Needs::Everything {
        for (i, layer) in doc.layer.iter().enumerate() {
            let ground = Ground { crs, terrain: first_terrain(&layers) };
            if let LayerDoc::Terrain(terrain) = layer {
                let drapes = loader.drapes(i, terrain, &ground)?;
                if let Some(Layer { kind: LayerKind::Terrain(t), .. }) = &mut layers[i] {
                    t.drapes = drapes;
                }
            } else {
                layers[i] = loader.layer(i, layer, &ground)?;
            }
        }
    }
    let layers = layers.into_iter().flatten().collect();
    Ok(Scene { title: doc.title.clone(), crs, unit: unit(doc.unit), layers })
}

fn first_terrain(layers: &[Option<Layer>]) -> Option<&Heightfield> {
    layers.iter().flatten().find_map(|l| match &l.kind {
        LayerKind::Terrain(t) => Some(&*t.heightfield),
        _ => None,
    })
}

/// Whether the view cannot be resolved without the terrain.
fn ground_is_needed(source: &SourceDocument, crs: Option<Crs>) -> bool {
    let doc = &source.document;
    let places = [Some(&doc.camera.eye), doc.camera.look_at.as_ref()];
    let stands = |p: &PointDoc| matches!(p, PointDoc::Map(m) if m.above_ground_m.is_some());
    let geographic = |p: &PointDoc| matches!(p, PointDoc::Map(m) if m.lon.is_some());
    let spline_floats = doc.stage.iter().any(|s| match s {
        StageDoc::SplineBend(spline) => spline.plane.as_ref().is_none_or(|p| p.height_m.is_none()),
        StageDoc::TerrainDisocclusion(_) => true,
        StageDoc::CurvedRays(_) => false,
    });
    let needs_place = places.into_iter().flatten().any(geographic)
        || doc.earth == EarthDoc::Curved
        || doc.light.as_ref().is_some_and(|l| l.time.is_some());
    places.into_iter().flatten().any(stands) || spline_floats || (crs.is_none() && needs_place)
}

fn unit(doc: UnitDoc) -> Unit {
    match doc {
        UnitDoc::Metre => Unit::Metre,
        UnitDoc::Angstrom => Unit::Angstrom,
        UnitDoc::Voxel => Unit::Voxel,
    }
}

/// The code of `EPSG:n`.
fn epsg(text: &str) -> Option<u32> {
    let text = text.trim();
    text.get(..5).filter(|p| p.eq_ignore_ascii_case("epsg:")).and_then(|_| text[5..].trim().parse().ok())
}

/// The system that the document names; `None` = automatic.
fn crs_wanted(source: &SourceDocument) -> Result<Option<Crs>, BelvedereError> {
    let text = source.document.crs.trim();
    if text.eq_ignore_ascii_case("auto") {
        return Ok(None);
    }
    if text.eq_ignore_ascii_case("local") {
        return Ok(Some(Crs::Local));
    }
    let fail = |reason: String| source.error(&["crs"], reason);
    let Some(code) = epsg(text) else {
        return Err(fail(format!("crs \"{text}\" is not known; give \"auto\", \"local\" or \"EPSG:n\"")));
    };
    let system = CoordinateSystem::from_epsg(code).map_err(|e| fail(e.to_string()))?;
    if !system.suits_scenes() {
        return Err(fail(format!(
            "crs EPSG:{code} is not projected in metres with x east and y north; give a UTM zone or another metric system, or \"auto\""
        )));
    }
    Ok(Some(Crs::Epsg(code)))
}

/// The UTM zone of an eye given by longitude and latitude: what `auto` means without terrain.
fn crs_of_eye(source: &SourceDocument) -> Option<Crs> {
    match source.document.camera.eye {
        PointDoc::Map(MapPointDoc { lon: Some(lon), lat: Some(lat), .. }) => utm_epsg(lon, lat).map(Crs::Epsg),
        _ => None,
    }
}

/// Radius of the earth at the middle of a scene, metres.
pub(crate) fn earth_radius(scene: &Scene) -> f64 {
    let ground = Ground { crs: scene.crs, terrain: scene.terrain() };
    let middle = scene.bounds().center().truncate();
    ground.lon_lat(middle).map_or(MEAN_EARTH_RADIUS_M, |place| gaussian_radius_m(place.y))
}

fn earth(
    source: &SourceDocument,
    ground: &Ground<'_>,
    eye: belvedere_core::DVec3,
    warnings: &mut Vec<String>,
) -> Vec<Stage> {
    if source.document.earth == EarthDoc::Flat {
        return Vec::new();
    }
    let radius = match ground.lon_lat(eye.truncate()) {
        Some(place) => gaussian_radius_m(place.y),
        None => {
            warnings.push(format!(
                "earth = \"curved\" in a scene without georeference: the mean radius {MEAN_EARTH_RADIUS_M} m is used"
            ));
            MEAN_EARTH_RADIUS_M
        }
    };
    vec![Stage::EarthCurvature(EarthCurvature { eye, radius, refraction: EarthCurvature::REFRACTION })]
}

/// What places on the map stand on: the scene's coordinate system and its undeformed terrain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ground<'a> {
    /// Coordinate system of the scene.
    pub(crate) crs: Crs,
    /// The first terrain.
    pub(crate) terrain: Option<&'a Heightfield>,
}

impl Ground<'_> {
    /// Scene position of a WGS84 position.
    pub(crate) fn place_of(&self, lon: f64, lat: f64) -> Result<DVec2, String> {
        if !((-180.0..=360.0).contains(&lon) && (-90.0..=90.0).contains(&lat)) {
            return Err(format!(
                "lon {lon}, lat {lat} is no place on the earth; lon in -180..=360 and lat in -90..=90 are needed"
            ));
        }
        self.wgs84()?
            .forward_one(DVec2::new(lon, lat))
            .ok_or_else(|| format!("lon {lon}, lat {lat} lies outside the domain of {}; choose another crs", self.crs))
    }

    /// Longitude and latitude (WGS84 degrees) of a scene position; `None` without georeference or outside its domain.
    pub(crate) fn lon_lat(&self, xy: DVec2) -> Option<DVec2> {
        self.wgs84().ok()?.inverse_one(xy)
    }

    fn wgs84(&self) -> Result<Transform, String> {
        if self.crs == Crs::Local {
            return Err(
                "lon and lat need a georeferenced scene, this one is local; give [x, y, z], or set crs = \"EPSG:n\""
                    .into(),
            );
        }
        let to = CoordinateSystem::from_scene(self.crs).map_err(|e| e.to_string())?;
        let from = CoordinateSystem::wgs84().map_err(|e| e.to_string())?;
        Transform::new(&from, &to).map_err(|e| e.to_string())
    }

    /// Bilinear height of the undeformed terrain.
    pub(crate) fn height_at(&self, xy: DVec2) -> Result<f64, String> {
        let Some(terrain) = self.terrain else {
            return Err("above_ground_m needs a terrain layer; add one, or give the height".into());
        };
        if let Some(height) = terrain.height_at(xy) {
            return Ok(height);
        }
        let b = terrain.bounds();
        let inside = (b.min.x..=b.max.x).contains(&xy.x) && (b.min.y..=b.max.y).contains(&xy.y);
        Err(if inside {
            format!(
                "the terrain has a hole at ({:.1}, {:.1}), so there is no ground to stand on; give the height, or set fill_voids = true",
                xy.x, xy.y
            )
        } else {
            format!(
                "({:.1}, {:.1}) lies outside the terrain (x {:.1}..{:.1}, y {:.1}..{:.1}), so there is no ground to stand on; move it inside, or give the height",
                xy.x, xy.y, b.min.x, b.max.x, b.min.y, b.max.y
            )
        })
    }
}
