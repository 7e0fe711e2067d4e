//! What is opened, saved, and left behind by a crash.

use crate::{app, opened, press, scene, settle};
use belvedere_viewer::Opening;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

#[test]
fn a_killed_application_comes_back_as_it_was() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let opening = Opening { state: Some(folder.path().join("state")), ..opened(std::slice::from_ref(&path)) };
    let mut harness = app(&opening);
    settle(&mut harness);
    harness.key_press(Key::ArrowLeft);
    settle(&mut harness);
    let document = harness.state().document().clone();
    let began = std::time::Instant::now();
    let written = || std::fs::read_to_string(folder.path().join("state/state-0.json")).unwrap_or_default();
    let eye = format!("{:?}", document.camera.eye);
    let x = eye.split(['[', ',']).nth(1).expect("a number").to_owned();
    while !written().contains(&x) {
        assert!(began.elapsed() < crate::PATIENCE, "nothing was written down: {x} {}", written());
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    drop(harness); // Without the word that an application says when it ends.
    let state = folder.path().join("other");
    std::fs::create_dir(&state).expect("folder");
    std::fs::copy(folder.path().join("state/state-0.json"), state.join("state-0.json")).expect("copied");
    let other = app(&Opening { state: Some(state.clone()), ..opening.clone() });
    other.get_by_label_contains("its unsaved scene is kept in");
    let kept = belvedere::scene_file::read(&state.join("recovered.toml")).expect("kept").document;
    assert_eq!(kept.camera, document.camera, "another scene is opened, and what was lost is kept");
    drop(other);
    let mut again = app(&Opening { files: Vec::new(), ..opening });
    settle(&mut again);
    assert_eq!(**again.state().document(), *document);
    press(&mut again, "Edit");
    press(&mut again, "Undo");
    settle(&mut again);
    assert_ne!(**again.state().document(), *document, "the unsaved change can be taken back");
}

#[test]
fn a_file_that_cannot_be_read_is_a_notice() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("broken.toml");
    std::fs::write(&path, "format = 1\n[camera\n").expect("file");
    let mut harness = app(&opened(&[path]));
    let began = std::time::Instant::now();
    while harness.query_by_label("Dismiss 1").is_none() {
        assert!(began.elapsed() < crate::PATIENCE, "no notice");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    harness.get_by_label_contains("broken.toml:2");
    settle(&mut harness);
    press(&mut harness, "Dismiss 1");
    assert!(harness.query_by_label("Dismiss 1").is_none());
}

#[test]
fn terrain_and_a_route_become_a_picture_in_which_the_route_is_seen() {
    let Some(dem) = belvedere_testkit::data("andorra/N42E001.hgt") else { return };
    let Some(route) = belvedere_testkit::data("andorra/gr11_andorra_no_elevation.gpx") else { return };
    let mut harness = app(&opened(&[dem, route]));
    settle(&mut harness);
    let document = harness.state().document().clone();
    assert!(document.layer.iter().any(|layer| layer.must_see()) && document.stage.len() == 1);
}

#[test]
fn what_is_saved_is_what_is_seen() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let mut harness = app(&opened(std::slice::from_ref(&path)));
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowUp);
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.step();
    harness.step();
    let saved = belvedere::scene_file::read(&path).expect("saved").document;
    assert_eq!(saved, **harness.state().document());
}
