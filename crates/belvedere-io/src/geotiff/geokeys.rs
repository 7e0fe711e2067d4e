//! Georeference: where the pixels lie (tie points, scales, matrices) and in which system (GeoKeys).
//!
//! Source: OGC GeoTIFF 1.1 (19-008r4), sections 7 and B.

mod parameters;

use super::ifd::{Container, Ifd, tag};
use crate::crs::is_of_earth;
use crate::raster::{Affine, CrsKind, RasterInfo, SourceCrs};
use belvedere_core::{Warning, WarningKind};
use std::collections::BTreeMap;

/// Value of a GeoKey.
#[derive(Debug, Clone)]
enum Key {
    Short(u32),
    Double(f64),
    Text(String),
}

const USER_DEFINED: u32 = 32767;

struct Keys(BTreeMap<u64, Key>);

impl Keys {
    fn read(container: &Container, ifd: &Ifd) -> Result<Self, String> {
        let directory = container.uints(ifd, tag::GEO_KEYS)?.unwrap_or_default();
        let doubles = container.floats(ifd, tag::GEO_DOUBLES)?.unwrap_or_default();
        let text = container.blob(ifd, tag::GEO_ASCII)?.unwrap_or_default();
        Ok(Self::of(&directory, &doubles, &text))
    }

    /// * `directory`: four numbers for each key, behind a head of four; `doubles`, `text`: the values that do not fit into it.
    fn of(directory: &[u64], doubles: &[f64], text: &[u8]) -> Self {
        let count = directory.get(3).map_or(0, |&n| n as usize);
        let mut keys = BTreeMap::new();
        for entry in directory.get(4..).unwrap_or(&[]).chunks_exact(4).take(count) {
            let &[id, location, count, value] = entry else { continue };
            let value_at = value as usize;
            let key = match u16::try_from(location).unwrap_or(0) {
                0 if location == 0 => Some(Key::Short(value as u32)),
                tag::GEO_DOUBLES => doubles.get(value_at).copied().map(Key::Double),
                tag::GEO_ASCII => {
                    text.get(value_at..value_at.saturating_add(count as usize).min(text.len())).map(|t| {
                        let end = t.iter().position(|&b| b == 0).unwrap_or(t.len());
                        Key::Text(String::from_utf8_lossy(&t[..end]).trim_end_matches('|').trim().to_owned())
                    })
                }
                _ => None,
            };
            if let Some(key) = key {
                keys.insert(id, key);
            }
        }
        Self(keys)
    }

    /// A code; 0 ("undefined") counts as absent.
    fn code(&self, id: u64) -> Option<u32> {
        match self.0.get(&id) {
            Some(&Key::Short(v)) if v != 0 => Some(v),
            _ => None,
        }
    }

    fn double(&self, id: u64) -> Option<f64> {
        match self.0.get(&id) {
            Some(&Key::Double(v)) => Some(v),
            _ => None,
        }
    }

    fn text(&self, id: u64) -> Option<&str> {
        match self.0.get(&id) {
            Some(Key::Text(t)) if !t.is_empty() => Some(t),
            _ => None,
        }
    }
}

mod key {
    pub(super) const MODEL_TYPE: u64 = 1024;
    pub(super) const RASTER_TYPE: u64 = 1025;
    pub(super) const CITATION: u64 = 1026;
    pub(super) const GEODETIC_CRS: u64 = 2048;
    pub(super) const GEODETIC_CITATION: u64 = 2049;
    pub(super) const SEMI_MAJOR_AXIS: u64 = 2057;
    pub(super) const PROJECTED_CRS: u64 = 3072;
    pub(super) const PROJECTED_CITATION: u64 = 3073;
    pub(super) const PROJECTION: u64 = 3074;
    pub(super) const PROJECTION_METHOD: u64 = 3075;
    pub(super) const LINEAR_UNIT: u64 = 3076;
    pub(super) const LINEAR_UNIT_SIZE: u64 = 3077;
    pub(super) const VERTICAL: u64 = 4096;
    pub(super) const VERTICAL_UNIT: u64 = 4099;
}

/// Fills the georeference of `info` from the tags; returns warnings.
pub(super) fn georeference(container: &Container, ifd: &Ifd, info: &mut RasterInfo) -> Result<Vec<Warning>, String> {
    let keys = Keys::read(container, ifd)?;
    let mut warnings = Vec::new();
    info.pixel_is_point = keys.code(key::RASTER_TYPE) == Some(2);
    info.pixel_to_model = transform(container, ifd, &mut warnings)?.map(|t| {
        // The tags of PixelIsPoint speak of sample positions, half a pixel inside the corner.
        if info.pixel_is_point { t.after_scale_and_shift(1.0, 1.0, -0.5, -0.5) } else { t }
    });
    keys.tell_system(info, &mut warnings);
    Ok(warnings)
}

/// Fills the coordinate system of `info` from GeoKeys outside of a TIFF, as LAS has them; returns warnings.
///
/// * `directory`, `doubles`, `text`: values of the tags 34735, 34736 and 34737.
pub(crate) fn system_of_keys(directory: &[u64], doubles: &[f64], text: &[u8], info: &mut RasterInfo) -> Vec<Warning> {
    let mut warnings = Vec::new();
    Keys::of(directory, doubles, text).tell_system(info, &mut warnings);
    warnings
}

impl Keys {
    fn tell_system(&self, info: &mut RasterInfo, warnings: &mut Vec<Warning>) {
        let keys = self;
        info.crs_kind = match keys.code(key::MODEL_TYPE) {
            Some(1) => CrsKind::Projected,
            Some(2) => CrsKind::Geographic,
            Some(3) => CrsKind::Geocentric,
            _ if keys.code(key::PROJECTED_CRS).is_some() => CrsKind::Projected,
            _ if keys.code(key::GEODETIC_CRS).is_some_and(|c| c != USER_DEFINED) => CrsKind::Geographic,
            _ => CrsKind::Unknown,
        };
        info.crs = crs(keys, info.crs_kind);
        info.linear_unit_m = match keys.code(key::LINEAR_UNIT) {
            Some(USER_DEFINED) => keys.double(key::LINEAR_UNIT_SIZE).filter(|s| s.is_finite() && *s > 0.0),
            Some(code) => unit_m(code),
            None => None,
        };
        info.vertical_epsg = keys.code(key::VERTICAL).filter(|&c| c != USER_DEFINED);
        info.vertical_unit_said = keys.code(key::VERTICAL_UNIT).is_some() || info.vertical_epsg.is_some();
        info.vertical_unit_m = match (keys.code(key::VERTICAL_UNIT), info.vertical_epsg) {
            (Some(code), _) => unit_m(code).unwrap_or_else(|| {
                let text = format!("unit of heights (EPSG:{code}) is not known, metres are assumed");
                warnings.push(Warning::new(WarningKind::Assumed, text).with("epsg", f64::from(code)));
                1.0
            }),
            (None, Some(6360)) => US_FOOT_M,
            (None, Some(8228)) => FOOT_M,
            _ => 1.0,
        };
    }
}

pub(super) const FOOT_M: f64 = 0.3048;
pub(super) const US_FOOT_M: f64 = 1200.0 / 3937.0;

/// Metres per unit of an EPSG unit of length.
fn unit_m(code: u32) -> Option<f64> {
    Some(match code {
        9001 => 1.0,
        9002 => FOOT_M,
        9003 => US_FOOT_M,
        9036 => 1000.0,
        9030 => 1852.0,
        _ => return None,
    })
}

fn transform(container: &Container, ifd: &Ifd, warnings: &mut Vec<Warning>) -> Result<Option<Affine>, String> {
    let scale = container.floats(ifd, tag::PIXEL_SCALE)?.unwrap_or_default();
    let ties = container.floats(ifd, tag::TIEPOINT)?.unwrap_or_default();
    let matrix = container.floats(ifd, tag::TRANSFORMATION)?.unwrap_or_default();
    let found = match (&scale[..], &ties[..], &matrix[..]) {
        (&[sx, sy, ..], &[i, j, _, x, y, _, ..], _) if sx != 0.0 && sy != 0.0 => {
            if sy < 0.0 {
                let text = format!("pixel height is stored as {sy:e}; rows are taken to run southwards as usual");
                warnings.push(Warning::new(WarningKind::Repaired, text).with("pixel_height", sy));
            }
            Affine([sx, 0.0, x - i * sx, 0.0, -sy.abs(), y + j * sy.abs()])
        }
        (_, _, &[a, b, _, c, d, e, _, f, ..]) => Affine([a, b, c, d, e, f]),
        (_, ties, _) if ties.len() >= 18 => fit(ties)?,
        (_, ties, _) if ties.len() >= 6 => {
            let text = "has a tie point but no pixel size; it is not georeferenced";
            warnings.push(Warning::new(WarningKind::Ignored, text));
            return Ok(None);
        }
        _ => return Ok(None),
    };
    if found.inverse().is_none() {
        let [a, b, c, d, e, f] = found.0;
        return Err(format!(
            "its georeference [{a:e}, {b:e}, {c:e}; {d:e}, {e:e}, {f:e}] cannot be inverted; assign a proper one, for example with gdal_edit"
        ));
    }
    Ok(Some(found))
}

/// Affine map through three or more ground control points by least squares; an error unless it fits to 0.1 pixel.
fn fit(ties: &[f64]) -> Result<Affine, String> {
    let points: Vec<[f64; 4]> = ties.as_chunks::<6>().0.iter().map(|t| [t[0], t[1], t[3], t[4]]).collect();
    let n = points.len() as f64;
    let mean = points.iter().fold([0.0; 4], |m, p| std::array::from_fn(|k| m[k] + p[k] / n));
    let moment = |a: usize, b: usize| points.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum::<f64>();
    let (cc, cr, rr) = (moment(0, 0), moment(0, 1), moment(1, 1));
    let det = cc * rr - cr * cr;
    let solve = |k: usize| {
        let (ck, rk) = (moment(0, k), moment(1, k));
        let (a, b) = ((ck * rr - rk * cr) / det, (rk * cc - ck * cr) / det);
        [a, b, mean[k] - a * mean[0] - b * mean[1]]
    };
    let ([a, b, c], [d, e, f]) = (solve(2), solve(3));
    let map = Affine([a, b, c, d, e, f]);
    let pixel = map.determinant().abs().sqrt();
    let off = points.iter().map(|p| {
        let [x, y] = map.apply(p[0], p[1]);
        (x - p[2]).hypot(y - p[3]) / pixel
    });
    let worst = off.fold(0.0, f64::max);
    if worst <= 0.1 && pixel > 0.0 {
        return Ok(map);
    }
    Err(format!(
        "is placed by {} ground control points that no affine map fits (worst {worst:.1} pixels off, 0.1 allowed); rectify it first, for example with gdalwarp",
        points.len()
    ))
}

fn crs(keys: &Keys, kind: CrsKind) -> SourceCrs {
    let projected = keys.code(key::PROJECTED_CRS);
    let geodetic = keys.code(key::GEODETIC_CRS);
    let direct = match kind {
        CrsKind::Geographic | CrsKind::Geocentric => geodetic,
        _ => projected,
    };
    if let Some(code) = direct.filter(|&c| c != USER_DEFINED) {
        return SourceCrs::Epsg(code);
    }
    if kind == CrsKind::Projected
        && let Some(code) = utm(geodetic, keys.code(key::PROJECTION))
    {
        return SourceCrs::Epsg(code);
    }
    let citations = [key::PROJECTED_CITATION, key::CITATION, key::GEODETIC_CITATION].map(|id| keys.text(id));
    for text in citations.iter().flatten() {
        if let Some((_, wkt)) = text.split_once("ESRI PE String = ") {
            return SourceCrs::Wkt(wkt.trim_end_matches('|').trim().to_owned());
        }
    }
    if keys.0.is_empty() || (kind == CrsKind::Unknown && citations.iter().all(Option::is_none)) {
        return SourceCrs::Unknown;
    }
    let name = citations.iter().flatten().next().copied().unwrap_or("unnamed");
    let name: String = name.chars().take(80).collect();
    let name = if name == "unknown" { "a system without a name".to_owned() } else { name };
    if keys.double(key::SEMI_MAJOR_AXIS).is_some_and(|a| !is_of_earth(a)) {
        return SourceCrs::OtherBody(name);
    }
    if let Some(system) = parameters::system(keys, kind, &name) {
        return system;
    }
    let method = keys.code(key::PROJECTION_METHOD).map_or(String::new(), |m| format!(", projection method {m}"));
    let what = match kind {
        CrsKind::Projected => "projected",
        CrsKind::Geographic => "geographic",
        CrsKind::Geocentric => "geocentric",
        CrsKind::Unknown => "unspecified",
    };
    SourceCrs::UserDefined(format!("user-defined {what} system \"{name}\"{method} without an EPSG code"))
}

/// UTM given as geodetic system and zone instead of as a projected system.
fn utm(geodetic: Option<u32>, projection: Option<u32>) -> Option<u32> {
    let (south, zone) = match projection? {
        p @ 16001..=16060 => (false, p - 16000),
        p @ 16101..=16160 => (true, p - 16100),
        _ => return None,
    };
    match (geodetic?, south) {
        (4326, false) => Some(32600 + zone),
        (4326, true) => Some(32700 + zone),
        (4258, false) if (28..=38).contains(&zone) => Some(25800 + zone),
        (4269, false) if zone <= 23 => Some(26900 + zone),
        (4267, false) if zone <= 22 => Some(26700 + zone),
        _ => None,
    }
}
