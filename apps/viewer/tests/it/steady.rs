//! Nothing moves under a pointer that drags, and long constructions tell what they are at.

use crate::{app, find, opened, press, scene, settle};
use belvedere_viewer::Viewer;
use eframe::egui::accesskit::Role;
use eframe::egui::{Rect, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

type Window = Harness<'static, Viewer>;

/// Drags from a place in steps, and looks at the window after each.
fn drag(harness: &mut Window, from: eframe::egui::Pos2, by: Vec2, mut look: impl FnMut(&Window)) {
    harness.hover_at(from);
    harness.step();
    harness.drag_at(from);
    harness.step();
    look(harness);
    for k in 1..=8 {
        harness.hover_at(from + by * (k as f32 / 8.0));
        harness.step();
        harness.step();
        look(harness);
    }
    harness.drop_at(from + by);
    harness.step();
}

fn fields(harness: &Window) -> Vec<Rect> {
    harness.query_all_by_role(Role::SpinButton).map(|node| node.rect()).collect()
}

#[test]
fn the_plot_of_a_curve_and_the_rows_below_it_stay_while_a_point_is_dragged_beyond_its_limit() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = opened(&[scene(folder.path())]);
    // Tall enough that all rows are in sight.
    let builder = Harness::builder().with_size([960.0, 1400.0]).with_max_steps(4);
    let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    settle(&mut harness);
    press(&mut harness, "Spline");
    press(&mut harness, "progressive");
    settle(&mut harness);
    let still = |harness: &Window| {
        ["Control point 1", "Curve of the preset", "Split section 1 in two", "Mirror"]
            .map(|name| find(harness, name).rect())
    };
    let before = still(&harness);
    let handle = find(&harness, "Control point 4").rect().center();
    let mut seen = Vec::new();
    drag(&mut harness, handle, vec2(-30.0, -60.0), |harness| {
        assert_eq!(still(harness), before);
        seen.push(find(harness, "Control point 4").rect().center());
    });
    let under = |k: usize| handle + vec2(-30.0, -60.0) * (k as f32 / 8.0);
    // The point stays under the pointer as far as it may go.
    assert!(seen[2].distance(under(2)) < 3.0, "{:?} {:?}", seen[2], under(2));
    settle(&mut harness);
    // A value stops at its limit, and a sentence says so.
    let still =
        |harness: &Window| ["Curve of the preset", "Split section 1 in two"].map(|name| find(harness, name).rect());
    let before = still(&harness);
    let field = find(&harness, "holds within ± degrees").rect().center();
    drag(&mut harness, field, vec2(2400.0, 0.0), |harness| assert_eq!(still(harness), before));
    assert!(harness.query_by_label_contains("stops at its limit").is_some());
    assert_eq!(still(&harness), before);
}

#[test]
fn the_fields_of_a_turn_keep_their_places_whatever_they_say() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    settle(&mut harness);
    // The window of the camera from above.
    harness.key_press(eframe::egui::Key::O);
    settle(&mut harness);
    let before = fields(&harness);
    assert!(before.len() >= 12, "{}", before.len());
    let document = harness.state().document().clone();
    // Far enough that the turn is not possible any more, and the reason is said.
    drag(&mut harness, before[3].center(), vec2(700.0, 0.0), |harness| {
        let now = fields(harness);
        assert_eq!(now[..12], before[..12]);
    });
    assert_ne!(*harness.state().document(), document);
    settle_or_say(&mut harness);
    assert_eq!(fields(&harness)[..12], before[..12]);
}

/// Runs frames for a while: a document that cannot be drawn never rests.
fn settle_or_say(harness: &mut Window) {
    let began = std::time::Instant::now();
    while !harness.state().rests() && began.elapsed().as_secs_f64() < 3.0 {
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

#[test]
fn a_look_into_what_is_hidden_tells_what_it_is_at_and_is_cancelled() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, include_str!("../../../../scenes/street_probe.toml")).expect("scene");
    let mut harness = app(&opened(&[path]));
    crate::wait_for(&mut harness, "the scene", |harness| !harness.state().is_opening());
    let tells = |harness: &Window| harness.query_by_label_contains("ways").is_some();
    // A machine that is done before a user would wait says nothing.
    crate::wait_for(&mut harness, "the search", |harness| harness.state().rests() || tells(harness));
    if !harness.state().rests() {
        press(&mut harness, "Cancel");
        crate::wait_for(&mut harness, "the way back", |harness| harness.query_by_label("Draw again").is_some());
        assert!(!tells(&harness), "it goes on");
    }
}

#[test]
fn one_click_keeps_a_thing_in_sight_in_place_of_turns_by_hand_and_the_ground_is_refused() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("towers.toml");
    let text = "format = 1\n[camera]\neye = [0, -90, 12]\nlook_at = [0, 0, 12]\nimage = [320, 180]\n\
        [[layer]]\nkind = \"boxes\"\nid = \"towers\"\nboxes = [{ base = [0, 0, 0], size = [60, 8, 40] }]\n";
    std::fs::write(&path, text).expect("scene");
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    settle(&mut harness);
    let by_hand = harness.state().document().clone();
    // The window of the camera from above lies over the picture.
    harness.key_press(eframe::egui::Key::O);
    settle(&mut harness);
    let click = |harness: &mut Window, down: f32| {
        let picture = find(harness, "Picture").rect();
        let at = picture.center() + vec2(0.0, down * picture.height());
        harness.hover_at(at);
        harness.drag_at(at);
        harness.drop_at(at);
        harness.step();
        harness.step();
    };
    press(&mut harness, "To keep something in sight");
    click(&mut harness, 0.0);
    settle(&mut harness);
    let document = harness.state().document().clone();
    let target = document.constructor.as_ref().and_then(|doc| doc.target.clone());
    assert_eq!((target.as_deref(), document.stage.len()), (Some("towers/1"), 0));
    harness.key_press_modifiers(eframe::egui::Modifiers::COMMAND, eframe::egui::Key::Z);
    settle(&mut harness);
    assert_eq!(*harness.state().document(), by_hand);

    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Curved rays");
    press(&mut harness, "To keep something in sight");
    click(&mut harness, 0.45);
    assert!(harness.state().document().constructor.is_none());
    find(&harness, "Click what has to stay in sight.");
}

#[test]
fn of_a_model_the_part_that_was_clicked_is_kept_in_sight() {
    let folder = tempfile::tempdir().expect("folder");
    let square = |name: &str, [a, b]: [i32; 2], k: i32| {
        let corners = format!("v {a} 0 0\nv {b} 0 0\nv {b} 0 24\nv {a} 0 24\n");
        format!("o {name}\n{corners}f {} {} {} {}\n", k + 1, k + 2, k + 3, k + 4)
    };
    let text = square("left", [-40, -2], 0) + &square("right", [2, 40], 4);
    std::fs::write(folder.path().join("two.obj"), text).expect("model");
    let path = folder.path().join("two.toml");
    let text = "format = 1\n[camera]\neye = [0, -90, 12]\nlook_at = [0, 0, 12]\nimage = [320, 180]\n\
        [[layer]]\nkind = \"mesh\"\nid = \"two\"\nsource = \"two.obj\"\n";
    std::fs::write(&path, text).expect("scene");
    for (name, right) in [("left", -0.15), ("right", 0.15)] {
        let mut harness = app(&opened(std::slice::from_ref(&path)));
        settle(&mut harness);
        press(&mut harness, "Curved rays");
        press(&mut harness, "To keep something in sight");
        let picture = find(&harness, "Picture").rect();
        let at = picture.center() + vec2(right * picture.width(), 0.0);
        harness.hover_at(at);
        harness.drag_at(at);
        harness.drop_at(at);
        (0..2).for_each(|_| harness.step());
        let document = harness.state().document().clone();
        let target = document.constructor.as_ref().and_then(|doc| doc.target.clone()).unwrap_or_default();
        assert!(target.contains(name), "{target:?}, not {name}");
    }
}
