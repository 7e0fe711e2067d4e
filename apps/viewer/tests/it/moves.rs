//! Ground that is moved by hand: placed by a click, dragged in the picture, set by numbers, taken away.

use crate::{app, find, opened, press, scene, settle};
use belvedere::scene_file::{MoveDoc, MoveKindDoc, StageDoc};
use belvedere_viewer::Viewer;
use eframe::egui::{Key, Modifiers, Pos2, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

type Window = Harness<'static, Viewer>;

fn moves(harness: &Window) -> Vec<MoveDoc> {
    let stages = &harness.state().document().stage;
    let found = stages.iter().find_map(|s| if let StageDoc::GroundMoves(s) = s { Some(s.moves.clone()) } else { None });
    found.unwrap_or_default()
}

fn window(folder: &std::path::Path) -> Window {
    let mut harness = app(&opened(&[scene(folder)]));
    settle(&mut harness);
    press(&mut harness, "Terrain");
    settle(&mut harness);
    harness
}

fn click(harness: &mut Window, at: Pos2) {
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    settle(harness);
}

fn drag(harness: &mut Window, name: &str, by: Vec2) -> Pos2 {
    let at = find(harness, name).rect().center();
    harness.drag_at(at);
    harness.step();
    for k in 1..=6 {
        harness.hover_at(at + by * (k as f32 / 6.0));
        harness.step();
        harness.step();
    }
    harness.drop_at(at + by);
    settle(harness);
    at
}

/// A place on the ground in the middle of the picture.
fn middle(harness: &Window) -> Pos2 {
    find(harness, "Picture").rect().center() + vec2(60.0, 60.0)
}

#[test]
fn a_summit_is_raised_by_a_click_and_a_drag() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(folder.path());
    let before = harness.state().document().clone();
    press(&mut harness, "Raise");
    assert!(harness.query_by_label("Click the place in the picture.").is_some());
    let at = middle(&harness);
    click(&mut harness, at);
    assert!(harness.query_by_label("Click the place in the picture.").is_none());
    let [one] = &moves(&harness)[..] else { panic!("{:?}", moves(&harness)) };
    let (kind, by) = (one.kind, one.by_m.expect("a height"));
    assert!(kind == MoveKindDoc::Raise && by > 0.0 && one.reach_m > 500.0, "{one:?}");
    let name = "Move 1 in the picture: Raise";
    let stood = drag(&mut harness, name, vec2(0.0, -40.0));
    let raised = moves(&harness)[0].by_m.expect("a height");
    let stands = find(&harness, name).rect().center();
    assert!(raised > by + 50.0, "{by} became {raised}");
    // The ground goes with the handle.
    assert!((stands - stood - vec2(0.0, -40.0)).length() < 6.0, "{stood:?} to {stands:?}");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(moves(&harness)[0].by_m, Some(by), "the drag is one step");
    press(&mut harness, "Remove move 1");
    settle(&mut harness);
    assert_eq!(harness.state().document().stage, before.stage, "nothing is left of it");
}

#[test]
fn ground_is_shifted_where_the_pointer_takes_it() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(folder.path());
    press(&mut harness, "Shift");
    let at = middle(&harness);
    click(&mut harness, at);
    assert_eq!(moves(&harness)[0].shift_m, Some([0.0, 0.0]));
    let name = "Move 1 in the picture: Shift";
    for by in [vec2(50.0, 0.0), vec2(-10.0, 25.0)] {
        let stood = drag(&mut harness, name, by);
        let stands = find(&harness, name).rect().center();
        assert!((stands - stood - by).length() < 6.0, "{stood:?} to {stands:?} by {by:?}");
    }
    let shift = moves(&harness)[0].shift_m.expect("a shift");
    assert!(shift[0].hypot(shift[1]) > 100.0, "{shift:?}");
    // What was moved is said.
    assert!(harness.query_by_label_contains("moved by up to").is_some() || harness.state().is_judged());
}

#[test]
fn a_turn_and_a_valley_along_a_line_have_handles_and_keys() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = window(folder.path());
    press(&mut harness, "Turn");
    let at = middle(&harness);
    click(&mut harness, at);
    for name in ["Widen", "Straighten"] {
        press(&mut harness, name);
        // The last one of that name is in the open menu.
        harness.get_all_by_label("trail").last().expect("the layer").click();
        harness.step();
        settle(&mut harness);
    }
    let kinds: Vec<MoveKindDoc> = moves(&harness).iter().map(|m| m.kind).collect();
    assert_eq!(kinds, [MoveKindDoc::Turn, MoveKindDoc::Widen, MoveKindDoc::Straighten]);
    for (k, name) in ["Turn", "Widen", "Straighten"].into_iter().enumerate() {
        let name = format!("Move {} in the picture: {name}", k + 1);
        let Some(handle) = harness.query_by_label(&name) else { continue };
        handle.focus();
        harness.step();
        let before = moves(&harness);
        harness.key_press(Key::ArrowUp);
        settle(&mut harness);
        let after = moves(&harness);
        let value = |m: &MoveDoc| m.angle_deg.or(m.by_m).or(m.share).unwrap_or_default();
        assert!(value(&after[k]) > value(&before[k]), "{name}: {:?} {:?}", before[k], after[k]);
        assert!((0..3).all(|i| i == k || after[i] == before[i]));
    }
    assert!(harness.query_by_label("Move 1 in the picture: Turn").is_some());
    // Handles are those of the open panel.
    press(&mut harness, "Layers");
    settle(&mut harness);
    assert!(harness.query_by_label("Move 1 in the picture: Turn").is_none());
}
