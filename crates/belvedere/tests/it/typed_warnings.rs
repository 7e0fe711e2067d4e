//! Warnings are values: an application reads their kind, subject and figures, and needs no words.

use belvedere::{OpenOptions, PictureOptions, Session, Warning, WarningKind};
use std::path::Path;

const SCENE: &str = r#"
format = 1
[camera]
eye = [500600.0, 5000050.0, 160.0]
look_at = [500600.0, 5001100.0, 100.0]
image = [64, 48]
[light]
time = "2026-01-01T00:00:00Z"
[[layer]]
id = "hills"
kind = "terrain"
source = "dem.asc"
source_crs = "EPSG:32632"
[[layer]]
id = "way"
kind = "line"
source = "way.geojson"
must_see = true
style = { labels = true }
[[stage]]
kind = "terrain_disocclusion"
"#;

/// Hills with a wall, a spike of 900 m, two samples without data and three numbers too many; a way behind the wall that goes on beyond
/// the data, with a name that is not set, and a line of one point.
fn write(folder: &Path) {
    let height = |c: usize, r: usize| match (c, r) {
        (45, 12) => 1000.0,
        (10 | 11, 50) => -9999.0,
        (_, 28..33) => 180.0,
        _ => 100.0 + 5.0 * ((c * 7 + r * 3) as f64 / 9.0).sin(),
    };
    let row = |r: usize| (0..60).map(|c| format!("{:.1} ", height(c, r)).replace('.', ",")).collect::<String>() + "\n";
    let header = "ncols 60\nnrows 60\nxllcorner 500000\nyllcorner 5000000\ncellsize 20\nNODATA_value -9999\n";
    let text = header.to_owned() + &(0..60).map(row).collect::<String>() + "1 2 3\n";
    std::fs::write(folder.join("dem.asc"), text).unwrap();
    let way = r#"{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:32632"}}, "features": [
        {"type": "Feature", "properties": {"name": "富士"}, "geometry": {"type": "LineString",
            "coordinates": [[500400, 5000800], [500900, 5000800], [502000, 5000800]]}},
        {"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[500400, 5000800]]}}]}"#;
    std::fs::write(folder.join("way.geojson"), way).unwrap();
}

/// Kind, subject, and a figure with its least and greatest value.
type Expected = (WarningKind, &'static str, Option<(&'static str, f64, f64)>);

const EXPECTED: [Expected; 7] = [
    (WarningKind::Repaired, "hills", None),
    (WarningKind::Ignored, "hills", Some(("count", 3.0, 3.0))),
    (WarningKind::Ignored, "hills", Some(("share", 2.0 / 3600.0, 2.0 / 3600.0))),
    (WarningKind::Ignored, "way", Some(("count", 1.0, 1.0))),
    (WarningKind::Ignored, "way", Some(("outside_m", 780.0, 840.0))),
    (WarningKind::Suspect, "terrain_disocclusion", Some(("samples", 1.0, 1.0))),
    (WarningKind::Suspect, "light", Some(("altitude_deg", -90.0, 0.0))),
];

fn answers(warning: &Warning, (kind, subject, figure): &Expected) -> bool {
    let within = |&(name, least, most): &(&str, f64, f64)| {
        warning.figure(name).is_some_and(|value| (least - 1e-9..=most + 1e-9).contains(&value))
    };
    warning.kind() == *kind && warning.subject() == Some(subject) && figure.as_ref().is_none_or(within)
}

#[test]
fn oddities_of_a_scene_come_with_kind_subject_and_figures() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, SCENE).unwrap();
    let session = Session::open(&path, &OpenOptions::default()).unwrap();
    let warnings = session.warnings();
    for expected in &EXPECTED {
        assert!(warnings.iter().any(|w| answers(w, expected)), "{expected:?} in {warnings:#?}");
    }
    let numbers = |text: &str| text.chars().any(|c| c.is_ascii_digit());
    assert!(warnings.iter().all(|w| w.text() == w.to_string() && !w.text().contains('\n')), "{warnings:#?}");
    assert!(warnings.iter().all(|w| w.figures().is_empty() || numbers(w.text())), "figures are said: {warnings:#?}");

    let sidecar = serde_json::to_value(session.render(&PictureOptions::default()).unwrap().sidecar).unwrap();
    let written: Vec<Warning> = serde_json::from_value(sidecar["warnings"].clone()).unwrap();
    let here = folder.path().canonicalize().unwrap().join("").display().to_string();
    let named = serde_json::to_string(&warnings).unwrap().replace(&here, "");
    assert_eq!(serde_json::to_string(&written).unwrap(), named, "the record names files relative to the scene");
    let bare = sidecar["warnings"].as_array().unwrap().iter().find(|w| w["kind"] == "repaired").unwrap();
    assert!(bare.get("figures").is_none() && bare["text"].is_string() && bare["subject"] == "hills", "{bare}");
}
