//! From a document to a scene and a view.

pub(crate) mod camera;
pub(crate) mod light;

use belvedere_core::DVec2;
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_scene::{Crs, Heightfield};

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
            return Err(format!("lon {lon}, lat {lat} is no place on the earth; lon in -180..=360 and lat in -90..=90 are needed"));
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
            return Err("lon and lat need a georeferenced scene, this one is local; give [x, y, z], or set crs = \"EPSG:n\"".into());
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
            format!("the terrain has a hole at ({:.1}, {:.1}), so there is no ground to stand on; give the height, or set fill_voids = true", xy.x, xy.y)
        } else {
            format!(
                "({:.1}, {:.1}) lies outside the terrain (x {:.1}..{:.1}, y {:.1}..{:.1}), so there is no ground to stand on; move it inside, or give the height",
                xy.x, xy.y, b.min.x, b.max.x, b.min.y, b.max.y
            )
        })
    }
}
