//! Options of `render`.

use super::Does::{Changes, IsRefused};
use super::{Does, of_data, scene, try_all};
use belvedere::request::{Render, options, read};
use belvedere::verbs::asked::opened;
use belvedere::verbs::open_files::scene_or_data;
use belvedere::{BelvedereError, OpenOptions};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Options that another test tries.
const ELSEWHERE: [(&str, &str); 13] = [
    ("panorama", "panorama.rs of the command line"),
    ("heading", "panorama.rs of the command line"),
    ("span", "panorama.rs of the command line"),
    ("pitch", "panorama.rs of the command line"),
    ("sphere", "panorama.rs of the command line"),
    ("straighten", "tube.rs of the command line"),
    ("radius", "tube.rs of the command line"),
    ("side", "tube.rs of the command line"),
    ("uncut", "tube.rs of the command line"),
    // It needs large ground.
    ("lod", "lod.rs of the renderer"),
    // The bytes are the same.
    ("band_rows", "bands.rs"),
    // They need styling sections that meet.
    ("thresholds", "sections.rs of the renderer"),
    ("compositing", "sections.rs of the renderer"),
];

fn rows(folder: &Path) -> Vec<(&'static str, Does)> {
    let none = || json!({});
    let large = || json!({ "size": [320, 180] });
    let molecule = "for molecules, and there is none";
    let mut rows = of_data();
    rows.extend([
        ("size", Changes(json!([64, 36]), none())),
        ("renderer", Changes(json!("exact"), none())),
        ("straight", Changes(json!(true), none())),
        ("compare", Changes(json!(true), none())),
        ("samples", Changes(json!(1), none())),
        ("stylise", Changes(json!({ "edges": true, "unsharp": true }), none())),
        ("paper", Changes(json!("40x30mm"), json!({ "dpi": 50 }))),
        ("dpi", Changes(json!(240), large())),
        ("margin_mm", Changes(json!(5), json!({ "dpi": 50, "paper": "40x30mm" }))),
        ("aux", Changes(json!(["depth", "displacement"]), none())),
        ("aux_format", Changes(json!("exr"), json!({ "aux": ["depth"] }))),
        ("grid", Changes(json!(500), none())),
        ("heatmap", Changes(json!(true), none())),
        ("ghost", Changes(json!(true), none())),
        ("highlight", Changes(json!(["revealed", "ghost_box"]), none())),
        ("no_mark", Changes(json!(true), large())),
        ("overhead", Changes(json!(true), none())),
        ("outside", Changes(json!(["500000,4999000,3000", "503000,5002000,200"]), none())),
        ("palette", Changes(json!("desert"), none())),
        ("sky", Changes(json!("white"), none())),
        ("haze", Changes(json!(2.0), none())),
        ("clouds", Changes(json!(0.5), none())),
        ("contours", Changes(json!(true), none())),
        ("landcover", Changes(json!(folder.join("way.geojson").display().to_string()), none())),
        ("plain", Changes(json!(true), none())),
        ("edge", Changes(json!("block"), none())),
        ("title", Changes(json!("Hills"), large())),
        ("furniture", Changes(json!("scale,compass"), large())),
        ("no_sea", Changes(json!(true), none())),
        ("area_style", Changes(json!("glacier"), none())),
        ("representation", IsRefused(json!("ribbon"), molecule)),
        ("color_by", IsRefused(json!("chain"), molecule)),
        ("assembly", IsRefused(json!("1"), molecule)),
        ("model", IsRefused(json!("all"), molecule)),
    ]);
    rows
}

/// Colours of both pictures, and what its files are.
type Drawn = (usize, Vec<[u8; 3]>, Option<Vec<[u8; 3]>>, String);

fn drawn(scene: &str, asked: &Value) -> Result<Drawn, BelvedereError> {
    let asked: Render = read(&asked.to_string()).expect("a request");
    let source = scene_or_data(&[PathBuf::from(scene)], &asked.data)?;
    let (session, options, _) = opened(source, &asked, OpenOptions::default())?;
    let picture = session.render(&options)?;
    let files = format!("{:?} {:?} {:?}", picture.sidecar.print, options.aux, options.aux_format);
    Ok((picture.frame.width, picture.frame.color, picture.straight.map(|frame| frame.color), files))
}

#[test]
fn every_option_of_render_changes_its_answer_or_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene(folder.path());
    try_all(&options::<Render>(), &ELSEWHERE, rows(folder.path()), &json!({}), |asked| drawn(&scene, asked));
}

#[test]
fn two_pictures_of_the_camera_are_one_too_many() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene(folder.path());
    let refused = drawn(&scene, &json!({ "overhead": true, "outside": true })).map(|_| ()).map_err(|e| e.to_string());
    assert!(refused.as_ref().is_err_and(|e| e.contains("two pictures of the camera")), "{refused:?}");
    let both = [json!({ "outside": true }), json!({ "outside": false })]
        .map(|asked| drawn(&scene, &asked).expect("a picture"));
    assert!(both[0] != both[1] && both[1] == drawn(&scene, &json!({})).expect("a picture"), "false asks for nothing");
}
