//! Coordinate systems against PROJ 9.5, which shares no code with the reader: by code and by ESRI's text without one.
//! `crs_reference.tsv` holds code, longitude, latitude, x, y and text, chosen at random and by hand by a script with pyproj.

use belvedere_io::crs::{CoordinateSystem, Transform};
use glam::DVec2;

/// Bound on the distance from PROJ without grids, metres.
const BOUND_M: f64 = 5.0;

struct Row {
    code: u32,
    degrees: DVec2,
    place: DVec2,
    text: &'static str,
}

fn rows() -> Vec<Row> {
    let row = |line: &'static str| {
        let parts: Vec<&str> = line.split('\t').collect();
        let number = |k: usize| parts[k].parse::<f64>().expect(line);
        let (degrees, place) = (DVec2::new(number(1), number(2)), DVec2::new(number(3), number(4)));
        Row { code: parts[0].parse().expect(line), degrees, place, text: parts[5] }
    };
    include_str!("crs_reference.tsv").lines().map(row).collect()
}

fn metres(system: &CoordinateSystem, a: DVec2, b: DVec2, lat: f64) -> f64 {
    match system.metres_per_unit() {
        Some(unit) => unit * a.distance(b),
        None => ((a - b) * DVec2::new(lat.to_radians().cos(), 1.0)).length() * 111_195.0,
    }
}

#[test]
fn places_by_code_are_those_of_proj() {
    let wgs84 = CoordinateSystem::wgs84().unwrap();
    let rows = rows();
    assert!(rows.len() > 140);
    let (mut off, mut unknown) = (Vec::new(), Vec::new());
    for row in &rows {
        let Ok(system) = CoordinateSystem::from_epsg(row.code) else {
            unknown.push(row.code);
            continue;
        };
        let t = Transform::new(&wgs84, &system).unwrap();
        let found = t.forward_one(row.degrees).unwrap_or(DVec2::INFINITY);
        let distance = metres(&system, found, row.place, row.degrees.y);
        if !(distance < BOUND_M) {
            off.push(format!("EPSG:{} by {distance:.1} m", row.code));
        }
    }
    assert!(off.is_empty(), "{off:?}");
    assert!(unknown.len() <= 3, "{unknown:?}");
}

#[test]
fn texts_of_esri_and_codes_give_the_same_place() {
    let wgs84 = CoordinateSystem::wgs84().unwrap();
    let mut off = Vec::new();
    let (mut by_code, mut all) = (0, 0);
    for row in rows() {
        let Ok(system) = CoordinateSystem::from_epsg(row.code) else { continue };
        all += 1;
        let by_text = match CoordinateSystem::from_wkt(row.text) {
            Ok(by_text) => by_text,
            Err(e) => {
                off.push(format!("EPSG:{}: {e}", row.code));
                continue;
            }
        };
        by_code += usize::from(by_text.epsg().is_some());
        let place = |s: &CoordinateSystem| Transform::new(&wgs84, s).unwrap().forward_one(row.degrees);
        let (Some(a), Some(b)) = (place(&system), place(&by_text)) else {
            off.push(format!("EPSG:{}: nowhere", row.code));
            continue;
        };
        let distance = metres(&system, a, b, row.degrees.y);
        if !(distance < 0.5) {
            off.push(format!("EPSG:{} by {distance:.2} m as {}", row.code, by_text.proj_string()));
        }
    }
    assert!(off.len() * 50 <= all, "{} of {all}: {off:#?}", off.len());
    assert!(by_code * 10 >= all * 8, "{by_code} of {all} by code");
}

/// Datums that agree with WGS 84 within two metres are no reason for a warning.
#[test]
fn no_false_alarms() {
    for code in [
        4326, 25832, 3035, 2056, 28355, 7844, 3111, 31983, 4674, 2193, 6670, 2154, 3857, 26913, 5070, 2903, 3812,
        32633, 4490, 4528, 22414, 9150, 9697, 10626, 9823, 6784, 6668,
    ] {
        let system = CoordinateSystem::from_epsg(code).unwrap();
        let note = system.datum_note();
        // 2056 is joined by a shift of hundreds of metres that is known to centimetres
        assert!(note.as_ref().is_none_or(|n| !n.text().contains("some 100 m")), "EPSG:{code}: {note:?}");
        assert!(note.is_none() || code == 2056, "EPSG:{code}: {note:?}");
    }
}

#[test]
fn codes_of_other_registers_are_those_of_today() {
    for text in ["EPSG:900913", "ESRI:102100", "urn:ogc:def:crs:ESRI::102100", "EPSG:3785", "102113", "EPSG:3857"] {
        assert_eq!(CoordinateSystem::from_text(text).unwrap().epsg(), Some(3857), "{text}");
    }
    for (text, code) in [("RD_New", 28992), ("GCS_Amersfoort", 4289), ("WGS_1984_UTM_Zone_33N", 32633)] {
        assert_eq!(CoordinateSystem::from_text(text).unwrap().epsg(), Some(code), "{text}");
    }
    let error = CoordinateSystem::from_text("my own system").unwrap_err().to_string();
    assert!(error.contains("my own system") && error.contains("give the EPSG code"), "{error}");
}

/// Texts of datums of satellite positioning that no table knows raise no alarm, those of old ones do.
#[test]
fn datums_on_modern_ellipsoids_are_close() {
    for (axis, flattening, close) in [
        (6_378_137.0, 298.257222101, true),
        (6_378_137.0, 298.257223563, true),
        (6_377_397.155, 299.1528128, false),
        (6_378_388.0, 297.0, false),
    ] {
        let text = format!(
            r#"PROJCS["Own_2031",GEOGCS["GCS_Own_2031",DATUM["D_Own_2031",SPHEROID["Own",{axis},{flattening}]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",1234.0],PARAMETER["Central_Meridian",9.5],PARAMETER["Scale_Factor",0.9997],UNIT["Meter",1.0]]"#
        );
        let note = CoordinateSystem::from_wkt(&text).unwrap().datum_note();
        assert_eq!(note.is_none(), close, "{axis} {flattening}: {note:?}");
    }
}

/// Krovak with axes to the south and west is refused, not drawn 2,400 km away.
#[test]
fn axes_to_the_south_and_west_are_refused() {
    for code in [2065, 5513] {
        let error = CoordinateSystem::from_epsg(code).unwrap_err().to_string();
        assert!(error.contains("south and west") && error.contains("5514"), "{error}");
    }
}
