//! At rest nothing is drawn again: the processor has nothing to do.

use crate::{app, find, opened, press, scene, settle};
use belvedere_viewer::{Opening, Viewer};
use eframe::egui::{Key, Modifiers, ViewportId};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::{Duration, Instant};

/// Frames within which a window comes to rest, and those in which it then stays there.
const WITHIN: usize = 400;
const STAYS: usize = 12;

/// Runs frames until none asks for another for a while; fails with the causes if that does not happen.
fn rests(harness: &mut Harness<'static, Viewer>, what: &str) {
    settle(harness);
    let began = Instant::now();
    let mut quiet = 0;
    for frame in 0.. {
        harness.step();
        let delay = harness.output().viewport_output.get(&ViewportId::ROOT).map(|output| output.repaint_delay);
        quiet = if delay == Some(Duration::MAX) { quiet + 1 } else { 0 };
        if quiet == STAYS {
            return;
        }
        let late = frame > WITHIN && began.elapsed() > Duration::from_secs(20);
        assert!(!late, "{what}: drawn again in {delay:?} by {:?}", harness.ctx.repaint_causes());
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_window_with_a_scene_rests_whatever_panel_is_open() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = Opening { state: Some(folder.path().join("state")), ..opened(&[scene(folder.path())]) };
    let mut harness = app(&opening);
    rests(&mut harness, "a scene");
    for panel in ["Look", "Curved rays", "Terrain", "Spline", "Export", "Layers"] {
        press(&mut harness, panel);
        rests(&mut harness, panel);
    }
    harness.key_press(Key::ArrowLeft);
    rests(&mut harness, "after a move of the camera");
    for compare in ["Split", "One picture", "Camera from above"] {
        press(&mut harness, "Look");
        press(&mut harness, compare);
        rests(&mut harness, compare);
    }
    for menu in ["File", "View"] {
        press(&mut harness, menu);
        rests(&mut harness, menu);
        harness.key_press(Key::Escape);
    }
    // The list of the bookmarks rests once it has their pictures.
    harness.key_press(Key::B);
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::B);
    crate::wait_for(&mut harness, "the picture of the bookmark", |harness| {
        harness.query_by_label("Picture of View 1").is_some()
    });
    rests(&mut harness, "the list of bookmarks");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::B);
    press(&mut harness, "Flicker");
    harness.step();
    let delay = harness.output().viewport_output[&ViewportId::ROOT].repaint_delay;
    assert!(delay < Duration::from_secs(1), "a flicker needs frames: {delay:?}");
}

#[test]
fn an_empty_window_rests_behind_its_welcome_and_its_tour() {
    let mut harness = app(&Opening::default());
    rests(&mut harness, "the welcome");
    press(&mut harness, "Take the tour, one minute");
    rests(&mut harness, "the tour");
    press(&mut harness, "Skip the tour");
    find(&harness, "Picture");
    rests(&mut harness, "after the tour");
}
