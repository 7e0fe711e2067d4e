//! Preset documents: files, selection, interpolation, styling sections, warnings.

use crate::spline_figures::{bend, camera_at};
use belvedere_core::map::spline::{PresetWarning, check_presets};
use belvedere_core::presets::{BUILTIN_NAMES, BendFrame, DepthUnits, Ease, Preset, PresetDocument, PresetError};
use belvedere_core::sections::{StylingSections, TagPoint};
use belvedere_testkit::Random;
use serde_json::{Value, json};

/// The example of the file format.
const EXAMPLE: &str = r#"
{ "version": 1, "frame": "camera", "units": "absolute", "pin": true, "ease": "linear", "follow": false,
  "presets": [ { "name": "low", "phi": 25, "tau": 3, "s": 900, "e": 2600, "a": 0.1, "b": 0.6,
                 "control": [[0,-0.22],[0.45,-0.12],[0.80,0.05],[0.98,0.62]],
                 "tags": [{"u": 0.4, "delta": 0.05}], "sections": ["loa0", "loa1"] } ] }"#;

fn example() -> PresetDocument {
    serde_json::from_str(EXAMPLE).unwrap()
}

#[test]
fn the_example_reads_alike_from_json_and_toml() {
    let text = r#"
        version = 1
        [[presets]]
        name = "low"
        phi = 25.0
        tau = 3.0
        s = 900.0
        e = 2600.0
        a = 0.1
        b = 0.6
        control = [[0.0, -0.22], [0.45, -0.12], [0.80, 0.05], [0.98, 0.62]]
        tags = [{ u = 0.4, delta = 0.05 }]
        sections = ["loa0", "loa1"]"#;
    let from_toml: PresetDocument = toml::from_str(text).unwrap();
    assert_eq!(example(), from_toml);
    example().validate().unwrap();
}

#[test]
fn defaults_are_those_of_the_format() {
    let text = r#"{"version": 1, "presets": [{"phi": 30, "s": 1, "e": 2, "control": [[0,0],[0.3,0],[0.6,0],[1,0]]}]}"#;
    let d: PresetDocument = serde_json::from_str(text).unwrap();
    d.validate().unwrap();
    assert_eq!(
        (d.frame, d.units, d.pin, d.ease, d.follow),
        (BendFrame::Camera, DepthUnits::Absolute, true, Ease::Linear, false)
    );
    let p = &d.presets[0];
    assert_eq!((p.tau, p.a, p.b, p.tags.len(), p.sections.as_slice()), (0.0, 0.0, 1.0, 0, &["all".to_owned()][..]));
    assert!(p.fov_y_deg.is_none() && p.knots.is_none());
}

#[test]
fn documents_survive_a_round_trip() {
    for name in BUILTIN_NAMES {
        let document = PresetDocument::builtin(name).unwrap();
        let json = serde_json::to_string(&document).unwrap();
        assert_eq!(serde_json::from_str::<PresetDocument>(&json).unwrap(), document, "{name}");
        let toml = toml::to_string(&document).unwrap();
        assert_eq!(toml::from_str::<PresetDocument>(&toml).unwrap(), document, "{name}");
    }
    for (name, field) in [("identity(35)", 35.0), (" identity( -2.5 ) ", -2.5)] {
        assert_eq!(PresetDocument::builtin(name).unwrap().presets[0].phi, field);
    }
    assert_eq!(PresetDocument::builtin("hybrid_flat_steep_flat"), PresetDocument::builtin("hybrid-flat-steep-flat"));
    let error = PresetDocument::builtin("progresive").unwrap_err();
    assert!(error.to_string().contains("progressive, degressive"), "{error}");
    for name in ["identity(nan)", "identity(91)", "identity(", "identity()", ""] {
        assert!(PresetDocument::builtin(name).is_err(), "{name}");
    }
}

#[test]
fn unusable_documents_are_refused_with_the_reason() {
    let refused = |change: fn(&mut Value), expected: &str| {
        let mut value: Value = serde_json::from_str(EXAMPLE).unwrap();
        change(&mut value);
        let text = match serde_json::from_value::<PresetDocument>(value) {
            Ok(document) => document.validate().unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        assert!(text.contains(expected), "expected {expected:?} in {text:?}");
    };
    refused(|v| v["version"] = json!(2), "version 2");
    refused(|v| v["presets"] = json!([]), "0 presets");
    refused(|v| v["presets"][0]["e"] = json!(900), "does not exceed near depth");
    refused(|v| v["presets"][0]["e"] = json!(-5), "does not exceed near depth");
    refused(|v| v["presets"][0]["control"] = json!([[1, 1], [1, 1], [1, 1], [1, 1]]), "at least 1e-9");
    refused(|v| v["presets"][0]["control"][1] = json!([1e9, 0]), "control is 1e9");
    refused(|v| v["presets"][0]["control"] = json!([[0, 0], [1, 1], [2, 2]]), "at least 4");
    refused(|v| v["presets"][0]["control"] = json!([[1, 0], [0.6, 0], [0.3, 0], [0, 0]]), "near to far");
    refused(|v| v["presets"][0]["control"][1] = json!([0.1, 0.2, 0.3]), "");
    refused(|v| v["presets"][0]["knots"] = json!([0, 0, 0, 0, 1, 1, 1]), "need 8");
    refused(|v| v["presets"][0]["knots"] = json!([0, 0, 0, 0.5, 1, 1, 1, 1]), "not clamped");
    refused(|v| v["presets"][0]["tags"][0]["u"] = json!(1.5), "tag u is 1.5");
    refused(|v| v["presets"][0]["tags"][0]["delta"] = json!(-0.1), "tag delta is -0.1");
    refused(|v| v["presets"][0]["sections"] = json!(["one"]), "exactly 2 are needed");
    refused(|v| v["presets"][0]["a"] = json!(0.7), "b is 0.6");
    refused(|v| v["presets"][0]["tau"] = json!(-1), "tau is -1");
    refused(|v| v["presets"][0]["phi"] = json!(120), "phi is 120");
    refused(|v| v["presets"][0]["fov_y_deg"] = json!(180), "fov_y_deg is 180");
    refused(|v| v["presets"][0]["colour"] = json!(1), "unknown field `colour`");
    refused(|v| v["framed"] = json!(1), "unknown field `framed`");
    refused(|v| v["frame"] = json!("eye"), "unknown variant");
    refused(|v| _ = v.as_object_mut().unwrap().remove("version"), "missing field `version`");
    refused(
        |v| {
            v["presets"][0]["tags"] = json!([{"u": 0.5, "delta": 0.0}, {"u": 0.4, "delta": 0.0}]);
            v["presets"][0]["sections"] = json!(["a", "b", "c"]);
        },
        "sort the tags",
    );
    refused(
        |v| {
            let twin = v["presets"][0].clone();
            v["presets"].as_array_mut().unwrap().push(twin);
        },
        "same phi = 25",
    );
}

#[test]
fn numbers_that_are_none_are_refused_everywhere() {
    let edits: [fn(&mut Preset, f64); 10] = [
        |p, v| p.phi = v,
        |p, v| p.tau = v,
        |p, v| p.s = v,
        |p, v| p.e = v,
        |p, v| p.a = v,
        |p, v| p.b = v,
        |p, v| p.control[2][1] = v,
        |p, v| p.tags[0].u = v,
        |p, v| p.tags[0].delta = v,
        |p, v| p.fov_y_deg = Some(v),
    ];
    for (i, edit) in edits.into_iter().enumerate() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut document = example();
            edit(&mut document.presets[0], value);
            assert!(matches!(document.validate(), Err(PresetError::NotFinite { .. })), "edit {i} to {value}");
        }
    }
    let mut document = example();
    document.presets[0].knots = Some(vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, f64::NAN]);
    assert!(document.validate().unwrap_err().to_string().contains("knot 7 is not a finite"));
}

fn three(phi_tau: [(f64, f64); 3]) -> PresetDocument {
    let mut document = PresetDocument::builtin("demo").unwrap();
    document.presets.truncate(3);
    for (preset, (phi, tau)) in document.presets.iter_mut().zip(phi_tau) {
        (preset.phi, preset.tau) = (phi, tau);
    }
    document
}

#[test]
fn selection_follows_the_printed_formula_with_plateaus() {
    let document = three([(20.0, 3.0), (40.0, 4.0), (80.0, 0.0)]);
    let expect = [
        (-30.0, "low", 0.0),
        (20.0, "low", 0.0),
        (23.0, "low", 0.0),
        (29.5, "low", 0.5),
        (36.0, "low", 1.0),
        (39.999, "low", 1.0),
        (40.0, "medium", 0.0),
        (44.0, "medium", 0.0),
        (62.0, "medium", 0.5),
        (80.0, "medium", 1.0),
        (90.0, "medium", 1.0),
    ];
    for (phi, start, sigma) in expect {
        let s = document.select(phi).unwrap();
        assert_eq!(s.start.name, start, "at {phi}");
        assert!((s.sigma - sigma).abs() < 1e-12, "at {phi}: {}", s.sigma);
    }
    let single = PresetDocument::builtin("map").unwrap();
    let s = single.select(12.0).unwrap();
    assert_eq!((s.start, s.target, s.sigma, s.beta()), (&single.presets[0], &single.presets[0], 0.0, 0.0));
    let smooth = PresetDocument { ease: Ease::Smoothstep, ..document };
    assert!((smooth.select(26.25).unwrap().sigma - 0.15625).abs() < 1e-12);
    assert!(PresetDocument { presets: vec![], ..smooth }.select(3.0).is_none());
}

#[test]
fn selection_is_continuous_also_where_plateaus_overlap() {
    for phi_tau in [[(20.0, 3.0), (40.0, 4.0), (80.0, 5.0)], [(20.0, 30.0), (21.0, 40.0), (80.0, 70.0)]] {
        let document = three(phi_tau);
        let place = |phi: f64| {
            let s = document.select(phi).unwrap();
            let first = document.sorted().iter().position(|p| *p == s.start).unwrap();
            first as f64 + s.sigma
        };
        let mut last = place(0.0);
        for i in 1..=90_000 {
            let now = place(f64::from(i) * 1e-3);
            assert!(now >= last && now - last < 0.06, "{phi_tau:?}: from {last} to {now} at {i}e-3 degrees");
            last = now;
        }
        assert_eq!((place(0.0), last), (0.0, 2.0));
    }
}

#[test]
fn presets_with_different_numbers_of_points_and_tags_interpolate() {
    let mut document = three([(20.0, 0.0), (40.0, 0.0), (80.0, 0.0)]);
    document.presets[1].control = PresetDocument::builtin("hybrid-flat-steep-flat").unwrap().presets[0].control.clone();
    document.presets[1].tags = vec![TagPoint { u: 0.2, delta: 0.04 }];
    document.presets[1].sections = vec!["loa0".to_owned(), "loa2".to_owned()];
    document.validate().unwrap();
    let mut last = None;
    for i in 0..=700 {
        let phi = 15.0 + 0.1 * f64::from(i);
        let b = bend(&document, &camera_at(phi, 1000.0));
        let shape: Vec<f64> = (0..=20)
            .flat_map(|k| {
                let (p, _) = b.curve().at(b.curve().length() * f64::from(k) / 20.0);
                let shown =
                    ["loa0", "loa1", "loa2"].map(|id| b.sections().representation_weight(id, f64::from(k) / 20.0));
                [p.x, p.y, shown[0], shown[1], shown[2]]
            })
            .collect();
        if let Some(before) = last.replace(shape.clone()) {
            let before: Vec<f64> = before;
            let step = shape.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(step < 0.15, "step of {step} at {phi}");
        }
    }
    // At its own angle a preset shows exactly its own sections.
    let own = StylingSections::new(
        document.presets[1].tags.clone(),
        document.presets[1].sections.clone(),
        document.presets[1].sections.clone(),
        0.0,
    )
    .unwrap();
    for phi in [39.999_999_999, 40.0] {
        let b = bend(&document, &camera_at(phi, 1000.0));
        for k in 0..=100 {
            let t = f64::from(k) / 100.0;
            for id in ["loa0", "loa1", "loa2"] {
                let (is, want) = (b.sections().representation_weight(id, t), own.representation_weight(id, t));
                assert!((is - want).abs() < 1e-6, "{id} at {t}, phi {phi}: {is} instead of {want}");
            }
        }
    }
}

#[test]
fn section_weights_are_a_partition_whatever_the_tags() {
    let mut random = Random::new(77);
    for round in 0..2000 {
        let count = random.below(5);
        let tags: Vec<TagPoint> = (0..count)
            .map(|_| TagPoint {
                u: random.range(-0.1, 1.1),
                delta: if random.unit() < 0.3 { 0.0 } else { random.unit() },
            })
            .collect();
        let names = |random: &mut Random| (0..=count).map(|_| ["x", "y", "z"][random.below(3)].to_owned()).collect();
        let (start, target) = (names(&mut random), names(&mut random));
        let sections = StylingSections::new(tags.clone(), start, target, random.unit()).unwrap();
        assert_eq!(sections.len(), count + 1);
        for k in -10..=110 {
            let t = f64::from(k) / 100.0;
            let w = sections.weights(t);
            assert!(w.iter().all(|&w| (0.0..=1.0).contains(&w)), "round {round}: {w:?} at {t} for {tags:?}");
            assert!((w.iter().sum::<f64>() - 1.0).abs() <= 4.5e-16, "round {round}: {w:?} at {t} for {tags:?}");
            let shown: f64 = sections.representations().iter().map(|id| sections.representation_weight(id, t)).sum();
            assert!((shown - 1.0).abs() < 1e-15, "round {round}: {shown} at {t}");
        }
    }
    let nan = StylingSections::plain().weights(f64::NAN);
    assert_eq!(nan, [1.0]);
    assert!(StylingSections::new(vec![], vec![], vec![], 0.0).is_none());
    assert!(StylingSections::new(vec![], vec!["a".into()], vec!["b".into()], f64::NAN).is_none());
}

#[test]
fn section_weights_ramp_over_twice_delta_and_keep_the_extensions() {
    let ids = |names: [&str; 3]| names.map(str::to_owned).to_vec();
    let tags = vec![TagPoint { u: 0.3, delta: 0.1 }, TagPoint { u: 0.7, delta: 0.0 }];
    let sections = StylingSections::new(tags, ids(["a", "b", "c"]), ids(["b", "b", "d"]), 0.25).unwrap();
    for (t, want) in [
        (-2.0, [1.0, 0.0, 0.0]),
        (0.2, [1.0, 0.0, 0.0]),
        (0.25, [0.75, 0.25, 0.0]),
        (0.4, [0.0, 1.0, 0.0]),
        (0.699, [0.0, 1.0, 0.0]),
        (0.7, [0.0, 0.0, 1.0]),
        (3.0, [0.0, 0.0, 1.0]),
    ] {
        for (is, want) in sections.weights(t).into_iter().zip(want) {
            assert!((is - want).abs() < 1e-12, "at {t}: {is} instead of {want}");
        }
    }
    assert_eq!(sections.representations(), ["a", "b", "c", "d"]);
    assert!((sections.representation_weight("b", 0.25) - (0.75 * 0.25 + 0.25)).abs() < 1e-12);
    assert_eq!(sections.representation_weight("d", 1.0), 0.25);
    assert_eq!(sections.representation_weight("no such", 0.5), 0.0);
}

#[test]
fn check_warns_of_what_will_look_bad() {
    for name in BUILTIN_NAMES.into_iter().filter(|&n| n != "identity") {
        let warnings = check_presets(&PresetDocument::builtin(name).unwrap(), 1000.0, Some([-50.0, 90.0]));
        assert_eq!(warnings, [], "{name}");
    }
    let hybrid = PresetDocument::builtin("hybrid-flat-steep-flat").unwrap();
    let folds = check_presets(&hybrid, 300.0, Some([-20.0, 90.0]));
    assert!(matches!(folds[..], [PresetWarning::Folds { data_max: 90.0, .. }]), "{folds:?}");

    let mut document = three([(25.0, 10.0), (42.0, 8.0), (80.0, 0.0)]);
    document.presets[2].tags = [0.2, 0.5, 0.8].map(|u| TagPoint { u, delta: 0.06 }).to_vec();
    document.presets[2].sections = ["a", "b", "c", "d"].map(str::to_owned).to_vec();
    document.presets[1].control[3][1] = 0.9;
    let warnings = check_presets(&document, 1000.0, None);
    let count = |f: fn(&PresetWarning) -> bool| warnings.iter().filter(|w| f(w)).count();
    assert_eq!(count(|w| matches!(w, PresetWarning::PlateausOverlap { .. })), 1, "{warnings:?}");
    assert_eq!(count(|w| matches!(w, PresetWarning::ManySections { sections: 4, .. })), 1, "{warnings:?}");
    assert_eq!(count(|w| matches!(w, PresetWarning::WideTransition { .. })), 3, "{warnings:?}");
    let mut rising = PresetDocument::builtin("progressive").unwrap();
    rising.presets[0].control = vec![[0.0, -0.2], [0.3, 0.35], [0.5, 0.5], [1.0, 0.55]];
    let warnings = check_presets(&rising, 1000.0, None);
    assert!(warnings.iter().any(|w| matches!(w, PresetWarning::FacesAway { .. })), "{warnings:?}");
}

/// Lists of equal length are matched by index, as in the paper: sections blend in place and do not slide.
#[test]
fn sections_of_equal_number_blend_where_they_stand() {
    let mut document = three([(25.0, 2.0), (55.0, 2.0), (80.0, 0.0)]);
    let sections = [["A", "B"], ["B", "A"]];
    for (preset, (sections, (u, delta))) in
        document.presets.iter_mut().zip(sections.into_iter().zip([(0.3, 0.1), (0.5, 0.05)]))
    {
        preset.sections = sections.map(str::to_owned).to_vec();
        preset.tags = vec![TagPoint { u, delta }];
    }
    document.presets.truncate(2);
    let middle = document.select(40.0).unwrap();
    let sections = middle.interpolate(45.0).unwrap().sections;
    assert_eq!((middle.sigma, sections.beta(), sections.len()), (0.5, 0.8, 2));
    let tag = sections.tags()[0];
    assert!((tag.u - 0.4).abs() < 1e-12 && (tag.delta - 0.075).abs() < 1e-12, "{tag:?}");
    let weight = |id: &str, t: f64| sections.representation_weight(id, t);
    assert!((weight("A", 0.0) - 0.2).abs() < 1e-12 && (weight("A", 1.0) - 0.8).abs() < 1e-12);
    for i in 0..=100 {
        let t = f64::from(i) / 100.0;
        let far = ((t - 0.325) / 0.15).clamp(0.0, 1.0);
        assert!((weight("A", t) - (0.2 * (1.0 - far) + 0.8 * far)).abs() < 1e-12, "at {t}");
        assert!((weight("A", t) + weight("B", t) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn two_presets_of_one_name_are_refused_and_nameless_ones_are_not() {
    let mut document = three([(20.0, 0.0), (40.0, 0.0), (80.0, 0.0)]);
    document.presets[2].name = "low".into();
    let error = document.validate().unwrap_err().to_string();
    assert!(error.contains("two presets are named \"low\" (phi = 20 and 80 degrees)"), "{error}");
    document.presets.iter_mut().for_each(|p| p.name.clear());
    document.validate().unwrap();
}
