//! What is saved leaves the rest of the file as it is, and asks before it replaces what another program wrote.

use crate::unsaved::{asked, close, drop_file, press_and_look};
use crate::{app, find, opened, press, scene, settle, wait_for};
use belvedere_viewer::Viewer;
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};

type Window = Harness<'static, Viewer>;

const WRITTEN: &str = "# My own note: must stay.\nformat = 1\ntitle = \"Hill\"   # and this one\n[camera]\n\
    eye = [0.0, -5200.0, 3600.0] # high\nlook_at = [0.0, 0.0, 300.0]\nimage = [320, 180]\n# the ground\n[[layer]]\nkind = \"terrain\"\n\
    id = \"ground\"\nsource = \"builtin:massif?seed=7&size=129\"\n";

/// A scene as a user writes it, opened and moved.
fn moved(folder: &tempfile::TempDir) -> (PathBuf, Window) {
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, WRITTEN).expect("scene");
    let mut harness = app(&opened(std::slice::from_ref(&path)));
    settle(&mut harness);
    harness.key_press(Key::ArrowLeft);
    settle(&mut harness);
    assert!(harness.state().is_changed());
    (path, harness)
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

fn save(harness: &mut Window) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    (0..3).for_each(|_| harness.step());
}

fn asks_about_file(harness: &Window) -> bool {
    harness.query_by_label("The file has changed").or(harness.query_by_label("The file is gone")).is_some()
}

/// Presses a button of the question.
fn answer(harness: &mut Window, name: &str) -> bool {
    let closes = press_and_look(harness, name);
    assert!(!asks_about_file(harness));
    closes
}

#[test]
fn a_saved_drag_changes_the_camera_and_no_other_byte() {
    let folder = tempfile::tempdir().expect("folder");
    let (path, mut harness) = moved(&folder);
    save(&mut harness);
    assert!(!harness.state().is_changed() && !asks_about_file(&harness));
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let (before, after) = (lines(WRITTEN), lines(&text(&path)));
    assert_eq!(before.len(), after.len(), "{}", text(&path));
    let differ: Vec<usize> = (0..before.len()).filter(|&i| before[i] != after[i]).collect();
    assert_eq!(differ, [4, 5], "{}", text(&path));
    assert!(after[4].ends_with("] # high"), "{}", after[4]);
    let stated = belvedere::scene_file::read(&path).expect("a scene").document;
    assert_eq!(stated, **harness.state().document());
}

#[test]
fn what_another_program_wrote_is_replaced_only_after_a_question() {
    let folder = tempfile::tempdir().expect("folder");
    let (path, mut harness) = moved(&folder);
    let other = WRITTEN.replace("\"Hill\"", "\"Mountain\"");
    std::fs::write(&path, &other).expect("another program");
    save(&mut harness);
    assert!(asks_about_file(&harness) && text(&path) == other, "it was overwritten without a question");
    let mine = harness.state().document().clone();
    harness.key_press(Key::ArrowLeft);
    harness.step();
    assert_eq!(*harness.state().document(), mine, "the keyboard belongs to the question");
    harness.key_press(Key::Escape);
    (0..3).for_each(|_| harness.step());
    assert!(!asks_about_file(&harness) && harness.state().is_changed() && text(&path) == other);
    save(&mut harness);
    answer(&mut harness, "Cancel");
    assert!(text(&path) == other);
    save(&mut harness);
    answer(&mut harness, "Reload");
    settle(&mut harness);
    assert!(harness.state().document().title == "Mountain" && !harness.state().is_changed());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(*harness.state().document(), mine, "undo brings the scene of before back");
    std::fs::write(&path, &other).expect("touched");
    save(&mut harness);
    assert!(!asks_about_file(&harness) && text(&path).contains("\"Hill\"   # and this one"), "{}", text(&path));
}

#[test]
fn a_question_about_the_file_keeps_what_waits_for_the_save() {
    let folder = tempfile::tempdir().expect("folder");
    let (path, mut harness) = moved(&folder);
    std::fs::remove_file(&path).expect("removed");
    assert!(!close(&mut harness) && asked(&harness));
    assert!(!press_and_look(&mut harness, "Save") && asks_about_file(&harness) && !path.exists());
    assert!(!answer(&mut harness, "Cancel"), "ended without a save");
    assert!(!close(&mut harness) && asked(&harness), "it asks again");
    press_and_look(&mut harness, "Save");
    answer(&mut harness, "Save as…");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    let target = folder.path().join("kept.toml");
    harness.event(Event::Text(target.display().to_string()));
    harness.step();
    assert!(press_and_look(&mut harness, "Write"), "saved and not ended");
    assert!(text(&target).starts_with("# My own note") && !path.exists());

    let (path, mut harness) = moved(&folder);
    std::fs::remove_file(&path).expect("removed");
    save(&mut harness);
    answer(&mut harness, "Write it again");
    assert!(!harness.state().is_changed() && text(&path).contains("# the ground\n[[layer]]"), "{}", text(&path));
}

#[test]
fn a_scene_that_was_made_of_files_is_not_lost_without_a_question() {
    let Some(dem) = belvedere_testkit::data("cases/dem.tif") else { return };
    let Some(route) = belvedere_testkit::data("cases/route.gpx") else { return };
    let folder = tempfile::tempdir().expect("folder");
    let other = scene(folder.path());
    for files in [vec![dem.clone(), route], vec![dem]] {
        let mut harness = app(&opened(&files));
        wait_for(&mut harness, "the scene", |harness| !harness.state().is_opening());
        settle(&mut harness);
        let made = harness.state().document().clone();
        assert!(!close(&mut harness) && asked(&harness), "the window closed without a question");
        press(&mut harness, "Cancel");
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Q);
        (0..2).for_each(|_| harness.step());
        assert!(asked(&harness), "it ended without a question");
        press(&mut harness, "Cancel");
        drop_file(&mut harness, &other);
        wait_for(&mut harness, "the question", asked);
        assert_eq!(*harness.state().document(), made);
        press(&mut harness, "Cancel");
        press(&mut harness, "File");
        press(&mut harness, "Built-in scenes");
        press(&mut harness, "Massif, a bent panorama");
        assert!(asked(&harness));
        press(&mut harness, "Save");
        let target = folder.path().join("made.toml");
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.event(Event::Text(target.display().to_string()));
        harness.step();
        press(&mut harness, "Write");
        settle(&mut harness);
        assert_ne!(harness.state().document().title, made.title, "the other scene comes once it is saved");
        let kept = belvedere::scene_file::read(&target).expect("a scene").document;
        assert_eq!((kept.camera, kept.stage), (made.camera.clone(), made.stage.clone()));
        find(&harness, "Picture");
    }
}
