//! Coordinate reference systems: EPSG codes and WKT to projections, and transforms between them.
//!
//! Axis order is always x = east or longitude first, y = north or latitude second, whatever the register says.
//! Longitudes and latitudes are degrees. Datum shifts are Helmert shifts (three or seven parameters); grid shifts are not
//! applied, see [`CoordinateSystem::datum_note`].

mod arc_info;
mod tables;
mod wkt;

pub(crate) use wkt::code_of_parameters;

use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Crs;
use glam::DVec2;
use proj4rs::Proj;
use rayon::prelude::*;
use std::sync::Arc;

/// Errors of coordinate reference systems and of transforms between them.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrsError {
    /// The code is in no table.
    #[error("EPSG:{code} is not a known projected or geographic 2D system; give the code of one (for example 32632)")]
    UnknownCode {
        /// The code.
        code: u32,
    },
    /// The projection method is not implemented.
    #[error("{name}: {reason}; reproject the data to another system, for example UTM")]
    Unsupported {
        /// The system.
        name: String,
        /// What is missing.
        reason: String,
    },
    /// The text is not WKT, or lacks required parts.
    #[error("CRS text cannot be understood: {reason}; give the EPSG code instead")]
    Text {
        /// What is wrong.
        reason: String,
    },
    /// A scene without georeference was asked for geographic positions.
    #[error("a scene with crs = \"local\" has no geographic positions; set crs to \"auto\" or an EPSG code")]
    Local,
    /// Positions in an unstated system cannot be transformed to another system.
    #[error(
        "their coordinate system is not stated, and the numbers are no longitudes and latitudes; state its EPSG code in the file (a \"crs\" member, a .prj), or use them with terrain in a local scene"
    )]
    Unstated,
}

/// A geographic or projected system, ready to transform from and to.
#[derive(Clone)]
pub struct CoordinateSystem {
    name: String,
    epsg: Option<u32>,
    local: bool,
    proj_string: String,
    proj: Arc<Proj>,
}

impl std::fmt::Debug for CoordinateSystem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CoordinateSystem").field("name", &self.name).field("proj", &self.proj_string).finish()
    }
}

impl std::fmt::Display for CoordinateSystem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

impl PartialEq for CoordinateSystem {
    /// Equal definitions; names do not count.
    fn eq(&self, other: &Self) -> bool {
        self.proj_string == other.proj_string
    }
}

/// Mean shift of the conterminous United States, the usual substitute for the NADCON grids.
const NAD27_SHIFT: &str = "+ellps=clrk66 +towgs84=-8,160,176";

impl CoordinateSystem {
    /// The system with this EPSG code, geographic or projected. Compound codes stand for their horizontal part.
    ///
    /// # Errors
    /// [`CrsError::UnknownCode`], [`CrsError::Unsupported`].
    pub fn from_epsg(code: u32) -> Result<Self, CrsError> {
        let code = tables::current_code(code);
        let definition = tables::definition(code)?;
        let name = format!("EPSG:{code}");
        let mut system = Self::build(&name, &definition)?;
        system.epsg = Some(code);
        Ok(system)
    }

    /// Its well-known text (OGC 1), if its EPSG code is a usual one.
    pub(crate) fn well_known_text(&self) -> Option<&'static str> {
        self.epsg.and_then(tables::well_known_text)
    }

    /// A system by its PROJ string, such as `+proj=utm +zone=31 +datum=WGS84`; `name` is for messages.
    ///
    /// # Errors
    /// [`CrsError::Unsupported`].
    pub fn from_proj_string(name: &str, proj_string: &str) -> Result<Self, CrsError> {
        Self::build(name, proj_string)
    }

    /// A system by its well-known text, OGC (1 or 2) or ESRI (`.prj` files): by its EPSG code or a well-known name if it
    /// holds one, else by its parameters.
    ///
    /// # Errors
    /// [`CrsError::Text`], [`CrsError::Unsupported`], [`CrsError::UnknownCode`].
    pub fn from_wkt(text: &str) -> Result<Self, CrsError> {
        wkt::parse(text)
    }

    /// The plane of a system of another body than the Earth; it fits only scenes without georeference.
    fn of_other_body(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::local() }
    }

    /// The plane of a file that states no system; it fits only scenes without georeference.
    pub fn local() -> Self {
        let proj = Proj::from_proj_string("+proj=eqc +ellps=WGS84 +units=m").unwrap_or_else(|_| unreachable!());
        let name = "no stated system".to_owned();
        Self { name, epsg: None, local: true, proj_string: "local".to_owned(), proj: Arc::new(proj) }
    }

    /// A system by its name: `EPSG:25832`, `urn:ogc:def:crs:EPSG::25832`, `ESRI:102100`, a bare number, well-known text, the name that
    /// texts give it, a PROJ string, which may follow a name, or the lines of an old `.prj` file of ARC/INFO.
    ///
    /// # Errors
    /// [`CrsError::Text`], [`CrsError::Unsupported`], [`CrsError::UnknownCode`].
    pub fn from_text(text: &str) -> Result<Self, CrsError> {
        let text = text.trim().trim_start_matches('\u{feff}');
        let keyword = text.split_once(['[', '(']).map(|(word, _)| word.trim());
        if keyword.is_some_and(|w| !w.is_empty() && w.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')) {
            return Self::from_wkt(text);
        }
        if text.starts_with("proj=") {
            return Self::from_proj_string("the PROJ string of the file", &with_signs(text));
        }
        if let Some(at) = text.find("+proj=") {
            let name = Some(text[..at].trim()).filter(|n| !n.is_empty()).unwrap_or("the PROJ string of the file");
            return match code_of_proj(&text[at..]) {
                Some(code) => Self::from_epsg(code),
                None => Self::from_proj_string(name, &text[at..]),
            };
        }
        if let Some(system) = arc_info::parse(text) {
            return system;
        }
        if text.contains(['[', '(']) {
            return Self::from_wkt(text);
        }
        let last = text.rsplit([':', '/', '#']).next().unwrap_or(text);
        match last.parse::<u32>() {
            Ok(code) => Self::from_epsg(code),
            Err(_) => wkt::by_name(text).unwrap_or_else(|| {
                let reason = format!("{text:.60?} is neither a code nor a name that is known");
                Err(CrsError::Text { reason })
            }),
        }
    }

    /// Whether it is the plane of a file that states no system.
    pub fn is_local(&self) -> bool {
        self.local
    }

    /// Longitude and latitude on WGS 84 (EPSG:4326, x = longitude).
    ///
    /// # Errors
    /// None in practice; the table holds it.
    pub fn wgs84() -> Result<Self, CrsError> {
        Self::from_epsg(4326)
    }

    /// The system of a scene.
    ///
    /// # Errors
    /// [`CrsError::Local`] for a scene without georeference, else as [`CoordinateSystem::from_epsg`].
    pub fn from_scene(crs: Crs) -> Result<Self, CrsError> {
        match crs {
            Crs::Local => Err(CrsError::Local),
            Crs::Epsg(code) => Self::from_epsg(code),
        }
    }

    fn build(name: &str, proj_string: &str) -> Result<Self, CrsError> {
        let mut parts: Vec<&str> = Vec::new();
        for part in proj_string.split_whitespace() {
            match part {
                "+datum=NAD27" => parts.push(NAD27_SHIFT),
                "+no_defs" | "+wktext" => {}
                // grids are not available; the Helmert shift that goes with them is
                p if p.starts_with("+nadgrids=") && p != "+nadgrids=@null" => {}
                p if p.starts_with("+geoidgrids=") || p.starts_with("+vunits=") => {}
                p => parts.push(p),
            }
        }
        let proj_string = parts.join(" ");
        let unsupported = |reason: String| CrsError::Unsupported { name: name.to_owned(), reason };
        let proj = Proj::from_proj_string(&proj_string)
            .map_err(|e| unsupported(format!("its projection is not supported ({e})")))?;
        if proj.is_geocent() {
            return Err(unsupported("earth-centred coordinates are not supported".into()));
        }
        if !proj.has_forward() || !proj.has_inverse() || !(proj.to_meter() > 0.0) {
            return Err(unsupported("its projection has no inverse".into()));
        }
        Ok(Self { name: name.to_owned(), epsg: None, local: false, proj_string, proj: Arc::new(proj) })
    }

    /// Name for messages: `EPSG:32631`, or what the file called it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// EPSG code, if known.
    pub fn epsg(&self) -> Option<u32> {
        self.epsg
    }

    /// PROJ string in use, after the replacements reported by [`CoordinateSystem::datum_note`].
    pub fn proj_string(&self) -> &str {
        &self.proj_string
    }

    /// Whether coordinates are longitude and latitude, degrees.
    pub fn is_geographic(&self) -> bool {
        self.proj.is_latlong()
    }

    /// Metres per unit of a projected system (0.3048 for feet); `None` if geographic.
    pub fn metres_per_unit(&self) -> Option<f64> {
        (!self.is_geographic()).then(|| self.proj.to_meter())
    }

    /// Whether scenes can use it as it is: projected in metres, x to the east, y to the north, with an EPSG code.
    pub fn suits_scenes(&self) -> bool {
        !self.local && self.epsg.is_some() && self.metres_per_unit() == Some(1.0) && self.proj.is_normalized_axis()
    }

    /// Approximation in its datum shift, if there is one: one sentence for warnings. Positions in systems without a note
    /// agree with PROJ's own to 1e-6 m.
    pub fn datum_note(&self) -> Option<Warning> {
        if self.local {
            return None;
        }
        let value = |key: &str| self.proj_string.split(' ').find_map(|p| p.strip_prefix(key));
        let inexact = |off_m: f64, what: &str| {
            let warning = Warning::new(WarningKind::Inexact, format!("{self} {what}"));
            Some(warning.about(self.to_string()).with("off_m", off_m))
        };
        let without_grid = || {
            inexact(5.0, "is joined to WGS 84 by a Helmert shift without a grid: positions may be off by a few metres")
        };
        if self.proj_string.contains(NAD27_SHIFT) {
            return inexact(
                10.0,
                "is on NAD27, shifted by the mean of the conterminous United States (-8, 160, 176 m): positions may be off by about 10 m there, more elsewhere",
            );
        }
        if let Some(shift) = value("+towgs84=") {
            return if is_small(shift) { None } else { without_grid() };
        }
        match value("+datum=") {
            Some("WGS84" | "NAD83") => None,
            Some(_) => without_grid(),
            None if value("+nadgrids=").is_some() || self.is_on_modern_ellipsoid() => None,
            None => {
                let text = format!(
                    "the datum shift of {self} is unknown and taken as zero: positions may be off by some 100 m"
                );
                Some(Warning::new(WarningKind::Inexact, text).about(self.to_string()).with("off_m", 100.0))
            }
        }
    }
}

impl CoordinateSystem {
    /// Whether its ellipsoid is that of satellite positioning (GRS 80, WGS 84, CGCS 2000): datums on it that name no shift agree with
    /// WGS 84 within about two metres. Those that do not (GGRS87, Israel 1993) have their shifts in the tables.
    fn is_on_modern_ellipsoid(&self) -> bool {
        let value = |key: &str| self.proj_string.split(' ').find_map(|p| p.strip_prefix(key));
        let number = |key: &str| value(key).and_then(|v| v.parse::<f64>().ok());
        matches!(value("+ellps="), Some("GRS80" | "WGS84"))
            || (number("+a=") == Some(6_378_137.0) && number("+rf=").is_some_and(|rf| (298.257..298.258).contains(&rf)))
    }
}

/// Whether a radius, metres, is one of the Earth.
pub(crate) fn is_of_earth(radius_m: f64) -> bool {
    (6.2e6..6.5e6).contains(&radius_m)
}

/// The EPSG code of a PROJ string on a datum that PROJ knows by name, if one has the same parameters.
fn code_of_proj(text: &str) -> Option<u32> {
    let datum = text.split_whitespace().find_map(|part| part.strip_prefix("+datum="))?;
    let base = match datum {
        "WGS84" => 4326,
        "NAD83" => 4269,
        "NAD27" => 4267,
        _ => return None,
    };
    let is_plain = text.contains("+proj=longlat") && !text.contains("+pm=");
    if is_plain { Some(base) } else { code_of_parameters(base, text) }
}

/// A PROJ string whose parts all begin with `+`.
fn with_signs(text: &str) -> String {
    let sign = |part: &str| if part.starts_with('+') { part.to_owned() } else { format!("+{part}") };
    text.split_whitespace().map(sign).collect::<Vec<_>>().join(" ")
}

/// Whether a Helmert shift moves positions by a few metres at most.
fn is_small(shift: &str) -> bool {
    /// Radius of the earth in metres per arc second, and per part of a million.
    const PER_SECOND: f64 = 31.0;
    const PER_MILLION: f64 = 6.4;
    let numbers: Vec<f64> = shift.split(',').map(|v| v.parse().unwrap_or(f64::INFINITY)).collect();
    let length = |part: Option<&[f64]>| part.map_or(0.0, |p| p.iter().map(|v| v * v).sum::<f64>().sqrt());
    let turn = PER_SECOND * length(numbers.get(3..6));
    length(numbers.get(..3)) + turn + PER_MILLION * numbers.get(6).map_or(0.0, |s| s.abs()) <= SMALL_SHIFT_M
}

/// Shifts up to this need no warning, metres.
const SMALL_SHIFT_M: f64 = 3.0;

/// Largest coordinate that a transform returns, metres or degrees; beyond it a projection has left its domain.
const MAX_COORDINATE: f64 = 1.0e8;
/// Below this many points one thread is faster.
const PARALLEL_FROM: usize = 4096;

/// A transform of points from one system to another. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Transform {
    from: CoordinateSystem,
    to: CoordinateSystem,
    identity: bool,
}

impl Transform {
    /// From one system to another.
    ///
    /// # Errors
    /// [`CrsError::Unstated`]: one of them is not known.
    pub fn new(from: &CoordinateSystem, to: &CoordinateSystem) -> Result<Self, CrsError> {
        if from.local != to.local {
            return Err(CrsError::Unstated);
        }
        Ok(Self { from: from.clone(), to: to.clone(), identity: from == to })
    }

    /// From one EPSG code to another.
    ///
    /// # Errors
    /// As [`CoordinateSystem::from_epsg`].
    pub fn between_epsg(from: u32, to: u32) -> Result<Self, CrsError> {
        Self::new(&CoordinateSystem::from_epsg(from)?, &CoordinateSystem::from_epsg(to)?)
    }

    /// Whether both systems are the same, so that every point stays as it is.
    pub fn is_identity(&self) -> bool {
        self.identity
    }

    /// System of the input.
    pub fn from(&self) -> &CoordinateSystem {
        &self.from
    }

    /// System of the output.
    pub fn to(&self) -> &CoordinateSystem {
        &self.to
    }

    /// One point; `None` where it is not finite or outside the domain of either system. Never NaN or infinite.
    /// Longitudes may run past 180 on input; on output they lie in -180..=180.
    pub fn forward_one(&self, p: DVec2) -> Option<DVec2> {
        convert(&self.from, &self.to, self.identity, p)
    }

    /// As [`Transform::forward_one`], from output to input.
    pub fn inverse_one(&self, p: DVec2) -> Option<DVec2> {
        convert(&self.to, &self.from, self.identity, p)
    }

    /// Many points, on all threads; the same bits as one by one.
    pub fn forward(&self, points: &[DVec2]) -> Vec<Option<DVec2>> {
        bulk(points, |p| self.forward_one(p))
    }

    /// As [`Transform::forward`], from output to input.
    pub fn inverse(&self, points: &[DVec2]) -> Vec<Option<DVec2>> {
        bulk(points, |p| self.inverse_one(p))
    }
}

fn bulk(points: &[DVec2], one: impl Fn(DVec2) -> Option<DVec2> + Sync) -> Vec<Option<DVec2>> {
    if points.len() < PARALLEL_FROM {
        return points.iter().map(|&p| one(p)).collect();
    }
    points.par_iter().with_min_len(512).map(|&p| one(p)).collect()
}

fn convert(from: &CoordinateSystem, to: &CoordinateSystem, identity: bool, p: DVec2) -> Option<DVec2> {
    if !p.is_finite() || p.abs().max_element() > MAX_COORDINATE {
        return None;
    }
    let mut q = p;
    if from.is_geographic() {
        if p.y.abs() > 90.0 || p.x.abs() > 540.0 {
            return None;
        }
        q = DVec2::new(p.x.to_radians(), p.y.to_radians());
    }
    if identity {
        return Some(p);
    }
    let mut point = (q.x, q.y, 0.0);
    proj4rs::transform::transform(&from.proj, &to.proj, &mut point).ok()?;
    let mut out = DVec2::new(point.0, point.1);
    if to.is_geographic() {
        out = DVec2::new(wrap_lon(out.x.to_degrees()), out.y.to_degrees());
    }
    (out.is_finite() && out.abs().max_element() <= MAX_COORDINATE).then_some(out)
}

fn wrap_lon(lon_deg: f64) -> f64 {
    if (-180.0..=180.0).contains(&lon_deg) { lon_deg } else { (lon_deg + 180.0).rem_euclid(360.0) - 180.0 }
}

/// EPSG code of the metric system that suits a position: the WGS 84 UTM zone (326xx, 327xx), beyond 84 north and 80 south
/// the polar stereographic systems 32661 and 32761. The exceptions of Norway and Svalbard are not made.
/// `None` if the position is not on the earth.
pub fn utm_epsg(lon_deg: f64, lat_deg: f64) -> Option<u32> {
    if !lon_deg.is_finite() || lat_deg.is_nan() || lat_deg.abs() > 90.0 {
        return None;
    }
    if lat_deg > 84.0 {
        return Some(32661);
    }
    if lat_deg < -80.0 {
        return Some(32761);
    }
    let zone = 1 + (((lon_deg + 180.0).rem_euclid(360.0) / 6.0).floor() as u32).min(59);
    Some(if lat_deg >= 0.0 { 32600 } else { 32700 } + zone)
}

/// Gaussian mean radius of curvature of WGS 84 at a latitude, metres: `sqrt(M N) = a sqrt(1 - e^2) / (1 - e^2 sin^2 lat)`,
/// with M and N the radii along the meridian and across it (any textbook of geodesy). 6,335 to 6,400 km; latitudes
/// beyond the poles and NaN count as the nearest pole or the equator.
pub fn gaussian_radius_m(lat_deg: f64) -> f64 {
    const A: f64 = 6_378_137.0;
    const F: f64 = 1.0 / 298.257_223_563;
    const E2: f64 = F * (2.0 - F);
    let lat = if lat_deg.is_nan() { 0.0 } else { lat_deg.clamp(-90.0, 90.0) };
    let sin = lat.to_radians().sin();
    A * (1.0 - E2).sqrt() / (1.0 - E2 * sin * sin)
}
