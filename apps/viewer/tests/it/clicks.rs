//! Clicks reach their controls although something comes or goes above them: results of work in the background.

use crate::{app, opened, press, scene, settle, wait_for};
use belvedere_viewer::Viewer;
use eframe::egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::collections::HashMap;

type Window = Harness<'static, Viewer>;

/// Notes the identities of all controls by name; of names that several have, none. Returns what has another than before.
fn note(harness: &Window, known: &mut HashMap<String, String>) -> Vec<String> {
    let mut now: HashMap<String, Option<String>> = HashMap::new();
    for node in harness.root().children_recursive() {
        let told = node.accesskit_node();
        let name = told.label().unwrap_or_default();
        let roles = [Role::Button, Role::CheckBox, Role::ComboBox, Role::Slider, Role::SpinButton];
        if !name.is_empty() && roles.contains(&told.role()) {
            let id = format!("{:?}", told.id());
            now.entry(name).and_modify(|one| *one = None).or_insert(Some(id));
        }
    }
    let now = now.into_iter().filter_map(|(name, id)| Some((name, id?)));
    let changes = now.filter_map(|(name, id)| {
        let before = known.insert(name.clone(), id.clone())?;
        (before != id).then_some(name)
    });
    changes.collect()
}

#[test]
fn a_click_aimed_before_the_shares_are_measured_reaches_its_control() {
    let folder = tempfile::tempdir().expect("folder");
    let scene = scene(folder.path());
    // It is measured in the background after the picture is drawn, now and then before this thread looks at the panel.
    let early = (0..20).find_map(|_| {
        let mut harness = app(&opened(std::slice::from_ref(&scene)));
        wait_for(&mut harness, "the panel", |harness| harness.query_by_label("trail must be seen").is_some());
        (!harness.state().is_judged()).then_some(harness)
    });
    let mut harness = early.expect("the panel is shown before the shares are measured");
    let at = harness.get_by_label("trail must be seen").rect().center();
    wait_for(&mut harness, "the shares", |harness| harness.query_by_label_contains(" visible, ").is_some());
    harness.hover_at(at);
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    settle(&mut harness);
    assert!(!harness.state().document().layer[1].must_see(), "the click is lost");
}

#[test]
fn controls_keep_their_identities_while_work_in_the_background_ends() {
    let folder = tempfile::tempdir().expect("folder");
    for panel in ["Layers", "Curved rays", "Terrain", "Export"] {
        let mut harness = app(&opened(&[scene(folder.path())]));
        press(&mut harness, panel);
        let mut known = HashMap::new();
        let mut judged_for = 0;
        // The panel is empty until the first picture.
        wait_for(&mut harness, "the panel", |harness| !harness.state().is_opening());
        if panel == "Layers" {
            press(&mut harness, "Style of trail");
            (0..30).for_each(|_| harness.step());
            known.clear();
        }
        while judged_for < 5 {
            harness.step();
            let changed = note(&harness, &mut known);
            assert!(changed.is_empty(), "{panel}: {changed:?} changed their identities");
            judged_for += usize::from(harness.state().is_judged() && harness.state().rests());
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        assert!(known.len() > 8, "{panel}: {known:?}");
    }
}
