//! Every option of every request changes the answer on an input where it must, or is refused with a reason.

mod animate;
mod disocclude;
mod others;
mod render;
mod reveal;

use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::fmt::Display;
use std::path::Path;

/// What an option does.
enum Does {
    /// It changes the answer, beside other options.
    Changes(Value, Value),
    /// It is refused with a sentence that holds this.
    IsRefused(Value, &'static str),
}
use Does::{Changes, IsRefused};

/// Tries every option of a request.
///
/// * `names`: all of them; `elsewhere`: those that another test tries, which is named.
/// * `base`: options of all answers; `answer`: the answer to a request.
fn try_all<A: PartialEq, E: Display>(
    names: &[String],
    elsewhere: &[(&str, &str)],
    rows: Vec<(&'static str, Does)>,
    base: &Value,
    answer: impl Fn(&Value) -> Result<A, E>,
) {
    for name in names {
        let tried = rows.iter().any(|(row, _)| row == name) || elsewhere.iter().any(|(row, _)| row == name);
        assert!(tried, "{name}: a new option has a row in this test");
    }
    let given = |more: &Value| {
        let mut asked: Map<String, Value> = base.as_object().expect("an object").clone();
        asked.extend(more.as_object().expect("an object").clone());
        asked.retain(|_, value| !value.is_null());
        answer(&Value::Object(asked))
    };
    let (mut faults, mut without) = (Vec::new(), HashMap::new());
    for (name, does) in rows {
        match does {
            Changes(value, beside) => {
                let mut with = beside.clone();
                with[name] = value;
                let key = beside.to_string();
                let without = without
                    .entry(key)
                    .or_insert_with(|| given(&beside).unwrap_or_else(|e| panic!("without {name}: {e}")));
                match given(&with) {
                    Ok(with) if *without == with => faults.push(format!("{name} changes nothing")),
                    Ok(_) => {}
                    Err(e) => faults.push(format!("{name}: {e}")),
                }
            }
            IsRefused(value, reason) => match given(&json!({ name: value })) {
                Ok(_) => faults.push(format!("{name} is taken, {reason:?} was expected")),
                Err(e) if !e.to_string().contains(reason) => faults.push(format!("{name}: {e}")),
                Err(_) => {}
            },
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Hills of 6 km with a flat sea in a corner, a small and a large hole, a route, another one, and a wood.
fn hills(folder: &Path) -> Value {
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

/// The same as a scene with a spline: its path.
fn scene(folder: &Path) -> String {
    hills(folder);
    let text = r#"format = 1
[camera]
eye = [503000.0, 4999000.0, 900.0]
look_at = [503000.0, 5003000.0, 200.0]
image = [96, 54]
[[layer]]
kind = "terrain"
id = "ground"
source = "hills.asc"
source_crs = "EPSG:32632"
[[layer]]
kind = "line"
id = "way"
source = "way.geojson"
must_see = true
[[layer]]
kind = "area"
id = "wood"
source = "way.geojson"
[[stage]]
kind = "spline_bend"
presets = "progressive"
"#;
    let path = folder.join("hills.toml");
    std::fs::write(&path, text).expect("a file");
    path.display().to_string()
}

/// What data alone may be asked, of a scene file, which says it itself.
fn of_data() -> Vec<(&'static str, Does)> {
    let itself = "a scene file says it itself";
    vec![
        ("crs", IsRefused(json!("local"), itself)),
        ("curved_earth", IsRefused(json!(true), itself)),
        ("source_crs", IsRefused(json!("EPSG:32633"), itself)),
        ("nodata", IsRefused(json!(0), itself)),
        ("vertical_unit", IsRefused(json!("ft"), itself)),
    ]
}
