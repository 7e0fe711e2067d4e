//! Opening, saving, and recovery after a crash.

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
    drop(harness); // Dropped without the end of session that an application reports.
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

#[test]
fn a_scene_of_no_file_comes_back_with_its_bookmarks_and_the_way_it_was_looked_at() {
    let folder = tempfile::tempdir().expect("folder");
    let state = folder.path().join("state");
    let opening = Opening { state: Some(state.clone()), ..Opening::default() };
    let mut harness = app(&opening);
    settle(&mut harness);
    harness.key_press(Key::ArrowLeft);
    harness.step();
    harness.key_press(Key::B);
    harness.step();
    press(&mut harness, "Look");
    press(&mut harness, "Split");
    settle(&mut harness);
    let document = harness.state().document().clone();
    let began = std::time::Instant::now();
    let written = || std::fs::read_to_string(state.join("state-0.json")).unwrap_or_default();
    while !(written().contains("\"Split\"") && written().contains("View 1")) {
        assert!(began.elapsed() < crate::PATIENCE, "nothing was written down: {}", written());
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    drop(harness);
    // Another file is opened: the scene that was never saved is still kept.
    let other = folder.path().join("other");
    std::fs::create_dir(&other).expect("folder");
    std::fs::copy(state.join("state-0.json"), other.join("state-0.json")).expect("copied");
    let file = opened(&[scene(folder.path())]);
    app(&Opening { state: Some(other.clone()), ..file }).get_by_label_contains("its unsaved scene is kept in");
    let kept = belvedere::scene_file::read(&other.join("recovered.toml")).expect("kept").document;
    assert_eq!(kept.camera, document.camera);
    let mut again = app(&opening);
    settle(&mut again);
    assert_eq!(**again.state().document(), *document);
    again.get_by_label("Bar between straight and bent");
    press(&mut again, "Places");
    again.get_by_label("View 1");
}

#[test]
fn without_windows_of_the_system_files_are_chosen_in_our_own() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let mut harness = app(&opened(std::slice::from_ref(&path)));
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowUp);
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.step();
    press(&mut harness, "Export");
    press(&mut harness, "Export picture…");
    harness.step(); // A new window is measured before it is shown.
    press(&mut harness, "Write");
    let exported = folder.path().join("picture.png");
    let began = std::time::Instant::now();
    while !folder.path().join("picture.png.json").exists() {
        assert!(began.elapsed() < crate::PATIENCE, "nothing is exported");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let session = belvedere::Session::open(&path, &belvedere::OpenOptions::default()).expect("saved scene");
    let drawn = session.render(&belvedere::picture::PictureOptions::default()).expect("drawn");
    drawn.write(&folder.path().join("again.png"), false).expect("written");
    let read = |path: &std::path::Path| std::fs::read(path).expect("picture");
    assert!(read(&exported) == read(&folder.path().join("again.png")), "the exported picture is another one");

    press(&mut harness, "Layers");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    (0..3).for_each(|_| harness.step());
    press(&mut harness, "Cancel");
    assert!(harness.query_by_label("Cancel").is_none());
}

#[test]
fn without_a_folder_for_its_state_the_window_says_so_and_works() {
    let folder = tempfile::tempdir().expect("folder");
    let state = folder.path().join("state");
    std::fs::write(&state, "a file where the folder should be").expect("file");
    let mut harness = app(&Opening { state: Some(state), ..opened(&[scene(folder.path())]) });
    harness.get_by_label_contains("what you do is not written down for the case of a crash: ");
    settle(&mut harness);
    assert_eq!(harness.state().document().title, "A small massif");
}
