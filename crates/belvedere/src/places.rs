//! Places as users write them, and where they lie in a scene.
//!
//! `X,Y` or `X,Y,Z`. X and Y are scene coordinates, or longitude and latitude in degrees where the scene is georeferenced, X is within
//! ±360, Y within ±90, and no ground lies there as scene coordinates. With letters, in any order, they are always degrees:
//! `46.5N,11.3E`. Z is in metres over the datum of the data; `+20` is 20 m above the ground, as is `+0`.
//!
//! Where the place as written lies farther from the ground than the ground is large, and with its two numbers exchanged it lies on the
//! ground or near it, the exchanged place is taken, and a warning says so.

pub use crate::scene_file::place::{Place, PlaceHeight, PlacePosition};
use crate::{BelvedereError, Session};
use belvedere_core::{DVec2, DVec3, Warning, WarningKind};
use belvedere_io::terrain::OriginalTerrain;
use belvedere_resolve::ground::Ground;
use belvedere_scene::{Crs, Scene};
use std::fmt;

/// Distance from the ground from which on a place is doubted, and up to which another reading is taken, as shares of the diagonal of
/// the ground.
const FAR: f64 = 1.0;
const NEAR: f64 = 0.25;
/// Width of the border around the ground in which small numbers are scene coordinates, as a share of its diagonal.
const BORDER: f64 = 0.1;

/// A way to read two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reading {
    /// In the system of the elevation model.
    Model,
    /// In that of the scene.
    Scene,
    /// Longitude and latitude.
    LonLat,
}

/// A reading of two numbers, in their order or exchanged.
struct Read {
    reading: Reading,
    exchanged: bool,
}

impl fmt::Display for Read {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match (self.reading, self.exchanged) {
            (Reading::Model, false) => "x,y of the elevation model",
            (Reading::Model, true) => "y,x of the elevation model",
            (Reading::Scene, false) => "x,y of the scene",
            (Reading::Scene, true) => "y,x of the scene",
            (Reading::LonLat, false) => "lon,lat",
            (Reading::LonLat, true) => "lat,lon",
        })
    }
}

/// The ground on which places are found.
pub(crate) struct PlaceFinder<'a> {
    ground: Ground<'a>,
    /// South-west and north-east corner.
    bounds: [DVec2; 2],
    /// Height of places without a height where there is no terrain.
    middle: f64,
    model: Option<&'a OriginalTerrain>,
}

impl<'a> PlaceFinder<'a> {
    /// Places in the coordinates of a scene.
    pub(crate) fn of(scene: &'a Scene) -> Self {
        let ground = Ground::of(scene);
        let all = scene.bounds();
        let bounds = ground.terrain.map_or(all, belvedere_scene::Heightfield::bounds);
        let bounds = [bounds.min.truncate(), bounds.max.truncate()];
        let middle = if all.is_empty() { 0.0 } else { all.center().z };
        Self { ground, bounds, middle, model: None }
    }

    /// The same with numbers in the system of an elevation model.
    pub(crate) fn in_model(self, model: &'a OriginalTerrain) -> Self {
        Self { model: Some(model), ..self }
    }

    /// The scene position of a place, and a warning if it was not read as it is written.
    ///
    /// # Errors
    /// [`BelvedereError::Position`] about `what` if it is not on the map, or if it needs a height that there is no ground for.
    pub(crate) fn find(&self, place: &Place, what: &'static str) -> Result<(DVec3, Option<Warning>), BelvedereError> {
        let (xy, said) = self.on_map(place, what)?;
        let height = match place.height {
            PlaceHeight::Metres(z) => Ok(z),
            PlaceHeight::OnGround if self.ground.terrain.is_none() => Ok(self.middle),
            PlaceHeight::OnGround => self.ground.height_at(xy),
            PlaceHeight::AboveGround(_) if self.ground.terrain.is_none() => {
                Err("a height above the ground needs terrain; give the height itself, without +".into())
            }
            PlaceHeight::AboveGround(above) => self.ground.height_at(xy).map(|ground| ground + above),
        };
        Ok((xy.extend(height.map_err(|reason| BelvedereError::Position { what, reason })?), said))
    }

    /// The position in plan of a place.
    ///
    /// # Errors
    /// As [`PlaceFinder::find`].
    pub(crate) fn on_map(&self, place: &Place, what: &'static str) -> Result<(DVec2, Option<Warning>), BelvedereError> {
        let fail = |reason| BelvedereError::Position { what, reason };
        let numbers = match place.position {
            PlacePosition::LonLat([lon, lat]) => {
                return Ok((self.ground.position_of(lon, lat).map_err(fail)?, None));
            }
            PlacePosition::Numbers(numbers) => numbers,
        };
        let as_written = Read { reading: self.reading_of(numbers), exchanged: false };
        let found = self.read(as_written.reading, numbers);
        let away = found.as_ref().map_or(f64::INFINITY, |p| self.distance(*p));
        let limit = self.size();
        if self.ground.crs != Crs::Local
            && away > FAR * limit
            && let Some((read, position)) = self.other_reading(&as_written, numbers)
        {
            let said = self.said(what, numbers, (&as_written, away), (&read, position));
            return Ok((position, Some(said)));
        }
        found.map(|p| (p, None)).map_err(fail)
    }

    /// The reading of numbers in their order.
    fn reading_of(&self, [x, y]: [f64; 2]) -> Reading {
        let own = if self.model.is_some() { Reading::Model } else { Reading::Scene };
        let degrees = self.ground.crs != Crs::Local && x.abs() <= 360.0 && y.abs() <= 90.0;
        let on_ground = || self.read(own, [x, y]).is_ok_and(|p| self.distance(p) <= BORDER * self.size());
        if degrees && !on_ground() { Reading::LonLat } else { own }
    }

    fn read(&self, reading: Reading, [x, y]: [f64; 2]) -> Result<DVec2, String> {
        match (reading, self.model) {
            (Reading::LonLat, _) => self.ground.position_of(x, y),
            (Reading::Model, Some(model)) => {
                model.scene_from_model(self.ground.crs, DVec2::new(x, y)).ok_or_else(|| {
                    format!(
                        "{x},{y} is no position in the system of the elevation model ({}); give x,y in that system",
                        model.system_name()
                    )
                })
            }
            _ => Ok(DVec2::new(x, y)),
        }
    }

    /// The reading, other than `not`, that lies nearest to the ground, if that is near it.
    fn other_reading(&self, not: &Read, [x, y]: [f64; 2]) -> Option<(Read, DVec2)> {
        let model = self.model.is_some().then_some(Reading::Model);
        let readings = [Some(Reading::LonLat), model, Some(Reading::Scene)].into_iter().flatten();
        let all = readings.flat_map(|reading| [false, true].map(|exchanged| Read { reading, exchanged }));
        all.filter(|read| read.reading != not.reading || read.exchanged != not.exchanged)
            .filter_map(|read| {
                let numbers = if read.exchanged { [y, x] } else { [x, y] };
                self.read(read.reading, numbers).ok().map(|p| (read, p))
            })
            .filter(|(_, p)| self.distance(*p) <= NEAR * self.size())
            .min_by(|(_, a), (_, b)| self.distance(*a).total_cmp(&self.distance(*b)))
    }

    fn said(&self, what: &str, [x, y]: [f64; 2], (given, away): (&Read, f64), (read, p): (&Read, DVec2)) -> Warning {
        let long = |metres: f64| match metres {
            1000.0.. => format!("{:.0} km", metres / 1000.0),
            _ => format!("{metres:.0} m"),
        };
        let wrong =
            if away.is_finite() { format!("lies {} from the ground", long(away)) } else { "is no position".into() };
        let near = self.distance(p);
        let right = if near > 0.0 { format!("{} from it", long(near)) } else { "on it".into() };
        let order = if read.exchanged { format!("; write {y},{x}") } else { String::new() };
        let which = if what == "target" { format!("the point looked at, {x},{y},") } else { format!("{what} {x},{y}") };
        let text = format!("{which} {wrong} as {given}; as {read} it lies {right}, and is taken so{order}");
        Warning::new(WarningKind::Repaired, text).about(what).with("away_m", away).with("taken_away_m", near)
    }

    /// Distance in plan from the ground.
    fn distance(&self, p: DVec2) -> f64 {
        let [min, max] = self.bounds;
        (p - p.clamp(min, max.max(min))).length()
    }

    /// Diagonal of the ground.
    fn size(&self) -> f64 {
        let [min, max] = self.bounds;
        (max - min).max(DVec2::ZERO).length()
    }
}

impl Session {
    /// The scene position of a place that a user wrote, and a warning if it was not read as it is written.
    ///
    /// * `what`: the place in messages, such as `eye`.
    ///
    /// # Errors
    /// [`BelvedereError::Position`] if it is not on the map, or needs a height that there is no ground for.
    pub fn find_place(&self, place: &Place, what: &'static str) -> Result<(DVec3, Option<Warning>), BelvedereError> {
        PlaceFinder::of(self.scene()).find(place, what)
    }
}

#[cfg(test)]
mod tests;
