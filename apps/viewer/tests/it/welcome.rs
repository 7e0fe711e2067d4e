//! The first minute: an empty window says what to do.

use crate::{app, find, press, scene, settle};
use belvedere_viewer::Opening;
use egui_kittest::kittest::Queryable;

#[test]
fn an_empty_window_offers_examples_and_a_tour_that_is_remembered() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = Opening { state: Some(folder.path().join("state")), ..Opening::default() };
    let mut harness = app(&opening);
    settle(&mut harness);
    find(&harness, "Drop an elevation model and a track");
    for card in ["A panorama", "Behind a pass", "Two side streets", "A canyon ahead", "Inside an engine"] {
        assert!(harness.query_all_by_label(card).count() >= 1, "{card}");
    }
    press(&mut harness, "Take the tour, one minute");
    harness.step();
    find(&harness, "1 of 5: Move");
    press(&mut harness, "Next");
    harness.step();
    find(&harness, "2 of 5: Straight and bent");
    press(&mut harness, "Skip the tour");
    harness.step();
    assert!(harness.query_by_label_contains("of 5").is_none());
    press(&mut harness, "Help");
    press(&mut harness, "Welcome and examples");
    harness.step();
    assert!(harness.query_by_label("Take the tour, one minute").is_none(), "the tour is remembered");
    let card = harness.get_by_role_and_label(eframe::egui::accesskit::Role::Button, "Two side streets");
    card.click();
    let title = "Both side streets of a crossing";
    crate::wait_for(&mut harness, "the example", |harness| harness.state().document().title == title);
    settle(&mut harness);
    assert!(harness.query_by_label("Drop an elevation model and a track").is_none());
    drop(harness);
    let kept = std::fs::read_to_string(folder.path().join("state/remembered.json")).expect("state");
    assert!(kept.contains("\"toured\":true"), "{kept}");
}

#[test]
fn the_pictures_of_the_examples_are_drawn_by_the_program_and_kept() {
    let folder = tempfile::tempdir().expect("folder");
    let state = folder.path().join("state");
    let opening = Opening { state: Some(state.clone()), ..Opening::default() };
    let mut harness = app(&opening);
    settle(&mut harness);
    let cards = || {
        let files = std::fs::read_dir(&state).into_iter().flatten().flatten();
        files.filter(|file| file.file_name().to_string_lossy().starts_with("card-")).count()
    };
    crate::wait_for(&mut harness, "a picture of a card", |_| cards() > 0);
    assert!(cards() >= 1);
}

#[test]
fn who_opens_a_file_is_not_welcomed() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&crate::opened(&[scene(folder.path())]));
    settle(&mut harness);
    assert!(harness.query_by_label("Drop an elevation model and a track").is_none());
}
