//! Every control has a name, every panel works on every kind of scene.

use crate::{app, opened, press, scene, settle};
use belvedere::scene_file::StageDoc;
use belvedere_viewer::Opening;
use eframe::egui::{Key, vec2};
use egui_kittest::kittest::Queryable;
use std::time::{Duration, Instant};

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
    let began = Instant::now();
    loop {
        let said =
            harness.query_by_label_contains("visible straight").and_then(|node| node.value()).unwrap_or_default();
        let words = said.split(' ').map(|word| word.trim_start_matches('('));
        let shares: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        // Shares of the whole trail, each with the share in the frame.
        if let [straight, straight_in_frame, bent, in_frame] = shares[..]
            && straight < 0.9 * straight_in_frame
            && bent > 0.98 * in_frame
        {
            break;
        }
        assert!(began.elapsed() < crate::PATIENCE, "the ground did not make way: {said:?}");
        harness.step();
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn without_a_file_a_built_in_scene_is_there() {
    let mut harness = app(&Opening::default());
    settle(&mut harness);
    assert_eq!(harness.state().document().title, "A massif and its trail");
}

#[test]
fn the_pivot_line_of_a_turn_is_dragged_in_the_camera_from_above() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let text = std::fs::read_to_string(&path).expect("scene");
    let stage = r#"
[[stage]]
kind = "curved_rays"
[[stage.turn]]
viewpoint = [6400.0, -4750.0, 3600.0]
t0 = [3900.0, -3380.0, 2445.0]
t1 = [3600.0, -3120.0, 2280.0]
t2 = [3300.0, -2860.0, 2115.0]
line = { point = [16700.0, 12000.0, 2280.0], dir = [0.0, 0.0, 1.0] }
"#;
    std::fs::write(&path, text + stage).expect("scene");
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    harness.key_press(Key::O);
    settle(&mut harness);
    let line = |harness: &egui_kittest::Harness<'_, belvedere_viewer::Viewer>| {
        let Some(StageDoc::CurvedRays(stage)) = harness.state().document().stage.first().cloned() else {
            panic!("no turns")
        };
        stage.turn[0].line.expect("a line")
    };
    let before = line(&harness);
    let handle = harness.get_by_label("Pivot line of turn 1").rect().center();
    harness.drag_at(handle);
    harness.step();
    for k in 1..=5 {
        harness.hover_at(handle + vec2(4.0 * k as f32, 0.0));
        harness.step();
    }
    harness.drop_at(handle + vec2(20.0, 0.0));
    settle(&mut harness);
    let after = line(&harness);
    assert!(after.point[0] != before.point[0] && after.point[2] == before.point[2], "{before:?} {after:?}");
    assert_eq!(after.dir, before.dir);
}

#[test]
fn the_picture_keeps_its_size_whatever_the_panel_shows() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    let before = harness.get_by_label("Picture").rect();
    for tab in TABS {
        press(&mut harness, tab);
        harness.step();
        assert_eq!(harness.get_by_label("Picture").rect(), before, "{tab}");
    }
}

#[test]
fn long_work_is_cancelled_and_taken_up_again() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("scene.toml");
    let text = include_str!("../../../../scenes/massif_terrain.toml");
    std::fs::write(&path, text).expect("scene");
    let mut harness = app(&opened(&[path]));
    crate::wait_for(&mut harness, "a picture to cancel", |harness| {
        harness.state().document().solves_terrain() && harness.query_by_label("Cancel").is_some()
    });
    // While files are opened there is the same button.
    crate::wait_for(&mut harness, "the scene", |harness| !harness.state().is_opening());
    let document = harness.state().document().clone();
    let began = Instant::now();
    while harness.query_by_label("Draw again").is_none() {
        assert!(began.elapsed() < crate::PATIENCE, "no picture takes long enough to be cancelled");
        if harness.query_by_label("Cancel").is_some() {
            // The picture may be done before the click is.
            press(&mut harness, "Cancel");
        } else if harness.state().rests() {
            // Another eye needs another picture.
            harness.key_press(Key::ArrowLeft);
        }
        harness.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(!harness.state().rests(), "nothing was given up");
    let now = harness.state().document();
    assert_eq!((&now.layer, &now.stage), (&document.layer, &document.stage), "the scene stays");
    press(&mut harness, "Draw again");
    crate::wait_for(&mut harness, "the work again", |harness| {
        harness.query_by_label("Cancel").is_some() || harness.state().rests()
    });
    assert!(harness.query_by_label("Draw again").is_none());
}
