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
        Self { snow_line_m, tree_line_m, dryness, latitude_deg: lat_deg }
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
mod tests {
    use super::*;

    #[test]
    fn snow_lines_are_those_of_known_mountains() {
        // (place, longitude, latitude, snow line in the literature, metres)
        let known = [
            ("Kilimanjaro", 37.4, -3.1, [4500.0, 5500.0]),
            ("Chimborazo", -78.8, -1.5, [4500.0, 5200.0]),
            ("Aconcagua", -70.0, -32.7, [4700.0, 5800.0]),
            ("Karakoram", 76.5, 35.9, [4700.0, 5600.0]),
            ("Everest", 86.9, 28.0, [5200.0, 6000.0]),
            ("Pyrenees", 1.5, 42.6, [2700.0, 3600.0]),
            ("Alps", 8.0, 46.5, [2700.0, 3100.0]),
            ("Southern Alps", 170.1, -43.6, [1600.0, 2400.0]),
            ("Jotunheimen", 8.3, 61.6, [1100.0, 1900.0]),
            ("Spitsbergen", 16.0, 78.5, [150.0, 600.0]),
        ];
        for (place, lon, lat, [low, high]) in known {
            let climate = Climate::at(lon, lat);
            assert!((low..=high).contains(&climate.snow_line_m), "{place}: {}", climate.snow_line_m);
            assert!(climate.tree_line_m < climate.snow_line_m, "{place}");
        }
    }

    #[test]
    fn deserts_are_dry_and_mountains_beside_them_need_not_be() {
        for (place, lon, lat) in [("Grand Canyon", -112.1, 36.1), ("Ahaggar", 5.5, 23.3), ("Uluru", 131.0, -25.3)] {
            assert!(Climate::at(lon, lat).dryness > 0.9, "{place}");
        }
        for (place, lon, lat) in [
            ("Alps", 8.0, 46.5),
            ("Everest", 86.9, 28.0),
            ("Japan", 138.7, 35.4),
            ("Cape", 20.4, -34.0),
            ("Rasht", 49.6, 37.3),
            ("Kelardasht", 51.1, 36.5),
            ("Yosemite", -119.5, 37.8),
            ("Sequoia", -118.6, 36.5),
            ("Tahoe", -120.0, 39.1),
            ("Kashmir", 74.8, 34.1),
            ("Simien", 38.2, 13.2),
            ("Lebanon", 36.0, 34.2),
            ("Dagestan", 46.5, 42.3),
            ("Tenerife", -16.6, 28.3),
        ] {
            assert!(Climate::at(lon, lat).dryness < 0.1, "{place}");
        }
    }
}
