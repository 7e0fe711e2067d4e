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
        let Some(path) = data(file) else { return };
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
