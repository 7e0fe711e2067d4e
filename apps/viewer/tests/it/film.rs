//! Films from the window: along a route, past bookmarks, with a duration and a rate.

use crate::{app, find, opened, press, scene, settle};
use belvedere_viewer::Viewer;
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::Path;

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

/// Exports the chosen film into the folder and returns the number of frames that it has.
fn exported(harness: &mut Window, folder: &Path, name: &str) -> usize {
    write(harness, "Seconds", "0.5");
    write(harness, "Frames per second", "8");
    press(harness, "Export film…");
    harness.step();
    let out = folder.join(name);
    write(harness, "File, or folder to go to", &out.display().to_string());
    crate::wait_for(harness, "the film", |harness| harness.query_by_label_contains("Written:").is_some());
    let frames = std::fs::read_dir(&out).expect("frames").flatten();
    frames.filter(|file| file.path().extension().is_some_and(|e| e == "png")).count()
}

#[test]
fn films_follow_a_route_and_pass_bookmarks_as_long_as_is_said() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let text = std::fs::read_to_string(&path).expect("scene").replace("[320, 180]", "[64, 36]");
    std::fs::write(&path, text).expect("scene");
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    press(&mut harness, "Export");
    press(&mut harness, "Film");
    press(&mut harness, "along a route");
    assert_eq!(exported(&mut harness, folder.path(), "route"), 4);
    press(&mut harness, "Dismiss 1");

    press(&mut harness, "Film");
    press(&mut harness, "past the bookmarks");
    for _ in 0..2 {
        harness.key_press(Key::B);
        harness.step();
        harness.key_press(Key::ArrowUp);
        settle(&mut harness);
    }
    assert_eq!(exported(&mut harness, folder.path(), "bookmarks"), 4);
}
