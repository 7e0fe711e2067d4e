//! The list of layers: what is seen, order, names, removal, styles; each one step of undo.

use crate::{app, find, opened, press, scene, settle, wait_for};
use belvedere::scene_file::LayerDoc;
use belvedere_viewer::Viewer;
use eframe::egui::{Event, Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::path::Path;

type Window = Harness<'static, Viewer>;

fn ids(harness: &Window) -> Vec<String> {
    harness.state().document().layer.iter().map(|layer| layer.id().to_owned()).collect()
}

fn undo(harness: &mut Window) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(harness);
}

#[test]
fn layers_are_hidden_ordered_named_and_removed_and_each_is_undone() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    let whole = harness.state().document().clone();

    press(&mut harness, "Hide trail");
    settle(&mut harness);
    assert_eq!(harness.state().document().hidden, ["trail"]);
    press(&mut harness, "Show trail");
    settle(&mut harness);
    assert_eq!(*harness.state().document(), whole);

    press(&mut harness, "Move trail up");
    settle(&mut harness);
    assert_eq!(ids(&harness), ["trail", "ground"]);
    undo(&mut harness);
    assert_eq!(ids(&harness), ["ground", "trail"]);

    press(&mut harness, "Style of trail");
    for _ in 0..20 {
        harness.step();
    }
    find(&harness, "name of trail").focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("the way up".into()));
    harness.step();
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(ids(&harness), ["ground", "the way up"]);
    undo(&mut harness);
    assert_eq!(ids(&harness), ["ground", "trail"]);

    press(&mut harness, "names of trail");
    settle(&mut harness);
    let LayerDoc::Line(line) = &harness.state().document().layer[1] else { panic!("no line") };
    assert!(line.style.labels);
    undo(&mut harness);

    press(&mut harness, "Remove trail");
    settle(&mut harness);
    assert_eq!(ids(&harness), ["ground"]);
    press(&mut harness, "Edit");
    press(&mut harness, "Steps");
    press(&mut harness, "As it was opened");
    settle(&mut harness);
    assert_eq!(*harness.state().document(), whole);
    press(&mut harness, "Edit");
    press(&mut harness, "Steps");
    press(&mut harness, "1. hid trail");
    settle(&mut harness);
    assert_eq!(harness.state().document().hidden, ["trail"]);
}

/// A click that is under way when the shares of a layer or the properties of its file come in still finds its control.
#[test]
fn controls_of_a_layer_keep_their_identities() {
    let folder = tempfile::tempdir().expect("folder");
    let names = ["Hide trail", "trail must be seen", "Style of trail"];
    let identities = |harness: &Window| names.map(|name| find(harness, name).accesskit_node().id());
    // The measure may come before the list is looked at.
    let is_early = || {
        let mut harness = app(&opened(&[scene(folder.path())]));
        wait_for(&mut harness, "the list", |harness| harness.query_by_label(names[2]).is_some());
        (!harness.state().is_judged()).then_some(harness)
    };
    let mut harness = (0..20).find_map(|_| is_early()).expect("a list before the measure");
    let before = identities(&harness);
    wait_for(&mut harness, "the measure", |harness| harness.state().is_judged());
    assert_eq!(identities(&harness), before);
}

/// A scene of one layer.
pub(crate) fn alone(folder: &Path, unit: &str, layer: &str) -> std::path::PathBuf {
    let path = folder.join("alone.toml");
    let text = format!(
        "format = 1\nunit = \"{unit}\"\n[camera]\neye = [80.0, -260.0, 104.0]\nlook_at = [80.0, 60.0, 56.0]\nimage = [160, 90]\n[[layer]]\nid = \"it\"\n{layer}"
    );
    std::fs::write(&path, text).expect("scene");
    path
}

#[test]
fn the_transfer_curve_of_a_volume_is_dragged_over_its_histogram() {
    let folder = tempfile::tempdir().expect("folder");
    let path = alone(folder.path(), "voxel", "kind = \"volume\"\nsource = \"builtin:engine\"\ntransfer = \"engine\"\n");
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    press(&mut harness, "Style of it");
    for _ in 0..20 {
        harness.step();
    }
    let point = find(&harness, "Opacity point 2").rect().center();
    harness.drag_at(point);
    harness.step();
    for k in 1..=4 {
        harness.hover_at(point + vec2(0.0, -10.0 * k as f32));
        harness.step();
    }
    harness.drop_at(point + vec2(0.0, -40.0));
    settle(&mut harness);
    let LayerDoc::Volume(volume) = &harness.state().document().layer[0] else { panic!("no volume") };
    assert!(volume.transfer.starts_with("points "), "{}", volume.transfer);
    undo(&mut harness);
    let LayerDoc::Volume(volume) = &harness.state().document().layer[0] else { panic!("no volume") };
    assert_eq!(volume.transfer, "engine", "the drag is one step");
}

#[test]
fn atoms_become_space_filling_and_coloured_by_chain() {
    let folder = tempfile::tempdir().expect("folder");
    let layer = "kind = \"molecule\"\nsource = \"builtin:dna?pairs=4&seed=7\"\n";
    let mut harness = app(&opened(&[alone(folder.path(), "angstrom", layer)]));
    settle(&mut harness);
    press(&mut harness, "Style of it");
    for _ in 0..20 {
        harness.step();
    }
    press(&mut harness, "atoms of it");
    press(&mut harness, "space filling");
    settle(&mut harness);
    press(&mut harness, "coloured by, it");
    press(&mut harness, "chain");
    settle(&mut harness);
    let LayerDoc::Molecule(molecule) = &harness.state().document().layer[0] else { panic!("no molecule") };
    let style = &molecule.style;
    assert_eq!(style.color, "chain");
    assert_ne!(style.representation, belvedere::scene::molecule::Representation::default());
}

#[test]
fn the_title_is_what_is_written_in_its_field() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    find(&harness, "Title").focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("Seen from the south".into()));
    settle(&mut harness);
    assert_eq!(harness.state().document().title, "Seen from the south");
}
