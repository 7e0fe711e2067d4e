//! Options of `disocclude`.

use super::Does::{Changes, IsRefused};
use super::{Does, hills, try_all};
use belvedere::request::{Disocclude, options, read};
use belvedere::scene::Progress;
use belvedere::verbs::disocclude::{DisoccludeFiles, disocclude};
use belvedere::{BelvedereError, OpenOptions};
use serde_json::{Value, json};
use std::path::Path;

/// Options that another test tries.
const ELSEWHERE: [(&str, &str); 2] = [
    // It needs ground that is solved for, beyond its limits.
    ("no_limits", "terrain.rs of the command line"),
    // It needs rough ground.
    ("robust", "other_diagonal.rs"),
];

fn rows(folder: &Path) -> Vec<(&'static str, Does)> {
    let none = || json!({});
    let path = |name: &str| json!(folder.join(name).display().to_string());
    vec![
        ("data", IsRefused(json!("gone.asc"), "gone.asc")),
        ("features", Changes(json!([path("other.geojson")]), none())),
        ("rivers", Changes(json!([path("other.geojson")]), none())),
        ("eye", Changes(json!("502000,5000100,700"), none())),
        ("look", Changes(json!([503_500.0, 5_003_000.0]), none())),
        ("fov", Changes(json!(50), none())),
        ("mode", Changes(json!("paper"), none())),
        ("show", Changes(json!(0.5), none())),
        ("move_at_most", Changes(json!(1), none())),
        ("set", Changes(json!(["solver_nodes=20"]), none())),
        (
            "grid",
            Changes(
                json!("scene"),
                json!({ "crs": "EPSG:32633", "eye": "45.155N,9.038E,600", "look": "45.18N,9.04E" }),
            ),
        ),
        ("fill_voids", Changes(json!(true), none())),
        ("area_style", Changes(json!("glacier"), none())),
        ("curved_earth", Changes(json!(true), none())),
        ("crs", Changes(json!("EPSG:32633"), json!({ "eye": "45.155N,9.038E,600", "look": "45.18N,9.04E" }))),
        ("source_crs", IsRefused(json!("EPSG:1"), "EPSG:1")),
        ("nodata", Changes(json!(40), none())),
        ("vertical_unit", Changes(json!("ft"), none())),
        ("name_field", Changes(json!("ref"), none())),
    ]
}

/// The written heights, the report without times, and the picture.
fn solved(folder: &Path, asked: &Value) -> Result<(Vec<u8>, String, Vec<u8>), BelvedereError> {
    let asked: Disocclude = read(&asked.to_string()).expect("a request");
    let found = disocclude(&asked, &OpenOptions::default())?;
    let [out, picture] = ["out.tif", "out.png"].map(|name| folder.join(name));
    let files = DisoccludeFiles { out: out.clone(), picture: Some(picture.clone()), ..DisoccludeFiles::default() };
    found.write(&files, true, &Progress::silent())?;
    let mut report = serde_json::to_value(found.document()).expect("a report");
    report["times"] = Value::Null;
    let [out, picture] = [out, picture].map(|path| std::fs::read(path).expect("a file"));
    Ok((out, report.to_string(), picture))
}

#[test]
fn every_option_of_disocclude_changes_its_answer_or_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut base = hills(folder.path());
    base["eye"] = json!("503000,5000100,600");
    base["look"] = json!("503000,5003000");
    base["set"] = json!(["solver_nodes=24"]);
    base["size"] = Value::Null;
    try_all(&options::<Disocclude>(), &ELSEWHERE, rows(folder.path()), &base, |asked| solved(folder.path(), asked));
}

#[test]
fn an_eye_is_needed() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = hills(folder.path());
    let asked = json!({ "data": base["data"], "features": base["features"], "look": "503000,5003000" });
    let refused = solved(folder.path(), &asked).map(|_| ()).map_err(|e| e.to_string());
    assert!(refused.as_ref().is_err_and(|e| e.contains("`eye` and `look` are needed")), "{refused:?}");
}

/// The hills have a hole of 9 % of their nodes, which is larger than what `reveal` fills unasked.
#[test]
fn large_holes_are_filled_where_it_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = hills(folder.path());
    let (eye, look) = ("503000,5000100,600", "503000,5003000");
    let holes = [false, true].map(|fill_voids| {
        let asked = json!({ "data": base["data"], "features": base["features"], "source_crs": base["source_crs"], "eye": eye, "look": look,
            "set": ["solver_nodes=24"], "fill_voids": fill_voids });
        let asked: Disocclude = read(&asked.to_string()).expect("a request");
        let found = disocclude(&asked, &OpenOptions::default()).expect("ground");
        let heights = &found.rasters()[0];
        let count = heights.info.width * heights.info.height;
        (0..count).filter(|i| heights.sample_f64(0, i % heights.info.width, i / heights.info.width).is_none()).count()
    });
    assert_eq!(holes, [925, 0]);
}
