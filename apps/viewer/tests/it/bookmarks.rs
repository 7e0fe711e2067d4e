//! Bookmarks in their window, and where they are kept.

use crate::{app, find, opened, press, scene, settle};
use belvedere_viewer::{Opening, Viewer};
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

type Window = Harness<'static, Viewer>;

fn write(harness: &mut Window, name: &str, text: &str) {
    find(harness, name).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(Event::Text(text.into()));
    harness.step();
    harness.key_press(Key::Enter);
    harness.step();
}

fn list(harness: &mut Window) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::B);
    harness.step();
    harness.step();
}

/// Names in the window of the bookmarks, from top to bottom.
fn names(harness: &Window) -> Vec<String> {
    (1..).map_while(|i| harness.query_by_label(&format!("Name of bookmark {i}"))?.value()).collect()
}

#[test]
fn bookmarks_are_renamed_ordered_removed_and_flown_to() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = Opening { state: Some(folder.path().join("state")), ..opened(&[scene(folder.path())]) };
    let mut harness = app(&opening);
    settle(&mut harness);
    let first = harness.state().document().camera.clone();
    for _ in 0..3 {
        harness.key_press(Key::B);
        harness.step();
        harness.key_press(Key::ArrowUp);
        settle(&mut harness);
    }
    list(&mut harness);
    assert_eq!(names(&harness), ["View 1", "View 2", "View 3"]);
    write(&mut harness, "Name of bookmark 1", "Über dem Tal");
    press(&mut harness, "Move Über dem Tal down");
    press(&mut harness, "Remove View 3");
    assert_eq!(names(&harness), ["View 2", "Über dem Tal"]);
    press(&mut harness, "Go to Über dem Tal");
    settle(&mut harness);
    let (now, then) = (&harness.state().document().camera, &first);
    assert_eq!((&now.eye, &now.fov_y_deg), (&then.eye, &then.fov_y_deg));
    // A name is never empty.
    write(&mut harness, "Name of bookmark 1", " ");
    assert_eq!(names(&harness), ["View 2", "Über dem Tal"]);
    drop(harness);
    let mut again = app(&opening);
    settle(&mut again);
    list(&mut again);
    assert_eq!(names(&again), ["View 2", "Über dem Tal"], "they are kept in this order");
}

#[test]
fn bookmarks_of_a_scene_without_a_file_survive_a_crash_and_are_kept_once_it_is_saved() {
    let folder = tempfile::tempdir().expect("folder");
    let state = folder.path().join("state");
    let opening = Opening { state: Some(state.clone()), ..Opening::default() };
    let mut harness = app(&opening);
    settle(&mut harness);
    harness.key_press(Key::B);
    harness.step();
    let written = || std::fs::read_to_string(state.join("state-0.json")).unwrap_or_default();
    crate::wait_for(&mut harness, "the entry", |_| written().contains("View 1"));
    drop(harness); // Dropped without the end of session that an application reports.
    let mut harness = app(&opening);
    settle(&mut harness);
    list(&mut harness);
    assert_eq!(names(&harness), ["View 1"]);
    list(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    harness.step();
    harness.step();
    let path = folder.path().join("kept.toml");
    write(&mut harness, "File, or folder to go to", &path.display().to_string());
    crate::wait_for(&mut harness, "the file", |_| path.exists());
    drop(harness);
    let other = folder.path().join("other");
    std::fs::create_dir(&other).expect("folder");
    std::fs::copy(state.join("remembered.json"), other.join("remembered.json")).expect("copied");
    let mut harness = app(&Opening { state: Some(other), ..opened(&[path]) });
    settle(&mut harness);
    list(&mut harness);
    assert_eq!(names(&harness), ["View 1"]);
}

#[test]
fn the_first_bookmark_has_no_way_up_and_the_last_none_down() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    for _ in 0..3 {
        harness.key_press(Key::B);
        harness.step();
    }
    list(&mut harness);
    let ways = |n: i32| {
        ["up", "down"].map(|way| !find(&harness, &format!("Move View {n} {way}")).accesskit_node().is_disabled())
    };
    assert_eq!([1, 2, 3].map(ways), [[false, true], [true, true], [true, false]]);
}
