//! Snapshots of the window. After an intended change: `UPDATE_SNAPSHOTS=1 cargo test -p belvedere-viewer`, then inspect the pictures.

use crate::screen::Screen;
use crate::{PATIENCE, opened, press, scene, settle};
use belvedere_viewer::Viewer;
use egui_kittest::{Harness, SnapshotOptions};
use std::time::{Duration, Instant};

/// Pixels that may differ between processors, which round differently.
const PIXELS: usize = 60;

/// The application with a small scene, in a window of 960 x 640 points.
fn drawn(folder: &std::path::Path) -> Harness<'static, Viewer> {
    sized(folder, [960.0, 640.0])
}

fn sized(folder: &std::path::Path, size: [f32; 2]) -> Harness<'static, Viewer> {
    let opening = opened(&[scene(folder)]);
    let builder = Harness::builder().with_size(size).with_max_steps(4).renderer(Screen::default());
    let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    settle(&mut harness);
    harness
}

/// Runs frames until the visibility is measured, which happens after the picture is shown.
fn judged(harness: &mut Harness<'_, Viewer>) {
    let began = Instant::now();
    while !harness.state().is_judged() {
        assert!(began.elapsed() < PATIENCE, "nothing is judged");
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.step();
}

fn compare(harness: &mut Harness<'_, Viewer>, name: &str) {
    settle(harness);
    harness.snapshot_options(name, &SnapshotOptions::new().max_failed_pixels(PIXELS));
}

#[test]
fn a_scene_and_its_layers() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = drawn(folder.path());
    press(&mut harness, "Layers");
    judged(&mut harness);
    compare(&mut harness, "layers");
}

#[test]
fn a_preset_and_its_curve() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = drawn(folder.path());
    press(&mut harness, "Spline");
    press(&mut harness, "progressive");
    settle(&mut harness);
    let began = Instant::now();
    while !harness.state().shows_presets() {
        assert!(began.elapsed() < PATIENCE, "no pictures of presets");
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    compare(&mut harness, "spline");
}

#[test]
fn a_preset_and_its_curve_in_light_colours() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = drawn(folder.path());
    press(&mut harness, "View");
    press(&mut harness, "Light");
    press(&mut harness, "Spline");
    press(&mut harness, "progressive");
    compare(&mut harness, "light");
}

#[test]
fn terrain_that_makes_way() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = drawn(folder.path());
    press(&mut harness, "Terrain");
    press(&mut harness, "The ground makes way");
    settle(&mut harness);
    judged(&mut harness);
    compare(&mut harness, "terrain");
}

#[test]
fn rays_that_turn_and_the_camera_from_above() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = drawn(folder.path());
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    compare(&mut harness, "rays");
}

#[test]
fn a_phone_with_the_sheet_open() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = sized(folder.path(), [390.0, 844.0]);
    press(&mut harness, "Show the panel");
    judged(&mut harness);
    compare(&mut harness, "phone");
}

#[test]
fn a_question_about_unsaved_changes() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = sized(folder.path(), [800.0, 600.0]);
    harness.key_press(eframe::egui::Key::ArrowUp);
    settle(&mut harness);
    judged(&mut harness);
    press(&mut harness, "File");
    press(&mut harness, "Quit");
    compare(&mut harness, "unsaved");
}
