//! Positions on the map: the scene's coordinate system, its terrain, and the shape of the earth.

use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Stage, View, ViewError};
use belvedere_core::{Warning, WarningKind};
use belvedere_document::EarthDoc;
use belvedere_io::crs::{CoordinateSystem, Transform, gaussian_radius_m};
use belvedere_scene::{Crs, Heightfield, Scene};

/// Mean radius of the earth for scenes without georeference, metres.
const MEAN_EARTH_RADIUS_M: f64 = 6_371_008.8;

/// The code of `EPSG:n`.
pub fn epsg(text: &str) -> Option<u32> {
    let text = text.trim();
    text.get(..5).filter(|p| p.eq_ignore_ascii_case("epsg:")).and_then(|_| text[5..].trim().parse().ok())
}

/// Radius of the earth at the middle of a scene, metres.
pub fn earth_radius(scene: &Scene, warnings: &mut Vec<Warning>) -> f64 {
    radius_at(&Ground::of(scene), scene.bounds().center().truncate(), warnings)
}

/// The stage of an earth shape seen from `eye`.
pub fn earth(shape: EarthDoc, ground: &Ground<'_>, eye: DVec3, warnings: &mut Vec<Warning>) -> Option<Stage> {
    (shape == EarthDoc::Curved).then(|| {
        let (radius, refraction) = (radius_at(ground, eye.truncate(), warnings), EarthCurvature::REFRACTION);
        Stage::EarthCurvature(EarthCurvature { eye, radius, refraction })
    })
}

/// The view of a camera before any bend: the shape of the earth is its only stage.
pub fn unbent(
    pinhole: Pinhole,
    shape: EarthDoc,
    scene: &Scene,
    warnings: &mut Vec<Warning>,
) -> Result<View, ViewError> {
    let stages = earth(shape, &Ground::of(scene), pinhole.eye, warnings);
    View::new(pinhole, stages.into_iter().collect())
}

fn radius_at(ground: &Ground<'_>, xy: DVec2, warnings: &mut Vec<Warning>) -> f64 {
    let radius = ground.lon_lat(xy).map(|lon_lat| gaussian_radius_m(lon_lat.y));
    radius.unwrap_or_else(|| {
        let text = format!(
            "earth = \"curved\" in a scene without georeference: the mean radius {MEAN_EARTH_RADIUS_M} m is used"
        );
        let warning = Warning::new(WarningKind::Assumed, text).about("earth");
        warnings.push(warning.with("radius_m", MEAN_EARTH_RADIUS_M));
        MEAN_EARTH_RADIUS_M
    })
}

/// The scene's coordinate system and its undeformed terrain.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// Coordinate system of the scene.
    pub crs: Crs,
    /// The first terrain.
    pub terrain: Option<&'a Heightfield>,
}

impl<'a> Ground<'a> {
    /// The ground of a scene.
    pub fn of(scene: &'a Scene) -> Self {
        Self { crs: scene.crs, terrain: scene.terrain() }
    }

    /// Scene position of a WGS84 position.
    pub fn position_of(&self, lon: f64, lat: f64) -> Result<DVec2, String> {
        if !((-180.0..=360.0).contains(&lon) && (-90.0..=90.0).contains(&lat)) {
            return Err(format!(
                "lon {lon}, lat {lat} is not on the earth; lon in -180..=360 and lat in -90..=90 are needed"
            ));
        }
        self.wgs84()?
            .forward_one(DVec2::new(lon, lat))
            .ok_or_else(|| format!("lon {lon}, lat {lat} lies outside the domain of {}; choose another crs", self.crs))
    }

    /// Longitude and latitude (WGS84 degrees) of a scene position; `None` without georeference or outside its domain.
    pub fn lon_lat(&self, xy: DVec2) -> Option<DVec2> {
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

    /// That a position in degrees lies outside the terrain, if it does, with the terrain's extent in degrees.
    pub fn outside(&self, lon: f64, lat: f64) -> Option<String> {
        let bounds = self.terrain?.bounds();
        let (low, high) = (bounds.min.truncate(), bounds.max.truncate());
        let xy = self.position_of(lon, lat).ok()?;
        if (low.x..=high.x).contains(&xy.x) && (low.y..=high.y).contains(&xy.y) {
            return None;
        }
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let corners: Vec<DVec2> = corners.into_iter().filter_map(|p| self.lon_lat(p)).collect();
        let least = corners.iter().copied().reduce(DVec2::min)?;
        let most = corners.iter().copied().reduce(DVec2::max)?;
        Some(format!(
            "lon {lon}, lat {lat} lies outside the terrain (lon {:.4}..{:.4}, lat {:.4}..{:.4}), so there is no ground to stand on; move it inside, or give the height",
            least.x, most.x, least.y, most.y
        ))
    }

    /// Bilinear height of the undeformed terrain.
    pub fn height_at(&self, xy: DVec2) -> Result<f64, String> {
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
