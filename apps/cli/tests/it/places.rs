//! Places as every verb takes them: scene coordinates, degrees, letters, heights above the ground, exchanged numbers.

use super::Place;
use super::reveal_looks::land;
use serde_json::Value;

fn json(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&super::read(&place.path(name))).expect("JSON")
}

/// The eye of the picture of `reveal`, and all warnings.
fn eye(place: &Place, eye: &str, look: &str) -> ([f64; 3], String) {
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "48x32", "--overwrite", "--json"];
    let result = place.json(&[&args[..], &["--eye", eye, "--look", look]].concat());
    let found = json(place, "out.png.json")["view"]["eye"].clone();
    (serde_json::from_value(found).expect("three numbers"), result["warnings"].to_string())
}

#[test]
fn one_place_in_all_its_forms_is_one_eye() {
    let place = land(0.0, |_, _| false);
    let (right, said) = eye(&place, "8.03,46.006,1900", "8.03,46.035");
    assert!(right[2] == 1900.0 && !said.contains("is taken so"), "{said}");
    let [x, y, _] = right;
    let near = |text: &str, look: &str, words: Option<&str>| {
        let (found, said) = eye(&place, text, look);
        let away = (0..3).map(|i| (found[i] - right[i]).abs()).fold(0.0, f64::max);
        assert!(away < 1e-6, "{text}: {found:?}, {right:?}");
        assert_eq!(said.contains("is taken so"), words.is_some(), "{text}: {said}");
        assert!(words.is_none_or(|words| said.contains(words)), "{text}: {said}");
    };
    near("46.006N,8.03E,1900", "8.03E,46.035N", None);
    near(&format!("{x},{y},1900"), "8.03,46.035,1000", None);
    near("46.006,8.03,1900", "8.03,46.035", Some("eye 46.006,8.03 lies"));
    near("8.03,46.006,1900", "46.035,8.03", Some("the point looked at, 46.035,8.03, lies"));
    near(&format!("{y},{x},1900"), "8.03,46.035", Some("as y,x of the scene it lies on it"));
    // Above the ground: 300 m more is 300 m higher.
    let [low, high] = ["+500", "+800"].map(|z| eye(&place, &format!("46.006N,8.03E,{z}"), "46.035N,8.03E").0[2]);
    assert!((high - low - 300.0).abs() < 1e-6 && low > 1000.0, "{low} {high}");
}

#[test]
fn disocclude_render_project_and_see_take_the_same_places() {
    let place = land(0.0, |_, _| false);
    let eye_of = |eye: &str, look: &str| {
        let args =
            ["disocclude", "dem.asc", "way.geojson", "-o", "d.tif", "--report", "d.json", "--overwrite", "--json"];
        let result = place.json(&[&args[..], &["--eye", eye, "--look", look]].concat());
        let report = json(&place, "d.json");
        (report["scene_eye"].clone(), result["warnings"].to_string(), report["crs"].clone())
    };
    let (right, said, crs) = eye_of("8.03,46.006,1900", "8.03,46.035");
    assert!(crs == "EPSG:32632" && !said.contains("is taken so"), "{said}");
    assert_eq!(eye_of("46.006N,8.03E,1900", "46.035N,8.03E").0, right);
    let (found, said, _) = eye_of("46.006,8.03,1900", "46.035,8.03");
    assert!(found == right && said.contains("as lat,lon it lies on it"), "{said}");
    let [x, y] = [0, 1].map(|i| right[i].as_f64().expect("a number"));
    let (found, said, _) = eye_of(&format!("{x},{y},1900"), "8.03,46.035");
    assert!(said.contains("as x,y of the scene it lies on it"), "{said}");
    assert!((found[0].as_f64().expect("a number") - x).abs() < 1e-6);

    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png", "--size", "48x32", "--scene", "s.toml"];
    place.ok(&[&args[..], &["--eye", "8.03,46.006,1900", "--look", "8.03,46.035"]].concat());
    place.write(
        "p.json",
        &format!("[[{x},{y},1000], \"46.006N,8.03E,1000\", \"8.03,46.006,1000\", \"46.006,8.03,1000\"]"),
    );
    let out = place.run(&["displace", "s.toml", "--points", "p.json"]);
    let points: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let points = points["points"].as_array().expect("a list").clone();
    let near = |a: &Value, b: &Value| {
        (0..3).all(|i| (a["displaced"][i].as_f64().unwrap() - b["displaced"][i].as_f64().unwrap()).abs() < 1e-3)
    };
    assert!(points.len() == 4 && points.iter().all(|p| near(p, &points[0])), "{points:?}");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(said.matches("is taken so").count() == 1 && said.contains("point 46.006,8.03"), "{said}");
    place.write("bad.json", "[[1,2,3], \"46.006N,8.03\"]");
    let line = place.fails(&["project", "s.toml", "--points", "bad.json"]);
    assert!(line.contains("element 1") && line.contains("only one of the two has a letter"), "{line}");

    let seen = |see: &str| {
        let args = ["reveal", "s.toml", "--see", see, "-o", "see.png", "--size", "48x32", "--overwrite", "--json"];
        let result = place.json(&args);
        (json(&place, "see.png.json")["target"]["point"].clone(), result["warnings"].to_string())
    };
    let (point, said) = seen("46.035N,8.03E,1200");
    assert!(point[2] == 1200.0 && !said.contains("is taken so"), "{point} {said}");
    let (exchanged, said) = seen("46.035,8.03,1200");
    assert!(exchanged == point && said.contains("see 46.035,8.03"), "{exchanged} {said}");

    let from = |text: &str, out: &str| {
        place.json(&["render", "s.toml", "-o", out, "--outside", text, "--size", "48x32", "--overwrite", "--json"])
    };
    from("8.03,46.0,4000,8.03,46.035,1000", "a.png");
    let result = from("46.0N,8.03E,4000,8.03E,46.035N,1000", "b.png");
    assert!(!result["warnings"].to_string().contains("is taken so"), "{result}");
    let result = from("46.0,8.03,4000,46.035,8.03,1000", "c.png");
    assert!(result["warnings"].to_string().contains("is taken so"), "{result}");
    let pictures =
        ["a.png", "b.png", "c.png"].map(|name| super::light_and_tints::pixels(&super::read(&place.path(name))));
    assert!(pictures[0] == pictures[1] && pictures[0] == pictures[2]);
}

#[test]
fn bad_places_are_refused_with_the_grammar() {
    let place = land(0.0, |_, _| false);
    let args = ["reveal", "dem.asc", "way.geojson", "-o", "out.png"];
    let reveal = |eye: &str, look: &str| place.fails(&[&args[..], &["--eye", eye, "--look", look]].concat());
    for (line, words) in [
        (reveal("8.03,46.0", "8.03,46.035"), "an eye needs a height"),
        (reveal("8.03,46.0,high", "8.03,46.035"), "\"high\" is not a height"),
        (reveal("8.03,46.0N,1900", "8.03,46.035"), "only one of the two has a letter"),
        (reveal("8.03,46.0,1900", "8.03"), "1 parts"),
        (reveal("8.3,46.0,+20", "8.03,46.035"), "--eye: "),
        (reveal("8.03,46.0,1900", "9.5,46.035"), "--look: "),
        (place.fails(&[&args[..], &["--eye", "8.03,46.0,1900"]].concat()), "--eye is given without --look"),
    ] {
        assert!(line.contains(words), "{line}");
    }
}

/// Data of a store of hashes, as of git-annex: the elevation model and its .prj are links, each into a folder of its own.
#[test]
#[cfg(unix)]
fn links_into_a_store_are_data_with_their_neighbours() {
    let place = Place::new();
    let heights: String = (0..1600).map(|i| format!("{} ", 100 + i * 7919 % 97)).collect();
    let grid = format!("ncols 40\nnrows 40\nxllcorner 500000\nyllcorner 5000000\ncellsize 10\n{heights}");
    let system = "PROJCS[\"UTM 32N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1]]";
    for (name, key, text) in [("dem.asc", "K1", grid.as_str()), ("dem.prj", "K2", system)] {
        let folder = format!(".git/annex/objects/{key}");
        std::fs::create_dir_all(place.path(&folder)).expect("folder");
        place.write(&format!("{folder}/{key}"), text);
        std::os::unix::fs::symlink(format!("{folder}/{key}"), place.path(name)).expect("link");
    }
    place.write("way.geojson", r#"{"type":"LineString","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"coordinates":[[500050,5000200],[500350,5000210]]}"#);
    let view = ["--eye", "500200,5000020,+50", "--look", "500200,5000300", "--size", "48x32", "-q"];
    place.ok(&[&["reveal", "dem.asc", "way.geojson", "-o", "a.png", "--scene", "s.toml"], &view[..]].concat());
    let scene = String::from_utf8(super::read(&place.path("s.toml"))).expect("UTF-8");
    assert!(scene.contains("crs = \"EPSG:32632\"") && scene.contains("source = \"dem.asc\""), "{scene}");
    place.ok(&["render", "s.toml", "-o", "b.png", "--size", "48x32", "-q", "--no-remember"]);
}
