//! Styles of lines, areas and points: by hand, and by a property of their file; the document holds them, so the command line draws alike.

use crate::{app, find, opened, press, settle, wait_for};
use belvedere::scene_file::{AutoOrLength, LayerDoc, LineStyleDoc, SourceDocument, StepsDoc};
use belvedere::{OpenOptions, PictureOptions, Session};
use belvedere_viewer::Viewer;
use eframe::egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::Path;

type Window = Harness<'static, Viewer>;

/// A scene of roads over generated ground.
fn roads(folder: &Path) -> std::path::PathBuf {
    let road = |i: i32, kind: &str| {
        let x = -1800 + 600 * i;
        format!(
            r#"{{"type": "Feature", "properties": {{"highway": "{kind}", "cars": {}, "title": "Road {i}"}}, "geometry": {{"type": "LineString", "coordinates": [[{x}, -1500], [{x}, 1500]]}}}}"#,
            100 * i * i
        )
    };
    let kinds = ["track", "path", "track", "primary", "path", "track"];
    let all: Vec<String> = kinds.iter().enumerate().map(|(i, kind)| road(i as i32, kind)).collect();
    let text = format!(r#"{{"type": "FeatureCollection", "features": [{}]}}"#, all.join(","));
    std::fs::write(folder.join("roads.geojson"), text).expect("roads");
    let path = folder.join("scene.toml");
    let text = r#"
format = 1
crs = "local"
[camera]
eye = [0.0, -6000.0, 5000.0]
look_at = [0.0, 0.0, 0.0]
image = [160, 90]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=65"
[[layer]]
kind = "line"
id = "roads"
source = "roads.geojson"
style = { hidden = "show" }
"#;
    std::fs::write(&path, text).expect("scene");
    path
}

fn style(harness: &Window) -> LineStyleDoc {
    let LayerDoc::Line(line) = &harness.state().document().layer[1] else { panic!("no line") };
    line.style.clone()
}

/// The window with the style of the roads open, and its properties read.
fn window(folder: &Path) -> Window {
    let mut harness = app(&opened(&[roads(folder)]));
    settle(&mut harness);
    press(&mut harness, "Style of roads");
    wait_for(&mut harness, "the properties", |harness| harness.query_by_label("roads coloured by").is_some());
    for _ in 0..20 {
        harness.step();
    }
    harness
}

#[test]
fn roads_are_coloured_by_their_kind_and_each_colour_is_one_step() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(folder.path());
    press(&mut harness, "roads coloured by");
    press(&mut harness, "highway: track, path, primary");
    settle(&mut harness);
    let by = style(&harness).color_by.expect("a property");
    assert_eq!((by.property.as_str(), by.values.len()), ("highway", 0), "the palette is that of the program");
    find(&harness, "track (3)");
    find(&harness, "others of roads (0)");
    // Paths get the colour of the others, which states the rest.
    let first = harness.query_all_by_label("Others").nth(1).expect("a button for paths");
    first.click();
    settle(&mut harness);
    let by = style(&harness).color_by.expect("a property");
    assert_eq!(by.values.keys().collect::<Vec<_>>(), ["primary", "track"]);
    find(&harness, "others of roads (2)");
    let document = harness.state().document().clone();
    let drawn = |folder: &Path| {
        let options = OpenOptions { allow_roots: vec![folder.to_owned()], ..OpenOptions::default() };
        let session = Session::from_document(SourceDocument::new((*document).clone()), &options).expect("session");
        session.render(&PictureOptions::default()).expect("picture").frame.color
    };
    let orange = |pixel: &[u8; 3]| pixel[0] > 200 && (130..190).contains(&pixel[1]) && pixel[2] < 60;
    assert!(drawn(folder.path()).iter().filter(|pixel| orange(pixel)).count() > 30, "tracks are not orange");
    for properties in [0, usize::MAX] {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut harness);
        assert_eq!(style(&harness).color_by.map(|by| by.values.len()), Some(properties).filter(|n| *n == 0));
    }
}

#[test]
fn numbers_become_classes_and_a_width() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(folder.path());
    press(&mut harness, "roads coloured by");
    press(&mut harness, "cars: 0, 100, 1600, …");
    settle(&mut harness);
    press(&mut harness, "steps of roads");
    press(&mut harness, "classes of equal width");
    settle(&mut harness);
    press(&mut harness, "scale of roads");
    press(&mut harness, "cividis");
    settle(&mut harness);
    let by = style(&harness).color_by.expect("a property");
    assert_eq!((by.steps, by.scale.is_some()), (Some(StepsDoc::Equal), true));
    press(&mut harness, "width of roads by");
    press(&mut harness, "cars: 0, 100, 1600, …");
    settle(&mut harness);
    assert_eq!(style(&harness).width_by.expect("a property").property, "cars");
    press(&mut harness, "width of roads by");
    press(&mut harness, "nothing: one width");
    settle(&mut harness);
    assert!(style(&harness).width_by.is_none());
    harness.check_accessibility();
}

#[test]
fn rims_marks_and_the_property_of_names_are_chosen() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(folder.path());
    press(&mut harness, "rim of roads");
    settle(&mut harness);
    assert_eq!(style(&harness).casing, "none");
    press(&mut harness, "distance marks of roads");
    press(&mut harness, "about ten on a line");
    settle(&mut harness);
    assert!(matches!(style(&harness).distance_markers_m, Some(AutoOrLength::Auto(_))));
    press(&mut harness, "names of roads");
    settle(&mut harness);
    press(&mut harness, "names of roads from");
    press(&mut harness, "highway: track, path, primary");
    settle(&mut harness);
    let LayerDoc::Line(line) = &harness.state().document().layer[1] else { panic!("no line") };
    assert_eq!((line.style.labels, line.name_field.as_deref()), (true, Some("highway")));
}

/// A scene of one layer of points or areas, each with a kind.
fn places(folder: &Path, layer: &str, shape: impl Fn(f64) -> String) -> std::path::PathBuf {
    let place = |(i, kind): (usize, &str)| {
        let shape = shape(700.0 * i as f64 - 700.0);
        format!(r#"{{"type": "Feature", "properties": {{"kind": "{kind}"}}, "geometry": {shape}}}"#)
    };
    let all: Vec<String> = ["old", "new", "old"].into_iter().enumerate().map(place).collect();
    let text = format!(r#"{{"type": "FeatureCollection", "features": [{}]}}"#, all.join(","));
    std::fs::write(folder.join("places.geojson"), text).expect("places");
    let text = std::fs::read_to_string(roads(folder)).expect("scene");
    let text = text.replace("\"line\"", &format!("\"{layer}\"")).replace("roads", "places");
    let path = folder.join("places.toml");
    std::fs::write(&path, text).expect("scene");
    path
}

/// The window with the style of the places open, coloured by their kind.
fn by_kind(path: std::path::PathBuf) -> Window {
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    press(&mut harness, "Style of places");
    wait_for(&mut harness, "the properties", |harness| harness.query_by_label("places coloured by").is_some());
    (0..20).for_each(|_| harness.step());
    press(&mut harness, "places coloured by");
    press(&mut harness, "kind: old, new");
    settle(&mut harness);
    find(&harness, "old (2)");
    find(&harness, "new (1)");
    harness
}

#[test]
fn points_are_coloured_by_their_kind() {
    let folder = tempfile::tempdir().expect("folder");
    let point = |x: f64| format!(r#"{{"type": "Point", "coordinates": [{x}, 0]}}"#);
    let harness = by_kind(places(folder.path(), "point", point));
    let LayerDoc::Point(points) = &harness.state().document().layer[1] else { panic!("no points") };
    assert_eq!(points.style.color_by.as_ref().map(|by| by.property.as_str()), Some("kind"));
}

#[test]
fn areas_are_coloured_by_their_kind_and_the_line_round_them_is_chosen() {
    let folder = tempfile::tempdir().expect("folder");
    let square = |x: f64| {
        let [a, b] = [x, x + 400.0];
        format!(r#"{{"type": "Polygon", "coordinates": [[[{a}, 0], [{b}, 0], [{b}, 400], [{a}, 400], [{a}, 0]]]}}"#)
    };
    let mut harness = by_kind(places(folder.path(), "area", square));
    let style = |harness: &Window| {
        let LayerDoc::Area(areas) = &harness.state().document().layer[1] else { panic!("no areas") };
        (areas.style.color_by.as_ref().map(|by| by.property.clone()), areas.style.outline.clone())
    };
    assert_eq!(style(&harness), (Some("kind".into()), None));
    for (choice, outline) in [("none", Some("none")), ("as the surface has it", None)] {
        find(&harness, "line round places").scroll_to_me();
        (0..20).for_each(|_| harness.step());
        press(&mut harness, "line round places");
        press(&mut harness, choice);
        settle(&mut harness);
        assert_eq!(style(&harness).1.as_deref(), outline, "{choice}");
    }
}
