//! Cities in another coordinate system.

use super::CityFile;
use crate::IoError;
use crate::crs::{CoordinateSystem, CrsError, Transform, utm_epsg};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{City, Polygon};

const WEB_MERCATOR: u32 = 3857;

impl CityFile {
    /// A system in metres for the city: its own if that suits scenes (Web Mercator does not: its lengths are too great away from the
    /// equator, so houses would be too wide for their heights), else the UTM zone of its first position. `None` if the file names no
    /// system; `stated` replaces the one that it names.
    ///
    /// # Errors
    /// [`IoError`]: the first position lies in no UTM zone.
    pub fn metric_system(&self, stated: Option<&CoordinateSystem>) -> Result<Option<CoordinateSystem>, IoError> {
        let Some(system) = stated.or(self.crs.as_ref()) else { return Ok(None) };
        if system.suits_scenes() && system.epsg() != Some(WEB_MERCATOR) {
            return Ok(Some(system.clone()));
        }
        let fail = |e: CrsError| IoError::format(&self.path, e.to_string());
        let to_degrees = CoordinateSystem::wgs84().and_then(|wgs84| Transform::new(system, &wgs84)).map_err(fail)?;
        let Some(first) = first_place(&self.city) else { return Ok(None) };
        let zone = to_degrees.forward_one(first).and_then(|at| utm_epsg(at.x, at.y)).ok_or_else(|| {
            let reason = format!("({}, {}) lies in no UTM zone; project it to metres first", first.x, first.y);
            IoError::format(&self.path, reason)
        })?;
        CoordinateSystem::from_epsg(zone).map(Some).map_err(fail)
    }
}

fn first_place(city: &City) -> Option<DVec2> {
    let polygons = city.buildings.iter().flat_map(|b| &b.footprint).chain(city.areas.iter().flat_map(|a| &a.polygons));
    let faces = city.buildings.iter().flat_map(|b| &b.faces).chain(city.structures.iter().flat_map(|s| &s.faces));
    let corners = faces.flat_map(|f| &f.rings).flatten().map(|p| p.truncate());
    let plan = polygons.flat_map(|p| &p.outer).chain(city.ways.iter().flat_map(|w| &w.points));
    plan.copied().chain(corners).next()
}

/// Transforms all positions to another system and keeps heights. Returns the number of shapes outside its domain, which are left out.
///
/// # Errors
/// Every [`CrsError`] of [`Transform::new`].
pub fn reproject(city: &mut City, from: &CoordinateSystem, to: &CoordinateSystem) -> Result<usize, CrsError> {
    let transform = Transform::new(from, to)?;
    if transform.is_identity() {
        return Ok(0);
    }
    let point = |p: &mut DVec2| transform.forward_one(*p).map(|q| *p = q).is_some();
    let ring = |ring: &mut Vec<DVec2>| ring.iter_mut().all(point);
    let corner = |p: &mut DVec3| transform.forward_one(p.truncate()).map(|q| *p = q.extend(p.z)).is_some();
    let polygons = |polygons: &mut Vec<Polygon>| {
        polygons.iter_mut().flat_map(|p| std::iter::once(&mut p.outer).chain(&mut p.holes)).all(ring)
    };
    let shapes = |city: &City| city.buildings.len() + city.structures.len() + city.areas.len() + city.ways.len();
    let before = shapes(city);
    city.buildings.retain_mut(|b| {
        polygons(&mut b.footprint) && b.faces.iter_mut().flat_map(|f| &mut f.rings).flatten().all(corner)
    });
    city.structures.retain_mut(|s| s.faces.iter_mut().flat_map(|f| &mut f.rings).flatten().all(corner));
    city.areas.retain_mut(|a| polygons(&mut a.polygons));
    city.ways.retain_mut(|w| ring(&mut w.points));
    Ok(before - shapes(city))
}
