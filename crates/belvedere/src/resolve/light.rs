//! The light of a document: a direction, or the sun at a time.

use super::ground::Ground;
use crate::BelvedereError;
use crate::scene_file::{LightDoc, SourceDocument};
use belvedere_core::DVec3;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Light;

/// The light, and warnings.
pub(crate) fn resolve(
    source: &SourceDocument,
    ground: &Ground<'_>,
    eye: DVec3,
    warnings: &mut Vec<Warning>,
) -> Result<Light, BelvedereError> {
    let default = Light::default();
    let Some(doc) = &source.document.light else { return Ok(default) };
    let light = match &doc.time {
        Some(time) => from_time(source, ground, eye, doc, time, warnings)?,
        None => Light {
            azimuth: doc.azimuth_deg.map_or(default.azimuth, f64::to_radians),
            altitude: doc.altitude_deg.map_or(default.altitude, f64::to_radians),
            shadows: doc.shadows,
        },
    };
    let altitude_deg = light.altitude.to_degrees();
    if doc.time.is_none() && !(altitude_deg > 0.0 && altitude_deg <= 90.0) {
        return Err(source.error(
            &["light", "altitude_deg"],
            format!("light altitude_deg is {altitude_deg}, it must lie above 0 and up to 90"),
        ));
    }
    Ok(light)
}

fn from_time(
    source: &SourceDocument,
    ground: &Ground<'_>,
    eye: DVec3,
    doc: &LightDoc,
    time: &str,
    warnings: &mut Vec<Warning>,
) -> Result<Light, BelvedereError> {
    let fail = |reason: String| source.error(&["light", "time"], reason);
    if doc.azimuth_deg.is_some() || doc.altitude_deg.is_some() {
        return Err(fail("light has a time and a direction; give either time, or azimuth_deg and altitude_deg".into()));
    }
    let days = days_since_j2000(time).ok_or_else(|| {
        fail(format!("\"{time}\" is not a time; write it as 2026-07-01T15:00:00Z or with an offset such as +02:00"))
    })?;
    let eye = ground.lon_lat(eye.truncate()).ok_or_else(|| {
        fail("the sun at a time needs a georeferenced scene; set crs, or give azimuth_deg and altitude_deg".into())
    })?;
    let [azimuth_deg, altitude_deg] = sun_position_deg(days, eye.x, eye.y);
    if altitude_deg <= 0.0 {
        let text = format!(
            "the sun stands {:.1} degrees below the horizon at {time}; the ground is lit by the sky alone",
            -altitude_deg
        );
        warnings.push(Warning::new(WarningKind::Suspect, text).about("light").with("altitude_deg", altitude_deg));
    }
    Ok(Light { azimuth: azimuth_deg.to_radians(), altitude: altitude_deg.to_radians(), shadows: doc.shadows })
}

/// Azimuth (clockwise from north) and altitude of the sun, degrees, `days` after J2000.0 at a WGS84 position, without refraction.
/// Within 0.02 degrees from 1950 to 2050.
///
/// Source: low-precision formulas of the Astronomical Almanac (mean longitude, equation of centre with two terms).
pub(crate) fn sun_position_deg(days: f64, lon_deg: f64, lat_deg: f64) -> [f64; 2] {
    let mean_longitude = 280.460 + 0.985_647_4 * days;
    let anomaly = (357.528 + 0.985_600_3 * days).to_radians();
    let longitude = (mean_longitude + 1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
    let obliquity = (23.439 - 0.000_000_4 * days).to_radians();
    let ascension = (obliquity.cos() * longitude.sin()).atan2(longitude.cos());
    let declination = (obliquity.sin() * longitude.sin()).asin();
    let sidereal_deg = 280.460_618_37 + 360.985_647_366_29 * days + lon_deg;
    let hour_angle = sidereal_deg.rem_euclid(360.0).to_radians() - ascension;
    let lat = lat_deg.to_radians();
    let altitude =
        (lat.sin() * declination.sin() + lat.cos() * declination.cos() * hour_angle.cos()).clamp(-1.0, 1.0).asin();
    let east = -declination.cos() * hour_angle.sin();
    let north = lat.cos() * declination.sin() - lat.sin() * declination.cos() * hour_angle.cos();
    [east.atan2(north).to_degrees().rem_euclid(360.0), altitude.to_degrees()]
}

/// Days since 2000-01-01T12:00Z of an RFC 3339 time; `None` if it is malformed.
fn days_since_j2000(time: &str) -> Option<f64> {
    let (date, rest) = time.trim().split_once(['T', 't', ' '])?;
    let (clock, offset_minutes) = split_offset(rest)?;
    let [year, month, day] = numbers::<3>(date, '-')?;
    if !(1..=12).contains(&(month as i64)) || !(1.0..=31.0).contains(&day) || !(1900.0..=2100.0).contains(&year) {
        return None;
    }
    let [hour, minute, second] =
        numbers::<3>(clock, ':').or_else(|| numbers::<2>(clock, ':').map(|[h, m]| [h, m, 0.0]))?;
    if !(0.0..24.0).contains(&hour) || !(0.0..60.0).contains(&minute) || !(0.0..61.0).contains(&second) {
        return None;
    }
    // Days of the proleptic Gregorian calendar, with the year starting in March.
    let (y, m) = (year as i64 - i64::from(month < 3.0), (month as i64 + 9) % 12);
    let day_number =
        365 * y + y.div_euclid(4) - y.div_euclid(100) + y.div_euclid(400) + (306 * m + 5) / 10 + day as i64 - 1;
    const J2000_DAY: i64 = 730_425;
    let minutes = hour * 60.0 + minute + second / 60.0 - offset_minutes;
    Some((day_number - J2000_DAY) as f64 + (minutes - 720.0) / 1440.0)
}

fn split_offset(text: &str) -> Option<(&str, f64)> {
    if let Some(clock) = text.strip_suffix(['Z', 'z']) {
        return Some((clock, 0.0));
    }
    let at = text.rfind(['+', '-'])?;
    let sign = if text[at..].starts_with('-') { -1.0 } else { 1.0 };
    let [hours, minutes] = numbers::<2>(&text[at + 1..], ':')?;
    (hours < 24.0 && minutes < 60.0).then_some((&text[..at], sign * (60.0 * hours + minutes)))
}

/// Exactly `N` non-negative numbers separated by `by`.
fn numbers<const N: usize>(text: &str, by: char) -> Option<[f64; N]> {
    let parts: Vec<f64> = text
        .split(by)
        .map(|p| p.bytes().all(|b| b.is_ascii_digit() || b == b'.').then(|| p.parse().ok()).flatten())
        .collect::<Option<_>>()?;
    parts.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_days_since_j2000() {
        assert_eq!(days_since_j2000("2000-01-01T12:00:00Z"), Some(0.0));
        assert_eq!(days_since_j2000("2000-03-01T12:00:00Z"), Some(60.0));
        assert_eq!(days_since_j2000("2001-01-01T12:00:00Z"), Some(366.0));
        assert_eq!(days_since_j2000("2000-01-01T14:00:00+02:00"), Some(0.0));
        for bad in ["yesterday", "2026-13-01T00:00:00Z", "2026-07-01", "2026-07-01T15:00:00", "2026-07-01T25:00:00Z"] {
            assert_eq!(days_since_j2000(bad), None, "{bad}");
        }
    }

    #[test]
    fn the_sun_stands_where_almanacs_say() {
        // Equinox noon on the equator at Greenwich: overhead but for the equation of time (7.5 minutes, 1.9 degrees).
        let [_, alt] = sun_position_deg(days_since_j2000("2024-03-20T12:07:00Z").unwrap(), 0.0, 0.0);
        assert!((alt - 90.0).abs() < 0.4, "{alt}");
        // June solstice, true noon at 46 N: 90 - 46 + 23.44 degrees, due south.
        let [az, alt] = sun_position_deg(days_since_j2000("2024-06-20T12:01:50Z").unwrap(), 0.0, 46.0);
        assert!((alt - 67.44).abs() < 0.03 && (az - 180.0).abs() < 0.5, "{az} {alt}");
        // The worked example of NREL's solar position algorithm (Reda, Andreas 2004), without its refraction: Golden,
        // Colorado, 2003-10-17 12:30:30 at UTC-7.
        let days = days_since_j2000("2003-10-17T12:30:30-07:00").unwrap();
        let [az, alt] = sun_position_deg(days, -105.1786, 39.742_476);
        assert!((az - 194.340_24).abs() < 0.02 && (alt - 39.872_05).abs() < 0.02, "{az} {alt}");
        // A morning sun stands in the east, an evening sun in the west.
        assert!(sun_position_deg(days_since_j2000("2024-06-20T06:00:00Z").unwrap(), 0.0, 46.0)[0] < 90.0);
        assert!(sun_position_deg(days_since_j2000("2024-06-20T18:00:00Z").unwrap(), 0.0, 46.0)[0] > 270.0);
    }
}
