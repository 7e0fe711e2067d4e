//! Measuring along the ground in the picture.

use crate::{app, find, opened, press, scene, settle};
use belvedere::core::DVec3;
use belvedere_viewer::Viewer;
use eframe::egui::{Key, OutputCommand, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use serde_json::Value;

type Window = Harness<'static, Viewer>;

fn click(harness: &mut Window, at: Pos2) {
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.step();
    // The next click is no second one of a double click.
    (0..8).for_each(|_| harness.step());
}

/// Presses a button and returns what it copied.
fn copied(harness: &mut Window, button: &str) -> String {
    find(harness, button).click();
    for _ in 0..3 {
        harness.step();
        let commands = &harness.output().platform_output.commands;
        if let Some(OutputCommand::CopyText(text)) = commands.first() {
            return text.clone();
        }
    }
    panic!("nothing was copied");
}

/// Length, climb and descent along the ground by many small steps over the drawn surface.
fn by_small_steps(session: &belvedere::Session, points: &[DVec3]) -> [f64; 3] {
    let ground = session.scene().terrain().expect("terrain");
    let [mut length, mut climb, mut descent] = [0.0f64; 3];
    for pair in points.windows(2) {
        let at = |k: u32| {
            let xy = pair[0].truncate().lerp(pair[1].truncate(), f64::from(k) / 40_000.0);
            xy.extend(ground.surface_at(xy).expect("ground"))
        };
        for k in 0..40_000 {
            let (a, b) = (at(k), at(k + 1));
            length += a.distance(b);
            climb += (b.z - a.z).max(0.0);
            descent += (a.z - b.z).max(0.0);
        }
    }
    [length, climb, descent]
}

fn points_of(json: &Value) -> Vec<DVec3> {
    let list = json["features"][0]["geometry"]["coordinates"].as_array().expect("a line");
    let point = |p: &Value| DVec3::from_array([0, 1, 2].map(|i| p[i].as_f64().expect("a number")));
    list.iter().map(point).collect()
}

#[test]
fn clicked_points_are_measured_along_the_ground_also_through_a_bend() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let session = belvedere::Session::open(&path, &belvedere::OpenOptions::default()).expect("scene");
    let text = std::fs::read_to_string(&path).expect("scene");
    let bent = folder.path().join("bent.toml");
    std::fs::write(&bent, text + "[[stage]]\nkind = \"spline_bend\"\npresets = \"progressive\"\n").expect("scene");
    let ground = session.scene().terrain().expect("terrain");
    for (file, is_bent) in [(path, false), (bent, true)] {
        let mut harness = app(&opened(&[file]));
        settle(&mut harness);
        harness.key_press(Key::M);
        harness.step();
        harness.step();
        find(&harness, "Click points in the picture; a second click on the last one or Escape ends.");
        let picture = find(&harness, "Picture").rect();
        let middle = picture.center() + vec2(0.0, 0.1 * picture.height());
        for by in [vec2(-120.0, 30.0), vec2(90.0, 40.0), vec2(60.0, -10.0)] {
            click(&mut harness, middle + by);
        }
        let json: Value = serde_json::from_str(&copied(&mut harness, "Copy as GeoJSON")).expect("JSON");
        let points = points_of(&json);
        assert_eq!(points.len(), 3);
        for point in &points {
            let height = ground.surface_at(point.truncate()).expect("on the ground");
            assert!((height - point.z).abs() < 1e-6, "{point} lies off the ground at {height}");
        }
        let of = &json["features"][0]["properties"];
        let [length, climb, descent] = by_small_steps(&session, &points);
        for (name, expected) in [("along_ground", length), ("climb", climb), ("descent", descent)] {
            let said = of[name].as_f64().expect("a number");
            assert!((said - expected).abs() < 1e-5 * length, "{name}: {said}, {expected}");
        }
        let [a, b, c] = [points[0], points[1], points[2]].map(|p| p.truncate());
        let area = 0.5 * (b - a).perp_dot(c - a).abs();
        assert!((of["area_in_plan"].as_f64().expect("area") - area).abs() < 1e-6 * area);
        let text = copied(&mut harness, "Copy as text");
        assert!(text.contains("along the ground\t") && text.lines().count() == 9, "{text}");
        find(&harness, "Height profile");
        let said = harness.query_by_label("Lengths are of true space, not of the bent picture.").is_some();
        assert_eq!(said, is_bent, "whether lengths are those of the picture is said where they are not");
    }
}

#[test]
fn points_are_dragged_and_a_double_click_or_escape_ends() {
    let folder = tempfile::tempdir().expect("folder");
    let opening = opened(&[scene(folder.path())]);
    // Every event is a frame of its own, and two clicks are to be a double click.
    let builder = Harness::builder().with_size([1200.0, 760.0]).with_max_steps(4).with_step_dt(0.04);
    let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    settle(&mut harness);
    let before = harness.state().document().clone();
    press(&mut harness, "Look");
    press(&mut harness, "Measure");
    let middle = find(&harness, "Picture").rect().center() + vec2(0.0, 60.0);
    click(&mut harness, middle + vec2(-100.0, 0.0));
    click(&mut harness, middle + vec2(100.0, 0.0));
    let length = |harness: &mut Window| {
        let json: Value = serde_json::from_str(&copied(harness, "Copy as GeoJSON")).expect("JSON");
        json["features"][0]["properties"]["along_ground"].as_f64().expect("a number")
    };
    let short = length(&mut harness);
    let handle = find(&harness, "Measured point 2").rect().center();
    harness.drag_at(handle);
    harness.step();
    for k in 1..=6 {
        harness.hover_at(handle + vec2(12.0 * k as f32, 0.0));
        harness.step();
    }
    harness.drop_at(handle + vec2(72.0, 0.0));
    harness.step();
    let long = length(&mut harness);
    assert!(long > 1.15 * short, "{short} {long}");
    // A double click sets its point once and ends.
    let last = middle + vec2(40.0, 60.0);
    harness.hover_at(last);
    harness.step();
    for _ in 0..2 {
        harness.drag_at(last);
        harness.drop_at(last);
        harness.hover_at(last);
    }
    harness.step();
    harness.step();
    find(&harness, "Measured point 3");
    assert!(harness.query_by_label("Measured point 4").is_none());
    click(&mut harness, middle + vec2(-40.0, 60.0));
    assert!(harness.query_by_label("Measured point 4").is_none(), "it did not end");
    // Nothing of it is an edit of the scene.
    assert_eq!(*harness.state().document(), before);
    harness.key_press(Key::M);
    harness.step();
    harness.step();
    click(&mut harness, middle);
    assert!(harness.query_by_label("Measured point 2").is_none(), "a new measurement begins");
    harness.key_press(Key::Escape);
    harness.step();
    click(&mut harness, middle + vec2(30.0, 30.0));
    assert!(harness.query_by_label("Measured point 2").is_none(), "Escape ends");
    press(&mut harness, "Close the measurement");
    assert!(harness.query_by_label("Measured point 1").is_none());
}

#[test]
fn a_second_click_on_the_last_point_ends_however_late() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Look");
    press(&mut harness, "Measure");
    let middle = find(&harness, "Picture").rect().center() + vec2(0.0, 60.0);
    click(&mut harness, middle + vec2(-100.0, 0.0));
    click(&mut harness, middle + vec2(100.0, 0.0));
    // A click on another point than the last one changes nothing.
    let first = find(&harness, "Measured point 1").rect().center();
    click(&mut harness, first);
    let last = find(&harness, "Measured point 2").rect().center();
    (0..120).for_each(|_| harness.step());
    click(&mut harness, last);
    assert!(harness.query_by_label("Measured point 3").is_none(), "it set a point");
    click(&mut harness, middle);
    find(&harness, "Measured point 2");
    assert!(harness.query_by_label("Measured point 3").is_none(), "it did not end");
}
