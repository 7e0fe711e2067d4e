//! Well-known text of coordinate systems, OGC 1 and 2 and ESRI.

use super::{CoordinateSystem, CrsError, is_of_earth, tables};
use std::fmt::Write;

mod register;

pub(crate) use register::code_of_parameters;

/// Deepest nesting accepted.
const MAX_DEPTH: usize = 32;

/// `KEYWORD["text", 1.5, CHILD[...]]`.
#[derive(Debug, Default)]
struct Node {
    keyword: String,
    texts: Vec<String>,
    numbers: Vec<f64>,
    children: Vec<Node>,
}

impl Node {
    fn child(&self, keywords: &[&str]) -> Option<&Node> {
        self.children.iter().find(|c| keywords.iter().any(|k| c.keyword.eq_ignore_ascii_case(k)))
    }

    fn name(&self) -> &str {
        self.texts.first().map_or("", String::as_str)
    }

    fn is(&self, keywords: &[&str]) -> bool {
        keywords.iter().any(|k| self.keyword.eq_ignore_ascii_case(k))
    }

    /// EPSG code of this node itself, not of its children.
    fn epsg(&self) -> Option<u32> {
        let id = self.child(&["AUTHORITY", "ID"])?;
        if !id.name().eq_ignore_ascii_case("EPSG") {
            return None;
        }
        let code = id.texts.get(1).and_then(|t| t.parse().ok());
        code.or_else(|| id.numbers.first().filter(|n| (1.0..1e6).contains(*n)).map(|n| *n as u32))
    }
}

fn text_error(reason: impl Into<String>) -> CrsError {
    CrsError::Text { reason: reason.into() }
}

/// Reads one node from `rest`, leaving what follows it.
fn node(rest: &mut &str, depth: usize) -> Result<Node, CrsError> {
    if depth > MAX_DEPTH {
        return Err(text_error(format!("it is nested more than {MAX_DEPTH} deep")));
    }
    let open = rest.find(['[', '(']).ok_or_else(|| text_error("a bracket is missing"))?;
    let keyword = rest[..open].trim().to_owned();
    if keyword.is_empty() || !keyword.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(text_error("it does not start with a keyword"));
    }
    *rest = &rest[open + 1..];
    let mut out = Node { keyword, ..Node::default() };
    loop {
        *rest = rest.trim_start();
        let first = rest.chars().next().ok_or_else(|| text_error("it ends inside a bracket"))?;
        match first {
            ']' | ')' => {
                *rest = &rest[1..];
                return Ok(out);
            }
            ',' => *rest = &rest[1..],
            '"' => out.texts.push(quoted(rest)?),
            _ => {
                let end = rest.find([',', ']', ')', '[', '(']).ok_or_else(|| text_error("it ends inside a bracket"))?;
                if rest[end..].starts_with(['[', '(']) {
                    out.children.push(node(rest, depth + 1)?);
                    continue;
                }
                let word = rest[..end].trim();
                match word.parse::<f64>() {
                    Ok(v) if v.is_finite() => out.numbers.push(v),
                    _ => out.texts.push(word.to_owned()),
                }
                *rest = &rest[end..];
            }
        }
    }
}

/// Reads a quoted text; `""` inside it is a quote.
fn quoted(rest: &mut &str) -> Result<String, CrsError> {
    let mut out = String::new();
    let mut at = 1;
    loop {
        let tail = rest.get(at..).unwrap_or("");
        let end = tail.find('"').ok_or_else(|| text_error("a closing quote is missing"))?;
        out.push_str(&tail[..end]);
        at += end + 1;
        if !rest[at..].starts_with('"') {
            *rest = &rest[at..];
            return Ok(out);
        }
        out.push('"');
        at += 1;
    }
}

const PROJECTED: [&str; 4] = ["PROJCS", "PROJCRS", "PROJECTEDCRS", "BASEPROJCRS"];
const GEOGRAPHIC: [&str; 6] = ["GEOGCS", "GEOGCRS", "GEODCRS", "GEODETICCRS", "BASEGEOGCRS", "BASEGEODCRS"];

/// See [`CoordinateSystem::from_wkt`].
pub(super) fn parse(text: &str) -> Result<CoordinateSystem, CrsError> {
    let mut rest = text.trim_start_matches('\u{feff}').trim();
    let root = node(&mut rest, 0)?;
    let horizontal = find(&root).ok_or_else(|| text_error(format!("{} holds no horizontal system", root.keyword)))?;
    // Codes of other registers and unknown codes are ignored: names and parameters may identify the system.
    let stated = horizontal.epsg().map(CoordinateSystem::from_epsg).and_then(Result::ok);
    if let Some(system) =
        stated.or_else(|| code_by_name(horizontal.name()).and_then(|c| CoordinateSystem::from_epsg(c).ok()))
    {
        return Ok(system);
    }
    let name = match horizontal.name() {
        "" => "the system of the file",
        name => name,
    };
    if axis(horizontal).is_some_and(|a| !is_of_earth(a)) {
        return Ok(CoordinateSystem::of_other_body(name));
    }
    if let Some(extension) = horizontal.child(&["EXTENSION"])
        && extension.name().eq_ignore_ascii_case("PROJ4")
        && let Some(proj) = extension.texts.get(1)
    {
        return CoordinateSystem::from_proj_string(name, proj);
    }
    let text = proj_string(horizontal)?;
    match register::code_of(horizontal, &text).map(CoordinateSystem::from_epsg) {
        Some(Ok(system)) => Ok(system),
        _ => CoordinateSystem::from_proj_string(name, &register::on_known_datum(horizontal, &text)),
    }
}

/// The system of a name alone, such as `RD_New` or `GCS_Amersfoort`; `None` if it is not known.
pub(super) fn by_name(name: &str) -> Option<Result<CoordinateSystem, CrsError>> {
    let named = |name: &str| tables::geographic(&format!("={}", plain(name)));
    code_by_name(name).or_else(|| named(name)).map(CoordinateSystem::from_epsg)
}

/// Letters and digits of a name, in lower case.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
}

/// The projected or geographic node of a (possibly compound or bound) system.
fn find(node: &Node) -> Option<&Node> {
    if node.is(&PROJECTED) || node.is(&GEOGRAPHIC) {
        return Some(node);
    }
    node.children.iter().find_map(find)
}

/// Semi-major axis of the spheroid of a system, metres.
fn axis(system: &Node) -> Option<f64> {
    let geographic = if system.is(&PROJECTED) { system.child(&GEOGRAPHIC)? } else { system };
    let datum = geographic.child(&["DATUM", "GEODETICDATUM", "TRF", "ENSEMBLE"])?;
    let spheroid = datum.child(&["SPHEROID", "ELLIPSOID"])?;
    Some(
        spheroid.numbers.first()?
            * spheroid.child(&["LENGTHUNIT", "UNIT"]).and_then(|u| u.numbers.first()).unwrap_or(&1.0),
    )
}

/// EPSG codes of names that texts without codes use, mostly ESRI's.
fn code_by_name(name: &str) -> Option<u32> {
    let plain = plain(name);
    let fixed = match plain.as_str() {
        "gcswgs1984" | "wgs84" | "wgs1984" => 4326,
        "gcsnorthamerican1983" | "nad83" => 4269,
        "gcsnorthamerican1927" | "nad27" => 4267,
        "gcsetrs1989" | "etrs89" => 4258,
        "wgs1984webmercatorauxiliarysphere" | "wgs84pseudomercator" | "webmercator" => 3857,
        "ch1903lv95" | "ch1903lv95lv95" => 2056,
        "ch1903lv03" => 21781,
        "rdnew" | "amersfoortrdnew" => 28992,
        "mgiaustrialambert" => 31287,
        "sjtskkrovakeastnorth" => 5514,
        "hungarian1972egysegesorszagosvetuleti" | "hd72eov" => 23700,
        "stereo1970" | "stereo70" | "pulkovo194258stereo70" => 3844,
        "britishnationalgrid" | "osgb1936britishnationalgrid" => 27700,
        "rgf1993lambert93" | "rgf93lambert93" => 2154,
        "etrs1989laea" | "etrs89laeaeurope" | "etrs89extendedlaeaeurope" => 3035,
        _ => 0,
    };
    if fixed != 0 {
        return Some(fixed);
    }
    let (head, zone) = plain.split_once("utmzone")?;
    let (number, north) = match zone.strip_suffix('n') {
        Some(n) => (n, true),
        None => (zone.strip_suffix('s')?, false),
    };
    let zone: u32 = number.parse().ok().filter(|z| (1..=60).contains(z))?;
    match (head, north) {
        ("wgs1984" | "wgs84", true) => Some(32600 + zone),
        ("wgs1984" | "wgs84", false) => Some(32700 + zone),
        ("etrs1989" | "etrs89", true) if (28..=38).contains(&zone) => Some(25800 + zone),
        ("nad1983" | "nad83", true) if zone <= 23 => Some(26900 + zone),
        ("nad1927" | "nad27", true) if zone <= 22 => Some(26700 + zone),
        _ => None,
    }
}

/// PROJ string from the parameters of a WKT 1 node.
fn proj_string(system: &Node) -> Result<String, CrsError> {
    let projected = system.is(&PROJECTED);
    let geographic = if projected { system.child(&GEOGRAPHIC) } else { Some(system) };
    let geographic = geographic.ok_or_else(|| text_error("it has no geographic system inside"))?;
    let angle_rad = unit(geographic).unwrap_or(1f64.to_radians());
    let mut out = if projected { projection(system, angle_rad)? } else { String::from("+proj=longlat") };
    push(&mut out, &datum(geographic)?);
    if let Some(meridian) = geographic.child(&["PRIMEM", "PRIMEMERIDIAN"]).and_then(|m| m.numbers.first())
        && *meridian != 0.0
    {
        push(&mut out, &format!("+pm={}", degrees(*meridian, angle_rad)));
    }
    if projected {
        push(&mut out, &format!("+to_meter={}", unit(system).unwrap_or(1.0)));
    }
    Ok(out)
}

fn push(out: &mut String, part: &str) {
    if !part.is_empty() {
        let _ = write!(out, " {part}");
    }
}

fn unit(node: &Node) -> Option<f64> {
    let unit = node.child(&["UNIT", "LENGTHUNIT", "ANGLEUNIT"])?;
    unit.numbers.first().copied().filter(|u| *u > 0.0)
}

fn degrees(value: f64, angle_rad: f64) -> f64 {
    // the common rounding of pi/180 must not shift positions
    if (angle_rad - 1f64.to_radians()).abs() < 1e-12 { value } else { (value * angle_rad).to_degrees() }
}

fn datum(geographic: &Node) -> Result<String, CrsError> {
    let datum = geographic.child(&["DATUM", "GEODETICDATUM", "TRF", "ENSEMBLE"]);
    let datum = datum.ok_or_else(|| text_error("it has no datum"))?;
    let plain = plain(datum.name());
    match plain.as_str() {
        "dwgs1984" | "wgs1984" | "worldgeodeticsystem1984" | "worldgeodeticsystem1984ensemble" => {
            return Ok("+datum=WGS84".into());
        }
        "dnorthamerican1983" | "northamericandatum1983" => return Ok("+datum=NAD83".into()),
        "dnorthamerican1927" | "northamericandatum1927" => return Ok("+datum=NAD27".into()),
        _ => {}
    }
    let spheroid = datum.child(&["SPHEROID", "ELLIPSOID"]).ok_or_else(|| text_error("it has no spheroid"))?;
    let (a, rf) = match spheroid.numbers.as_slice() {
        [a, rf, ..] if *a > 0.0 && *rf >= 0.0 => (*a, *rf),
        _ => return Err(text_error("its spheroid has no valid axis and flattening")),
    };
    let mut out = if rf == 0.0 { format!("+a={a} +b={a}") } else { format!("+a={a} +rf={rf}") };
    let etrs = matches!(plain.as_str(), "detrs1989" | "europeanterrestrialreferencesystem1989");
    if let Some(shift) = datum.child(&["TOWGS84"]) {
        let numbers: Vec<String> = shift.numbers.iter().map(f64::to_string).collect();
        if matches!(numbers.len(), 3 | 7) {
            push(&mut out, &format!("+towgs84={}", numbers.join(",")));
        }
    } else if etrs {
        push(&mut out, "+towgs84=0,0,0");
    }
    Ok(out)
}

/// Projection method and its parameters.
fn projection(system: &Node, angle_rad: f64) -> Result<String, CrsError> {
    let method = system.child(&["PROJECTION"]).map(Node::name);
    let method = method.ok_or_else(|| text_error("it has no EPSG code and no PROJECTION element of WKT 1"))?;
    let plain = plain(method);
    let unsupported = |reason: String| CrsError::Unsupported { name: system.name().to_owned(), reason };
    let proj = match plain.as_str() {
        "transversemercator" | "gausskruger" | "transversemercatorsouthorientated" => "tmerc",
        "lambertconformalconic" | "lambertconformalconic1sp" | "lambertconformalconic2sp" => "lcc",
        "albers" | "albersconicequalarea" => "aea",
        "mercator" | "mercator1sp" | "mercator2sp" => "merc",
        "polarstereographic" | "stereographic" | "stereographicnorthpole" | "stereographicsouthpole" => "stere",
        "obliquestereographic" | "doublestereographic" => "sterea",
        "lambertazimuthalequalarea" => "laea",
        "azimuthalequidistant" => "aeqd",
        "geostationarysatellite" => "geos",
        "equirectangular" | "platecarree" | "equidistantcylindrical" => "eqc",
        "cylindricalequalarea" => "cea",
        "cassini" | "cassinisoldner" => "cass",
        "sinusoidal" => "sinu",
        "mollweide" => "moll",
        "robinson" => "robin",
        "equidistantconic" => "eqdc",
        "millercylindrical" => "mill",
        "orthographic" => "ortho",
        "gnomonic" => "gnom",
        "polyconic" => "poly",
        "krovak" => "krovak",
        "swissobliquecylindrical" | "swissobliquemercator" => "somerc",
        "hotineobliquemercatorazimuthcenter"
        | "obliquemercator"
        | "hotineobliquemercatorvariantb"
        | "rectifiedskeworthomorphiccenter"
        | "rectifiedskeworthomorphicnaturalorigin"
        | "hotineobliquemercator"
        | "hotineobliquemercatorazimuthnaturalorigin"
        | "hotineobliquemercatorvarianta" => "omerc",
        _ => return Err(unsupported(format!("the projection method {method} is not supported"))),
    };
    let value = |names: &[&str]| {
        let named = |c: &&Node| c.is(&["PARAMETER"]) && names.iter().any(|n| c.name().eq_ignore_ascii_case(n));
        system.children.iter().find(named).and_then(|p| p.numbers.first().copied())
    };
    if proj == "omerc" {
        return Ok(oblique(&plain, &value, angle_rad, unit(system).unwrap_or(1.0)));
    }
    if proj == "krovak" && value(&["X_Scale"]).is_some_and(|x| x > 0.0) {
        return Err(unsupported("its Krovak axes run south and west".to_owned()));
    }
    let mut out = format!("+proj={proj}");
    if plain == "transversemercatorsouthorientated" {
        out.push_str(" +axis=wsu");
    }
    for parameter in system.children.iter().filter(|c| c.is(&["PARAMETER"])) {
        let Some(&value) = parameter.numbers.first() else { continue };
        push(&mut out, &proj_parameter(proj, &plain, parameter.name(), value, angle_rad, unit(system).unwrap_or(1.0)));
    }
    Ok(out)
}

/// The oblique Mercator projections; with an azimuth of 90 degrees they are the Swiss projection, which is simpler.
fn oblique(method: &str, value: &dyn Fn(&[&str]) -> Option<f64>, angle_rad: f64, unit_m: f64) -> String {
    let angle = |names: &[&str]| value(names).map(|v| degrees(v, angle_rad));
    let azimuth = angle(&["azimuth", "Azimuth_of_initial_line"]).unwrap_or(90.0);
    let grid =
        angle(&["rectified_grid_angle", "XY_Plane_Rotation", "Angle_from_Rectified_to_Skew_Grid"]).unwrap_or(azimuth);
    let lat = angle(&["latitude_of_center", "latitude_of_origin", "Latitude_of_projection_centre"]).unwrap_or(0.0);
    let lon = angle(&["longitude_of_center", "central_meridian", "Longitude_of_projection_centre"]).unwrap_or(0.0);
    let k = value(&["scale_factor"]).unwrap_or(1.0);
    let shift = [value(&["false_easting"]), value(&["false_northing"])].map(|v| v.unwrap_or(0.0) * unit_m);
    let common = format!("+k_0={k} +x_0={} +y_0={}", shift[0], shift[1]);
    let at_centre = method.contains("center") || method.contains("variantb") || method == "obliquemercator";
    if (azimuth - 90.0).abs() < 1e-9 && (grid - 90.0).abs() < 1e-9 && at_centre {
        return format!("+proj=somerc +lat_0={lat} +lon_0={lon} {common}");
    }
    let origin = if at_centre { "" } else { " +no_uoff" };
    format!("+proj=omerc +lat_0={lat} +lonc={lon} +alpha={azimuth} +gamma={grid}{origin} {common}")
}

fn proj_parameter(proj: &str, method: &str, name: &str, value: f64, angle_rad: f64, unit_m: f64) -> String {
    let angle = degrees(value, angle_rad);
    match name.to_ascii_lowercase().as_str() {
        "false_easting" => format!("+x_0={}", value * unit_m),
        "false_northing" => format!("+y_0={}", value * unit_m),
        "scale_factor" => format!("+k_0={value}"),
        "central_meridian" | "longitude_of_center" | "longitude_of_origin" => format!("+lon_0={angle}"),
        "standard_parallel_1" if matches!(proj, "merc" | "stere" | "eqc" | "cea") => {
            let pole = if proj == "stere" { format!(" +lat_0={}", 90f64.copysign(angle)) } else { String::new() };
            format!("+lat_ts={angle}{pole}")
        }
        "standard_parallel_1" => format!("+lat_1={angle}"),
        "standard_parallel_2" => format!("+lat_2={angle}"),
        "latitude_of_origin" if method == "polarstereographic" && angle.abs() < 90.0 => {
            format!("+lat_ts={angle} +lat_0={}", 90f64.copysign(angle))
        }
        "latitude_of_origin" | "latitude_of_center" if method == "lambertconformalconic1sp" => {
            format!("+lat_0={angle} +lat_1={angle}")
        }
        "latitude_of_origin" | "latitude_of_center" => format!("+lat_0={angle}"),
        "satellite_height" => format!("+h={value}"),
        "azimuth" if proj == "krovak" => format!("+alpha={angle}"),
        "pseudo_standard_parallel_1" | "x_scale" | "y_scale" | "xy_plane_rotation" => String::new(),
        _ => String::new(),
    }
}
