//! `generalise` as a user meets it.

use super::{Place, read};
use belvedere_testkit::data;
use serde_json::{Value, json};

/// Four street blocks of nine houses in degrees, around lon 20, lat -34; main streets outside, side streets between.
fn place() -> Place {
    let place = Place::new();
    let at = |x: f64, y: f64| json!([20.0 + x / 92_000.0, -34.0 + y / 111_000.0]);
    let feature = |geometry: Value, properties: Value| json!({ "type": "Feature", "properties": properties, "geometry": geometry });
    let mut houses = Vec::new();
    for number in 0..36 {
        let (block, house) = (number / 9, number % 9);
        let x = 110.0 * f64::from(block % 2) + 12.0 + 28.0 * f64::from(house % 3);
        let y = 110.0 * f64::from(block / 2) + 12.0 + 28.0 * f64::from(house / 3);
        let ring = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0], [0.0, 0.0]].map(|d| at(x + d[0], y + d[1]));
        let kind = if number == 4 { "church" } else { "yes" };
        let properties = json!({ "building": kind, "building:levels": "2", "osm_id": number.to_string() });
        houses.push(feature(json!({ "type": "Polygon", "coordinates": [ring] }), properties));
    }
    let mut roads = Vec::new();
    for (k, class) in [(0.0, "secondary"), (105.0, "residential"), (210.0, "secondary")] {
        for ends in [[at(k, -40.0), at(k, 250.0)], [at(-40.0, k), at(250.0, k)]] {
            roads.push(feature(json!({ "type": "LineString", "coordinates": ends }), json!({ "highway": class })));
        }
    }
    for (name, features) in [("houses.geojson", houses), ("roads.geojson", roads)] {
        place.write(name, &json!({ "type": "FeatureCollection", "features": features }).to_string());
    }
    place
}

const FILES: [&str; 5] = ["loa1.city.json", "loa2.city.json", "report.json", "overview.png", "map.tif"];

#[test]
fn a_town_becomes_blocks_in_a_folder() {
    let place = place();
    let args = ["generalise", "houses.geojson", "roads.geojson", "-o", "blocks"];
    let text = place.ok(&args);
    assert!(text.contains("36 buildings") && text.contains("open blocks"), "{text}");
    let city =
        |name: &str| -> Value { serde_json::from_slice(&read(&place.path(&format!("blocks/{name}")))).expect("JSON") };
    let blocks = |document: &Value| {
        let objects = document["CityObjects"].as_object().expect("objects").values().cloned().collect::<Vec<_>>();
        let is_block = |o: &Value| o["type"] == "Building" && o["attributes"]["landmark"].is_null();
        objects.into_iter().filter(is_block).collect::<Vec<_>>()
    };
    let [fine, coarse] = ["loa1.city.json", "loa2.city.json"].map(city);
    assert_eq!([blocks(&fine).len(), blocks(&coarse).len()], [4, 1]);
    assert_eq!(fine["metadata"]["referenceSystem"], "https://www.opengis.net/def/crs/EPSG/0/32734");
    let counts: u64 = blocks(&fine).iter().map(|b| b["attributes"]["count"].as_u64().expect("a count")).sum();
    assert_eq!(counts, 35, "the church stays itself");
    assert_eq!(fine["CityObjects"]["4"]["attributes"]["landmark"], true);
    for block in blocks(&fine) {
        assert!((block["attributes"]["height"].as_f64().expect("a height") - 7.0).abs() < 1e-9, "{block}");
    }
    let report = city("report.json");
    // Nine houses of 20 m with gaps of 8 m between them.
    let share = report["levels"][0]["volume_share"].as_f64().expect("a share");
    assert!((1.2..1.7).contains(&share) && report["levels"][0]["volume_kept"] == false, "{report}");
    assert_eq!(report["inputs"].as_array().map(Vec::len), Some(2));
    let before = FILES.map(|name| read(&place.path(&format!("blocks/{name}"))));

    let refused = place.fails(&args);
    assert!(refused.contains("--overwrite"), "{refused}");
    let again = place.json(&[&args[..], &["--overwrite", "--json"]].concat());
    assert_eq!(again["levels"][1]["blocks"], 1);
    for (name, before) in FILES.iter().zip(before).filter(|(name, _)| **name != "report.json") {
        assert!(read(&place.path(&format!("blocks/{name}"))) == before, "{name}: same input, other bytes");
    }
}

#[test]
fn what_holds_no_buildings_is_refused_and_nothing_is_written() {
    let place = place();
    let text = place.fails(&["generalise", "roads.geojson", "-o", "blocks"]);
    assert!(text.contains("roads.geojson") && text.contains("building footprints"), "{text}");
    assert!(place.fails(&["generalise", "missing.geojson", "-o", "blocks"]).contains("missing.geojson"));
    let text = place.fails(&["generalise", "houses.geojson", "-o", "blocks", "--margin", "1"]);
    assert!(text.contains("margin_m is 1"), "{text}");
    assert!(!place.path("blocks").exists());
}

#[test]
fn a_mapped_town_is_told_how_much_its_blocks_hold() {
    let (Some(houses), Some(roads)) = (data("swellendam/buildings.geojson"), data("swellendam/roads.geojson")) else {
        return;
    };
    let place = Place::new();
    let [houses, roads] = [houses, roads].map(|p| p.to_string_lossy().into_owned());
    let made = place.json(&["generalise", &houses, &roads, "-o", "town", "--json"]);
    assert_eq!(made["buildings"], 4708);
    for level in made["levels"].as_array().expect("levels") {
        let number = |key: &str| level[key].as_f64().expect("a number");
        // As much more as the ground of the blocks is larger than that of the buildings, for houses of about one height.
        let larger = number("block_area_m2") / number("built_area_m2");
        let told = number("volume_share");
        assert!((0.85..1.15).contains(&(told / larger)) && told > 1.5, "{told} on {larger} times the ground");
        assert_eq!(level["volume_kept"], false);
    }
    assert!(FILES.iter().all(|name| place.path(&format!("town/{name}")).exists()));
}

/// Share of an overhead picture of `loa` that buildings fill, m^2, on ground that rises by `slope` and swings.
fn seen_from_above(place: &Place, loa: u8, slope: f64) -> f64 {
    let (side, spacing, px) = (420.0, 20.0, 420);
    let nodes = 32;
    let mut grid = format!(
        "ncols {nodes}\nnrows {nodes}\nxllcenter 499900\nyllcenter 4999900\ncellsize {spacing}\nNODATA_value -9999\n"
    );
    for row in (0..nodes).rev() {
        let height = |column: i32| {
            let [x, y] = [column, row].map(|k| spacing * f64::from(k) - 100.0);
            200.0 + slope * (0.8 * y + 0.6 * x) + 4.0 * (x / 50.0).sin() * (y / 60.0).cos()
        };
        grid += &(0..nodes).map(|c| format!("{:.2} ", height(c))).collect::<String>();
        grid.push('\n');
    }
    place.write("hill.asc", &grid);
    place.write(
        "hill.toml",
        &format!(
            "format = 1\ncrs = \"EPSG:32632\"\n[[layer]]\nid = \"g\"\nkind = \"terrain\"\nsource = \"hill.asc\"\n\
             source_crs = \"EPSG:32632\"\n[[layer]]\nid = \"c\"\nkind = \"city\"\n\
             source = [\"hill_houses.geojson\", \"hill_streets.geojson\"]\nloa = {loa}\n[camera]\n\
             projection = \"orthographic\"\northo_height_m = {side}\neye = [500110, 5000110, 4000]\n\
             look_at = [500110, 5000110, 0]\nup = [0, 1, 0]\nimage = [{px}, {px}]\n"
        ),
    );
    place.ok(&["render", "hill.toml", "-o", "hill.png", "--overwrite", "--aux", "id"]);
    let bytes = read(&place.path("hill.id.npy"));
    let city = bytes[bytes.len() - 4 * px * px..].chunks_exact(4).filter(|b| **b == 2u32.to_le_bytes()).count();
    city as f64 * (side / px as f64).powi(2)
}

#[test]
fn blocks_on_slopes_are_seen_from_above_as_their_buildings_are() {
    let place = Place::new();
    let feature = |kind: &str, coordinates: Value, properties: Value| {
        let geometry = json!({ "type": kind, "coordinates": coordinates });
        json!({ "type": "Feature", "properties": properties, "geometry": geometry })
    };
    let at = |x: f64, y: f64| json!([500_000.0 + x, 5_000_000.0 + y]);
    let houses = (0..36).map(|number| {
        let (block, house) = (number / 9, number % 9);
        let x = 110.0 * f64::from(block % 2) + 12.0 + 28.0 * f64::from(house % 3);
        let y = 110.0 * f64::from(block / 2) + 12.0 + 28.0 * f64::from(house / 3);
        let ring = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0], [0.0, 0.0]].map(|d| at(x + d[0], y + d[1]));
        feature("Polygon", json!([ring]), json!({ "building": "yes", "height": "7" }))
    });
    let roads =
        [(0.0, "secondary"), (105.0, "residential"), (210.0, "secondary")].into_iter().flat_map(|(k, class)| {
            let ends = [[at(k, -40.0), at(k, 250.0)], [at(-40.0, k), at(250.0, k)]];
            ends.map(|ends| feature("LineString", json!(ends), json!({ "highway": class })))
        });
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32632" } });
    let (houses, roads): (Vec<Value>, Vec<Value>) = (houses.collect(), roads.collect());
    for (name, features) in [("hill_houses.geojson", houses), ("hill_streets.geojson", roads)] {
        place.write(name, &json!({ "type": "FeatureCollection", "crs": crs, "features": features }).to_string());
    }
    let plan = 36.0 * 400.0;
    for slope in [0.1, 0.35, 0.6] {
        let seen = [0, 1, 2].map(|loa| seen_from_above(&place, loa, slope));
        assert!((seen[0] / plan - 1.0).abs() < 0.02, "slope {slope}: {} of {plan} m^2 at level 0", seen[0]);
        assert!(seen[1] >= 0.9 * seen[0] && seen[2] >= 0.9 * seen[0], "slope {slope}: {seen:?} m^2");
    }
}

/// A building that crosses itself at nearly every pair of its edges, beside a house.
fn tangle(place: &Place, corners: usize) {
    let mut random = belvedere_testkit::Random::new(5);
    let at = |x: f64, y: f64| json!([20.0 + x / 92_000.0, -34.0 + y / 111_000.0]);
    let mut ring: Vec<Value> = (0..corners).map(|_| at(random.range(0.0, 200.0), random.range(0.0, 200.0))).collect();
    ring.push(ring[0].clone());
    let house = [[300.0, 0.0], [320.0, 0.0], [320.0, 20.0], [300.0, 0.0]].map(|[x, y]| at(x, y)).to_vec();
    let feature = |ring: Vec<Value>| {
        let geometry = json!({ "type": "Polygon", "coordinates": [ring] });
        json!({ "type": "Feature", "properties": { "building": "yes", "height": 9 }, "geometry": geometry })
    };
    let all = json!({ "type": "FeatureCollection", "features": [feature(ring), feature(house)] });
    place.write("tangle.geojson", &all.to_string());
}

#[test]
fn a_building_that_crosses_itself_everywhere_is_taken_as_its_hull_with_one_warning() {
    let place = Place::new();
    tangle(&place, 700);
    let begun = std::time::Instant::now();
    let out = place.run(&["generalise", "tangle.geojson", "-o", "g", "--max-mem", "600MiB"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
    assert_eq!(said.matches("cross themselves more than 1000 times").count(), 1, "{said}");
    let report: Value = serde_json::from_slice(&read(&place.path("g/report.json"))).expect("JSON");
    let built = report["levels"][0]["built_area_m2"].as_f64().expect("an area");
    assert!((36_000.0..41_000.0).contains(&built), "the hull of points all over a square of 200 m: {built}");
    let scene = "format = 1\n[camera]\neye = { lon = 20.001, lat = -34.003, height_m = 180.0 }\n\
         look_at = { lon = 20.001, lat = -33.999, height_m = 0.0 }\nimage = [96, 72]\n\
         [[layer]]\nid = \"town\"\nkind = \"city\"\nsource = \"tangle.geojson\"\nloa = 1\n";
    place.write("scene.toml", scene);
    let out = place.run(&["render", "scene.toml", "-o", "p.png", "--max-mem", "600MiB"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert_eq!(said.matches("cross themselves more than 1000 times").count(), 1, "{said}");
}

#[test]
fn ambient_occlusion_of_a_small_reach_is_bounded_and_check_computes_none() {
    let place = place();
    let scene = "format = 1\n[camera]\neye = { lon = 20.001, lat = -34.003, height_m = 180.0 }\n\
         look_at = { lon = 20.001, lat = -33.999, height_m = 0.0 }\nimage = [96, 72]\n\
         [[layer]]\nid = \"town\"\nkind = \"city\"\nsource = \"houses.geojson\"\nstyle = { ambient_occlusion = REACH }\n";
    let timed = |reach: &str, args: &[&str]| {
        place.write("scene.toml", &scene.replace("REACH", reach));
        let begun = std::time::Instant::now();
        let out = place.run(args);
        assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
        (begun.elapsed().as_secs_f64(), String::from_utf8_lossy(&out.stderr).into_owned())
    };
    let render = ["render", "scene.toml", "-o", "p.png", "--overwrite"];
    let (_, said) = timed("30.0", &render);
    assert!(!said.contains("ambient_occlusion"), "a usual reach is sampled as asked for: {said}");
    let (took, said) = timed("0.02", &render);
    assert!(took < 20.0, "{took} s");
    assert_eq!(said.matches("ambient_occlusion = 0.02 asks for points").count(), 1, "{said}");
    let (_, said) = timed("0.02", &["check", "scene.toml"]);
    assert!(!said.contains("ambient_occlusion"), "{said}");
    let (_, said) = timed("0.02", &[&render[..], &["--time-limit", "0.000001"]].concat());
    assert!(said.contains("time was up before"), "{said}");
}
