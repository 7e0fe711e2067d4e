//! City layers as a user meets them: drawn, on terrain of another system, and broken.

use super::Place;
use belvedere_testkit::data;

const LIGHT: &str = "[light]\nazimuth_deg = 300\naltitude_deg = 40\nshadows = true\n";

fn layer(id: &str, kind: &str, source: &str) -> String {
    format!("[[layer]]\nid = \"{id}\"\nkind = \"{kind}\"\nsource = \"{source}\"\n")
}

/// Pixels of each layer, by name; `""` = sky.
fn seen(place: &Place, scene: &str, root: Option<&str>) -> std::collections::BTreeMap<String, usize> {
    place.write("s.toml", scene);
    let (across, down) = (48, 27);
    let pixels: Vec<[f64; 2]> =
        (0..across * down).map(|i| [f64::from(i % across) * 6.0 + 3.0, f64::from(i / across) * 6.0 + 3.0]).collect();
    place.write("p.json", &serde_json::to_string(&pixels).expect("JSON"));
    let mut args = vec!["pick", "s.toml", "--pixels", "p.json", "-o", "picked.json", "--overwrite"];
    args.extend(root.into_iter().flat_map(|root| ["--allow-root", root]));
    place.ok(&args);
    let picked: serde_json::Value = serde_json::from_slice(&super::read(&place.path("picked.json"))).expect("JSON");
    let mut out = std::collections::BTreeMap::new();
    for pick in picked["pixels"].as_array().expect("pixels") {
        *out.entry(pick["layer"].as_str().unwrap_or_default().to_owned()).or_insert(0) += 1;
    }
    out
}

#[test]
fn cities_of_every_format_fill_their_picture() {
    for (file, eye, look_at) in [
        ("city_delft/delft.city.json", [84880.0, 447300.0, 180.0], [84960.0, 447550.0, 0.0]),
        ("city_berlin/berlin_lod2_citygml1.gml", [390500.0, 5819100.0, 250.0], [390590.0, 5819380.0, 35.0]),
    ] {
        let Some(path) = data(file) else { continue };
        let root = path.parent().and_then(|p| p.to_str()).expect("folder");
        let place = Place::new();
        let scene = format!(
            "format = 1\n{}{LIGHT}[camera]\neye = {eye:?}\nlook_at = {look_at:?}\nimage = [288, 162]\n",
            layer("city", "city", path.to_str().expect("UTF-8"))
        );
        let seen = seen(&place, &scene, Some(root));
        assert!(seen["city"] > 400, "{file}: {seen:?}");
        place.ok(&["render", "s.toml", "-o", "a.png", "--allow-root", root]);
    }
}

#[test]
fn footprints_in_degrees_stand_on_terrain_in_metres() {
    let (Some(dem), Some(houses)) = (data("swellendam/srtm_41_19_utm33s.tif"), data("swellendam/buildings.geojson"))
    else {
        return;
    };
    let root = dem.parent().and_then(|p| p.to_str()).expect("folder");
    let place = Place::new();
    let camera = "[camera]\neye = { lon = 20.445, lat = -34.038, above_ground_m = 250 }\n\
                  look_at = { lon = 20.44, lat = -34.022, above_ground_m = 0 }\nimage = [288, 162]\n";
    let scene = |offset: &str| {
        format!(
            "format = 1\n{}{}{offset}{LIGHT}{camera}",
            layer("dem", "terrain", dem.to_str().expect("UTF-8")),
            layer("town", "city", houses.to_str().expect("UTF-8"))
        )
    };
    let on_ground = seen(&place, &scene(""), Some(root));
    assert!(on_ground["town"] > 20 && on_ground["dem"] > 400, "{on_ground:?}");
}

#[test]
fn a_city_whose_datum_differs_from_the_terrain_is_spoken_of() {
    let place = Place::new();
    let corner = |x: f64, y: f64, z: f64| format!("[{x},{y},{z}]");
    let square = [[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0]];
    let ring = |z: f64| square.map(|[x, y]| corner(x, y, z)).join(",");
    place.write(
        "a.city.json",
        &format!(
            r#"{{"type":"CityJSON","version":"1.1","transform":{{"scale":[1,1,1],"translate":[0,0,5000]}},
            "vertices":[{},{}],"CityObjects":{{"h":{{"type":"Building","geometry":[{{"type":"Solid","lod":"1","boundaries":[[
            [[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]]}}]}}}}}}"#,
            ring(0.0),
            ring(10.0)
        ),
    );
    let scene = format!(
        "format = 1\n{}{}[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 1500]\n",
        layer("g", "terrain", "builtin:massif?size=65"),
        layer("c", "city", "a.city.json")
    );
    place.write("s.toml", &scene);
    let out = place.run(&["check", "s.toml"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned() + &String::from_utf8_lossy(&out.stdout);
    assert!(said.contains("above the terrain") && said.contains("set height_offset_m = -"), "{said}");
}

#[test]
fn broken_cities_end_in_one_error_with_the_place() {
    let refuses = |name: &str, content: &str, words: &[&str]| {
        let place = Place::new();
        place.write(name, content);
        let scene = format!(
            "format = 1\ncrs = \"local\"\n{}[camera]\neye = [0, -900, 400]\nlook_at = [0, 0, 0]\n",
            layer("c", "city", name)
        );
        place.write("s.toml", &scene);
        let line = place.fails(&["render", "s.toml", "-o", "a.png"]);
        assert!(words.iter().all(|w| line.contains(w)) && !place.path("a.png").exists(), "{name}: {line}");
    };
    refuses("a.city.json", r#"{"type":"CityJSON","version":"2.0","CityObjects":{},"vertices":[]}"#, &["a.city.json"]);
    refuses("b.city.json", r#"{"type":"CityJSON","version":"9.0","CityObjects":{},"vertices":[]}"#, &["9.0"]);
    refuses("c.gml", "<CityModel><broken", &["c.gml"]);
    refuses("d.osm.pbf", "\0\0\0\x0d\x0a\x09OSMHeader\x18", &["d.osm.pbf"]);
    let contours = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},
        "geometry":{"type":"LineString","coordinates":[[7.0,46.0],[7.01,46.0]]}}]}"#;
    refuses("e.geojson", contours, &["ways alone are drawn by a line layer"]);
    let flat = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"building":"yes","height":"0"},
        "geometry":{"type":"Polygon","coordinates":[[[7.0,46.0],[7.01,46.0],[7.02,46.0],[7.0,46.0]]]}}]}"#;
    refuses("f.geojson", flat, &["f.geojson"]);
}

#[test]
fn a_city_is_abstracted_on_loading() {
    let place = Place::new();
    let scene = |loa: &str| {
        format!(
            "format = 1\ncrs = \"local\"\n{}{loa}[camera]\neye = [0, -500, 300]\nlook_at = [0, 0, 0]\n",
            layer("c", "city", "builtin:town?size=600")
        )
    };
    let triangles = |loa: &str| {
        place.write("s.toml", &scene(loa));
        let record = place.json(&["render", "s.toml", "-o", "a.png", "--size", "160x90", "--overwrite", "--json"]);
        assert!(record.is_object());
        let sidecar: serde_json::Value =
            serde_json::from_slice(&super::read(&place.path("a.png.json"))).expect("a record");
        sidecar["stats"]["triangles_in"].as_u64().expect("a count")
    };
    let [all, blocks, quarters] = ["", "loa = 1\n", "loa = 2\n"].map(triangles);
    assert!(blocks < all && quarters <= blocks, "{all} {blocks} {quarters}");
    place.write("s.toml", &scene("loa = 3\n"));
    assert!(place.fails(&["check", "s.toml"]).contains("loa is 3, it must be 0"));
}

#[test]
fn several_sources_line_up_or_say_that_they_do_not() {
    let place = Place::new();
    let said = |name: &str, scene: &str| {
        place.write("s.toml", scene);
        let out = place.run(&["check", "s.toml"]);
        let said = String::from_utf8_lossy(&out.stderr).into_owned() + &String::from_utf8_lossy(&out.stdout);
        assert!(!said.contains("panicked"), "{name}: {said}");
        (out.status.code(), said)
    };
    let camera = "[camera]\neye = [0, -900, 400]\nlook_at = [0, 0, 0]\n";
    let solid = |z: i32, head: &str| {
        format!(
            r#"{{"type":"CityJSON","version":"1.1",{head}"transform":{{"scale":[1,1,1],"translate":[390000,5819000,{z}]}},
            "vertices":[[0,0,0],[9,0,0],[9,9,0],[0,9,0],[0,0,7],[9,0,7],[9,9,7],[0,9,7]],"CityObjects":{{"h":{{"type":"Building",
            "geometry":[{{"type":"Solid","lod":"1","boundaries":[[[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]]}}]}}}}}}"#
        )
    };
    let crs = r#""metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/25833"},"#;
    place.write("a.city.json", &solid(35, crs));
    place.write("b.city.json", &solid(35, ""));
    let feature = |properties: &str, kind: &str, coordinates: &str| {
        format!(
            r#"{{"type":"FeatureCollection","features":[{{"type":"Feature","properties":{properties},
            "geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}]}}"#
        )
    };
    place.write("way.geojson", &feature("{}", "LineString", "[[13.378,52.512],[13.379,52.513]]"));
    let (city, way) = (layer("c", "city", "a.city.json"), layer("w", "line", "way.geojson"));
    // Ways without heights lie on the ground of the city, whatever the order of the layers.
    for layers in [format!("{city}{way}"), format!("{way}{city}")] {
        let (code, text) = said("way", &format!("format = 1\n{layers}{camera}"));
        assert!(code == Some(0) && text.contains("2 positions without height lie at 35.0 m"), "{text}");
    }
    // A city without a system is said to be taken as it stands.
    let plain = layer("p", "city", "b.city.json");
    let (_, text) = said("no system", &format!("format = 1\n{city}{plain}{camera}"));
    assert!(text.contains("b.city.json: names no system that is known and is taken as in EPSG:25833"), "{text}");
    assert!(!text.contains("a.city.json: names no system"), "{text}");
    // Latitudes before longitudes: another continent.
    let Some(dem) = data("swellendam/srtm_41_19_utm33s.tif") else { return };
    let root = dem.parent().and_then(|p| p.to_str()).expect("folder").to_owned();
    let house = |corners: &str| feature(r#"{"building":"yes","height":7}"#, "MultiPolygon", corners);
    let right = "[[[20.44,-34.02],[20.441,-34.02],[20.441,-34.021],[20.44,-34.02]]]";
    let swapped = "[[[-34.02,20.44],[-34.02,20.441],[-34.021,20.441],[-34.02,20.44]]]";
    place.write("swapped.geojson", &house(&format!("[{swapped}]")));
    let ground = layer("g", "terrain", dem.to_str().expect("UTF-8"));
    let scene = |name: &str| format!("format = 1\n{ground}{}{camera}", layer("c", "city", name));
    place.write("s.toml", &scene("swapped.geojson"));
    let line = place.fails(&["check", "s.toml", "--allow-root", &root]);
    assert!(line.contains("none of its 1 buildings lies on the terrain") && line.contains("latitudes"), "{line}");
    let two = feature(r#"{"building":"yes"}"#, "Polygon", right).replace(
        "\"features\":[",
        &format!("\"features\":[{},", r#"{"type":"Feature","properties":{"building":"yes"},"geometry":{"type":"Polygon","coordinates":[[[25,-34],[25.1,-34],[25.1,-34.1],[25,-34]]]}}"#),
    );
    place.write("two.geojson", &two);
    place.write(
        "far.geojson",
        &two.replace("[25,-34]", "[50,14]").replace("[25.1,-34]", "[50.1,14]").replace("[25.1,-34.1]", "[50.1,14.1]"),
    );
    place.write("s.toml", &format!("format = 1\n{}{camera}", layer("c", "city", "far.geojson")));
    let line = place.fails(&["check", "s.toml"]);
    assert!(line.contains("its shapes lie over") && line.contains("1500 km are possible"), "{line}");
    place.write("s.toml", &scene("two.geojson"));
    let out = place.run(&["check", "s.toml", "--allow-root", &root]);
    let text = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(text.contains("1 of 2 buildings lie outside the terrain and are left out"), "{text}");
}
