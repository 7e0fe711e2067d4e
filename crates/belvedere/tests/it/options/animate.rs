//! Options of `animate`.

use super::Does::{Changes, IsRefused};
use super::{Does, of_data, scene, try_all};
use belvedere::request::{Animate, options, read};
use belvedere::scene::Progress;
use belvedere::verbs::animate::{animate, frame_name};
use belvedere::verbs::asked::{film, paper};
use belvedere::verbs::open_files::scene_or_data;
use belvedere::{BelvedereError, OpenOptions, Session};
use serde_json::{Value, json};
use std::cell::Cell;
use std::path::{Path, PathBuf};

/// Options that another test tries.
const ELSEWHERE: [(&str, &str); 6] = [
    // It is an option of opening, and needs a molecule.
    ("trajectory", "molecules.rs of the command line"),
    // It needs large ground.
    ("lod", "lod.rs of the renderer"),
    // The frames are the same.
    ("resume", "parts.rs"),
    // It needs a route with times.
    ("clock", "films.rs of the command line"),
    // They need styling sections that meet.
    ("thresholds", "sections.rs of the renderer"),
    ("compositing", "sections.rs of the renderer"),
];

fn rows() -> Vec<(&'static str, Does)> {
    let none = || json!({});
    let large = || json!({ "size": [320, 180], "frames": 1 });
    let free = || json!({ "along": null, "turntable": 30 });
    let mut rows = of_data();
    rows.extend([
        ("frames", Changes(json!(3), none())),
        ("fps", Changes(json!(10), none())),
        ("along", IsRefused(json!("gone"), "gone")),
        ("follow", IsRefused(json!("gone"), "follow")),
        ("speed", Changes(json!(30), none())),
        ("sweep", Changes(json!([30, 60, 0]), json!({ "along": null, "sweep": [20, 50, 0] }))),
        ("turntable", Changes(json!(90), free())),
        ("marker", Changes(json!(true), large())),
        ("profile", Changes(json!(true), large())),
        ("part", Changes(json!([0, 0]), free())),
        ("size", Changes(json!([64, 36]), none())),
        ("renderer", Changes(json!("exact"), none())),
        ("straight", Changes(json!(true), none())),
        ("compare", Changes(json!(true), none())),
        ("samples", Changes(json!(1), none())),
        ("stylise", Changes(json!({ "edges": true, "unsharp": true }), none())),
        ("paper", Changes(json!("40x30mm"), json!({ "dpi": 50 }))),
        ("dpi", Changes(json!(240), large())),
        ("margin_mm", Changes(json!(5), json!({ "dpi": 50, "paper": "40x30mm" }))),
        ("title", Changes(json!("Hills"), large())),
        ("furniture", Changes(json!("scale,compass"), large())),
    ]);
    rows
}

/// The record of a film, and the bytes of its frames.
fn filmed(scene: &str, out: &Path, asked: &Value) -> Result<(f64, Vec<Vec<u8>>), BelvedereError> {
    let asked: Animate = read(&asked.to_string()).expect("a request");
    let source = scene_or_data(&[PathBuf::from(scene)], &asked.data)?;
    let (sheet, image) = paper((&asked.paper, asked.drawing.size), &source.document)?;
    let furniture = Some(asked.furnishing.wish());
    let session =
        Session::from_document(source, &OpenOptions { unsolved: true, furniture, image, ..OpenOptions::default() })?;
    let made = animate(&session, &film(&asked, sheet, out.to_owned(), true)?, &Progress::silent())?;
    let files =
        (0..made.manifest.frames.len()).map(|i| std::fs::read(made.folder.join(frame_name(i))).unwrap_or_default());
    Ok((made.manifest.settings.fps, files.collect()))
}

#[test]
fn every_option_of_animate_changes_its_film_or_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let (scene, count) = (scene(folder.path()), Cell::new(0));
    let base = json!({ "along": "way", "frames": 2 });
    try_all(&options::<Animate>(), &ELSEWHERE, rows(), &base, |asked| {
        count.set(count.get() + 1);
        filmed(&scene, &folder.path().join(format!("film{}", count.get())), asked)
    });
}
