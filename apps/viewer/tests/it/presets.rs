//! Presets as pictures of the scene, and sections made by the words on the screen.

use crate::{app, find, opened, press, scene, settle, wait_for};
use belvedere::scene_file::{LayerDoc, PresetsDoc, StageDoc};
use belvedere::{OpenOptions, Session};
use belvedere_viewer::Viewer;
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};

type Window = Harness<'static, Viewer>;

/// Scrolls the panel to a control and presses it.
fn reach(harness: &mut Window, name: &str) {
    scroll(harness, name);
    press(harness, name);
}

fn scroll(harness: &mut Window, name: &str) {
    find(harness, name).scroll_to_me();
    for _ in 0..20 {
        harness.step();
    }
}

fn presets(harness: &Window) -> Option<PresetsDoc> {
    harness.state().document().stage.iter().find_map(|stage| match stage {
        StageDoc::SplineBend(stage) => Some(stage.presets.clone()),
        _ => None,
    })
}

fn named(harness: &Window) -> Option<String> {
    match presets(harness)? {
        PresetsDoc::Named(name) => Some(name),
        PresetsDoc::Inline(_) => None,
    }
}

fn sections(harness: &Window) -> (Vec<String>, Vec<f64>) {
    let Some(PresetsDoc::Inline(document)) = presets(harness) else { panic!("the preset is not the user's own") };
    let preset = &document.presets[0];
    (preset.sections.clone(), preset.tags.iter().map(|tag| tag.u).collect())
}

#[test]
fn a_picture_of_a_preset_is_clicked_or_chosen_by_a_key_and_undone_in_one_step() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Spline");
    wait_for(&mut harness, "a picture of each preset", |harness| harness.state().shows_presets());
    press(&mut harness, "degressive");
    settle(&mut harness);
    assert_eq!(named(&harness).as_deref(), Some("degressive"));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(presets(&harness), None);
    find(&harness, "map").focus();
    harness.step();
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(named(&harness).as_deref(), Some("map"));
    // The camera moves: the pictures are drawn again, and the window rests meanwhile.
    harness.key_press(Key::ArrowUp);
    settle(&mut harness);
    wait_for(&mut harness, "new pictures", |harness| harness.state().shows_presets());
    harness.check_accessibility();
}

/// A small town without terrain.
fn town(folder: &Path) -> PathBuf {
    let path = folder.join("town.toml");
    let text = r#"
format = 1
crs = "local"
[camera]
eye = [-120.0, -900.0, 330.0]
look_at = [0.0, -100.0, 0.0]
image = [160, 90]
[[layer]]
kind = "city"
id = "town"
source = "builtin:town?seed=7&size=600"
"#;
    std::fs::write(&path, text).expect("scene");
    path
}

#[test]
fn a_city_gets_a_preset_with_three_sections_by_three_presses_and_a_drag() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[town(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Spline");
    press(&mut harness, "progressive");
    settle(&mut harness);
    reach(&mut harness, "Three sections of town: buildings, blocks, main blocks");
    settle(&mut harness);
    let (shown, borders) = sections(&harness);
    assert_eq!(shown, ["town", "town, blocks", "town, main blocks"]);
    let loas: Vec<u8> = harness.state().document().layer.iter().filter_map(level).collect();
    assert_eq!(loas, [0, 1, 2]);
    // The nearer border is dragged to the left, in one step.
    scroll(&mut harness, "Border 1 of the sections");
    let border = find(&harness, "Border 1 of the sections").rect().center();
    harness.drag_at(border);
    harness.step();
    for k in 1..=5 {
        harness.hover_at(border - vec2(6.0 * k as f32, 0.0));
        harness.step();
    }
    harness.drop_at(border - vec2(30.0, 0.0));
    settle(&mut harness);
    let (_, moved) = sections(&harness);
    assert!(moved[0] < borders[0] - 0.05 && moved[1] == borders[1], "{borders:?} {moved:?}");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(sections(&harness).1, borders, "the drag is one step");
    // What is saved is drawn by the command line.
    let document = (**harness.state().document()).clone();
    let source = belvedere::scene_file::SourceDocument::new(document);
    let session = Session::from_document(source, &OpenOptions::default()).expect("the saved scene");
    assert_eq!(session.scene().representations.len(), 3);
}

fn level(layer: &LayerDoc) -> Option<u8> {
    match layer {
        LayerDoc::City(city) => Some(city.loa),
        _ => None,
    }
}

#[test]
fn sections_are_split_removed_and_given_a_style_of_their_own() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Spline");
    press(&mut harness, "progressive");
    settle(&mut harness);
    reach(&mut harness, "Split section 1 in two");
    settle(&mut harness);
    assert_eq!(sections(&harness).0, ["all", "all"]);
    reach(&mut harness, "Style of its own for section 2");
    for _ in 0..10 {
        harness.step();
    }
    press(&mut harness, "Copy of ground");
    settle(&mut harness);
    assert_eq!(sections(&harness).0, ["ground", "ground, section 2"]);
    let document = harness.state().document().clone();
    assert_eq!(document.layer[1].id(), "ground, section 2");
    harness.key_press(Key::Escape);
    harness.step();
    reach(&mut harness, "Remove section 1");
    settle(&mut harness);
    assert_eq!(sections(&harness).0, ["ground, section 2"], "its neighbour takes its place");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(*harness.state().document(), document, "it is one step");
    assert!(harness.query_by_label("Remove section 2").is_some());
}
