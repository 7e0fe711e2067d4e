//! Each gesture is one step of undo: what one control does from when it is taken hold of, or gets the keyboard, to when it is left.

use crate::{app, find, opened, press, scene, settle};
use belvedere::scene_file::Document;
use belvedere_viewer::Viewer;
use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, TouchPhase, Vec2, vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::sync::Arc;

type Window = Harness<'static, Viewer>;

fn window(folder: &tempfile::TempDir) -> Window {
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    harness
}

fn now(harness: &Window) -> Arc<Document> {
    harness.state().document().clone()
}

/// Ctrl Z, or with Shift its reverse.
fn undo(harness: &mut Window, modifiers: Modifiers) {
    harness.key_press_modifiers(Modifiers::COMMAND | modifiers, Key::Z);
    (0..2).for_each(|_| harness.step());
}

fn middle(harness: &Window) -> Pos2 {
    find(harness, "Picture").rect().center() + vec2(0.0, 60.0)
}

/// Drags with a button of the pointer.
fn drag(harness: &mut Window, from: Pos2, by: Vec2, button: PointerButton) {
    let pressed = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
    harness.hover_at(from);
    harness.step();
    harness.event(pressed(from, true));
    harness.step();
    for k in 1..=5 {
        harness.hover_at(from + by * (k as f32 / 5.0));
        harness.step();
    }
    harness.event(pressed(from + by, false));
    harness.step();
}

fn drag_picture(harness: &mut Window) {
    let middle = middle(harness);
    drag(harness, middle, vec2(60.0, 25.0), PointerButton::Primary);
}

/// Turns the wheel over the picture until the motion has run out.
fn wheel(harness: &mut Window, frames: usize) {
    harness.hover_at(middle(harness));
    let (unit, delta, phase) = (MouseWheelUnit::Point, vec2(0.0, 40.0), TouchPhase::Move);
    let (modifiers, source) = (Modifiers::NONE, MouseWheelSource::Wheel);
    harness.event(Event::MouseWheel { unit, delta, phase, modifiers, source });
    (0..frames).for_each(|_| harness.step());
}

/// Types letters into a field, which gets the keyboard first.
fn enter(harness: &mut Window, name: &str, text: &str) {
    find(harness, name).focus();
    (0..2).for_each(|_| harness.step());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    type_on(harness, text);
}

fn type_on(harness: &mut Window, text: &str) {
    for letter in text.chars() {
        harness.event(Event::Text(letter.to_string()));
        harness.step();
    }
}

#[test]
fn undo_takes_back_the_title_alone_and_then_the_drag() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(&folder);
    let first = now(&harness);
    drag_picture(&mut harness);
    let dragged = now(&harness);
    assert_ne!(first.camera, dragged.camera);
    enter(&mut harness, "Title", "ab");
    assert_eq!(now(&harness).title, "ab");
    undo(&mut harness, Modifiers::NONE);
    assert_eq!(*now(&harness), *dragged, "the title alone goes back");
    // The field still has the keyboard: what is typed now is a step of its own, over the drag.
    type_on(&mut harness, "c");
    assert_eq!(now(&harness).camera, dragged.camera);
    undo(&mut harness, Modifiers::NONE);
    assert_eq!(*now(&harness), *dragged);
    undo(&mut harness, Modifiers::SHIFT);
    type_on(&mut harness, "d");
    undo(&mut harness, Modifiers::NONE);
    assert!(now(&harness).title.contains('c') && !now(&harness).title.contains('d'), "undo right after redo");
    undo(&mut harness, Modifiers::NONE);
    undo(&mut harness, Modifiers::NONE);
    assert_eq!(*now(&harness), *first);
    assert!(!harness.state().is_changed());
}

#[test]
fn width_and_height_are_steps_of_their_own_however_they_are_changed() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(&folder);
    drag_picture(&mut harness);
    let dragged = now(&harness);
    press(&mut harness, "Export");
    enter(&mut harness, "Width, pixels", "640");
    let wide = now(&harness);
    assert_eq!(wide.camera.image, [640, 180]);
    // From one field right into the next.
    enter(&mut harness, "Height, pixels", "48");
    assert_eq!(now(&harness).camera.image, [640, 48]);
    harness.key_press(Key::Escape);
    harness.step();
    let both = now(&harness);
    for by in [30.0, 20.0] {
        let field = find(&harness, "Width, pixels").rect().center();
        drag(&mut harness, field, vec2(by, 0.0), PointerButton::Primary);
    }
    assert!(now(&harness).camera.image[0] > 640);
    undo(&mut harness, Modifiers::NONE);
    assert!(now(&harness).camera.image[0] > 640, "two drags are two steps");
    for before in [&both, &wide, &dragged] {
        undo(&mut harness, Modifiers::NONE);
        assert_eq!(*now(&harness), **before);
    }
}

#[test]
fn the_wheel_does_not_join_a_drag_that_comes_between_its_turns() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(&folder);
    let mut states = vec![now(&harness)];
    for k in 0..4 {
        match k % 2 {
            0 => wheel(&mut harness, 12),
            _ => drag_picture(&mut harness),
        }
        states.push(now(&harness));
    }
    for before in states.iter().rev().skip(1) {
        undo(&mut harness, Modifiers::NONE);
        assert_eq!(*now(&harness), **before);
    }
}

#[test]
fn a_number_that_is_typed_into_a_style_is_one_step() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(&folder);
    press(&mut harness, "Style of trail");
    (0..30).for_each(|_| harness.step());
    let first = now(&harness);
    enter(&mut harness, "width of trail, pixels", "12");
    let wide = now(&harness);
    assert_ne!(*wide, *first);
    enter(&mut harness, "Title", "x");
    enter(&mut harness, "width of trail, pixels", "34");
    for before in ["12x", "12", "first"] {
        undo(&mut harness, Modifiers::NONE);
        match before {
            "12x" => assert!(now(&harness).title == "x" && now(&harness).layer == wide.layer),
            "12" => assert_eq!(*now(&harness), *wide),
            _ => assert_eq!(*now(&harness), *first),
        }
    }
}

#[test]
fn a_look_at_a_panel_is_no_edit() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let text = std::fs::read_to_string(&path).expect("scene");
    let text = text.replace("[320, 180]", "[320, 10]\nfov_y_deg = 3.1234567") + "style = { width_px = 55.5 }\n";
    let turn = "[[stage]]\nkind = \"curved_rays\"\n[[stage.turn]]\nviewpoint = [6400.12345, -4750.98765, 3600.55555]\n\
        t0 = [3900.0, -3380.0, 2445.0]\nt1 = [3600.0, -3120.0, 2280.0]\nt2 = [3300.0, -2860.0, 2115.0]\n\
        normal = [-0.9, 0.8, 0.0]\nm = 1.23456789\n";
    std::fs::write(&path, text + turn).expect("scene");
    let mut harness = app(&opened(&[path]));
    crate::wait_for(&mut harness, "the scene", |harness| harness.state().document().camera.image[1] == 10);
    crate::wait_for(&mut harness, "the panel", |harness| !harness.state().is_opening());
    for panel in ["Look", "Terrain", "Spline", "Layers"] {
        press(&mut harness, panel);
        (0..3).for_each(|_| harness.step());
    }
    press(&mut harness, "Style of trail");
    (0..30).for_each(|_| harness.step());
    assert!(!harness.state().is_changed(), "shown");
    // The keyboard goes from field to field, forwards and back.
    let fields =
        [("Export", ["Width, pixels", "Height, pixels"]), ("Curved rays", ["viewpoint 1, x", "viewpoint 1, z"])];
    for (panel, [first, second]) in fields {
        press(&mut harness, panel);
        for name in [first, second, first, second] {
            find(&harness, name).focus();
            (0..3).for_each(|_| harness.step());
        }
        harness.key_press(Key::Escape);
        (0..3).for_each(|_| harness.step());
        assert!(!harness.state().is_changed(), "{panel}: {:?}", now(&harness));
    }
    enter(&mut harness, "viewpoint 1, x", "7000");
    find(&harness, "viewpoint 1, z").focus();
    (0..3).for_each(|_| harness.step());
    assert!(harness.state().is_changed());
}

/// A small generator of numbers (Knuth's MMIX constants).
fn throw(dice: &mut u64, sides: u64) -> u64 {
    *dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*dice >> 33) % sides
}

#[test]
fn random_gestures_are_undone_one_by_one() {
    let folder = tempfile::tempdir().expect("folder");
    for seed in 1..=4 {
        let (mut harness, mut dice) = (window(&folder), seed);
        let mut states = vec![now(&harness)];
        let mut names = Vec::new();
        for _ in 0..14 {
            let (what, by) = (throw(&mut dice, 10), 20.0 + throw(&mut dice, 40) as f32);
            let text = format!("{}", 200 + throw(&mut dice, 500));
            match what {
                0 => drag_picture(&mut harness),
                1 => {
                    let middle = middle(&harness);
                    drag(&mut harness, middle, vec2(by, 9.0), PointerButton::Secondary);
                }
                2 => wheel(&mut harness, 20),
                3 => harness.key_press(Key::ArrowLeft),
                4 | 5 => {
                    press(&mut harness, "Layers");
                    match what {
                        4 => enter(&mut harness, "Title", &text),
                        _ => press(&mut harness, "trail must be seen"),
                    }
                }
                6 | 7 => {
                    press(&mut harness, "Look");
                    let names = ["field of view, degrees", "sun from, degrees"];
                    let slider =
                        harness.get_all_by_label(names[usize::from(what == 7)]).next().expect("a slider").rect();
                    drag(&mut harness, slider.left_center() + vec2(40.0, 0.0), vec2(by, 0.0), PointerButton::Primary);
                }
                _ => {
                    press(&mut harness, "Export");
                    match what {
                        8 => enter(&mut harness, "Width, pixels", &text),
                        _ => {
                            let field = find(&harness, "Height, pixels").rect().center();
                            drag(&mut harness, field, vec2(by, 0.0), PointerButton::Primary);
                        }
                    }
                }
            }
            (0..2).for_each(|_| harness.step());
            let after = now(&harness);
            if after != *states.last().expect("the first") {
                states.push(after);
                names.push(what);
            }
        }
        assert!(states.len() > 8, "seed {seed}: {names:?}");
        for (k, before) in states.iter().enumerate().rev().skip(1) {
            undo(&mut harness, Modifiers::NONE);
            assert_eq!(*now(&harness), **before, "seed {seed}: step {k} of {names:?}");
        }
        undo(&mut harness, Modifiers::NONE);
        assert!(!harness.state().is_changed(), "seed {seed}: {names:?}");
    }
}
