//! The climate of a place, as far as its colours need it.

/// Heights and dryness of the climate at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Climate {
    /// Height over the sea above which gentle slopes keep snow in summer, metres.
    pub snow_line_m: f64,
    /// Height over the sea above which no forest grows, metres.
    pub tree_line_m: f64,
    /// 0 = humid, 1 = desert.
    pub dryness: f64,
    /// Latitude, degrees north.
    pub latitude_deg: f64,
    /// Whether it is the climate of the place; else it is guessed from heights.
    pub of_place: bool,
}

/// Snow lines by distance from the equator: degrees, and metres over the sea. Rounded from tables of physical geography: highest in the dry
/// subtropics, lower at the humid equator.
const SNOW_LINE: [(f64, f64); 10] = [
    (0.0, 4800.0),
    (15.0, 5100.0),
    (24.0, 5600.0),
    (32.0, 5300.0),
    (36.0, 4800.0),
    (41.0, 3700.0),
    (47.0, 2850.0),
    (55.0, 1900.0),
    (65.0, 1100.0),
    (80.0, 250.0),
];

/// Deserts and steppes: west, east, south, north in degrees. Coarse outlines of climates of kind B.
const DRY: [[f64; 4]; 16] = [
    [-14.0, 33.0, 15.0, 31.5],
    [40.0, 60.0, 14.0, 33.0],
    [41.0, 55.0, 31.0, 35.0],
    [55.0, 71.0, 27.0, 46.0],
    [66.0, 76.0, 22.0, 30.0],
    [76.4, 81.0, 34.5, 37.5],
    [75.0, 112.0, 36.0, 47.0],
    [79.0, 92.0, 30.0, 36.0],
    [-117.0, -107.0, 29.0, 41.5],
    [-107.0, -100.0, 25.0, 36.0],
    [-117.0, -113.5, 36.5, 43.0],
    [-74.0, -66.0, -34.5, -14.0],
    [-70.8, -64.0, -51.0, -34.5],
    [12.0, 24.0, -31.0, -15.0],
    [114.0, 144.0, -32.0, -18.0],
    [40.0, 51.0, 0.0, 12.5],
];
/// Width of the belt around them in which dryness fades, degrees.
const BELT_DEG: f64 = 1.5;

impl Climate {
    /// The climate at a WGS84 position, degrees.
    pub fn at(lon_deg: f64, lat_deg: f64) -> Self {
        let away = lat_deg.abs();
        let dryness = DRY.iter().map(|area| inside(area, lon_deg, lat_deg)).fold(0.0, f64::max);
        // South of 40 degrees the ocean makes for humid summers, and lower snow lines.
        let oceanic = if lat_deg < 0.0 { 0.35 * ((away - 35.0) / 10.0).clamp(0.0, 1.0) } else { 0.0 };
        let snow_line_m = at_latitude(away) * (1.0 - oceanic) + 350.0 * dryness;
        let tree_line_m = (snow_line_m - 1050.0).min(4000.0);
        Self { snow_line_m, tree_line_m, dryness, latitude_deg: lat_deg, of_place: true }
    }

    /// A humid climate whose lines are those of a range of heights, metres, for ground whose place is not known.
    pub fn of_heights([bottom, top]: [f64; 2]) -> Self {
        let snow_line_m = (bottom + 0.7 * (top - bottom)).max(2450.0);
        Self { snow_line_m, tree_line_m: snow_line_m - 1050.0, dryness: 0.0, latitude_deg: 45.0, of_place: false }
    }

    /// Share of winter in its coldest month: 0 in the tropics, 1 from 40 degrees on.
    pub fn winter(&self) -> f64 {
        ((self.latitude_deg.abs() - 20.0) / 20.0).clamp(0.0, 1.0)
    }
}

fn at_latitude(away_deg: f64) -> f64 {
    let i = SNOW_LINE.partition_point(|(lat, _)| *lat <= away_deg).clamp(1, SNOW_LINE.len() - 1);
    let ((a, low), (b, high)) = (SNOW_LINE[i - 1], SNOW_LINE[i]);
    low + (high - low) * ((away_deg - a) / (b - a)).clamp(0.0, 1.0)
}

/// 1 in an area, 0 from [`BELT_DEG`] outside of it on.
fn inside([west, east, south, north]: &[f64; 4], lon_deg: f64, lat_deg: f64) -> f64 {
    let outside = (west - lon_deg).max(lon_deg - east).max(south - lat_deg).max(lat_deg - north);
    (1.0 - outside / BELT_DEG).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests;
