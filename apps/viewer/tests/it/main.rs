//! The application driven by its accessibility tree, as a screen reader sees it.

mod accessible;
mod authoring;
mod bookmarks;
mod choosing;
mod clicks;
mod consent;
mod controls;
mod density;
mod files;
mod film;
mod finding;
mod fingers;
mod handles;
mod languages;
mod layers;
mod layout;
mod measuring;
mod moves;
mod moving;
mod narrow;
mod presets;
mod rest;
mod saving;
mod screen;
mod snapshots;
mod sources;
mod steady;
mod styles;
mod tasks;
mod undoing;
mod unsaved;
mod welcome;
#[cfg(target_os = "linux")]
mod window;

use belvedere_viewer::{Opening, Viewer};
use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, Node};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest that a picture may take in a test.
const PATIENCE: Duration = Duration::from_secs(120);

/// The application in a window of 1200 x 760 points.
fn app(opening: &Opening) -> Harness<'static, Viewer> {
    let opening = opening.clone();
    let builder = Harness::builder().with_size([1200.0, 760.0]).with_max_steps(4);
    builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening))
}

/// Runs frames until the picture rests.
fn settle(harness: &mut Harness<'_, Viewer>) {
    let began = Instant::now();
    // An action takes effect in the next two frames.
    harness.step();
    harness.step();
    while !harness.state().rests() {
        assert!(began.elapsed() < PATIENCE, "no picture");
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.step();
}

/// Runs frames until a condition holds.
fn wait_for(harness: &mut Harness<'static, Viewer>, what: &str, holds: impl Fn(&Harness<'static, Viewer>) -> bool) {
    let began = Instant::now();
    while !holds(harness) {
        assert!(began.elapsed() < PATIENCE, "{what} does not come");
        harness.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.step();
}

/// Presses the control of that name.
fn press(harness: &mut Harness<'_, Viewer>, name: &str) {
    find(harness, name).click();
    harness.step();
    harness.step();
}

fn find<'a>(harness: &'a Harness<'_, Viewer>, name: &'a str) -> Node<'a> {
    harness.get_by_label(name)
}

/// A small scene file in a folder.
fn scene(folder: &Path) -> PathBuf {
    let path = folder.join("scene.toml");
    let text = r#"
format = 1
title = "A small massif"
crs = "local"
[camera]
eye = [6000.0, -5200.0, 3600.0]
look_at = [0.0, 0.0, 300.0]
image = [320, 180]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=129"
[[layer]]
kind = "line"
id = "trail"
source = "builtin:massif?seed=7&size=129"
must_see = true
"#;
    std::fs::write(&path, text).expect("scene");
    path
}

fn opened(files: &[PathBuf]) -> Opening {
    Opening { files: files.to_vec(), ..Opening::default() }
}
