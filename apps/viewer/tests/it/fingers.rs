//! The camera by one and two fingers.

use crate::{app, find, opened, scene, settle};
use belvedere::core::{DVec2, DVec3, Pinhole, Projection};
use belvedere::scene_file::PointDoc;
use belvedere_viewer::Viewer;
use eframe::egui::{Event, Modifiers, PointerButton, Pos2, TouchDeviceId, TouchId, TouchPhase, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

type Window = Harness<'static, Viewer>;

fn touch(harness: &Window, finger: u64, phase: TouchPhase, pos: Pos2) {
    let (device_id, id) = (TouchDeviceId(1), TouchId(finger));
    harness.event(Event::Touch { device_id, id, phase, pos, force: None });
    // As the window's shell does, the first finger is a pointer, too.
    if finger == 0 {
        match phase {
            TouchPhase::Start | TouchPhase::Move => harness.event(Event::PointerMoved(pos)),
            TouchPhase::End | TouchPhase::Cancel => {}
        }
        if phase != TouchPhase::Move {
            let (button, pressed) = (PointerButton::Primary, phase == TouchPhase::Start);
            harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        }
        if phase == TouchPhase::End {
            harness.event(Event::PointerGone);
        }
    }
}

/// The move of a finger, in the next frame together with those of others.
fn slide(harness: &mut Window, finger: u64, pos: Pos2) {
    let (device_id, id, phase) = (TouchDeviceId(1), TouchId(finger), TouchPhase::Move);
    let events = &mut harness.input_mut().events;
    events.push(Event::Touch { device_id, id, phase, pos, force: None });
    if finger == 0 {
        events.push(Event::PointerMoved(pos));
    }
}

/// Puts fingers on the picture, moves them in steps, and lifts them.
fn gesture(harness: &mut Window, from: &[Pos2], to: &[Pos2]) {
    for (finger, at) in (0..).zip(from) {
        touch(harness, finger, TouchPhase::Start, *at);
        harness.step();
    }
    for k in 1..=8 {
        for (finger, (a, b)) in (0..).zip(from.iter().zip(to)) {
            slide(harness, finger, a.lerp(*b, k as f32 / 8.0));
        }
        harness.step();
    }
    for (finger, at) in (0..).zip(to) {
        touch(harness, finger, TouchPhase::End, *at);
    }
    settle(harness);
}

fn pinhole(harness: &Window) -> (Pinhole, DVec3) {
    let camera = &harness.state().document().camera;
    let at = |point: &PointDoc| match point {
        PointDoc::Scene(p) => DVec3::from_array(*p),
        PointDoc::Map(_) => panic!("a rule"),
    };
    let (eye, target) = (at(&camera.eye), at(camera.look_at.as_ref().expect("a point")));
    let lens = Projection::Perspective { fov_y: camera.fov_y_deg.to_radians() };
    (Pinhole::look_at(eye, target, DVec3::Z, lens, camera.image, 1.0, None).expect("camera"), target)
}

fn ready(folder: &std::path::Path) -> (Window, Pos2) {
    let mut harness = app(&opened(&[scene(folder)]));
    settle(&mut harness);
    let middle = find(&harness, "Picture").rect().center();
    (harness, middle)
}

#[test]
fn one_finger_drags_the_map() {
    let folder = tempfile::tempdir().expect("folder");
    let (mut harness, middle) = ready(folder.path());
    let (before, _) = pinhole(&harness);
    gesture(&mut harness, &[middle + vec2(0.0, 60.0)], &[middle + vec2(90.0, 80.0)]);
    let (after, _) = pinhole(&harness);
    assert!(after.eye.distance(before.eye) > 50.0 && (after.eye.z - before.eye.z).abs() < 1e-9);
}

#[test]
fn two_fingers_apart_go_nearer_to_the_point_between_them_in_one_step() {
    let folder = tempfile::tempdir().expect("folder");
    let (mut harness, middle) = ready(folder.path());
    let document = harness.state().document().clone();
    let (before, target) = pinhole(&harness);
    let by = |x: f32| [middle - vec2(x, 0.0), middle + vec2(x, 0.0)];
    gesture(&mut harness, &by(60.0), &by(120.0));
    let (after, near) = pinhole(&harness);
    let ratio = before.eye.distance(target) / after.eye.distance(near);
    assert!((1.9..2.1).contains(&ratio), "twice as near, not {ratio}");
    assert!(after.forward.distance(before.forward) < 0.02, "a pinch does not turn");
    harness.key_press_modifiers(Modifiers::COMMAND, eframe::egui::Key::Z);
    settle(&mut harness);
    assert_eq!(*harness.state().document(), document, "a gesture is one step");
}

#[test]
fn the_picture_turns_with_two_fingers() {
    let folder = tempfile::tempdir().expect("folder");
    let (mut harness, middle) = ready(folder.path());
    let (before, target) = pinhole(&harness);
    // A quarter of a turn clockwise, by way of an eighth.
    let at = |degrees: f32| {
        let arm = 100.0 * eframe::egui::Vec2::angled(degrees.to_radians());
        [middle - arm, middle + arm]
    };
    gesture(&mut harness, &at(0.0), &at(40.0));
    let (after, _) = pinhole(&harness);
    let heading = |p: &Pinhole| p.forward.truncate().to_angle();
    let turned = (heading(&after) - heading(&before)).to_degrees();
    assert!((25.0..55.0).contains(&turned), "{turned} degrees");
    assert!((after.eye.distance(target) / before.eye.distance(target) - 1.0).abs() < 0.35);
    // A point to the right of the middle goes down, as the finger there does.
    let right = target + 300.0 * before.right;
    let pixel = |p: &Pinhole| p.project(right).expect("in front").0;
    let by: DVec2 = pixel(&after) - pixel(&before);
    assert!(by.y > 1.0, "{by}");
}

#[test]
fn two_fingers_up_or_down_together_tilt() {
    let folder = tempfile::tempdir().expect("folder");
    let (mut harness, middle) = ready(folder.path());
    let at = |y: f32| [middle + vec2(-50.0, y), middle + vec2(50.0, y)];
    let steepness = |harness: &Window| -pinhole(harness).0.forward.z;
    let (before, distance) = (steepness(&harness), pinhole(&harness).0.eye.distance(pinhole(&harness).1));
    gesture(&mut harness, &at(0.0), &at(80.0));
    let steeper = steepness(&harness);
    assert!(steeper > before + 0.1, "{before} {steeper}");
    gesture(&mut harness, &at(80.0), &at(0.0));
    assert!((steepness(&harness) - before).abs() < 0.02, "up again");
    let after = pinhole(&harness);
    assert!((after.0.eye.distance(after.1) / distance - 1.0).abs() < 1e-6, "a tilt keeps the distance");
}

#[test]
fn a_long_press_opens_the_menu_of_the_place() {
    let folder = tempfile::tempdir().expect("folder");
    let (mut harness, middle) = ready(folder.path());
    let at = middle + vec2(30.0, 60.0);
    touch(&harness, 0, TouchPhase::Start, at);
    for _ in 0..6 {
        harness.step();
    }
    touch(&harness, 0, TouchPhase::End, at);
    harness.step();
    harness.step();
    crate::press(&mut harness, "Measure from here");
    harness.step();
    assert!(harness.query_by_label("Measured point 1").is_some());
}
