//! Handles in the picture: planes of turns and control points of the curve.

use crate::{app, find, opened, press, scene, settle};
use belvedere::scene_file::{PresetsDoc, StageDoc, TurnDoc};
use belvedere_viewer::Viewer;
use eframe::egui::{Key, Modifiers, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

type Window = Harness<'static, Viewer>;

fn turn(harness: &Window) -> TurnDoc {
    let Some(StageDoc::CurvedRays(stage)) = harness.state().document().stage.first() else { panic!("no turn") };
    stage.turn[0].clone()
}

/// Drags a handle in steps, and tells a value after each.
fn dragged<T>(harness: &mut Window, name: &str, by: Vec2, steps: i32, tell: impl Fn(&Window) -> T) -> Vec<T> {
    let at = find(harness, name).rect().center();
    harness.drag_at(at);
    harness.step();
    let mut told = Vec::new();
    for k in 1..=steps {
        harness.hover_at(at + by * (k as f32 / steps as f32));
        harness.step();
        harness.step();
        told.push(tell(harness));
    }
    harness.drop_at(at + by);
    settle(harness);
    told
}

fn undo(harness: &mut Window) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(harness);
}

fn with_a_turn(folder: &std::path::Path) -> Window {
    let mut harness = app(&opened(&[scene(folder)]));
    settle(&mut harness);
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    settle(&mut harness);
    // The camera from above would cover the picture.
    harness.key_press(Key::O);
    settle(&mut harness);
    harness
}

#[test]
fn a_plane_is_dragged_along_the_view_and_nothing_else_changes() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = with_a_turn(folder.path());
    let before = harness.state().document().clone();
    let original = turn(&harness);
    let along = |t: &TurnDoc| {
        let [a, b] = [original.t0, t.t0];
        let view = [0, 1, 2].map(|i| original.t2[i] - original.t0[i]);
        (0..3).map(|i| (b[i] - a[i]) * view[i]).sum::<f64>()
    };
    let name = "First plane of turn 1 in the picture";
    let nearer = dragged(&mut harness, name, vec2(0.0, 40.0), 6, |harness| along(&turn(harness)));
    assert!(nearer.windows(2).all(|pair| pair[1] <= pair[0]) && nearer[5] < 0.0, "{nearer:?}");
    let after = turn(&harness);
    assert_eq!(TurnDoc { t0: original.t0, ..after.clone() }, original, "something else changed");
    let mut others = (**harness.state().document()).clone();
    others.stage = before.stage.clone();
    assert_eq!(others, *before, "the camera or a layer changed");
    undo(&mut harness);
    assert_eq!(*harness.state().document(), before, "the drag is one step");

    find(&harness, name).focus();
    harness.step();
    harness.key_press(Key::ArrowDown);
    settle(&mut harness);
    assert!(along(&turn(&harness)) < 0.0);
    assert_eq!(TurnDoc { t0: original.t0, ..turn(&harness) }, original);
    undo(&mut harness);
    assert_eq!(*harness.state().document(), before);
}

#[test]
fn handles_are_those_of_the_open_panel_and_leave_the_rest_of_the_picture_to_the_map() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = with_a_turn(folder.path());
    let name = "Last plane of turn 1 in the picture";
    assert!(harness.query_by_label(name).is_some());
    let before = harness.state().document().clone();
    let at = find(&harness, "Picture").rect().center() + vec2(180.0, 120.0);
    harness.drag_at(at);
    harness.step();
    for by in [vec2(10.0, 5.0), vec2(20.0, 10.0)] {
        harness.hover_at(at + by);
        harness.step();
    }
    harness.drop_at(at + vec2(20.0, 10.0));
    settle(&mut harness);
    let after = harness.state().document().clone();
    assert!(after.camera != before.camera && after.stage == before.stage);
    press(&mut harness, "Layers");
    settle(&mut harness);
    assert!(harness.query_by_label(name).is_none());
}

#[test]
fn a_control_point_is_raised_in_the_picture_and_nothing_else_changes() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Spline");
    press(&mut harness, "progressive");
    settle(&mut harness);
    let before = harness.state().document().clone();
    let builtin = belvedere::core::presets::PresetDocument::builtin("progressive").expect("built in");
    let preset = |harness: &Window| match &harness.state().document().stage[..] {
        [StageDoc::SplineBend(stage)] => match &stage.presets {
            PresetsDoc::Inline(presets) => (**presets).clone(),
            PresetsDoc::Named(_) => builtin.clone(),
        },
        other => panic!("{other:?}"),
    };
    let point = (1..=builtin.presets[0].control.len())
        .rev()
        .find(|i| harness.query_by_label(&format!("Control point {i} in the picture")).is_some())
        .expect("a control point in the picture");
    let name = format!("Control point {point} in the picture");
    let height = |harness: &Window| preset(harness).presets[0].control[point - 1][1];
    let raised = dragged(&mut harness, &name, vec2(0.0, -60.0), 6, height);
    assert!(raised.windows(2).all(|pair| pair[1] > pair[0]), "it does not follow the pointer: {raised:?}");
    assert!(raised[5] > builtin.presets[0].control[point - 1][1], "{raised:?}");
    let mut others = preset(&harness);
    others.presets[0].control[point - 1] = builtin.presets[0].control[point - 1];
    assert_eq!(others, builtin, "something else changed");
    undo(&mut harness);
    assert_eq!(*harness.state().document(), before, "the drag is one step");
}
