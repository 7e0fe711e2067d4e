//! Cities: CityJSON by hand and from the collection, footprints, and broken ones.

use belvedere_io::{Limits, load_city};
use belvedere_scene::{HeightSource, LandCover, StructureKind, Surface, WayClass};
use belvedere_testkit::data;
use serde_json::{Value, json};
use std::path::PathBuf;

fn write(dir: &tempfile::TempDir, name: &str, content: &str) -> PathBuf {
    let path = dir.path().join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// A cube of 10 m on the ground at (100, 200, 3), by semantics or without.
fn cube(semantics: bool) -> Value {
    let mut solid = json!({ "type": "Solid", "lod": "2", "boundaries": [[
        [[0, 3, 2, 1]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]],
    ]] });
    if semantics {
        let surfaces = json!([{ "type": "GroundSurface" }, { "type": "RoofSurface" }, { "type": "WallSurface" }]);
        solid["semantics"] = json!({ "surfaces": surfaces, "values": [[0, 1, 2, 2, 2, 2]] });
    }
    let corner = |i: usize| {
        let side = |bit: bool| if bit { 10_000 } else { 0 };
        json!([side((i + 1) & 2 != 0), side(i & 2 != 0), side(i & 4 != 0)])
    };
    json!({
        "type": "CityJSON", "version": "2.0",
        "transform": { "scale": [0.001, 0.001, 0.001], "translate": [100.0, 200.0, 3.0] },
        "metadata": { "referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/7415" },
        "vertices": (0..8).map(corner).collect::<Vec<_>>(),
        "CityObjects": {
            "part": { "type": "BuildingPart", "parents": ["house"], "geometry": [solid] },
            "house": { "type": "Building", "children": ["part"], "attributes": { "name": "Hall", "function": "church" } },
        },
    })
}

fn load(value: &Value) -> Result<belvedere_io::Loaded<belvedere_io::CityFile>, String> {
    let dir = tempfile::tempdir().unwrap();
    load_city(&write(&dir, "a.city.json", &value.to_string()), None, &Limits::default()).map_err(|e| e.to_string())
}

#[test]
fn parts_join_their_building_and_faces_are_told_by_semantics_or_direction() {
    for semantics in [true, false] {
        let loaded = load(&cube(semantics)).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let file = loaded.value;
        let [b] = file.city.buildings.as_slice() else { panic!("{:?}", file.city) };
        assert_eq!((b.id.as_str(), b.name.as_str(), b.landmark), ("house", "Hall", true));
        assert_eq!((b.base_m, b.height_m, b.height_source), (Some(3.0), 10.0, HeightSource::Shape));
        let count = |s: Surface| b.faces.iter().filter(|f| f.surface == s).count();
        assert_eq!([Surface::Ground, Surface::Roof, Surface::Wall].map(count), [1, 1, 4], "{semantics}");
        let [polygon] = b.footprint.as_slice() else { panic!("one footprint") };
        let area: f64 = {
            let r = &polygon.outer;
            (0..r.len()).map(|k| r[k].perp_dot(r[(k + 1) % r.len()])).sum::<f64>() / 2.0
        };
        assert!((area - 100.0).abs() < 1e-6, "counter-clockwise: {area}");
        assert_eq!(file.crs.and_then(|crs| crs.epsg()), Some(28992), "the flat part of a compound system");
        assert_eq!((file.format.as_str(), file.lods.as_slice()), ("CityJSON 2.0", &["2".to_owned()][..]));
    }
}

#[test]
fn templates_stand_where_instances_put_them() {
    let mut city = cube(true);
    city["geometry-templates"] = json!({
        "templates": [{ "type": "MultiSurface", "lod": "2", "boundaries": [[[0, 1, 2]]] }],
        "vertices-templates": [[0, 0, 0], [1, 0, 0], [0, 0, 2]],
    });
    let matrix = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1];
    let instance =
        json!({ "type": "GeometryInstance", "template": 0, "boundaries": [6], "transformationMatrix": matrix });
    city["CityObjects"]["tree"] = json!({ "type": "SolitaryVegetationObject", "geometry": [instance] });
    let file = load(&city).unwrap().value;
    let [tree] = file.city.structures.as_slice() else { panic!("{:?}", file.city.structures) };
    assert_eq!(tree.kind, StructureKind::Vegetation);
    let corners: Vec<[f64; 3]> = tree.faces[0].rings[0].iter().map(|p| p.to_array()).collect();
    let at = [110.0, 210.0, 13.0];
    assert_eq!(corners, [at, [112.0, 210.0, 13.0], [110.0, 210.0, 17.0]]);
    city["CityObjects"]["tree"]["geometry"][0]["template"] = json!(7);
    assert!(load(&city).unwrap_err().contains("\"tree\": template 7 does not exist, there are 1"));
}

#[test]
fn solids_that_are_inside_out_are_those_that_are_not() {
    for semantics in [false, true] {
        let cube = cube(semantics);
        let mut inverted = cube.clone();
        let shell = &mut inverted["CityObjects"]["part"]["geometry"][0]["boundaries"][0];
        for face in shell.as_array_mut().expect("faces") {
            face[0].as_array_mut().expect("a ring").reverse();
        }
        let [right, turned] = [&cube, &inverted].map(|value| load(value).expect("read"));
        let said = |w: &belvedere_core::Warning| w.text().contains("1 solids were inside out and are turned");
        assert!(turned.warnings.iter().any(said) && !right.warnings.iter().any(said), "{:?}", turned.warnings);
        let [right, turned] =
            [right, turned].map(|loaded| loaded.value.city.buildings.into_iter().next().expect("one"));
        assert_eq!((right.height_m, right.base_m), (10.0, Some(3.0)), "with semantics: {semantics}");
        assert_eq!((turned.height_m, turned.base_m, turned.height_source), (10.0, Some(3.0), HeightSource::Shape));
        assert_eq!(right.faces.len(), turned.faces.len());
        for (a, b) in right.faces.iter().zip(&turned.faces) {
            let area = |ring: &[belvedere_core::DVec3]| {
                (1..ring.len() - 1)
                    .map(|k| (ring[k] - ring[0]).cross(ring[k + 1] - ring[0]))
                    .sum::<belvedere_core::DVec3>()
            };
            assert_eq!(a.surface, b.surface, "with semantics: {semantics}");
            assert!(area(&a.rings[0]).distance(area(&b.rings[0])) < 1e-9, "with semantics: {semantics}");
        }
    }
}

#[test]
fn broken_models_are_one_clear_error_or_a_counted_repair() {
    let broken = |change: fn(&mut Value), expected: &str| {
        let mut city = cube(true);
        change(&mut city);
        let text = load(&city).unwrap_err();
        assert!(text.contains(expected) && text.contains("a.city.json"), "{text}");
    };
    broken(|c| c["version"] = json!("3.1"), "CityJSON 3.1; versions 1.0, 1.1 and 2.0 are read");
    broken(|c| c["vertices"][3] = json!([1, "x", 2]), "vertex 3 is not three finite numbers");
    broken(|c| c["vertices"] = json!([[0, 0, 0]]), "vertex 3 does not exist, there are 1");
    broken(|c| c["CityObjects"] = json!({}), "no geometry that is read");
    broken(|c| c["CityObjects"]["part"]["geometry"][0]["boundaries"] = json!(3), "boundaries are not nested");
    broken(|c| c["CityObjects"]["part"]["geometry"][0]["type"] = json!("Blob"), "geometry of type \"Blob\"");
    broken(|c| c["transform"]["scale"] = json!([1, 2]), "transform.scale is not three finite numbers");
    let mut city = cube(true);
    city["CityObjects"]["part"]["geometry"][0]["boundaries"][0][2] = json!([[0, 0, 1]]);
    let loaded = load(&city).unwrap();
    assert_eq!(loaded.value.city.buildings[0].faces.len(), 5);
    assert!(
        loaded.warnings[0].text().contains("1 rings of fewer than 3 different vertices were dropped"),
        "{:?}",
        loaded.warnings
    );
    let dir = tempfile::tempdir().unwrap();
    let text = cube(true).to_string();
    for cut in (1..text.len()).step_by(text.len() / 60) {
        let path = write(&dir, "cut.city.json", &text[..cut]);
        assert!(load_city(&path, None, &Limits::default()).is_err(), "{cut}");
    }
}

#[test]
fn a_level_of_detail_may_be_asked_for() {
    let Some(path) = data("city_delft/multi_lod.city.json") else { return };
    let height = |lod: Option<&str>| {
        let file = load_city(&path, lod, &Limits::default()).unwrap().value;
        assert_eq!(file.lods, ["1.2", "1.3", "2.2"]);
        file.city.buildings.iter().map(|b| b.faces.len()).sum::<usize>()
    };
    let (highest, low) = (height(None), height(Some("1.2")));
    assert!(highest == height(Some("2.2")) && low < highest, "{low} {highest}");
    let text = load_city(&path, Some("3"), &Limits::default()).unwrap_err().to_string();
    assert!(text.contains("has no level of detail 3; it has 1.2, 1.3, 2.2"), "{text}");
}

#[test]
fn the_collection_is_read_with_its_counts() {
    for (name, format, buildings, structures, areas) in [
        ("city_delft/delft.city.json", "CityJSON 2.0", 160, 57, 353),
        ("city_delft/delft_1b.city.json", "CityJSON 1.1", 1, 0, 0),
        ("city_delft/small.city.jsonl", "CityJSONSeq", 3, 0, 0),
        ("city_bubenec/buildings.geojson", "GeoJSON", 144, 0, 0),
        ("swellendam/buildings.geojson", "GeoJSON", 4708, 0, 0),
    ] {
        let Some(path) = data(name) else { continue };
        let file = load_city(&path, None, &Limits::default()).unwrap().value;
        let found =
            (file.format.as_str(), file.city.buildings.len(), file.city.structures.len(), file.city.areas.len());
        assert_eq!(found, (format, buildings, structures, areas), "{name}");
        assert!(file.city.buildings.iter().all(|b| b.height_m > 0.0 && !b.footprint.is_empty()), "{name}");
    }
}

#[test]
fn map_features_are_buildings_ways_and_land_cover() {
    let square = json!([[[18.0, -34.0], [18.001, -34.0], [18.001, -33.999], [18.0, -33.999], [18.0, -34.0]]]);
    let feature = |properties: Value, kind: &str, coordinates: Value| json!({ "type": "Feature", "properties": properties, "geometry": { "type": kind, "coordinates": coordinates } });
    let line = json!([[18.0, -34.0], [18.001, -34.0]]);
    let all = json!({ "type": "FeatureCollection", "features": [
        feature(json!({ "building": "yes", "building:levels": 4, "name": "Mill" }), "Polygon", square.clone()),
        feature(json!({ "building": "no" }), "Polygon", square.clone()),
        feature(json!({ "natural": "water" }), "Polygon", square.clone()),
        feature(json!({ "leisure": "park", "height": 3 }), "Polygon", square),
        feature(json!({ "highway": "primary_link" }), "LineString", line.clone()),
        feature(json!({ "railway": "tram" }), "LineString", line.clone()),
        feature(json!({ "power": "line" }), "LineString", line),
    ] });
    let dir = tempfile::tempdir().unwrap();
    let loaded = load_city(&write(&dir, "a.geojson", &all.to_string()), None, &Limits::default()).unwrap();
    let city = &loaded.value.city;
    let [b] = city.buildings.as_slice() else { panic!("{:?}", city.buildings) };
    assert_eq!((b.name.as_str(), b.height_m, b.height_source), ("Mill", 13.0, HeightSource::Levels));
    assert_eq!(city.ways.iter().map(|w| w.class).collect::<Vec<_>>(), [WayClass::Primary, WayClass::Rail]);
    assert_eq!(city.areas.iter().map(|a| a.cover).collect::<Vec<_>>(), [LandCover::Water, LandCover::Green]);
    assert!(loaded.warnings.iter().any(|w| w.text().contains("2 features that are neither")), "{:?}", loaded.warnings);
}
