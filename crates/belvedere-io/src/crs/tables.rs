//! Tables that supplement the register of PROJ strings: missing systems, missing or outdated datum shifts, and the geographic system of
//! each datum and projected system.
//!
//! Source: the EPSG Geodetic Parameter Dataset (11.022), with the transformations that PROJ 9.5 chooses without grids at the middle of a system's
//! area of use. A line holds its value first, then codes; `a-b` stands for all codes from a to b.

use super::CrsError;

/// `code PROJ-string`.
const SYSTEMS: &str = include_str!("systems.txt");
/// `towgs84 codes`.
const SHIFTS: &str = include_str!("shifts.txt");
/// `geographic-code projected-codes`.
const BASES: &str = include_str!("bases.txt");
/// `geographic-code names`, only letters and digits, in lower case; names of systems begin with `=`, the others are of datums.
const DATUMS: &str = include_str!("datums.txt");

/// Krovak systems with southings and westings in the register, but not in their PROJ strings.
const SOUTH_WEST: [u32; 2] = [2065, 5513];

fn codes(list: &str) -> impl Iterator<Item = std::ops::RangeInclusive<u32>> + '_ {
    list.split_whitespace().filter_map(|part| {
        let (from, to) = part.split_once('-').unwrap_or((part, part));
        Some(from.parse().ok()?..=to.parse().ok()?)
    })
}

/// The rest of the first line that begins with a word.
fn line_of<'t>(table: &'t str, word: &str) -> Option<&'t str> {
    table.lines().find_map(|line| line.strip_prefix(word)?.strip_prefix(' '))
}

/// The current EPSG code of ESRI's, unofficial and superseded codes that are in use.
pub(super) fn current_code(code: u32) -> u32 {
    match code {
        900_913 | 3785 | 102_100 | 102_113 | 41_001 => 3857,
        54_004 => 3395,
        102_039 => 5070,
        102_067 => 5514,
        104_199 | 104_000 => 4326,
        code => code,
    }
}

/// The well-known text of an EPSG code. Pages of the web have none, which saves 4 MiB.
pub(super) fn well_known_text(code: u32) -> Option<&'static str> {
    #[cfg(target_arch = "wasm32")]
    let text = |_| None;
    #[cfg(not(target_arch = "wasm32"))]
    let text = |definition: crs_definitions::Def| Some(definition.wkt);
    u16::try_from(code).ok().and_then(crs_definitions::from_code).and_then(text)
}

/// The PROJ string of an EPSG code, with the current datum shift.
pub(super) fn definition(code: u32) -> Result<String, CrsError> {
    if SOUTH_WEST.contains(&code) {
        let reason = "its axes run south and west (EPSG:5514 is the same with axes to the east and north)".to_owned();
        return Err(CrsError::Unsupported { name: format!("EPSG:{code}"), reason });
    }
    let listed = u16::try_from(code).ok().and_then(crs_definitions::from_code).map(|d| d.proj4);
    let text = listed.or_else(|| line_of(SYSTEMS, &code.to_string())).ok_or(CrsError::UnknownCode { code })?;
    let shift = SHIFTS
        .lines()
        .filter_map(|line| line.split_once(' '))
        .find(|(_, list)| codes(list).any(|range| range.contains(&code)));
    Ok(match shift {
        Some((shift, _)) => with_shift(text, shift),
        None => text.to_owned(),
    })
}

/// A PROJ string with another datum shift on the same ellipsoid.
fn with_shift(text: &str, shift: &str) -> String {
    let mut parts: Vec<String> = Vec::new();
    for part in text.split_whitespace() {
        match part.split_once('=') {
            Some(("+towgs84" | "+nadgrids", _)) => {}
            Some(("+datum", datum)) => parts.push(format!("+ellps={}", ellipsoid(datum))),
            _ => parts.push(part.to_owned()),
        }
    }
    parts.push(format!("+towgs84={shift}"));
    parts.join(" ")
}

/// The ellipsoid of a datum that PROJ knows by name.
fn ellipsoid(datum: &str) -> &'static str {
    match datum {
        "potsdam" | "hermannskogel" => "bessel",
        "carthage" => "clrk80ign",
        "ire65" => "mod_airy",
        "nzgd49" => "intl",
        "OSGB36" => "airy",
        "NAD27" => "clrk66",
        "GGRS87" | "NAD83" => "GRS80",
        _ => "WGS84",
    }
}

/// The geographic system of a datum, or of that name, in letters and digits of lower case.
pub(super) fn geographic(datum: &str) -> Option<u32> {
    let line = DATUMS.lines().find(|line| line.split(' ').skip(1).any(|name| name == datum))?;
    line.split(' ').next()?.parse().ok()
}

/// The projected systems on a geographic one.
pub(super) fn projected_on(geographic: u32) -> impl Iterator<Item = u32> {
    line_of(BASES, &geographic.to_string()).into_iter().flat_map(codes).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::CoordinateSystem;

    #[test]
    fn every_line_is_of_systems_that_can_be_built() {
        assert!(SYSTEMS.lines().count() > 400 && SHIFTS.lines().count() > 50 && BASES.lines().count() > 300);
        for line in SYSTEMS.lines() {
            let code = line.split(' ').next().and_then(|c| c.parse().ok()).expect(line);
            CoordinateSystem::from_epsg(code).unwrap_or_else(|e| panic!("{line}: {e}"));
        }
        for (table, first) in [(SHIFTS, false), (BASES, true)] {
            for line in table.lines() {
                let (head, list) = line.split_once(' ').expect(line);
                assert_eq!(codes(list).count(), list.split_whitespace().count(), "{line}");
                let some = codes(list).next().map(|r| *r.start()).expect(line);
                if first {
                    // the New Zealand Map Grid and others are listed, and not projected
                    assert!(head.parse::<u32>().is_ok() && definition(some).is_ok(), "{line}");
                } else {
                    CoordinateSystem::from_epsg(some).unwrap_or_else(|e| panic!("{some}: {e}"));
                }
            }
        }
    }

    #[test]
    fn a_datum_has_its_geographic_system() {
        for (name, code) in [("dch1903", 4149), ("=gcswgs1984", 4326), ("damersfoort", 4289), ("dsjtsk", 4156)] {
            assert_eq!(geographic(name), Some(code), "{name}");
        }
        assert_eq!(geographic("nowhere"), None);
        assert!(projected_on(4289).any(|c| c == 28992));
    }
}
