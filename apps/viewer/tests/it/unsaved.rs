//! Nothing that is not saved is taken away without a question.

use crate::{app, find, opened, press, scene, settle};
use belvedere::scene_file::Document;
use belvedere_viewer::Viewer;
use eframe::egui::{DroppedFile, Event, Key, Modifiers, ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::sync::Arc;

type Window = Harness<'static, Viewer>;

#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

pub(crate) fn drop_file(harness: &mut Window, path: &Path) {
    harness.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    harness.step();
    wait(harness);
}

/// Runs frames until a file that is being opened is there and drawn, or a question waits.
fn wait(harness: &mut Window) {
    let began = std::time::Instant::now();
    loop {
        harness.step();
        if asked(harness) || harness.state().rests() {
            break;
        }
        assert!(began.elapsed() < crate::PATIENCE, "neither a picture nor a question");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    harness.step();
}

pub(crate) fn asked(harness: &Window) -> bool {
    harness.query_by_label("Save the changes?").is_some()
}

/// Presses the cross of the window. Whether the window closes.
pub(crate) fn close(harness: &mut Window) -> bool {
    let viewport = harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
    viewport.events.push(ViewportEvent::Close);
    harness.step();
    let commands = commands(harness);
    harness.input_mut().viewports.entry(ViewportId::ROOT).or_default().events.clear();
    harness.step();
    !commands.contains(&ViewportCommand::CancelClose)
}

fn commands(harness: &Window) -> Vec<ViewportCommand> {
    harness.output().viewport_output.values().flat_map(|viewport| viewport.commands.clone()).collect()
}

/// Presses a button. Whether the window was told to close.
pub(crate) fn press_and_look(harness: &mut Window, name: &str) -> bool {
    find(harness, name).click();
    let mut closes = false;
    for _ in 0..3 {
        harness.step();
        closes |= commands(harness).contains(&ViewportCommand::Close);
    }
    closes
}

fn now(harness: &Window) -> Arc<Document> {
    harness.state().document().clone()
}

fn on_disk(path: &Path) -> Document {
    belvedere::scene_file::read(path).expect("a scene").document
}

fn titled(folder: &Path, name: &str) -> PathBuf {
    let text = std::fs::read_to_string(scene(folder)).expect("scene");
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text.replace("A small massif", name)).expect("scene");
    path
}

#[test]
fn quit_and_close_ask_once_something_is_not_saved() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let mut harness = app(&opened(std::slice::from_ref(&path)));
    settle(&mut harness);
    assert!(!harness.state().is_changed());
    harness.key_press(Key::ArrowLeft);
    settle(&mut harness);
    assert!(!close(&mut harness) && asked(&harness), "the window closed without a question");
    let moved = now(&harness);
    harness.key_press(Key::ArrowLeft);
    harness.step();
    assert_eq!(*now(&harness), *moved, "the keyboard belongs to the question");
    harness.key_press(Key::Escape);
    harness.step();
    harness.step();
    assert!(!asked(&harness) && harness.state().is_changed(), "Escape cancels");
    press(&mut harness, "File");
    assert!(!press_and_look(&mut harness, "Quit") && asked(&harness));
    assert!(press_and_look(&mut harness, "Save"), "saved and not ended");
    assert_eq!(on_disk(&path), *moved);
    drop(harness);

    let mut harness = app(&opened(std::slice::from_ref(&path)));
    settle(&mut harness);
    harness.key_press(Key::ArrowLeft);
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert!(!harness.state().is_changed() && close(&mut harness), "undone back to what is saved");
    harness.key_press(Key::ArrowUp);
    settle(&mut harness);
    assert!(!close(&mut harness));
    assert!(press_and_look(&mut harness, "Discard changes"), "discarded and not ended");
    assert_eq!(on_disk(&path), *moved, "what was discarded was written");
}

#[test]
fn a_scene_that_was_never_saved_gets_a_file_before_it_goes() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&belvedere_viewer::Opening::default());
    settle(&mut harness);
    harness.key_press(Key::ArrowLeft);
    settle(&mut harness);
    let moved = now(&harness);
    assert!(!close(&mut harness));
    press(&mut harness, "Save");
    let target = folder.path().join("kept.toml");
    // The file window has the keyboard.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(Event::Text(target.display().to_string()));
    harness.step();
    assert!(press_and_look(&mut harness, "Write"), "saved and not ended");
    assert_eq!(on_disk(&target), *moved);
}

#[test]
fn a_broken_scene_leaves_the_good_one_with_its_changes() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let broken = folder.path().join("broken.toml");
    let lacks = folder.path().join("lacks.toml");
    std::fs::write(&broken, "format = 1\n[camera\n").expect("file");
    std::fs::write(
        &lacks,
        "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[layer]]\nkind = 'mesh'\nid = 'a'\nsource = 'gone.obj'\n",
    )
    .expect("file");
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    harness.key_press(Key::ArrowLeft);
    settle(&mut harness);
    let good = now(&harness);
    drop_file(&mut harness, &broken);
    crate::wait_for(&mut harness, "the error", |harness| harness.query_by_label_contains("broken.toml:2").is_some());
    assert_eq!(*now(&harness), *good);
    // It reads well, but its file is missing: that is known only when it is drawn.
    drop_file(&mut harness, &lacks);
    crate::wait_for(&mut harness, "the question", asked);
    press(&mut harness, "Discard changes");
    crate::wait_for(&mut harness, "the error", |harness| harness.query_by_label_contains("gone.obj").is_some());
    settle(&mut harness);
    assert_eq!(*now(&harness), *good);
    assert!(harness.state().is_changed(), "its changes count as saved");
    assert!(!harness.state().is_opening(), "dropped files that were answered still wait");
    press(&mut harness, "Edit");
    press(&mut harness, "Undo");
    settle(&mut harness);
    assert!(!harness.state().is_changed());
}

/// A small generator of numbers (Knuth's MMIX constants).
struct Dice(u64);

impl Dice {
    fn throw(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % sides
    }
}

/// Thirty actions; every scene that goes away was saved, or discarded by a press.
fn thirty_actions(seed: u64) {
    let folder = tempfile::tempdir().expect("folder");
    let scenes = ["one", "two"].map(|name| titled(folder.path(), name));
    let broken = folder.path().join("broken.toml");
    std::fs::write(&broken, "format = 1\n[camera\n").expect("file");
    let mut harness = app(&opened(std::slice::from_ref(&scenes[0])));
    settle(&mut harness);
    let (mut dice, mut questions) = (Dice(seed), 0);
    for action in 0..30 {
        let (before, was_changed) = (now(&harness), harness.state().is_changed());
        let what = dice.throw(10);
        let mut closes = false;
        match what {
            0..=2 => harness.key_press([Key::ArrowLeft, Key::ArrowUp, Key::Plus][what as usize]),
            3 => harness.key_press_modifiers(Modifiers::COMMAND, Key::Z),
            4 => harness.key_press_modifiers(Modifiers::COMMAND, Key::Y),
            // A scene that has no file yet would ask for one.
            5 if before.title == "one" || before.title == "two" => {
                harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
            }
            6 => drop_file(&mut harness, &scenes[dice.throw(2) as usize]),
            7 => drop_file(&mut harness, &broken),
            8 => {
                press(&mut harness, "File");
                press(&mut harness, "Built-in scenes");
                press(&mut harness, "Massif, a bent panorama");
            }
            _ => closes = close(&mut harness),
        }
        wait(&mut harness);
        // A file may be read only after a rest of the present picture.
        if (6..=7).contains(&what) {
            crate::wait_for(&mut harness, "the file", |harness| !harness.state().is_opening());
            wait(&mut harness);
        }
        let mut discarded = false;
        if asked(&harness) {
            questions += 1;
            assert_eq!(*now(&harness), *before, "it went before the question was answered");
            match dice.throw(3) {
                0 if before.title == "one" || before.title == "two" => {
                    closes |= press_and_look(&mut harness, "Save");
                }
                1 => {
                    closes |= press_and_look(&mut harness, "Discard changes");
                    discarded = true;
                }
                _ => closes |= press_and_look(&mut harness, "Cancel"),
            }
            wait(&mut harness);
        }
        let after = now(&harness);
        let edits = what <= 4 && before.title == after.title;
        let is_kept = edits || *after == *before || discarded || !was_changed;
        let is_saved = || scenes.iter().any(|path| on_disk(path) == *before);
        assert!(is_kept || is_saved(), "seed {seed}, action {action} ({what}): lost");
        assert!(
            !closes || discarded || !was_changed || is_saved(),
            "seed {seed}, action {action}: closed with changes"
        );
    }
    assert!(questions > 0, "seed {seed}: nothing was ever asked");
}

#[test]
fn nothing_is_lost_in_thirty_mixed_actions() {
    (1..=3).for_each(thirty_actions);
}

#[test]
fn the_present_scene_keeps_its_panel_while_another_file_is_opened() {
    let folder = tempfile::tempdir().expect("folder");
    let other = titled(folder.path(), "Another");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    harness.input_mut().dropped_files.push(Arc::new(Dropped(other)));
    harness.step();
    assert!(harness.state().is_opening());
    find(&harness, "Hide trail");
    crate::wait_for(&mut harness, "the scene", |harness| harness.state().document().title == "Another");
}
