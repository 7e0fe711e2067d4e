//! What of the features lies beyond the data counts as not shown, in every verb that tells a share.

use super::Place;
use serde_json::{Value, json};

/// A plain of 2 km with a gentle slope, a hole in it, and features of which half lie beyond.
fn with_data() -> Place {
    let place = Place::new();
    let mut grid =
        "ncols 41\nnrows 41\nxllcorner 500000\nyllcorner 5000000\ncellsize 50\nNODATA_value -9999\n".to_owned();
    for row in 0..41 {
        let height =
            |col: i32| if (10..14).contains(&row) && (20..24).contains(&col) { -9999.0 } else { 2.0 * f64::from(row) };
        grid += &((0..41).map(|col| format!("{:.1}", height(col))).collect::<Vec<_>>().join(" ") + "\n");
    }
    place.write("dem.asc", &grid);
    place.write("dem.prj", "EPSG:32631");
    let feature = |geometry: Value| json!({ "type": "Feature", "properties": {}, "geometry": geometry });
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32631" } });
    let file = |all: Vec<Value>| json!({ "type": "FeatureCollection", "crs": crs, "features": all }).to_string();
    // From the middle of the ground to as far beyond its eastern rim.
    let line = json!({ "type": "LineString", "coordinates": [[501000, 5000500], [503050, 5000500]] });
    place.write("line.geojson", &file(vec![feature(line)]));
    let point = |x: f64| feature(json!({ "type": "Point", "coordinates": [x, 5000500.0] }));
    place.write("points.geojson", &file(vec![point(500900.0), point(501100.0), point(501200.0), point(509000.0)]));
    let square = |x: f64| {
        let ring = [[x, 5000400.0], [x + 300.0, 5000400.0], [x + 300.0, 5000700.0], [x, 5000700.0], [x, 5000400.0]];
        feature(json!({ "type": "Polygon", "coordinates": [ring] }))
    };
    place.write("areas.geojson", &file(vec![square(500800.0), square(508000.0), square(509000.0)]));
    place
}

const EYE: [&str; 4] = ["--eye=501000,4998500,900", "--look=501000,5000600", "--fov=80", "--fill-voids"];

#[test]
fn what_lies_beyond_the_data_is_not_shown() {
    let place = with_data();
    for (file, kind, share) in [("line", "lines", 0.5), ("points", "points", 0.75), ("areas", "areas", 1.0 / 3.0)] {
        let name = format!("{file}.geojson");
        let (out, told) = (format!("{file}.tif"), format!("{file}.json"));
        place.ok(&[&["disocclude", "dem.asc", &name, "-o", &out, "--report", &told], &EYE[..]].concat());
        let report: Value = serde_json::from_slice(&super::read(&place.path(&told))).expect("JSON");
        for key in ["visible_whole", "visible_whole_before"] {
            let found = report[key].as_f64().unwrap_or_else(|| panic!("{key}: {report}"));
            assert!((found - share).abs() < 0.02, "{file}, {key}: {found}, {share} lie on the ground");
        }
        place.write(
            "s.toml",
            &format!(
                "format = 1\n[camera]\neye = [501000, 4998500, 900]\nlook_at = [501000, 5000600, 50]\nfov_y_deg = 60\nimage = [160, 90]\n\
                 [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'dem.asc'\nfill_voids = true\n\
                 [[layer]]\nkind = '{}'\nid = 'what'\nsource = '{name}'\nmust_see = true\n",
                kind.trim_end_matches('s')
            ),
        );
        let measured = place.json(&["measure", "s.toml"]);
        let found = measured[kind]["bent"]["visible_share"].as_f64().unwrap_or_else(|| panic!("{measured}"));
        assert!((found - share).abs() < 0.02, "{file}: {found}, {share} lie on the ground");
        // The feature on the ground is whole.
        let own = measured["features"][0]["bent"]["visible_share"].as_f64().unwrap_or_else(|| panic!("{measured}"));
        assert!(own > 0.98, "{file}: {own}");
    }
}
