//! Every option of `reveal` changes the answer on an input where it must, or is refused with a reason.

use belvedere::BelvedereError;
use belvedere::request::{Reveal, options, read};
use belvedere::verbs::asked::{Setting, reveal};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::path::Path;

/// What an option does.
enum Does {
    /// It changes the answer, beside other options.
    Changes(Value, Value),
    /// It is refused with a sentence that holds this.
    IsRefused(Value, &'static str),
}
use Does::{Changes, IsRefused};

/// Options of terrain with features that another test tries.
const ELSEWHERE: [(&str, &str); 2] = [
    // It needs a georeferenced picture.
    ("drape", "reveal_looks.rs of the command line"),
    // It needs ground that is solved for, beyond its limits.
    ("no_limits", "terrain.rs of the command line"),
];

/// Hills of 6 km with a flat sea in a corner, a small and a large hole, a route, another one, and a wood.
fn write(folder: &Path) -> Value {
    const CELLS: usize = 100;
    let height = |row: usize, column: usize| {
        let [x, y] = [column, row].map(|k| k as f64 / CELLS as f64);
        match () {
            () if (40..45).contains(&row) && (40..45).contains(&column) => -9999.0,
            () if row >= 70 && column >= 70 => -9999.0,
            () if row < 35 && column < 35 => 0.0,
            () => (40.0 + 500.0 * (9.0 * y).sin().powi(2) * (0.4 + x)).round(),
        }
    };
    let mut grid =
        format!("ncols {CELLS}\nnrows {CELLS}\nxllcorner 500000\nyllcorner 5000000\ncellsize 60\nNODATA_value -9999\n");
    for row in 0..CELLS {
        let row: Vec<String> = (0..CELLS).map(|column| height(row, column).to_string()).collect();
        grid += &(row.join(" ") + "\n");
    }
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32632" } });
    let collection =
        |features: Value| json!({ "type": "FeatureCollection", "crs": crs, "features": features }).to_string();
    let line = |y: f64| json!([[500_900.0, 5_000_000.0 + y], [505_000.0, 5_000_400.0 + y]]);
    let way = |y: f64| json!({ "type": "Feature", "properties": { "name": "Way", "ref": "E5" }, "geometry": { "type": "LineString", "coordinates": line(y) } });
    let ring = json!([[
        [502_000.0, 5_000_600.0],
        [504_000.0, 5_000_600.0],
        [504_000.0, 5_001_800.0],
        [502_000.0, 5_000_600.0]
    ]]);
    let wood = json!({ "type": "Feature", "properties": { "name": "Wood", "natural": "wood" }, "geometry": { "type": "Polygon", "coordinates": ring } });
    let files = [
        ("hills.asc", grid),
        ("way.geojson", collection(json!([way(2600.0), wood]))),
        ("other.geojson", collection(json!([way(3400.0)]))),
    ];
    for (name, text) in files {
        std::fs::write(folder.join(name), text).expect("a file");
    }
    let path = |name: &str| folder.join(name).display().to_string();
    json!({ "data": path("hills.asc"), "features": [path("way.geojson")], "source_crs": "EPSG:32632", "size": [96, 54],
        "eye": "503000,4999000,900", "look": "503000,5003000,200" })
}

fn rows(folder: &Path) -> Vec<(&'static str, Does)> {
    let none = || json!({});
    let path = |name: &str| json!(folder.join(name).display().to_string());
    let model = "for a part of a model or city, and none is asked for";
    let molecule = "for molecules, and there is none";
    vec![
        ("data", IsRefused(json!("gone.asc"), "gone.asc")),
        ("features", Changes(json!([path("other.geojson")]), none())),
        ("see", IsRefused(json!("a house"), "for terrain with features, not for models")),
        ("fallback", IsRefused(json!(["cutaway"]), model)),
        ("transfer", IsRefused(json!("solid"), model)),
        ("up", IsRefused(json!([0, 0, 1]), model)),
        ("no_shadows", IsRefused(json!(true), model)),
        ("eye", Changes(json!("502000,4999500,700"), none())),
        ("look", Changes(json!([503_500.0, 5_003_000.0]), none())),
        ("fov", Changes(json!(60), none())),
        ("size", Changes(json!([64, 36]), none())),
        ("renderer", Changes(json!("exact"), none())),
        ("samples", Changes(json!(1), none())),
        ("paper", Changes(json!("40x30mm"), json!({ "size": null, "dpi": 50 }))),
        ("dpi", Changes(json!(240), json!({ "size": [320, 180] }))),
        ("margin_mm", Changes(json!(5), json!({ "size": null, "dpi": 50, "paper": "40x30mm" }))),
        ("curved_earth", Changes(json!(true), none())),
        ("keep_voids", Changes(json!(true), none())),
        ("fill_voids", Changes(json!(true), none())),
        ("palette", Changes(json!("desert"), none())),
        ("labels", Changes(json!(true), none())),
        ("no_sea", Changes(json!(true), none())),
        ("rivers", IsRefused(json!([path("other.geojson")]), "kept from running uphill")),
        ("area_style", Changes(json!("glacier"), none())),
        ("technique", Changes(json!("curved_rays"), none())),
        ("crs", Changes(json!("EPSG:32633"), json!({ "eye": "45.14N,9.04E,900", "look": "45.18N,9.04E,200" }))),
        ("source_crs", IsRefused(json!("EPSG:1"), "EPSG:1")),
        ("nodata", Changes(json!(40), none())),
        ("vertical_unit", Changes(json!("ft"), none())),
        ("name_field", Changes(json!("ref"), json!({ "labels": true }))),
        ("light_time", Changes(json!("2026-07-01T06:00:00Z"), none())),
        ("light", Changes(json!([120, 20]), none())),
        ("sky", Changes(json!("white"), none())),
        ("haze", Changes(json!(2.0), none())),
        ("contours", Changes(json!(true), none())),
        ("edge", Changes(json!("block"), none())),
        ("title", Changes(json!("Hills"), json!({ "size": [320, 180] }))),
        ("furniture", Changes(json!(["scale"]), json!({ "size": [320, 180] }))),
        ("shadows", Changes(json!(true), json!({ "light": [90, 10] }))),
        ("relief", Changes(json!("sun"), none())),
        ("hidden", Changes(json!("show"), json!({ "technique": "curved_rays" }))),
        ("exaggeration", Changes(json!(2), none())),
        ("stylise", Changes(json!({ "edges": true, "unsharp": true }), none())),
        ("no_mark", Changes(json!(true), json!({ "size": [320, 180] }))),
        ("representation", IsRefused(json!("ribbon"), molecule)),
        ("color_by", IsRefused(json!("chain"), molecule)),
        ("assembly", IsRefused(json!("1"), molecule)),
        ("model", IsRefused(json!(1), molecule)),
    ]
}

/// The colours of the picture that a request gives.
fn drawn(base: &Value, more: &Value) -> Result<(usize, Vec<[u8; 3]>), BelvedereError> {
    let mut asked: Map<String, Value> = base.as_object().expect("an object").clone();
    asked.extend(more.as_object().expect("an object").clone());
    asked.retain(|_, value| !value.is_null());
    let asked: Reveal = read(&Value::Object(asked).to_string()).expect("a request");
    reveal(&asked, &Setting::default()).map(|answer| {
        let frame = &answer.picture().frame;
        (frame.width, frame.color.clone())
    })
}

#[test]
fn every_option_of_reveal_changes_its_answer_or_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = write(folder.path());
    let rows = rows(folder.path());
    for name in options::<Reveal>() {
        let tried = rows.iter().any(|(row, _)| *row == name) || ELSEWHERE.iter().any(|(row, _)| *row == name);
        assert!(tried, "{name}: a new option has a row in this test");
    }
    let (mut faults, mut without) = (Vec::new(), HashMap::new());
    for (name, does) in rows {
        match does {
            Changes(value, beside) => {
                let mut with = beside.clone();
                with[name] = value;
                let key = beside.to_string();
                let without = without.entry(key).or_insert_with(|| drawn(&base, &beside).expect("a picture"));
                match drawn(&base, &with) {
                    Ok(with) if *without == with => faults.push(format!("{name} changes nothing")),
                    Ok(_) => {}
                    Err(e) => faults.push(format!("{name}: {e}")),
                }
            }
            IsRefused(value, reason) => match drawn(&base, &json!({ name: value })) {
                Ok(_) => faults.push(format!("{name} is taken, {reason:?} was expected")),
                Err(e) if !e.to_string().contains(reason) => faults.push(format!("{name}: {e}")),
                Err(_) => {}
            },
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
