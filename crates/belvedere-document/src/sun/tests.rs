use super::*;

#[test]
fn times_are_days_since_j2000() {
    assert_eq!(days_since_j2000("2000-01-01T12:00:00Z"), Some(0.0));
    assert_eq!(days_since_j2000("2000-03-01T12:00:00Z"), Some(60.0));
    assert_eq!(days_since_j2000("2001-01-01T12:00:00Z"), Some(366.0));
    assert_eq!(days_since_j2000("2000-01-01T14:00:00+02:00"), Some(0.0));
    for (day, exists) in [("2024-02-29", true), ("2000-02-29", true), ("2026-02-29", false), ("2100-02-29", false)] {
        assert_eq!(days_since_j2000(&format!("{day}T12:00Z")).is_some(), exists, "{day}");
    }
    for bad in ["2026-02-31T12:00:00Z", "2026-04-31T12:00:00Z", "2026-06-00T12:00:00Z", "2026-02-1.5T12:00:00Z"] {
        assert_eq!(days_since_j2000(bad), None, "{bad}");
    }
    for bad in ["yesterday", "2026-13-01T00:00:00Z", "2026-07-01", "2026-07-01T15:00:00", "2026-07-01T25:00:00Z"] {
        assert_eq!(days_since_j2000(bad), None, "{bad}");
        assert!(check_time(bad).is_err_and(|e| e.contains(bad) && e.contains("+02:00")), "{bad}");
    }
}

#[test]
fn times_are_written_as_they_are_read() {
    for time in [
        "2000-01-01T12:00Z",
        "1999-12-31T23:59Z",
        "2024-02-29T00:00Z",
        "2024-03-01T06:30Z",
        "2026-12-31T23:00Z",
        "1900-03-01T00:05Z",
        "2100-02-28T11:59Z",
    ] {
        assert_eq!(written_time(days_since_j2000(time).unwrap()), time);
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

#[test]
fn the_nearest_day_is_that_of_sunrise_or_sunset_and_none_in_the_polar_night() {
    let near =
        |time: &str, lon, lat| nearest_day_time(days_since_j2000(time).unwrap(), [lon, lat], 0.0).map(written_time);
    // Equinox at Greenwich on the equator: the sun is up from 6:07 to 18:07, to the step of five minutes.
    assert_eq!(near("2024-03-20T04:00Z", 0.0, 0.0).as_deref(), Some("2024-03-20T06:10Z"));
    assert_eq!(near("2024-03-20T20:00Z", 0.0, 0.0).as_deref(), Some("2024-03-20T18:05Z"));
    assert_eq!(near("2024-03-20T12:00Z", 0.0, 0.0).as_deref(), Some("2024-03-20T12:00Z"));
    // Longyearbyen: polar night in December, midnight sun in June.
    assert_eq!(near("2024-12-21T12:00Z", 15.6, 78.2), None);
    assert_eq!(near("2024-06-21T23:00Z", 15.6, 78.2).as_deref(), Some("2024-06-21T23:00Z"));
}
