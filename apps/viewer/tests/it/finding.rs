//! Finding things by their names and flying there.

use crate::{app, find, opened, settle};
use belvedere::core::DVec3;
use belvedere::scene_file::{CameraDoc, PointDoc};
use belvedere_viewer::Viewer;
use eframe::egui::{Event, Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};

type Window = Harness<'static, Viewer>;

/// A massif with huts that have names.
fn huts(folder: &Path) -> PathBuf {
    let path = crate::scene(folder);
    let text = std::fs::read_to_string(&path).expect("scene");
    let feature = |(name, x, y): (&str, f64, f64)| {
        format!(
            r#"{{"type":"Feature","properties":{{"name":"{name}"}},"geometry":{{"type":"Point","coordinates":[{x},{y}]}}}}"#
        )
    };
    let all = [("Étable du Lac", 900.0, 1200.0), ("Grande Étable", -1500.0, 300.0), ("Refuge", 2000.0, -900.0)];
    let all: Vec<String> = all.into_iter().map(feature).collect();
    let json = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, all.join(","));
    std::fs::write(folder.join("huts.geojson"), json).expect("huts");
    let layer = "[[layer]]\nkind = \"point\"\nid = \"huts\"\nsource = \"huts.geojson\"\n";
    std::fs::write(&path, text + layer).expect("scene");
    path
}

fn camera(harness: &Window) -> CameraDoc {
    harness.state().document().camera.clone()
}

fn at(point: &PointDoc) -> DVec3 {
    match point {
        PointDoc::Scene(p) => DVec3::from_array(*p),
        PointDoc::Map(_) => panic!("a rule"),
    }
}

fn target(harness: &Window) -> DVec3 {
    at(&camera(harness).look_at.expect("a point"))
}

fn eye(harness: &Window) -> DVec3 {
    at(&camera(harness).eye)
}

/// Types a text into the field, which Ctrl F opens, and waits until the names are read.
fn look_for(harness: &mut Window, text: &str, row: &str) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::F);
    harness.step();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(Event::Text(text.into()));
    crate::wait_for(harness, row, |harness| harness.query_by_label(row).is_some());
}

#[test]
fn a_name_is_typed_and_the_camera_flies_there_in_one_step() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[huts(folder.path())]));
    settle(&mut harness);
    let before = harness.state().document().clone();
    let heading = |harness: &Window| (target(harness) - eye(harness)).truncate().normalize();
    let ahead = heading(&harness);
    look_for(&mut harness, "etable", "Étable du Lac, huts");
    // What begins with the text stands before what holds it.
    let [first, second] = ["Étable du Lac, huts", "Grande Étable, huts"].map(|row| find(&harness, row).rect().top());
    assert!(first < second);
    harness.key_press(Key::ArrowDown);
    harness.step();
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert!(harness.query_by_label("Grande Étable, huts").is_none(), "the list is closed");
    let there = target(&harness);
    assert!(there.truncate().distance([-1500.0, 300.0].into()) < 1e-6, "{there}");
    assert!(heading(&harness).distance(ahead) < 1e-6, "from the present direction");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(*harness.state().document(), before, "undo returns");
    // A row is clicked, too.
    look_for(&mut harness, "REFUGE", "Refuge, huts");
    crate::press(&mut harness, "Refuge, huts");
    settle(&mut harness);
    assert!(target(&harness).truncate().distance([2000.0, -900.0].into()) < 1e-6);
}

#[test]
fn a_flight_goes_through_places_between_and_any_input_ends_it() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = opened(&[huts(folder.path())]);
    let builder = Harness::builder().with_size([1200.0, 760.0]).with_max_steps(4).with_step_dt(0.1);
    let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    settle(&mut harness);
    harness.ctx.all_styles_mut(|style| style.animation_time = 0.1);
    let from = eye(&harness);
    look_for(&mut harness, "refuge", "Refuge, huts");
    harness.key_press(Key::Enter);
    let mut eyes = vec![from];
    for _ in 0..14 {
        harness.step();
        eyes.push(eye(&harness));
    }
    settle(&mut harness);
    let end = eye(&harness);
    let between = eyes.iter().filter(|eye| eye.distance(from) > 1.0 && eye.distance(end) > 1.0).count();
    assert!((4..=9).contains(&between), "{between} places between");
    // The way is one step of undo.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.step();
    harness.step();
    assert!(eye(&harness).distance(from) < 1e-9);

    look_for(&mut harness, "etable", "Étable du Lac, huts");
    harness.key_press(Key::Enter);
    for _ in 0..5 {
        harness.step();
    }
    let middle = find(&harness, "Picture").rect().center() + vec2(0.0, 120.0);
    harness.drag_at(middle);
    harness.step();
    harness.drop_at(middle);
    harness.step();
    let stopped = eye(&harness);
    settle(&mut harness);
    assert_eq!(eye(&harness), stopped, "the flight went on");
    assert!(target(&harness).truncate().distance([900.0, 1200.0].into()) > 10.0, "it had ended already");
}

#[test]
fn places_and_bookmarks_are_found_and_what_is_unknown_is_said() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[huts(folder.path())]));
    settle(&mut harness);
    harness.key_press(Key::B);
    harness.step();
    let bookmarked = eye(&harness);
    look_for(&mut harness, "-700, 1100", "-700, 1100, place");
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert!(target(&harness).truncate().distance([-700.0, 1100.0].into()) < 1e-6);
    look_for(&mut harness, "view 1", "View 1, bookmark");
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert!(eye(&harness).distance(bookmarked) < 1e-6);
    look_for(&mut harness, "nowhere", "nothing has that name");
    harness.key_press(Key::Escape);
    harness.step();
    harness.step();
    assert!(harness.query_by_label("nothing has that name").is_none(), "Escape closes the field");
}
