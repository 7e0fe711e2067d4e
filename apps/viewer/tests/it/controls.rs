//! Every control has a name, every panel works on every kind of scene.

use crate::{app, opened, press, scene, settle};
use belvedere_viewer::Opening;
use egui_kittest::kittest::Queryable;

const TABS: [&str; 6] = ["Layers", "Look", "Curved rays", "Terrain", "Spline", "Export"];

#[test]
fn every_control_has_a_name() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    for tab in TABS {
        press(&mut harness, tab);
        harness.check_accessibility();
    }
    press(&mut harness, "Help");
    harness.check_accessibility();
    harness.get_by_label("Keys and pointer");
}

#[test]
fn what_nothing_can_draw_is_said_in_words_and_undone() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    settle(&mut harness);
    assert_eq!(harness.state().document().stage.len(), 1);
    for _ in 0..3 {
        press(&mut harness, "Add a turn");
    }
    press(&mut harness, "Straight rays");
    settle(&mut harness);
    assert!(harness.state().document().stage.is_empty());
}

#[test]
fn the_ground_makes_way_at_a_press() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Terrain");
    press(&mut harness, "The ground makes way");
    settle(&mut harness);
    let began = std::time::Instant::now();
    loop {
        let said =
            harness.query_by_label_contains("visible straight").and_then(|node| node.value()).unwrap_or_default();
        let shares: Vec<f64> = said.split(' ').filter_map(|word| word.parse().ok()).collect();
        if let [straight, bent] = shares[..]
            && straight < 90.0
            && bent > 98.0
        {
            break;
        }
        assert!(began.elapsed() < crate::PATIENCE, "the ground did not make way: {said:?}");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
}

#[test]
fn without_a_file_a_built_in_scene_is_there() {
    let mut harness = app(&Opening::default());
    settle(&mut harness);
    assert_eq!(harness.state().document().title, "A massif and its trail");
}
