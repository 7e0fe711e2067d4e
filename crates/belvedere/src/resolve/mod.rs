//! From a document to a scene and a view.

mod camera;
mod light;
mod stages;
mod validate;

use crate::scene_file::paths::Roots;
use crate::scene_file::{EarthDoc, MapPointDoc, PointDoc, SourceDocument, UnitDoc};
use crate::{BelvedereError, OpenOptions, Session};
use belvedere_core::{DVec2, EarthCurvature, Stage, View};
use belvedere_io::crs::{CoordinateSystem, Transform, gaussian_radius_m, utm_epsg};
use belvedere_scene::{Crs, Heightfield, Scene, Unit};

/// Mean radius of the earth for scenes without georeference, metres.
const MEAN_EARTH_RADIUS_M: f64 = 6_371_008.8;

/// Resolves everything.
pub(crate) fn session(
    source: SourceDocument,
    roots: &Roots,
    _options: &OpenOptions,
) -> Result<Session, BelvedereError> {
    validate::document(&source)?;
    let mut warnings = Vec::new();
    let mut inputs = vec![source.path().to_owned()];
    let wanted = crs_wanted(&source)?;
    let crs = wanted.or_else(|| crs_of_eye(&source)).unwrap_or_default();
    let scene =
        Scene { title: source.document.title.clone(), crs, unit: unit(source.document.unit), layers: Vec::new() };
    let ground = Ground { crs, terrain: scene.terrain() };
    let camera = camera::resolve(&source, &ground, stages::plane_normal(&source))?;
    let mut chain = earth(&source, &ground, camera.pinhole.eye, &mut warnings);
    let mut document = source.document.clone();
    let (stages, stage_docs) = stages::resolve(&source, roots, &ground, &camera, &mut inputs, &mut warnings)?;
    chain.extend(stages);
    let view = View::new(camera.pinhole, chain).map_err(|e| source.error(&["stage"], e))?;
    let light = light::resolve(&source, &ground, view.pinhole().eye, &mut warnings)?;
    document.crs = crs.to_string();
    document.camera = camera.document;
    document.stage = stage_docs;
    Ok(Session { document, path: source.path().to_owned(), scene, view, light, warnings, inputs })
}

fn unit(doc: UnitDoc) -> Unit {
    match doc {
        UnitDoc::Metre => Unit::Metre,
        UnitDoc::Angstrom => Unit::Angstrom,
        UnitDoc::Voxel => Unit::Voxel,
    }
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
    let code =
        text.get(..5).filter(|p| p.eq_ignore_ascii_case("epsg:")).and_then(|_| text[5..].trim().parse::<u32>().ok());
    let Some(code) = code else {
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
    pub(crate) fn from_lon_lat(&self, lon: f64, lat: f64) -> Result<DVec2, String> {
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
