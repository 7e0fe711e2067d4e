//! A way over ground as steep as a roof: one definition of its length; and an eye whose position is given in degrees.

use belvedere::core::WarningKind;
use belvedere::picture::PictureOptions;
use belvedere::scene_file::parse;
use belvedere::vectors::VectorContent;
use belvedere::verbs::measure::MeasureOptions;
use belvedere::{OpenOptions, Session};
use std::path::Path;

/// Ridges of 40 degrees, and a way of 2200 m in plan across them; `camera` is the rest of the scene.
fn session(folder: &Path, camera: &str) -> Session {
    let height = |c: usize| 300.0 + 25.0 * (c % 20).abs_diff(10) as f64;
    let row: String = (0..80).map(|c| format!("{} ", height(c))).collect();
    let head = "ncols 80\nnrows 80\nxllcorner 500000\nyllcorner 5100000\ncellsize 30\nNODATA_value -9999\n";
    std::fs::write(folder.join("ground.asc"), head.to_owned() + &format!("{row}\n").repeat(80)).expect("written");
    let way = r#"{"type": "LineString", "crs": {"type": "name", "properties": {"name": "EPSG:32632"}},
        "coordinates": [[500100, 5101200], [502300, 5101200]]}"#;
    std::fs::write(folder.join("way.geojson"), way).expect("written");
    let text = format!(
        "format = 1\ncrs = 'EPSG:32632'\n[[layer]]\nid = 'ground'\nkind = 'terrain'\nsource = 'ground.asc'\nsource_crs = 'EPSG:32632'\n\
         [[layer]]\nid = 'way'\nkind = 'line'\nmust_see = true\nsource = 'way.geojson'\nstyle = {{ distance_markers_m = 500 }}\n{camera}"
    );
    Session::from_document(parse(&folder.join("s.toml"), &text).expect("a scene"), &OpenOptions::default())
        .expect("opened")
}

#[test]
fn lengths_of_vectors_and_distance_marks_on_steep_ground_are_those_of_measure() {
    let folder = tempfile::tempdir().expect("a folder");
    let camera = "[camera]\neye = [501200, 5098500, 3500]\nlook_at = [501200, 5101200, 400]\nimage = [1280, 720]\n";
    let session = session(folder.path(), camera);
    let options = PictureOptions { vectors: VectorContent::Alone, ..PictureOptions::default() };
    let svg = session.render(&options).expect("a picture").to_svg().expect("written").expect("vectors");
    let stated = |name: &str| {
        let key = format!("{name}=\"");
        let lengths = svg.split(&key).skip(1).filter_map(|rest| rest.split('"').next());
        lengths.map(|v| v.parse::<f64>().expect("a number")).sum::<f64>()
    };
    let written = [stated("data-visible-length"), stated("data-hidden-length")];
    let found = session.measure(&MeasureOptions::default()).expect("measured");
    let lines = found.measures.lines.expect("lines").bent.sight;
    let sum = written[0] + written[1];
    assert!((sum / 2200.0 - 1.0).abs() < 0.005, "{written:?}, 2200 m in plan");
    assert!((written[0] / sum - lines.share.expect("in view")).abs() < 0.005, "{written:?}, {lines:?}");
    // Every half kilometre of the 2.2, and not of the 2.9 along the slopes.
    let mark = |text: &str| svg.contains(&format!(">{text} m<"));
    assert!(mark("500") && mark("2000") && !mark("2500"));
}

#[test]
fn a_picture_of_nothing_says_how_far_the_eye_stands_and_how_degrees_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |camera: &str, vectors: VectorContent| {
        let options = PictureOptions { vectors, ..PictureOptions::default() };
        let picture = session(folder.path(), camera).render(&options).expect("a picture");
        let said = picture.sidecar.warnings.into_iter().filter(|w| w.subject() == Some("camera"));
        said.collect::<Vec<_>>()
    };
    let degrees = "[camera]\neye = [8.1, 46.0, 3500]\nlook_at = [8.2, 46.1, 2500]\nimage = [96, 54]\n";
    let found = said(degrees, VectorContent::Nothing);
    assert!(found.len() == 1 && found[0].kind() == WarningKind::Suspect, "{found:?}");
    let text = found[0].text();
    assert!(["nothing of any layer", "km", "EPSG:32632", "46.0N,8.1E,3500"].iter().all(|w| text.contains(w)), "{text}");
    assert!((found[0].figures()["distance"] / 5_124_000.0 - 1.0).abs() < 0.01, "{:?}", found[0].figures());
    // An eye at its place that looks past everything has another remedy; one that sees ground has none to need.
    let past = "[camera]\neye = [501200, 5098500, 3500]\nlook_at = [501200, 5090000, 9000]\nimage = [96, 54]\n";
    let found = said(past, VectorContent::OverRaster);
    assert!(found.len() == 1 && !found[0].text().contains("degrees"), "{found:?}");
    let usual = "[camera]\neye = [501200, 5098500, 3500]\nlook_at = [501200, 5101200, 400]\nimage = [96, 54]\n";
    assert!(said(usual, VectorContent::Nothing).is_empty());
}
