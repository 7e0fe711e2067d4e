//! Authoring of presets: what operations do, what they refuse, and that none gives an invalid document.

use belvedere_core::DVec2;
use belvedere_core::presets::edit::{EditError, PresetChange, PresetHistory, PresetOperation};
use belvedere_core::presets::{BUILTINS, PresetDocument};
use belvedere_testkit::Random;

fn demo() -> PresetDocument {
    PresetDocument::builtin("demo").unwrap()
}

fn after(document: &PresetDocument, operations: &[&str]) -> PresetDocument {
    operations.iter().fold(document.clone(), |document, text| {
        document
            .edited(&text.parse().unwrap_or_else(|e| panic!("{text}: {e}")))
            .unwrap_or_else(|e| panic!("{text}: {e}"))
    })
}

fn refused(document: &PresetDocument, text: &str) -> String {
    match text.parse::<PresetOperation>() {
        Ok(operation) => document.edited(&operation).expect_err(text).to_string(),
        Err(e) => e.to_string(),
    }
}

#[test]
fn every_alias_means_its_document() {
    for builtin in BUILTINS {
        let document = PresetDocument::builtin(builtin.name).unwrap();
        for alias in builtin.aliases {
            assert_eq!(PresetDocument::builtin(&alias.replace('-', "_")).unwrap(), document, "{alias}");
        }
    }
}

#[test]
fn a_point_more_leaves_the_curve_as_it_is() {
    for t in [0.1, 1.0 / 3.0, 0.5, 0.9] {
        for name in ["progressive", "hybrid-flat-steep-flat"] {
            let old = PresetDocument::builtin(name).unwrap();
            let new = after(&old, &[&format!("1.add-point={t}")]);
            assert_eq!(new.presets[0].control.len(), old.presets[0].control.len() + 1);
            let [a, b] = [&old, &new].map(|d| d.presets[0].spline().unwrap());
            for i in 0..=200 {
                let t = f64::from(i) / 200.0;
                assert!(a.point(t).distance(b.point(t)) < 1e-12);
            }
            // The added point is removed again: as many points and knots as before.
            let back = after(&new, &["1.remove-point=2"]);
            assert_eq!(back.presets[0].control.len(), old.presets[0].control.len());
        }
    }
}

#[test]
fn operations_do_what_they_say() {
    let preset = |d: &PresetDocument, name: &str| d.presets.iter().find(|p| p.name == name).unwrap().clone();
    let d = after(
        &demo(),
        &[
            "low.point.2=0.5,-0.1",
            "low.phi=20",
            "low.tau=2",
            "low.range=0.3, 1.7",
            "low.fade=0.2,0.4",
            "low.fov=30",
            "pin=false",
        ],
    );
    let low = preset(&d, "low");
    assert_eq!((low.control[1], low.phi, low.tau, low.s, low.e), ([0.5, -0.1], 20.0, 2.0, 0.3, 1.7));
    assert_eq!((low.a, low.b, low.fov_y_deg, d.pin), (0.2, 0.4, Some(30.0), false));
    let d = after(&d, &["low.split=3", "low.section.4=map", "low.tag.3=0.95", "low.width.3=0.5", "low.fov=none"]);
    let low = preset(&d, "low");
    assert_eq!(low.sections, ["loa0", "loa1", "loa2", "map"]);
    assert!((low.tags[2].u - 0.95).abs() < 1e-12 && (low.tags[2].delta - 0.025).abs() < 1e-12, "{:?}", low.tags);
    assert_eq!((preset(&after(&d, &["low.merge=3"]), "low").sections.len(), low.fov_y_deg), (3, None));
    // Borders never pass each other.
    let pushed = preset(&after(&d, &["low.tag.1=1"]), "low");
    assert!(pushed.tags[0].u < pushed.tags[1].u && pushed.tags[0].u > low.tags[1].u - 0.01);
    let d = after(&demo(), &["high.duplicate=top, 88", "add=steep-flat,far,10", "top.name=plan", "low.remove"]);
    let names: Vec<&str> = d.presets.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["medium", "high", "horizon", "plan", "far"]);
}

#[test]
fn a_tag_is_dragged_to_the_nearest_place_of_the_curve() {
    let curve = |d: &PresetDocument| {
        belvedere_core::deformation::DeformationCurve::new(&d.presets[0].spline().unwrap()).unwrap()
    };
    let c = curve(&demo());
    for u in [0.2, 0.4, 0.55] {
        let (p, tangent) = c.at(u * c.length());
        let beside = p + 0.02 * tangent.perp();
        let d = after(&demo(), &[&format!("low.tag.1={},{}", beside.x, beside.y)]);
        assert!((d.presets[0].tags[0].u - u).abs() < 1e-6, "{u}: {}", d.presets[0].tags[0].u);
    }
}

#[test]
fn corners_are_made_softened_and_taken_back() {
    let smooth = PresetDocument::builtin("progressive").unwrap();
    let hard = after(&smooth, &["1.corner=2"]);
    assert_eq!(hard.presets[0].control[1], hard.presets[0].control[2]);
    assert_eq!(after(&hard, &["1.corner=3"]), smooth);
    // The spread of the design: curvature falls to about a fifth.
    let hybrid = PresetDocument::builtin("flat-steep-flat").unwrap();
    let sharpest = |d: &PresetDocument| {
        let curve = belvedere_core::deformation::DeformationCurve::new(&d.presets[0].spline().unwrap()).unwrap();
        curve.curvature_range().map(f64::abs).into_iter().fold(0.0, f64::max)
    };
    let [before, soft] = [sharpest(&hybrid), sharpest(&after(&hybrid, &["1.soften=1"]))];
    assert!(soft < 0.4 * before, "{before} {soft}");
    assert_eq!(after(&hybrid, &["1.soften=0"]), hybrid);
}

#[test]
fn mirrored_twice_is_as_before_and_once_turns_progressive_into_degressive() {
    let slopes = |d: &PresetDocument| {
        let curve = belvedere_core::deformation::DeformationCurve::new(&d.presets[0].spline().unwrap()).unwrap();
        [0.0, curve.length()].map(|l| curve.at(l).1.to_angle().to_degrees())
    };
    let old = PresetDocument::builtin("progressive").unwrap();
    let new = after(&old, &["1.mirror"]);
    let ([a, b], [c, d]) = (slopes(&old), slopes(&new));
    assert!((a - d).abs() < 1e-9 && (b - c).abs() < 1e-9 && a > b);
    for (p, q) in after(&new, &["1.mirror"]).presets[0].control.iter().zip(&old.presets[0].control) {
        assert!(DVec2::from(*p).distance(DVec2::from(*q)) < 1e-15);
    }
}

#[test]
fn what_cannot_be_done_is_said_and_leaves_the_document() {
    let d = demo();
    for (text, why) in [
        ("lo.phi=3", "there is no preset \"lo\"; there are \"low\", \"medium\", \"high\""),
        ("low.point.9=0,0", "preset \"low\": there is no control point 9; there are 4, counted from 1"),
        ("low.remove-point=2", "preset \"low\": a curve needs 4 control points; add one before you remove one"),
        ("low.corner=1", "preset \"low\": control point 1 is an end of the curve; make a corner of one between"),
        ("low.soften=1", "preset \"low\": no control point is doubled; make a corner first"),
        ("low.add-point=2", "preset \"low\": curve parameter is 2, it must be in 0.000001..=0.999999"),
        ("low.point.1=NaN,0", "preset \"low\": control is not a finite number; give a finite value"),
        ("low.range=5,4", "preset \"low\": far depth e = 4 does not exceed near depth s = 5; give e > s"),
        ("low.phi=50", "presets \"low\" and \"medium\" have the same phi = 50 degrees; change one of them"),
        ("low.merge=3", "preset \"low\": section 3 is the last one; merge the one before it"),
        ("low.tag.3=0.5", "preset \"low\": there is no tag 3; there are 2, counted from 1"),
        ("low.name=high", "there is a preset \"high\" already; give another name"),
        ("low.duplicate=high,3", "there is a preset \"high\" already; give another name"),
    ] {
        let said = refused(&d, text);
        assert!(said.starts_with(why), "{text}: {said}");
    }
    for text in [
        "",
        "low",
        "low.phi",
        "low.phi=",
        "low.phi=x",
        "low.point=1,2",
        "low.point.x=1,2",
        "low.tau.2=1",
        "low.mirror=1",
        "a.b.c.d=1",
        "frame=sky",
        "pin=perhaps",
        "add=map",
        "low.tag.1=1,2,3",
        "low.duplicate=x",
    ] {
        assert!(matches!(text.parse::<PresetOperation>(), Err(EditError::Text { .. })), "{text}");
    }
    assert!(refused(&PresetDocument::builtin("map").unwrap(), "1.remove").contains("add another one first"));
}

#[test]
fn histories_go_back_and_forth() {
    let mut history = PresetHistory::new(demo());
    let texts = ["low.phi=20", "medium.mirror", "high.remove"];
    let mut states = vec![demo()];
    for text in texts {
        history.apply(&text.parse().unwrap()).unwrap();
        states.push(history.document().clone());
    }
    assert!(history.apply(&"low.phi=99".parse().unwrap()).is_err());
    for state in states.iter().rev().skip(1) {
        assert!(history.undo());
        assert_eq!(history.document(), state);
    }
    assert!(!history.undo());
    assert!(history.redo() && history.document() == &states[1]);
    history.apply(&"pin=false".parse().unwrap()).unwrap();
    assert!(!history.redo());
}

#[test]
fn whatever_is_done_ends_in_a_valid_document_or_an_error() {
    let mut random = Random::new(77);
    let mut done = 0;
    for round in 0..300 {
        let mut history = PresetHistory::new(PresetDocument::builtin(BUILTINS[round % 8].name).unwrap());
        for _ in 0..40 {
            let number = random.range(0.0, 6.0) as usize;
            let [x, y, z] = [(); 3].map(|()| random.range(-0.3, 1.3));
            let change = match random.range(0.0, 15.0) as usize {
                0 => PresetChange::MovePoint(number, [x, y]),
                1 => PresetChange::AddPoint(x),
                2 => PresetChange::RemovePoint(number),
                3 => PresetChange::Corner(number),
                4 => PresetChange::Soften(x),
                5 => PresetChange::MoveTag(number, [x, y]),
                6 => PresetChange::PlaceTag(number, x),
                7 => PresetChange::TagWidth(number, x),
                8 => PresetChange::Section(number, format!("s{number}")),
                9 => PresetChange::Split(number),
                10 => PresetChange::Merge(number),
                11 => PresetChange::Range([x, y]),
                12 => PresetChange::Phi(90.0 * z),
                13 => PresetChange::Mirror,
                _ => PresetChange::Duplicate { name: format!("p{number}"), phi: 90.0 * z },
            };
            let preset = (1 + random.range(0.0, 3.0) as usize).to_string();
            let before = history.clone();
            match history.apply(&PresetOperation::Preset { preset, change }) {
                Ok(()) => {
                    done += 1;
                    history.document().validate().unwrap();
                    let mut undone = history.clone();
                    assert!(undone.undo() && undone.document() == before.document());
                }
                Err(_) => assert_eq!(history, before),
            }
        }
    }
    assert!(done > 3000, "{done}");
}

#[test]
fn what_neighbours_stop_is_said() {
    let said = |text: &str| {
        let operation: PresetOperation = text.parse().unwrap();
        let (document, clamped) = demo().edited_saying(&operation).unwrap();
        assert_eq!(document, demo().edited(&operation).unwrap());
        clamped.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    for fine in ["low.tag.1=0.4", "low.width.1=0.1", "low.phi=3", "low.tag.2=0.7", "follow=false"] {
        assert_eq!(said(fine), [""; 0], "{fine}");
    }
    let stopped = said("low.tag.1=0.9");
    assert!(stopped[0].contains("tag 1 is 0.6657, not 0.9000"), "{stopped:?}");
    assert!(stopped[1].contains("half width of the transition at tag 1"), "{stopped:?}");
    assert!(said("low.width.2=0.5")[0].contains("is 0.1667, not 0.5000"));
    // Dragged in the plane of the curve to beyond its far end.
    assert_eq!(said("low.tag.1=2,2").len(), 2);
    assert_eq!(said("low.tag.2=2,2").len(), 2);
}
