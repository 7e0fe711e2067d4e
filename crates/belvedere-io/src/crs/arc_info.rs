//! The `.prj` files of ARC/INFO, which are older than well-known text: lines of a word and its value, then parameters.
//!
//! Source: ESRI, ARC/INFO Command References, PROJECT and PROJECTIONDEFINE.

use super::{CoordinateSystem, CrsError};

/// The system of such a text; `None` if it is something else.
pub(super) fn parse(text: &str) -> Option<Result<CoordinateSystem, CrsError>> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.clone().next()?.to_ascii_lowercase();
    let method = first.strip_prefix("projection")?.trim().to_ascii_uppercase();
    if method.is_empty() || !first.starts_with("projection ") && !first.starts_with("projection\t") {
        return None;
    }
    let value = |key: &str| {
        let of_key = |line: &str| {
            let (word, rest) = line.split_once(char::is_whitespace)?;
            word.eq_ignore_ascii_case(key).then(|| rest.trim().to_ascii_uppercase())
        };
        text.lines().map(str::trim).find_map(of_key).filter(|v| !v.is_empty())
    };
    lines.find(|line| line.eq_ignore_ascii_case("parameters"));
    let parameters: Vec<f64> = lines.filter_map(parameter).collect();
    Some(system(&method, &value, &parameters))
}

/// A number, or degrees, minutes and seconds; what follows `/*` is a comment.
fn parameter(line: &str) -> Option<f64> {
    let numbers = line.split("/*").next()?.split_whitespace().map(str::parse);
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
    match numbers.as_slice() {
        [value] => Some(*value),
        [degrees, minutes, seconds] => {
            let size = degrees.abs() + minutes / 60.0 + seconds / 3600.0;
            Some(if line.trim_start().starts_with('-') { -size } else { size })
        }
        _ => None,
    }
}

fn system(
    method: &str,
    value: &dyn Fn(&str) -> Option<String>,
    parameters: &[f64],
) -> Result<CoordinateSystem, CrsError> {
    let datum = value("Datum").filter(|d| d != "NONE");
    let units = value("Units").unwrap_or_else(|| "METERS".into());
    let number = |key: &str| value(key).and_then(|v| v.parse::<f64>().ok());
    let is_wgs84 = matches!(datum.as_deref(), Some("WGS84" | "WGS_1984"));
    let is_nad83 = datum.as_deref() == Some("NAD83");
    let is_metric =
        units == "METERS" && number("Yshift").unwrap_or(0.0) == 0.0 && number("Xshift").unwrap_or(0.0) == 0.0;
    let fail = |reason: String| CrsError::Text { reason };
    let zone = || {
        let zone = number("Zone").filter(|z| z.fract() == 0.0 && (1.0..=60.0).contains(&z.abs()));
        zone.ok_or_else(|| fail("it states UTM without a zone from 1 to 60".into()))
    };
    let projection = match (method, parameters) {
        ("GEOGRAPHIC", _) if is_wgs84 => return CoordinateSystem::from_epsg(4326),
        ("GEOGRAPHIC", _) if units == "DD" || units == "DEGREES" => "+proj=longlat".to_owned(),
        ("UTM", _) if is_metric && (is_wgs84 || (is_nad83 && zone()? > 0.0)) => {
            let zone = zone()?;
            let base = if is_nad83 { 26900 } else { 32600 } + if zone < 0.0 { 100 } else { 0 };
            return CoordinateSystem::from_epsg(base + zone.abs() as u32);
        }
        ("UTM", _) => {
            let zone = zone()?;
            let south = if zone < 0.0 { " +south" } else { "" };
            format!("+proj=utm +zone={}{south}", zone.abs())
        }
        ("ALBERS" | "LAMBERT", [lat_1, lat_2, lon, lat, x, y, ..]) => {
            let name = if method == "ALBERS" { "aea" } else { "lcc" };
            format!("+proj={name} +lat_1={lat_1} +lat_2={lat_2} +lon_0={lon} +lat_0={lat} +x_0={x} +y_0={y}")
        }
        ("TRANSVERSE" | "TRANSVERSE_MERCATOR", [k, lon, lat, x, y, ..]) => {
            format!("+proj=tmerc +k={k} +lon_0={lon} +lat_0={lat} +x_0={x} +y_0={y}")
        }
        _ => {
            return Err(fail(format!(
                "its lines of ARC/INFO state the projection {method:.40}, which is not known in this form"
            )));
        }
    };
    let unit = match units.as_str() {
        "FEET" => " +units=us-ft",
        _ if method == "GEOGRAPHIC" => "",
        _ => " +units=m",
    };
    let name = format!("{method} of ARC/INFO");
    let spheroid = value("Spheroid").unwrap_or_default();
    CoordinateSystem::from_proj_string(&name, &format!("{projection}{unit} {}", on(datum.as_deref(), &spheroid)))
}

/// Datum or ellipsoid.
fn on(datum: Option<&str>, spheroid: &str) -> String {
    match (datum, spheroid.replace(['_', ' '], "").as_str()) {
        (Some("WGS84" | "WGS_1984"), _) => "+datum=WGS84".into(),
        (Some("NAD83"), _) => "+datum=NAD83".into(),
        (Some("NAD27"), _) => "+datum=NAD27".into(),
        (_, "GRS80" | "GRS1980") => "+ellps=GRS80 +towgs84=0,0,0".into(),
        (_, "WGS84") => "+datum=WGS84".into(),
        (_, "CLARKE1866") => "+ellps=clrk66".into(),
        (_, "BESSEL" | "BESSEL1841") => "+ellps=bessel".into(),
        (_, "INT1909" | "INTERNATIONAL1909" | "INTERNATIONAL1924") => "+ellps=intl".into(),
        (_, "KRASOVSKY" | "KRASSOVSKY") => "+ellps=krass".into(),
        (_, "AIRY") => "+ellps=airy".into(),
        _ => "+ellps=WGS84".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_arc_info_are_systems() {
        let of = |text: &str| parse(text).map(|s| s.map(|s| (s.epsg(), s.proj_string().to_owned())));
        let utm = |zone: &str, datum: &str| {
            format!(
                "Projection    UTM\r\nZone          {zone}\r\nDatum         {datum}\r\nZunits        NO\r\nUnits         METERS\r\nSpheroid      GRS80\r\nXshift        0.0\r\nYshift        0.0\r\nParameters\r\n"
            )
        };
        assert_eq!(of(&utm("32", "WGS84")).expect("known").expect("valid").0, Some(32632));
        assert_eq!(of(&utm("-33", "WGS84")).expect("known").expect("valid").0, Some(32733));
        assert_eq!(of(&utm("13", "NAD83")).expect("known").expect("valid").0, Some(26913));
        assert_eq!(
            of("projection geographic\ndatum wgs84\nunits dd\nparameters\n").expect("known").expect("valid").0,
            Some(4326)
        );
        let albers = "Projection ALBERS\nDatum NAD83\nUnits METERS\nSpheroid GRS1980\nParameters\n 29 30  0.0 /* 1st standard parallel\n 45 30  0.0 /* 2nd\n-96  0  0.0 /* central meridian\n 23  0  0.0 /* latitude\n0.0 /* false easting (meters)\n0.0 /* false northing (meters)\n";
        let (_, found) = of(albers).expect("known").expect("valid");
        assert!(found.contains("+proj=aea +lat_1=29.5 +lat_2=45.5 +lon_0=-96 +lat_0=23 +x_0=0 +y_0=0"), "{found}");
        for (text, want) in
            [("Projection UTM\nUnits METERS\n", "without a zone"), ("Projection VAN_DER_GRINTEN\n", "VAN_DER_GRINTEN")]
        {
            let error = of(text).expect("known").unwrap_err().to_string();
            assert!(error.contains(want), "{error}");
        }
        for text in ["PROJCS[\"x\"]", "EPSG:32632", "", "Projection", "projections of all kinds"] {
            assert!(of(text).is_none(), "{text}");
        }
    }
}
