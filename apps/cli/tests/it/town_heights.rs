//! Where towns stand: roofs over the ground at every level of abstraction, looked at straight down, and the volumes that are told.

use super::{Place, read};
use serde_json::{Value, json};

/// South-western corner of the town, metres.
const CORNER: [f64; 2] = [500_000.0, 5_000_000.0];
/// Height of the houses, metres.
const HIGH: f64 = 9.0;
/// Side of the square that is looked at, metres.
const SIDE: f64 = 420.0;

/// Height of the ground: a slope with waves.
fn ground(slope: f64, waves: f64, [x, y]: [f64; 2]) -> f64 {
    500.0 + slope * (0.8 * y + 0.6 * x) + waves * (x / 50.0).sin() * (y / 60.0).cos()
}

/// Longitude and latitude of the town's corner, and lengths of a degree of each on the map there (UTM zone 32 on its central meridian,
/// WGS 84), metres.
const LON_LAT: [f64; 2] = [9.0, 45.153477183281];
const DEGREE_M: [f64; 2] = [78_604.6, 111_090.32];

/// The houses and streets as OpenStreetMap has them.
fn mapped_town(place: &Place) {
    let (mut nodes, mut ways) = (String::new(), String::new());
    let mut count = 0;
    let mut way = |points: &[[f64; 2]], closed: bool, tags: &str| {
        let first = count + 1;
        let mut refs = String::new();
        for [x, y] in points {
            count += 1;
            let [lon, lat] = [LON_LAT[0] + x / DEGREE_M[0], LON_LAT[1] + y / DEGREE_M[1]];
            nodes += &format!("<node id=\"{count}\" version=\"1\" lon=\"{lon:.9}\" lat=\"{lat:.9}\"/>");
            refs += &format!("<nd ref=\"{count}\"/>");
        }
        if closed {
            refs += &format!("<nd ref=\"{first}\"/>");
        }
        ways += &format!("<way id=\"{}\" version=\"1\">{refs}{tags}</way>", 100_000 + first);
    };
    for [x, y] in houses() {
        let ring = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]].map(|[dx, dy]| [x + dx, y + dy]);
        way(&ring, true, &format!("<tag k=\"building\" v=\"yes\"/><tag k=\"height\" v=\"{HIGH}\"/>"));
    }
    for (k, class) in [(0.0, "secondary"), (105.0, "residential"), (210.0, "secondary")] {
        let tag = format!("<tag k=\"highway\" v=\"{class}\"/>");
        way(&[[k, -40.0], [k, 250.0]], false, &tag);
        way(&[[-40.0, k], [250.0, k]], false, &tag);
    }
    place.write("town.osm", &format!("<?xml version=\"1.0\"?><osm version=\"0.6\">{nodes}{ways}</osm>"));
}

/// Corners of 36 houses of 20 m in four street blocks.
fn houses() -> Vec<[f64; 2]> {
    let at = |number: i32| {
        let (block, house) = (number / 9, number % 9);
        let x = 110.0 * f64::from(block % 2) + 12.0 + 28.0 * f64::from(house % 3);
        [x, 110.0 * f64::from(block / 2) + 12.0 + 28.0 * f64::from(house / 3)]
    };
    (0..36).map(at).collect()
}

fn features(name: &str, list: Vec<(&str, Value, Value)>, place: &Place) {
    let feature = |(kind, coordinates, properties): (&str, Value, Value)| json!({ "type": "Feature", "properties": properties, "geometry": { "type": kind, "coordinates": coordinates } });
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32632" } });
    let list: Vec<Value> = list.into_iter().map(feature).collect();
    place.write(name, &json!({ "type": "FeatureCollection", "crs": crs, "features": list }).to_string());
}

/// Streets, a terrain, and the houses as footprints and as solids whose floors lie at the ground of their middle.
fn town(place: &Place, slope: f64, waves: f64) {
    let at = |x: f64, y: f64| json!([CORNER[0] + x, CORNER[1] + y]);
    let footprint = |[x, y]: [f64; 2]| {
        let ring = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0], [0.0, 0.0]].map(|d| at(x + d[0], y + d[1]));
        ("Polygon", json!([ring]), json!({ "building": "yes", "height": HIGH.to_string() }))
    };
    features("houses.geojson", houses().into_iter().map(footprint).collect(), place);
    let ways = [(0.0, "secondary"), (105.0, "residential"), (210.0, "secondary")];
    let ways = ways.into_iter().flat_map(|(k, class)| {
        let ends = [[at(k, -40.0), at(k, 250.0)], [at(-40.0, k), at(250.0, k)]];
        ends.map(|ends| ("LineString", json!(ends), json!({ "highway": class })))
    });
    features("streets.geojson", ways.collect(), place);
    let (mut vertices, mut objects) = (Vec::new(), serde_json::Map::new());
    for (number, [x, y]) in houses().into_iter().enumerate() {
        let (first, base) = (8 * number, ground(slope, waves, [x + 10.0, y + 10.0]));
        for z in [base, base + HIGH] {
            let corners = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
            vertices.extend(corners.map(|d| json!([1000.0 * (x + d[0]), 1000.0 * (y + d[1]), (1000.0 * z).round()])));
        }
        let faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let shell: Vec<Value> = faces.iter().map(|f| json!([f.map(|k| first + k)])).collect();
        let solid = json!({ "type": "Solid", "lod": "1", "boundaries": [shell] });
        objects.insert(format!("h{number}"), json!({ "type": "Building", "geometry": [solid] }));
    }
    let city = json!({ "type": "CityJSON", "version": "2.0", "vertices": vertices, "CityObjects": objects,
        "transform": { "scale": [0.001, 0.001, 0.001], "translate": [CORNER[0], CORNER[1], 0.0] },
        "metadata": { "referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/32632" } });
    place.write("houses.city.json", &city.to_string());
    let mut grid =
        "ncols 64\nnrows 64\nxllcenter 499900\nyllcenter 4999900\ncellsize 10\nNODATA_value -9999\n".to_owned();
    for row in (0..64).rev() {
        let height = |column| ground(slope, waves, [column, row].map(|k| 10.0 * f64::from(k) - 100.0));
        grid += &((0..64).map(|c| format!("{:.2} ", height(c))).collect::<String>() + "\n");
    }
    place.write("hill.asc", &grid);
}

/// Positions from the town's corner, and heights, of what the city shows where the pixels of a lattice look straight down at it.
fn roofs(place: &Place, houses: &str, terrain: bool, loa: u8) -> Vec<([f64; 2], f64)> {
    let terrain = if terrain {
        "[[layer]]\nid = \"g\"\nkind = \"terrain\"\nsource = \"hill.asc\"\nsource_crs = \"EPSG:32632\"\n"
    } else {
        ""
    };
    let [x, y] = CORNER.map(|v| v + 105.0);
    // A map holds its streets.
    let streets = if houses.ends_with(".osm") { "" } else { ", \"streets.geojson\"" };
    let sources = format!("\"{houses}\"{streets}");
    place.write(
        "town.toml",
        &format!(
            "format = 1\ncrs = \"EPSG:32632\"\n{terrain}[[layer]]\nid = \"c\"\nkind = \"city\"\n\
             source = [{sources}]\nloa = {loa}\n[camera]\nprojection = \"orthographic\"\n\
             ortho_height_m = {SIDE}\neye = [{x}, {y}, 6000]\nlook_at = [{x}, {y}, 0]\nup = [0, 1, 0]\nimage = [420, 420]\n"
        ),
    );
    let pixels: Vec<[f64; 2]> =
        (0..105 * 105).map(|i| [f64::from(i % 105), f64::from(i / 105)].map(|k| 4.0 * k + 2.0)).collect();
    place.write("pixels.json", &json!(pixels).to_string());
    place.ok(&["pick", "town.toml", "--pixels", "pixels.json", "-o", "picked.json", "--overwrite"]);
    let picked: Value = serde_json::from_slice(&read(&place.path("picked.json"))).expect("JSON");
    let shown = picked["pixels"].as_array().expect("pixels").iter().filter(|p| p["layer"] == "c");
    let point = |p: &Value| [0, 1, 2].map(|k| p["point"][k].as_f64().expect("a number"));
    shown.map(point).map(|[x, y, z]| ([x - CORNER[0], y - CORNER[1]], z)).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Checks how high the roofs of a level stand over their ground; those of single footprints over the lowest of it.
fn check(what: &str, [slope, waves]: [f64; 2], lowest: bool, shown: &[([f64; 2], f64)]) {
    let over: Vec<f64> = shown.iter().map(|(at, z)| z - ground(slope, waves, *at)).collect();
    let middle = median(over.clone());
    let rise = if lowest { 14.0 * slope } else { 0.0 };
    assert!((middle - HIGH).abs() < 1.0 + 0.5 * waves + rise, "{what}: roofs {middle:.1} m over the ground (median)");
    // On the slope under a house, and within a quarter of the height on waves.
    let room = 0.25 * HIGH + 1.0 + 21.0 * slope + waves;
    let off = over.iter().filter(|h| (**h - HIGH).abs() > room).count();
    assert!(50 * off <= over.len(), "{what}: {off} of {} roofs more than {room:.1} m off", over.len());
}

#[test]
fn roofs_of_towns_on_terrain_stand_as_high_over_it_as_their_buildings_at_every_level() {
    let place = Place::new();
    for (slope, waves) in [(0.0, 0.0), (0.2, 0.0), (0.1, 2.0), (0.35, 0.0)] {
        town(&place, slope, waves);
        mapped_town(&place);
        for houses in ["houses.geojson", "houses.city.json", "town.osm"] {
            for loa in [0, 1, 2] {
                let shown = roofs(&place, houses, true, loa);
                let what = format!("{houses} at level {loa} on a slope of {slope} with waves of {waves} m");
                assert!(shown.len() > 700, "{what}: {} of 900 pixels", shown.len());
                check(&what, [slope, waves], loa == 0 && houses != "houses.city.json", &shown);
            }
        }
    }
}

#[test]
fn towns_without_terrain_stand_on_one_ground_through_their_buildings_at_every_level() {
    let place = Place::new();
    for (slope, waves) in [(0.2, 0.0), (0.1, 2.0), (0.4, 0.0)] {
        town(&place, slope, waves);
        let mut plates: Vec<Vec<([f64; 2], f64)>> = Vec::new();
        for loa in [0, 1, 2] {
            let what = format!("level {loa} on a slope of {slope} with waves of {waves} m");
            let shown = roofs(&place, "houses.city.json", false, loa);
            let over = |(at, z): &([f64; 2], f64)| z - ground(slope, waves, *at);
            let (roof, plate): (Vec<_>, Vec<_>) = shown.into_iter().partition(|p| over(p) > 0.5 * HIGH);
            assert!(roof.len() > 700, "{what}: roofs fill {} of 900 pixels", roof.len());
            check(&what, [slope, waves], false, &roof);
            if loa == 0 {
                // Every house is seen, at its own height.
                for [x, y] in houses() {
                    let base = ground(slope, waves, [x + 10.0, y + 10.0]);
                    let own = |(at, z): &&([f64; 2], f64)| {
                        (at[0] - x - 10.0).abs() < 9.0
                            && (at[1] - y - 10.0).abs() < 9.0
                            && (z - base - HIGH).abs() < 0.1
                    };
                    assert!(roof.iter().filter(own).count() >= 16, "{what}: the house at {x}, {y}");
                }
            }
            // The ground between lies on the slope, not on a level plate.
            let town = |(at, _): &&([f64; 2], f64)| at.iter().all(|v| (0.0..210.0).contains(v));
            let off: Vec<f64> = plate.iter().filter(town).map(|p| over(p).abs()).collect();
            assert!(median(off.clone()) < 0.5 + waves, "{what}: ground {:.1} m off the slope", median(off));
            plates.push(plate);
        }
        for other in &plates[1..] {
            for (at, z) in other {
                let same = plates[0].iter().find(|(p, _)| (p[0] - at[0]).abs() < 0.1 && (p[1] - at[1]).abs() < 0.1);
                assert!(same.is_none_or(|(_, first)| (first - z).abs() < 0.05), "a step of the ground at {at:?}");
            }
        }
    }
}

/// Volume of the buildings of a written city, m^3, by the divergence theorem.
fn volume(document: &Value) -> f64 {
    let numbers = |v: &Value| [0, 1, 2].map(|k| v[k].as_f64().expect("a number"));
    let list = |v: &Value| v.as_array().expect("a list").clone();
    let scale = numbers(&document["transform"]["scale"]);
    let point = |i: &Value| {
        let v = numbers(&document["vertices"][i.as_u64().expect("an index") as usize]);
        [0, 1, 2].map(|k| v[k] * scale[k])
    };
    let mut six = 0.0;
    for object in document["CityObjects"].as_object().expect("objects").values() {
        for geometry in list(&object["geometry"]).iter().filter(|_| object["type"] == "Building") {
            let boundaries = list(&geometry["boundaries"]);
            let shells = if geometry["type"] == "Solid" { boundaries } else { vec![json!(boundaries)] };
            for ring in shells.iter().flat_map(&list).flat_map(|surface| list(&surface)) {
                let corners: Vec<[f64; 3]> = list(&ring).iter().map(point).collect();
                for k in 2..corners.len() {
                    let [a, b, c] = [corners[0], corners[k - 1], corners[k]];
                    six += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                        + a[2] * (b[0] * c[1] - b[1] * c[0]);
                }
            }
        }
    }
    six / 6.0
}

#[test]
fn the_volume_that_is_told_is_that_of_the_solids_that_are_written() {
    let place = Place::new();
    for (slope, waves) in [(0.0, 0.0), (0.2, 0.0), (0.1, 2.0)] {
        town(&place, slope, waves);
        let mut shares = Vec::new();
        for houses in ["houses.geojson", "houses.city.json"] {
            let args = ["generalise", houses, "streets.geojson", "-o", "out", "--overwrite", "--json"];
            let made = place.json(&args);
            let held = 36.0 * 400.0 * HIGH;
            let told = made["volume_m3"].as_f64().expect("a volume");
            assert!((told / held - 1.0).abs() < 1e-3, "{houses}: {told} in place of {held} m^3");
            for (level, name) in made["levels"].as_array().expect("levels").iter().zip(["loa1", "loa2"]) {
                let written: Value =
                    serde_json::from_slice(&read(&place.path(&format!("out/{name}.city.json")))).expect("JSON");
                let (real, told) = (volume(&written) / held, level["volume_share"].as_f64().expect("a share"));
                let what = format!("{houses} {name} on a slope of {slope} with waves of {waves} m");
                assert!((told / real - 1.0).abs() < 0.01, "{what}: {told} told, {real} written");
                assert_eq!(level["volume_kept"], (0.9..=1.1).contains(&real), "{what}: {real}");
                shares.push(real);
            }
        }
        // Blocks on a slope hold what they hold on level ground, but for their feet in waves.
        for (on_slope, level) in shares[2..].iter().zip(&shares) {
            assert!((0.99..1.03 + 0.1 * waves).contains(&(on_slope / level)), "{on_slope} after {level} on {slope}");
        }
    }
    let args = ["generalise", "houses.geojson", "streets.geojson", "-o", "out", "--overwrite", "--strict"];
    let (_, said, code) = place.piped(&args, b"");
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("of the volume of the buildings, 90 to 110 are good"), "{said}");
}
