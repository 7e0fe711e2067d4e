//! What areas and sea level are drawn as, and what the record says about it.

use super::Place;
use super::light_and_tints::pixels;

const SIDE: usize = 64;

/// Hills from `low` up, rising from column `shore` on, 30 m a node; at `low` before it.
fn ground(shore: usize, low: f64) -> String {
    let mut text =
        format!("ncols {SIDE}\nnrows {SIDE}\nxllcorner 500000\nyllcorner 4500000\ncellsize 30\nNODATA_value -9999\n");
    for row in 0..SIDE {
        for col in 0..SIDE {
            let rise = col.saturating_sub(shore) as f64;
            text += &format!("{:.1} ", low + rise * (4.0 + (0.3 * row as f64).sin()));
        }
        text += "\n";
    }
    text
}

fn polygon(properties: &str) -> String {
    let ring = "[[500900,4500300],[501500,4500300],[501500,4500900],[500900,4500900]]";
    let crs = r#""crs":{"type":"name","properties":{"name":"EPSG:32631"}}"#;
    format!(
        r#"{{"type":"FeatureCollection",{crs},"features":[{{"type":"Feature","properties":{properties},"geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}]}}"#
    )
}

/// The record of a picture of the scene, and its pixels.
fn drawn(place: &Place, area: Option<&str>, more: &[&str]) -> (serde_json::Value, Vec<u8>) {
    let layer = area.map(|file| format!("[[layer]]\nid = 'shape'\nkind = 'area'\nsource = '{file}'\n"));
    let scene = format!(
        "crs = 'EPSG:32631'\n[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'dem.asc'\nsource_crs = 'EPSG:32631'\n{}\
         [camera]\neye = [500600, 4499300, 900]\nlook_at = [501000, 4500900, 0]\nimage = [96, 64]\n",
        layer.unwrap_or_default()
    );
    place.write("s.toml", &scene);
    place.ok(&[&["render", "s.toml", "-o", "p.png", "--overwrite"], more].concat());
    let record = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
    (record, pixels(&super::read(&place.path("p.png"))))
}

#[test]
fn areas_are_what_they_say_they_are_and_the_record_says_why() {
    let place = Place::new();
    place.write("dem.asc", &ground(0, 400.0));
    let mut pictures = Vec::new();
    for (file, properties, kind, why) in [
        ("a.geojson", r#"{"natural":"glacier"}"#, "glacier", "natural = glacier"),
        ("a.geojson", r#"{"boundary":"national_park"}"#, "park", "boundary = national_park"),
        ("a.geojson", r#"{"natural":"water"}"#, "water", "natural = water"),
        ("a.geojson", r#"{"x":1}"#, "outline", "neither properties nor names"),
        ("wald.geojson", r#"{"x":1}"#, "forest", "says wald"),
    ] {
        place.write(file, &polygon(properties));
        let (record, picture) = drawn(&place, Some(file), &[]);
        assert_eq!(record["areas"][0]["kind"], kind, "{properties}");
        assert_eq!(record["scene"]["layer"][1]["style"]["surface"], kind);
        assert!(record["areas"][0]["why"].as_str().is_some_and(|text| text.contains(why)), "{}", record["areas"]);
        let warned = record["warnings"].to_string().contains("drawn as outlines");
        assert_eq!(warned, kind == "outline", "{}", record["warnings"]);
        assert!(!pictures.contains(&picture), "{kind} looks its own");
        pictures.push(picture);
    }
    let (record, picture) = drawn(&place, Some("wald.geojson"), &["--area-style", "glacier"]);
    assert_eq!(record["areas"][0]["kind"], "glacier");
    assert!(record["areas"][0]["why"].as_str().is_some_and(|text| text.contains("asked for")));
    assert!(picture == pictures[0], "the option and the property mean the same");
    let line = place.fails(&["render", "s.toml", "-o", "x.png", "--area-style", "swamp"]);
    assert!(line.contains("outline") && line.contains("glacier"), "{line}");
}

#[test]
fn reveal_takes_the_style_of_areas_too() {
    let place = Place::new();
    let geographic =
        ground(0, 400.0).replace("4500000", "46.0").replace("500000", "8.0").replace("cellsize 30", "cellsize 0.001");
    place.write("dem.asc", &geographic);
    place.write("a.geojson", r#"{"type":"Polygon","coordinates":[[[8.02,46.02],[8.04,46.02],[8.03,46.04]]]}"#);
    let kind = |more: &[&str]| {
        let args = ["reveal", "dem.asc", "a.geojson", "-o", "p.png", "--size", "64x48", "--overwrite"];
        place.ok(&[&args[..], more].concat());
        let record: serde_json::Value = serde_json::from_slice(&super::read(&place.path("p.png.json"))).expect("JSON");
        record["areas"][0]["kind"].clone()
    };
    assert_eq!([kind(&[]), kind(&["--area-style", "park"])], ["outline", "park"]);
}

#[test]
fn level_ground_at_0_by_the_edge_is_sea_until_told_otherwise_and_inland_nothing_changes() {
    let place = Place::new();
    place.write("dem.asc", &ground(30, 0.0));
    let (sea, with) = drawn(&place, None, &[]);
    assert_eq!(
        (&sea["areas"][0]["layer"], &sea["areas"][0]["kind"]),
        (&"sea".into(), &"sea".into()),
        "{}",
        sea["areas"]
    );
    let (land, without) = drawn(&place, None, &["--no-sea"]);
    assert!(land["areas"].is_null() && with != without);
    assert_eq!(land["scene"]["layer"][0]["style"]["sea"], false);
    let void = |token: &str| if token == "0.0" { "-9999 ".to_owned() } else { format!("{token} ") };
    let coast = ground(30, 0.0);
    let (head, heights) = coast.split_once("-9999\n").expect("a header");
    place.write("dem.asc", &format!("{head}-9999\n{}", heights.split_whitespace().map(void).collect::<String>()));
    let (filled, _) = drawn(&place, None, &[]);
    assert_eq!(filled["areas"][0]["kind"], "sea");
    assert!(filled["terrain"]["filled_nodes"].as_u64() > Some(1500), "{}", filled["terrain"]);
    assert!(filled["warnings"].to_string().contains("taken for sea"), "{}", filled["warnings"]);
    let (open, _) = drawn(&place, None, &["--no-sea"]);
    assert_eq!(open["terrain"]["filled_nodes"], 0);
    for low in [400.0, -3.0] {
        // A tilt keeps the land below 0 from being level.
        let tilted = ground(0, low);
        place.write("dem.asc", &tilted);
        assert!(drawn(&place, None, &[]).1 == drawn(&place, None, &["--no-sea"]).1, "inland at {low} m");
    }
}
