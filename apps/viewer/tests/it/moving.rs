//! The camera by pointer and keyboard.

use crate::{app, find, opened, press, scene, settle};
use belvedere::scene_file::PointDoc;
use belvedere_viewer::{Opening, Viewer};
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;

fn eye(harness: &Harness<'_, Viewer>) -> [f64; 3] {
    match harness.state().document().camera.eye {
        PointDoc::Scene(eye) => eye,
        PointDoc::Map(_) => panic!("the eye is a rule"),
    }
}

#[test]
fn a_drag_moves_the_ground_under_the_pointer_and_is_one_step() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    let before = eye(&harness);
    let middle = find(&harness, "Picture").rect().center() + vec2(0.0, 60.0);
    harness.drag_at(middle);
    harness.step();
    for k in 1..=10 {
        harness.hover_at(middle + vec2(8.0 * k as f32, 3.0 * k as f32));
        harness.step();
    }
    harness.drop_at(middle + vec2(80.0, 30.0));
    settle(&mut harness);
    let after = eye(&harness);
    assert!((after[0] - before[0]).hypot(after[1] - before[1]) > 50.0, "{before:?} {after:?}");
    assert_eq!(after[2], before[2], "a map is dragged level");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(eye(&harness), before);
}

#[test]
fn keys_do_what_the_pointer_does() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    let mut last = eye(&harness);
    for (modifiers, key) in [
        (Modifiers::NONE, Key::ArrowLeft),
        (Modifiers::NONE, Key::ArrowUp),
        (Modifiers::SHIFT, Key::ArrowRight),
        (Modifiers::SHIFT, Key::ArrowUp),
        (Modifiers::NONE, Key::Plus),
        (Modifiers::NONE, Key::Minus),
        (Modifiers::NONE, Key::F),
    ] {
        harness.key_press_modifiers(modifiers, key);
        settle(&mut harness);
        let now = eye(&harness);
        assert_ne!(now, last, "{key:?}");
        last = now;
    }
}

#[test]
fn views_are_bookmarked_beyond_the_window_and_compared() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = Opening { state: Some(folder.path().join("state")), ..opened(&[scene(folder.path())]) };
    let mut harness = app(&opening);
    settle(&mut harness);
    let before = eye(&harness);
    harness.key_press(Key::B);
    harness.step();
    drop(harness);
    let mut harness = app(&opening);
    settle(&mut harness);
    harness.key_press(Key::ArrowLeft);
    settle(&mut harness);
    assert_ne!(eye(&harness), before);
    press(&mut harness, "Places");
    press(&mut harness, "View 1");
    settle(&mut harness);
    let again = eye(&harness);
    assert!(before.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-6), "{before:?} {again:?}");
    press(&mut harness, "Look");
    press(&mut harness, "Split");
    settle(&mut harness);
    find(&harness, "Bar between straight and bent");
}

#[test]
fn a_strip_along_a_route_is_drawn_while_the_camera_moves_and_at_rest() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let text = std::fs::read_to_string(&path).expect("scene");
    std::fs::write(&path, text + "[[stage]]\nkind = \"strip\"\nalong = \"trail\"\n").expect("scene");
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    let before = eye(&harness);
    for key in [Key::ArrowUp, Key::Plus, Key::Space, Key::ArrowLeft] {
        harness.key_press_modifiers(Modifiers::NONE, key);
        settle(&mut harness);
    }
    assert_ne!(eye(&harness), before);
    assert_eq!(harness.state().document().stage[0].kind(), "strip");
    assert!(find(&harness, "Picture").rect().width() > 100.0);
}

#[test]
fn each_drag_is_a_step_of_its_own() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    let middle = find(&harness, "Picture").rect().center() + vec2(0.0, 60.0);
    let mut eyes = vec![eye(&harness)];
    for way in [vec2(60.0, 20.0), vec2(-30.0, 40.0)] {
        harness.drag_at(middle);
        harness.step();
        for k in 1..=4 {
            harness.hover_at(middle + way * (k as f32 / 4.0));
            harness.step();
        }
        harness.drop_at(middle + way);
        settle(&mut harness);
        eyes.push(eye(&harness));
    }
    assert!(eyes.windows(2).all(|pair| pair[0] != pair[1]), "{eyes:?}");
    for before in eyes.iter().rev().skip(1) {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut harness);
        assert_eq!(eye(&harness), *before);
    }
}

/// Left and right go across the view, up and down along it, level both; two opposite keys end where they began.
#[test]
fn arrow_keys_go_along_and_across_the_view_and_opposite_ones_cancel() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    let from = eye(&harness);
    // The scene looks at the middle of its ground.
    let ahead = [-from[0], -from[1]];
    let right = [ahead[1], -ahead[0]];
    for (there, back, way) in [
        (Key::ArrowUp, Key::ArrowDown, ahead),
        (Key::ArrowDown, Key::ArrowUp, ahead.map(|x| -x)),
        (Key::ArrowRight, Key::ArrowLeft, right),
        (Key::ArrowLeft, Key::ArrowRight, right.map(|x| -x)),
    ] {
        harness.key_press(there);
        settle(&mut harness);
        let by = [0, 1, 2].map(|i| eye(&harness)[i] - from[i]);
        let (along, length) = (by[0] * way[0] + by[1] * way[1], by[0].hypot(by[1]) * way[0].hypot(way[1]));
        assert!(length > 0.0 && along > (1.0 - 1e-6) * length && by[2].abs() < 1e-6, "{there:?}: {by:?}, not {way:?}");
        harness.key_press(back);
        settle(&mut harness);
        let now = eye(&harness);
        assert!(now.iter().zip(from).all(|(a, b)| (a - b).abs() < 1e-6), "{there:?} and {back:?}: {now:?}");
    }
}
