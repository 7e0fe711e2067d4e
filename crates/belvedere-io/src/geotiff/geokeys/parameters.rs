//! Systems that GeoKeys give by parameters alone, as PROJ strings.
//!
//! Source: OGC GeoTIFF 1.1 (19-008r4), sections 7.5 and C; parameters of the methods as in GDAL's list of GeoTIFF projections.

use super::{Keys, USER_DEFINED, key, unit_m};
use crate::crs::{CoordinateSystem, code_of_parameters};
use crate::raster::{CrsKind, SourceCrs};

/// Numbers of keys, those that mean the same in turn.
const LAT_0: [u64; 3] = [3081, 3085, 3089];
const LON_0: [u64; 4] = [3080, 3084, 3088, 3095];
const X_0: [u64; 3] = [3082, 3086, 3090];
const Y_0: [u64; 3] = [3083, 3087, 3091];
const SCALE: [u64; 2] = [3092, 3093];
const PARALLEL_1: [u64; 1] = [3078];
const PARALLEL_2: [u64; 1] = [3079];
const AZIMUTH: [u64; 1] = [3094];
const RECTIFIED: [u64; 1] = [3096];

const GEODETIC_DATUM: u64 = 2050;
const ANGULAR_UNIT: u64 = 2054;
const ELLIPSOID: u64 = 2056;
const SEMI_MINOR_AXIS: u64 = 2058;
const INVERSE_FLATTENING: u64 = 2059;
const PRIME_MERIDIAN: u64 = 2061;
const DEGREE: u32 = 9102;

/// The system of these keys: its EPSG code if one has the same parameters, else its name and PROJ string. `None` if its method or its
/// datum is not known.
pub(super) fn system(keys: &Keys, kind: CrsKind, name: &str) -> Option<SourceCrs> {
    if keys.code(ANGULAR_UNIT).is_some_and(|unit| unit != DEGREE) {
        return None;
    }
    let geodetic = keys.code(key::GEODETIC_CRS).filter(|c| *c != USER_DEFINED);
    // Datums of the register have the number of their geographic system plus 2000.
    let datum = keys.code(GEODETIC_DATUM).filter(|c| (6000..7000).contains(c)).map(|c| c - 2000);
    let base = geodetic.or(datum).filter(|c| CoordinateSystem::from_epsg(*c).is_ok_and(|s| s.is_geographic()));
    let projection = match kind {
        CrsKind::Projected => projection(keys)?,
        CrsKind::Geographic => "+proj=longlat".to_owned(),
        _ => return None,
    };
    if let Some(base) = base {
        if kind == CrsKind::Geographic {
            return Some(SourceCrs::Epsg(base));
        }
        if let Some(code) = code_of_parameters(base, &projection) {
            return Some(SourceCrs::Epsg(code));
        }
    }
    let on = match base {
        Some(base) => {
            let system = CoordinateSystem::from_epsg(base).ok()?;
            system.proj_string().replace("+proj=longlat", "").replace("+proj=latlong", "").trim().to_owned()
        }
        None => ellipsoid(keys)?,
    };
    let meridian = keys.double(PRIME_MERIDIAN).filter(|m| *m != 0.0 && base.is_none());
    let meridian = meridian.map_or(String::new(), |m| format!(" +pm={m}"));
    Some(SourceCrs::Wkt(format!("{} {projection} {on}{meridian}", name.replace("+proj=", ""))))
}

/// Method and parameters; lengths in metres.
fn projection(keys: &Keys) -> Option<String> {
    let unit = match keys.code(key::LINEAR_UNIT) {
        Some(USER_DEFINED) => keys.double(key::LINEAR_UNIT_SIZE).filter(|s| s.is_finite() && *s > 0.0)?,
        Some(code) => unit_m(code)?,
        None => 1.0,
    };
    let first = |ids: &[u64]| ids.iter().find_map(|id| keys.double(*id)).filter(|v| v.is_finite());
    let (lat_0, lon_0) = (first(&LAT_0).unwrap_or(0.0), first(&LON_0).unwrap_or(0.0));
    let parallel = |ids: &[u64]| first(ids).unwrap_or(lat_0);
    let (lat_1, lat_2) = (parallel(&PARALLEL_1), parallel(&PARALLEL_2));
    let k = first(&SCALE).filter(|k| *k > 0.0).unwrap_or(1.0);
    let at = format!("+lat_0={lat_0} +lon_0={lon_0}");
    let azimuth = first(&AZIMUTH).unwrap_or(90.0);
    let oblique = || {
        let grid = first(&RECTIFIED).unwrap_or(azimuth);
        format!("+proj=omerc +lat_0={lat_0} +lonc={lon_0} +alpha={azimuth} +gamma={grid} +k={k}")
    };
    let method = match keys.code(key::PROJECTION_METHOD)? {
        1 => format!("+proj=tmerc {at} +k={k}"),
        3 => format!("{} +no_uoff", oblique()),
        9815 => oblique(),
        7 => match first(&PARALLEL_1) {
            Some(lat_ts) => format!("+proj=merc +lon_0={lon_0} +lat_ts={lat_ts}"),
            None => format!("+proj=merc +lon_0={lon_0} +k={k}"),
        },
        8 => format!("+proj=lcc {at} +lat_1={lat_1} +lat_2={lat_2}"),
        9 => format!("+proj=lcc {at} +lat_1={lat_0} +k={k}"),
        10 => format!("+proj=laea {at}"),
        11 => format!("+proj=aea {at} +lat_1={lat_1} +lat_2={lat_2}"),
        12 => format!("+proj=aeqd {at}"),
        13 => format!("+proj=eqdc {at} +lat_1={lat_1} +lat_2={lat_2}"),
        14 => format!("+proj=stere {at} +k={k}"),
        15 => {
            let pole = 90f64.copysign(lat_0);
            let scale = if lat_0.abs() < 90.0 { format!("+lat_ts={lat_0}") } else { format!("+k={k}") };
            format!("+proj=stere +lat_0={pole} +lon_0={lon_0} {scale}")
        }
        16 => format!("+proj=sterea {at} +k={k}"),
        17 => format!("+proj=eqc {at} +lat_ts={}", first(&PARALLEL_1).unwrap_or(0.0)),
        18 => format!("+proj=cass {at}"),
        19 => format!("+proj=gnom {at}"),
        20 => format!("+proj=mill +lon_0={lon_0}"),
        21 => format!("+proj=ortho {at}"),
        22 => format!("+proj=poly {at}"),
        23 => format!("+proj=robin +lon_0={lon_0}"),
        24 => format!("+proj=sinu +lon_0={lon_0}"),
        27 => format!("+proj=tmerc +axis=wsu {at} +k={k}"),
        28 => format!("+proj=cea +lon_0={lon_0} +lat_ts={}", first(&PARALLEL_1).unwrap_or(0.0)),
        _ => return None,
    };
    let [x_0, y_0] = [&X_0, &Y_0].map(|ids| first(ids).unwrap_or(0.0) * unit);
    let unit = if unit == 1.0 { "+units=m".to_owned() } else { format!("+to_meter={unit}") };
    Some(format!("{method} +x_0={x_0} +y_0={y_0} {unit}"))
}

/// Ellipsoid by its code or its axes.
fn ellipsoid(keys: &Keys) -> Option<String> {
    let known = match keys.code(ELLIPSOID) {
        Some(7030) => "+datum=WGS84",
        Some(7019) => "+ellps=GRS80 +towgs84=0,0,0",
        Some(7004) => "+ellps=bessel",
        Some(7008) => "+ellps=clrk66",
        Some(7012) => "+ellps=clrk80",
        Some(7022) => "+ellps=intl",
        Some(7024) => "+ellps=krass",
        Some(7001) => "+ellps=airy",
        _ => "",
    };
    if !known.is_empty() {
        return Some(known.to_owned());
    }
    let axis = keys.double(key::SEMI_MAJOR_AXIS).filter(|a| *a > 0.0)?;
    let flattening = keys.double(INVERSE_FLATTENING).filter(|f| *f > 0.0);
    let minor = keys.double(SEMI_MINOR_AXIS).unwrap_or(axis);
    Some(flattening.map_or_else(|| format!("+a={axis} +b={minor}"), |f| format!("+a={axis} +rf={f}")))
}
