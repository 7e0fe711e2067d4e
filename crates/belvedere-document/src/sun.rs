//! The sun at a time: its position over a place, and when it is up.

/// Step at which the sun is looked for, and the time around which it is, days.
const STEP_DAYS: f64 = 1.0 / 288.0;
const AROUND_DAYS: f64 = 1.0;
/// Days from 0000-03-01 to 2000-01-01.
const J2000_DAY: i64 = 730_425;

/// Whether a text is a time that [`crate::LightDoc::time`] takes.
///
/// # Errors
/// A sentence with the form of a time.
pub fn check_time(text: &str) -> Result<(), String> {
    let form =
        || format!("\"{text}\" is not a time; write it as 2026-07-01T15:00:00Z or with an offset such as +02:00");
    days_since_j2000(text).map(|_| ()).ok_or_else(form)
}

/// Azimuth (clockwise from north) and altitude of the sun, degrees, `days` after J2000.0 at a WGS84 position, without refraction.
/// Within 0.02 degrees from 1950 to 2050.
///
/// Source: low-precision formulas of the Astronomical Almanac (mean longitude, equation of centre with two terms).
pub fn sun_position_deg(days: f64, lon_deg: f64, lat_deg: f64) -> [f64; 2] {
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

/// The nearest time within a day of `days` at which the sun stands at least `altitude_deg` high, days after J2000.0 to five minutes;
/// `None` if it does not rise so high.
pub fn nearest_day_time(days: f64, [lon_deg, lat_deg]: [f64; 2], altitude_deg: f64) -> Option<f64> {
    let steps = (AROUND_DAYS / STEP_DAYS) as i64;
    let is_up = |t: &f64| sun_position_deg(*t, lon_deg, lat_deg)[1] >= altitude_deg;
    let at = |k: i64| days + k as f64 * STEP_DAYS;
    (0..=steps).flat_map(|k| [at(k), at(-k)]).find(is_up)
}

/// Days since 2000-01-01T12:00Z of an RFC 3339 time; `None` if it is malformed.
pub fn days_since_j2000(time: &str) -> Option<f64> {
    let (date, rest) = time.trim().split_once(['T', 't', ' '])?;
    let (clock, offset_minutes) = split_offset(rest)?;
    let [year, month, day] = numbers::<3>(date, '-')?;
    let is_day = [year, month, day].iter().all(|n| n.fract() == 0.0)
        && (1900.0..=2100.0).contains(&year)
        && (1.0..=12.0).contains(&month)
        && (1..=days_of(year as i64, month as usize)).contains(&(day as i64));
    if !is_day {
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
    let minutes = hour * 60.0 + minute + second / 60.0 - offset_minutes;
    Some((day_number - J2000_DAY) as f64 + (minutes - 720.0) / 1440.0)
}

/// Number of days of a month, 1 to 12.
fn days_of(year: i64, month: usize) -> i64 {
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    [31, 28 + i64::from(is_leap), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31][month - 1]
}

/// The time `days` after J2000.0 to the minute, such as `2026-07-01T15:00Z`.
pub fn written_time(days: f64) -> String {
    let minutes = (days * 1440.0).round() as i64 + 720;
    let (day_number, minute) = (minutes.div_euclid(1440) + J2000_DAY, minutes.rem_euclid(1440));
    // The inverse of the day number above: 400 years have 146 097 days, the year starts in March.
    let (era, of_era) = (day_number.div_euclid(146_097), day_number.rem_euclid(146_097));
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let m = (5 * of_year + 2) / 153;
    let (day, month) = (of_year - (153 * m + 2) / 5 + 1, if m < 10 { m + 3 } else { m - 9 });
    let year = 400 * era + year + i64::from(month < 3);
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}Z", minute / 60, minute % 60)
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
mod tests;
