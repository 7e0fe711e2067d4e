//! The window of the application in which files are chosen: what it lists, and what a click in it does.

use crate::{app, find, opened, press, scene, settle, wait_for};
use belvedere_viewer::Viewer;
use eframe::egui::accesskit::Toggled;
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::path::Path;

type Window = Harness<'static, Viewer>;

fn is_listed(harness: &Window, name: &str) -> bool {
    harness.query_by_label(name).is_some()
}

fn is_marked(harness: &Window, name: &str) -> bool {
    find(harness, name).accesskit_node().toggled() == Some(Toggled::True)
}

/// Goes to a folder by its name.
fn enter(harness: &mut Window, folder: &Path) {
    find(harness, "File, or folder to go to").focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(Event::Text(folder.display().to_string()));
    harness.step();
    harness.key_press(Key::Enter);
    (0..3).for_each(|_| harness.step());
}

/// A folder with a scene, a hidden file, and a folder in it with another scene.
fn folders(folder: &Path) -> std::path::PathBuf {
    let first = scene(folder);
    let text = std::fs::read_to_string(&first).expect("scene");
    std::fs::write(folder.join(".kept.toml"), &text).expect("file");
    std::fs::create_dir(folder.join("deep")).expect("folder");
    std::fs::write(folder.join("deep/below.toml"), text.replace("A small massif", "Below")).expect("scene");
    first
}

#[test]
fn a_scene_is_found_and_opened_by_clicks() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[folders(folder.path())]));
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    (0..3).for_each(|_| harness.step());
    enter(&mut harness, folder.path());
    assert!(is_listed(&harness, "scene.toml") && is_listed(&harness, "deep/"));
    assert!(!is_listed(&harness, ".kept.toml"), "what is hidden is listed");
    press(&mut harness, "deep/");
    assert!(is_listed(&harness, "below.toml") && !is_listed(&harness, "scene.toml"));
    press(&mut harness, "one folder up");
    assert!(is_listed(&harness, "scene.toml"), "it did not go up");
    press(&mut harness, "deep/");
    // Nothing is chosen until it is clicked, and a second click takes it back.
    let marked = |harness: &Window| ["one folder up", "below.toml"].map(|name| is_marked(harness, name));
    assert_eq!(marked(&harness), [false, false]);
    press(&mut harness, "below.toml");
    assert_eq!(marked(&harness), [false, true]);
    press(&mut harness, "below.toml");
    assert_eq!(marked(&harness), [false, false]);
    press(&mut harness, "below.toml");
    press(&mut harness, "Open");
    wait_for(&mut harness, "the scene", |harness| harness.state().document().title == "Below");
}

#[test]
fn a_click_on_a_file_to_write_takes_its_name_and_warns() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[folders(folder.path())]));
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    (0..3).for_each(|_| harness.step());
    press(&mut harness, "deep/");
    let warns = |harness: &Window| is_listed(harness, "This file is there already; it will be replaced.");
    assert!(!warns(&harness));
    press(&mut harness, "below.toml");
    assert_eq!(find(&harness, "File, or folder to go to").value().as_deref(), Some("below.toml"));
    assert!(warns(&harness));
    press(&mut harness, "Write");
    let path = folder.path().join("deep/below.toml");
    let title = || belvedere::scene_file::read(&path).map(|source| source.document.title).unwrap_or_default();
    wait_for(&mut harness, "the file", |_| title() == "A small massif");
}
