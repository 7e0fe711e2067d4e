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
