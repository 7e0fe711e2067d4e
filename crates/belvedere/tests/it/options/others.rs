//! Options of `measure`, `generalise` and `export`.

use super::Does::{Changes, IsRefused};
use super::{of_data, scene, try_all};
use belvedere::export::{ExportOptions, export};
use belvedere::request::{Export, Generalise, Measure, options, read};
use belvedere::scene::Progress;
use belvedere::verbs::generalise::generalise;
use belvedere::verbs::measure::measure;
use belvedere::verbs::open_files::scene_or_data;
use belvedere::{BelvedereError, OpenOptions, Session};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[test]
fn every_option_of_measure_changes_its_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene(folder.path());
    let rows = vec![
        ("spacing", Changes(json!(200), json!({}))),
        ("size", Changes(json!([48, 48]), json!({}))),
        ("renderer", Changes(json!("exact"), json!({}))),
        ("picture", Changes(json!(true), json!({}))),
    ];
    try_all(&options::<Measure>(), &[], rows, &json!({}), |asked| {
        let asked: Measure = read(&asked.to_string()).expect("a request");
        let open = OpenOptions { image: asked.size, ..OpenOptions::default() };
        let session = Session::open(Path::new(&scene), &open)?;
        let found = measure(&session, &asked, &Progress::silent())?;
        Ok::<_, BelvedereError>(serde_json::to_string(&found).expect("a report"))
    });
}

#[test]
fn every_option_of_export_changes_its_answer_or_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene(folder.path());
    let mut rows = of_data();
    rows.extend([
        ("size", Changes(json!([48, 48]), json!({}))),
        ("straight", Changes(json!(true), json!({}))),
        ("nodes", Changes(json!(100), json!({}))),
    ]);
    try_all(&options::<Export>(), &[], rows, &json!({}), |asked| {
        let asked: Export = read(&asked.to_string()).expect("a request");
        let source = scene_or_data(&[PathBuf::from(&scene)], &asked.data)?;
        let session = Session::from_document(source, &OpenOptions { image: asked.size, ..OpenOptions::default() })?;
        Ok::<_, BelvedereError>(export(&session, &ExportOptions::of(&asked))?.glb)
    });
}

/// Blocks of 20 m, 40 m apart, on both sides of a street.
fn town(folder: &Path) -> [String; 2] {
    let house = |i: u32, j: u32| {
        let [x, y] = [500_000.0 + 60.0 * f64::from(i), 5_000_000.0 + 60.0 * f64::from(j)];
        let ring = json!([[[x, y], [x + 20.0, y], [x + 20.0, y + 20.0], [x, y + 20.0], [x, y]]]);
        json!({ "type": "Feature", "properties": { "height": 8.0 + f64::from(i) }, "geometry": { "type": "Polygon", "coordinates": ring } })
    };
    let houses: Vec<Value> = (0..36).map(|k| house(k % 6, k / 6)).collect();
    let way = |x: f64| {
        let line = json!([[x, 4_999_900.0], [x, 5_000_500.0]]);
        json!({ "type": "Feature", "properties": { "highway": "primary" }, "geometry": { "type": "LineString", "coordinates": line } })
    };
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32632" } });
    ["houses", "ways"].map(|name| {
        let features = if name == "houses" { houses.clone() } else { vec![way(500_160.0)] };
        let path = folder.join(format!("{name}.geojson"));
        let text = json!({ "type": "FeatureCollection", "crs": crs, "features": features }).to_string();
        std::fs::write(&path, text).expect("a file");
        path.display().to_string()
    })
}

#[test]
fn every_option_of_generalise_changes_its_answer_or_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let [houses, ways] = town(folder.path());
    let rows = vec![
        ("city", IsRefused(json!("gone.geojson"), "gone.geojson")),
        ("roads", Changes(json!([ways]), json!({}))),
        ("margin", Changes(json!(60), json!({}))),
        ("keep", Changes(json!("volume"), json!({}))),
    ];
    try_all(&options::<Generalise>(), &[], rows, &json!({ "city": houses }), |asked| {
        let asked: Generalise = read(&asked.to_string()).expect("a request");
        let found = generalise(&asked, &Progress::silent())?;
        Ok::<_, BelvedereError>(serde_json::to_string(&found.document()).expect("a report"))
    });
}
