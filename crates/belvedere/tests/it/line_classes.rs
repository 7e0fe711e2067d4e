//! Lines of files are drawn by what they are, and what must be seen stays on top.

use belvedere::request::{Reveal, read};
use belvedere::scene::{Color, LayerKind, LineClass, LineFeature, LineLayer, Scene};
use belvedere::verbs::reveal::{RevealAnswer, Setting, reveal};
use serde_json::{Value, json};
use std::path::Path;

/// A level ground of 6 km with a valley of 200 m across its middle.
fn ground() -> String {
    const CELLS: usize = 60;
    let mut grid = format!("ncols {CELLS}\nnrows {CELLS}\nxllcorner 500000\nyllcorner 5000000\ncellsize 100\n");
    for _ in 0..CELLS {
        let height = |column: usize| if (25..35).contains(&column) { 300.0 } else { 500.0 };
        grid += &((0..CELLS).map(|column| height(column).to_string()).collect::<Vec<_>>().join(" ") + "\n");
    }
    grid
}

fn line(properties: Value, y: f64) -> Value {
    let at = [[500_900.0, 5_000_000.0 + y], [505_000.0, 5_000_000.0 + y]];
    json!({ "type": "Feature", "properties": properties, "geometry": { "type": "LineString", "coordinates": at } })
}

fn write(folder: &Path, name: &str, features: &[Value]) -> String {
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32632" } });
    let path = folder.join(name);
    let text = json!({ "type": "FeatureCollection", "crs": crs, "features": features }).to_string();
    std::fs::write(&path, text).expect("a file");
    path.display().to_string()
}

/// The picture of files from above, the first of which must be seen.
fn revealed(folder: &Path, features: &[String], more: Value) -> RevealAnswer {
    std::fs::write(folder.join("ground.asc"), ground()).expect("a file");
    let mut asked = json!({ "data": folder.join("ground.asc").display().to_string(), "features": features, "source_crs": "EPSG:32632",
        "size": [320, 240], "eye": "503000,4999500,7000", "look": "503000,5003000,400" });
    asked.as_object_mut().expect("an object").extend(more.as_object().cloned().expect("an object"));
    let asked: Reveal = read(&asked.to_string()).expect("a request");
    reveal(&asked, &Setting::default()).expect("a picture")
}

fn lines<'s>(scene: &'s Scene, id: &str) -> &'s LineLayer {
    let layer = scene.layers.iter().find(|layer| layer.id == id);
    match layer.map(|layer| &layer.kind) {
        Some(LayerKind::Line(lines)) => lines,
        other => panic!("{id}: {other:?}"),
    }
}

fn class(feature: &LineFeature) -> Option<LineClass> {
    feature.style.and_then(|own| own.class)
}

#[test]
fn context_has_the_colours_of_its_classes_and_ways_that_must_be_seen_are_routes() {
    let folder = tempfile::tempdir().expect("a folder");
    let trail = write(folder.path(), "trail.geojson", &[line(json!({ "highway": "path" }), 2600.0)]);
    let map = write(
        folder.path(),
        "map.geojson",
        &[line(json!({ "waterway": "river" }), 3400.0), line(json!({ "highway": "primary" }), 1800.0)],
    );
    let found = revealed(folder.path(), &[trail, map], json!({}));
    let scene = found.session.scene();
    let (trail, map) = (lines(scene, "trail"), lines(scene, "map"));
    assert_eq!(trail.features.iter().map(class).collect::<Vec<_>>(), [None]);
    assert_eq!(map.features.iter().map(class).collect::<Vec<_>>(), [Some(LineClass::River), Some(LineClass::MainRoad)]);
    let near = |color: Color| {
        let far = |p: &[u8; 3]| [color.r, color.g, color.b].into_iter().zip(p).map(|(a, b)| a.abs_diff(*b)).max();
        found.picture.frame.color.iter().filter(|p| far(p).is_some_and(|far| far < 24)).count()
    };
    for color in [trail.color, LineClass::River.look().color, LineClass::MainRoad.look().color] {
        assert!(near(color) > 60, "{color:?}: {}", near(color));
    }
    assert_eq!(near(LineClass::Border.look().color), 0);
}

#[test]
fn files_without_tags_are_told_by_their_name_or_by_the_caller() {
    let folder = tempfile::tempdir().expect("a folder");
    let way = write(folder.path(), "way.geojson", &[line(json!({}), 2600.0)]);
    let rivers = write(folder.path(), "rivers.geojson", &[line(json!({}), 3400.0)]);
    let features = [way, rivers];
    let of = |more: Value| {
        let found = revealed(folder.path(), &features, more);
        let scene = found.session.scene();
        ["way", "rivers"].map(|id| class(&lines(scene, id).features[0]))
    };
    assert_eq!(of(json!({})), [None, Some(LineClass::River)]);
    assert_eq!(of(json!({ "line_class": ["rivers=route", "way.geojson=Borders"] })), [Some(LineClass::Border), None]);
    let wrong = json!({ "data": folder.path().join("ground.asc").display().to_string(), "features": features, "source_crs": "EPSG:32632",
        "line_class": ["gone.geojson=river"] });
    let wrong: Reveal = read(&wrong.to_string()).expect("a request");
    let error = reveal(&wrong, &Setting::default()).expect_err("no such file").to_string();
    assert!(error.contains("no file of features is called \"gone.geojson\""), "{error}");
}

#[test]
fn lifts_hang_over_valleys_and_other_lines_lie_in_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let lift = write(folder.path(), "lift.geojson", &[line(json!({ "aerialway": "cable_car" }), 2600.0)]);
    let path = write(folder.path(), "path.geojson", &[line(json!({ "highway": "path" }), 2600.0)]);
    let found = revealed(folder.path(), &[lift, path], json!({}));
    let scene = found.session.scene();
    let terrain = scene.terrain().expect("ground");
    // Heights over the ground in the middle of the valley.
    let over = |lines: &LineLayer| {
        let pair = lines.features[0].points.windows(2).find(|pair| (pair[0].x..=pair[1].x).contains(&503_000.0));
        let pair = pair.expect("the line crosses the valley");
        let p = pair[0].lerp(pair[1], (503_000.0 - pair[0].x) / (pair[1].x - pair[0].x));
        p.z - terrain.surface_at(p.truncate()).expect("ground")
    };
    let [lift, path] = ["lift", "path"].map(|id| over(lines(scene, id)));
    assert!((200.0..225.0).contains(&lift) && path.abs() < 1e-6, "{lift} and {path}");
}

#[test]
fn points_of_a_track_are_its_waypoints_and_the_title_is_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let hut = json!({ "type": "Feature", "properties": { "name": "Hut" }, "geometry": { "type": "Point", "coordinates": [503_000.0, 5_002_500.0] } });
    let tour = write(folder.path(), "tour.geojson", &[hut, line(json!({ "name": "Round walk" }), 2600.0)]);
    let found = revealed(folder.path(), &[tour], json!({ "furniture": ["title", "legend"] }));
    let ids: Vec<&str> = found.session.scene().layers.iter().map(|layer| layer.id.as_str()).collect();
    assert!(ids.contains(&"tour") && ids.contains(&"Waypoints"), "{ids:?}");
    let record = serde_json::to_value(&found.picture.sidecar).expect("JSON");
    assert_eq!(record["furniture"], json!({ "title": "Round walk", "legend": 2 }));
    let document = found.session.resolved().expect("a document");
    let names = document.furniture.as_ref().map(|furniture| furniture.names.clone()).unwrap_or_default();
    assert_eq!(names.into_iter().collect::<Vec<_>>(), [("Waypoints".to_owned(), "Waypoints".to_owned())]);
}

#[test]
fn symbols_that_would_lie_over_one_another_are_left_out_and_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let way = write(folder.path(), "way.geojson", &[line(json!({}), 2600.0)]);
    let point = |i: usize, apart: f64| {
        let at = [501_000.0 + apart * i as f64, 5_003_000.0];
        json!({ "type": "Feature", "properties": { "place": "village", "population": 1000 - i }, "geometry": { "type": "Point", "coordinates": at } })
    };
    let left_out = |name: &str, apart: f64| {
        let points: Vec<Value> = (0..8).map(|i| point(i, apart)).collect();
        let places = write(folder.path(), name, &points);
        revealed(folder.path(), &[way.clone(), places], json!({})).picture.frame.stats.symbols_left_out
    };
    assert_eq!(left_out("far.geojson", 500.0), 0);
    assert_eq!(left_out("near.geojson", 5.0), 7, "one of eight stays");
}
