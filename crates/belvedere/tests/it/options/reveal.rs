//! Options of `reveal`.

use super::Does::{Changes, IsRefused};
use super::{Does, hills, try_all};
use belvedere::BelvedereError;
use belvedere::request::{Reveal, options, read};
use belvedere::verbs::reveal::{Setting, reveal};
use serde_json::{Value, json};
use std::path::Path;

/// Options of terrain with features that another test tries.
const ELSEWHERE: [(&str, &str); 2] = [
    // It needs a georeferenced picture.
    ("drape", "reveal_looks.rs of the command line"),
    // It needs ground that is solved for, beyond its limits.
    ("no_limits", "terrain.rs of the command line"),
];

fn rows(folder: &Path) -> Vec<(&'static str, Does)> {
    let none = || json!({});
    let path = |name: &str| json!(folder.join(name).display().to_string());
    let model = "for a part of a model or city, and none is asked for";
    let molecule = "for molecules, and there is none";
    vec![
        ("data", IsRefused(json!("gone.asc"), "gone.asc")),
        ("features", Changes(json!([path("other.geojson")]), none())),
        ("see", IsRefused(json!("a house"), "for terrain with features, not for models")),
        ("fallback", IsRefused(json!(["cutaway"]), model)),
        ("transfer", IsRefused(json!("solid"), model)),
        ("up", IsRefused(json!([0, 0, 1]), model)),
        ("no_shadows", IsRefused(json!(true), model)),
        ("eye", Changes(json!("502000,4999500,700"), none())),
        ("look", Changes(json!([503_500.0, 5_003_000.0]), none())),
        ("fov", Changes(json!(60), none())),
        ("size", Changes(json!([64, 36]), none())),
        ("renderer", Changes(json!("exact"), none())),
        ("samples", Changes(json!(1), none())),
        ("paper", Changes(json!("40x30mm"), json!({ "size": null, "dpi": 50 }))),
        ("dpi", Changes(json!(240), json!({ "size": [320, 180] }))),
        ("margin_mm", Changes(json!(5), json!({ "size": null, "dpi": 50, "paper": "40x30mm" }))),
        ("curved_earth", Changes(json!(true), none())),
        ("keep_voids", Changes(json!(true), none())),
        ("fill_voids", Changes(json!(true), none())),
        ("palette", Changes(json!("desert"), none())),
        ("labels", Changes(json!(true), none())),
        ("no_sea", Changes(json!(true), none())),
        ("rivers", IsRefused(json!([path("other.geojson")]), "kept from running uphill")),
        ("area_style", Changes(json!("glacier"), none())),
        ("line_class", Changes(json!(["way.geojson=river"]), none())),
        ("technique", Changes(json!("curved_rays"), none())),
        ("crs", Changes(json!("EPSG:32633"), json!({ "eye": "45.14N,9.04E,900", "look": "45.18N,9.04E,200" }))),
        ("source_crs", IsRefused(json!("EPSG:1"), "EPSG:1")),
        ("nodata", Changes(json!(40), none())),
        ("vertical_unit", Changes(json!("ft"), none())),
        ("name_field", Changes(json!("ref"), json!({ "labels": true }))),
        ("light_time", Changes(json!("2026-07-01T06:00:00Z"), none())),
        ("light", Changes(json!([120, 20]), none())),
        ("sky", Changes(json!("white"), none())),
        ("haze", Changes(json!(2.0), none())),
        ("clouds", Changes(json!(0.5), none())),
        ("contours", Changes(json!(true), none())),
        ("landcover", Changes(path("way.geojson"), none())),
        ("plain", Changes(json!(true), none())),
        ("edge", Changes(json!("block"), none())),
        ("title", Changes(json!("Hills"), json!({ "size": [320, 180] }))),
        ("furniture", Changes(json!(["scale"]), json!({ "size": [320, 180] }))),
        ("shadows", Changes(json!(true), json!({ "light": [180, 10] }))),
        ("relief", Changes(json!("sun"), none())),
        ("hidden", Changes(json!("show"), json!({ "technique": "curved_rays" }))),
        ("exaggeration", Changes(json!(2), none())),
        ("stylise", Changes(json!({ "edges": true, "unsharp": true }), none())),
        ("no_mark", Changes(json!(true), json!({ "size": [320, 180] }))),
        ("representation", IsRefused(json!("ribbon"), molecule)),
        ("color_by", IsRefused(json!("chain"), molecule)),
        ("assembly", IsRefused(json!("1"), molecule)),
        ("model", IsRefused(json!(1), molecule)),
    ]
}

/// The colours of the picture that a request gives.
fn drawn(asked: &Value) -> Result<(usize, Vec<[u8; 3]>), BelvedereError> {
    let asked: Reveal = read(&asked.to_string()).expect("a request");
    reveal(&asked, &Setting::default()).map(|answer| {
        let frame = &answer.picture.frame;
        (frame.width, frame.color.clone())
    })
}

#[test]
fn every_option_of_reveal_changes_its_answer_or_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = hills(folder.path());
    try_all(&options::<Reveal>(), &ELSEWHERE, rows(folder.path()), &base, drawn);
}
