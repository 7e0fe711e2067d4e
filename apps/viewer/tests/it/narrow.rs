//! Longer languages in small windows: nothing is cut off at the side of its panel, menu or window.

use crate::{opened, press, scene, settle};
use belvedere_viewer::{Opening, Viewer};
use eframe::egui::{Rect, accesskit::Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

type Window = Harness<'static, Viewer>;

/// The panels of a window in German and in French, and the words for its picture and its sheet.
const TONGUES: [(&str, [&str; 6], &str, &str); 2] = [
    ("de", ["Ebenen", "Darstellung", "Sehstrahlen", "Gelände", "Spline", "Export"], "Bild", "Leiste zeigen"),
    ("fr", ["Couches", "Aspect", "Rayons", "Relief", "Spline", "Export"], "Image", "Montrer le panneau"),
];

fn window(language: &str, size: [f32; 2], opening: Opening) -> Window {
    let opening = Opening { language: language.into(), ..opening };
    let builder = Harness::builder().with_size(size).with_max_steps(4);
    let mut harness = builder.build_eframe(move |cc| Viewer::new(&cc.egui_ctx, &opening));
    settle(&mut harness);
    harness
}

/// Notes what reaches beyond the right edge of `room`, of what begins within it.
fn look(harness: &mut Window, place: &str, room: Rect, wrong: &mut Vec<String>) {
    (0..8).for_each(|_| harness.step());
    for node in harness.root().children_recursive() {
        let told = node.accesskit_node();
        let words = told.label().or(told.value()).unwrap_or_default();
        let is_shown = matches!(
            told.role(),
            Role::Label | Role::Button | Role::CheckBox | Role::ComboBox | Role::Slider | Role::SpinButton
        );
        if !is_shown || words.is_empty() {
            continue;
        }
        let rect = node.rect();
        let over = rect.right() - room.right();
        if room.contains(rect.left_center()) && over > 1.0 {
            wrong.push(format!("{place}: {words:?} reaches {over:.0} points beyond {:.0}", room.right()));
        }
    }
}

fn assert_none(wrong: &[String]) {
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn panels_hold_their_words_in_german_and_french() {
    let folder = tempfile::tempdir().expect("folder");
    let mut wrong = Vec::new();
    for (language, panels, picture, show) in TONGUES {
        for size in [[800.0, 600.0], [390.0, 844.0]] {
            let mut harness = window(language, size, opened(&[scene(folder.path())]));
            let whole = Rect::from_min_size(eframe::egui::Pos2::ZERO, size.into());
            let is_small = size[0] < 600.0;
            if is_small {
                press(&mut harness, show);
            }
            for panel in panels {
                // A kind of layer may have the name of a panel.
                let tabs: Vec<_> = harness.get_all_by_label(panel).collect();
                tabs.iter().find(|node| node.accesskit_node().role() == Role::Button).expect("a tab").click();
                harness.step();
                let seen = harness.get_by_label(picture).rect();
                let share = seen.area() / (size[0] * size[1]);
                assert!(share >= 0.6, "{language}, {panel}: the picture has {share} of the window");
                let room = if is_small { whole } else { whole.with_min_y(seen.top()).with_max_x(seen.left() - 7.0) };
                look(&mut harness, &format!("{language} {size:?} {panel}"), room, &mut wrong);
            }
            let menu = if language == "de" { "Ansicht" } else { "Affichage" };
            press(&mut harness, menu);
            look(&mut harness, &format!("{language} {size:?} {menu}"), whole, &mut wrong);
        }
    }
    assert_none(&wrong);
}

#[test]
fn the_welcome_holds_its_words_in_german_and_french() {
    let mut wrong = Vec::new();
    for (language, ..) in TONGUES {
        let opening = Opening { language: language.into(), ..Opening::default() };
        let mut harness = crate::app(&opening);
        for size in [[800.0, 600.0], [390.0, 844.0]] {
            harness.set_size(size.into());
            let whole = Rect::from_min_size(eframe::egui::Pos2::ZERO, size.into());
            look(&mut harness, &format!("{language} {size:?} welcome"), whole, &mut wrong);
        }
    }
    assert_none(&wrong);
}

/// A scene with a layer of each kind that has a style of its own, coloured by property where that goes.
fn styled(folder: &std::path::Path) -> std::path::PathBuf {
    let feature = |i: i32, shape: &str| {
        let kinds = ["track", "path", "unclassified"];
        let [x, y] = [-1500 + 300 * (i % 8), -1500 + 300 * (i / 3)];
        let at = |dx: i32, dy: i32| format!("[{}, {}]", x + dx, y + dy);
        let coordinates = match shape {
            "Point" => at(0, 0),
            "LineString" => format!("[{}, {}]", at(0, 0), at(200, 700)),
            _ => format!("[[{}, {}, {}, {}]]", at(0, 0), at(200, 0), at(200, 200), at(0, 0)),
        };
        format!(
            r#"{{"type": "Feature", "properties": {{"kind": "{}", "amount": {}, "name": "N {i}"}}, "geometry": {{"type": "{shape}", "coordinates": {coordinates}}}}}"#,
            kinds[i as usize % 3],
            i * i
        )
    };
    for (name, shape) in [("ways", "LineString"), ("lakes", "Polygon"), ("huts", "Point")] {
        let all: Vec<String> = (0..9).map(|i| feature(i, shape)).collect();
        let text = format!(r#"{{"type": "FeatureCollection", "features": [{}]}}"#, all.join(","));
        std::fs::write(folder.join(format!("{name}.geojson")), text).expect("file");
    }
    let path = folder.join("styled.toml");
    let text = r##"
format = 1
crs = "local"
[camera]
eye = [0.0, -6000.0, 5000.0]
look_at = [0.0, 0.0, 0.0]
image = [160, 90]
[[layer]]
kind = "terrain"
id = "ground"
source = "builtin:massif?seed=7&size=65"
[[layer]]
kind = "line"
id = "ways"
source = "ways.geojson"
must_see = true
style = { labels = true, color_by = { property = "kind" }, width_by = { property = "amount", px = [1, 6] } }
[[layer]]
kind = "area"
id = "lakes"
source = "lakes.geojson"
style = { color_by = { property = "amount", steps = "equal" } }
[[layer]]
kind = "point"
id = "huts"
source = "huts.geojson"
style = { labels = true, color_by = { property = "amount", steps = "smooth" }, size_by = { property = "amount", px = [4, 20] } }
[[layer]]
kind = "boxes"
id = "towers"
boxes = [{ base = [0, 0, 900], size = [200, 200, 400] }]
[[layer]]
kind = "city"
id = "town"
source = "builtin:town?seed=7&size=500"
style = { ambient_occlusion = 40.0 }
"##;
    std::fs::write(&path, text).expect("scene");
    path
}

/// Notes what a panel and the help over each of its controls cut off.
fn look_at_all(harness: &mut Window, place: &str, room: Rect, whole: Rect, wrong: &mut Vec<String>) {
    look(harness, place, room, wrong);
    let controls: Vec<Rect> = harness
        .root()
        .children_recursive()
        .filter(|node| matches!(node.accesskit_node().role(), Role::Button | Role::CheckBox | Role::ComboBox))
        .map(|node| node.rect())
        .filter(|rect| room.contains(rect.center()))
        .collect();
    assert!(!controls.is_empty(), "{place} has no controls");
    for rect in controls {
        harness.hover_at(rect.center());
        // The help comes some time after the pointer.
        (0..4).for_each(|_| harness.step());
        for node in harness.root().children_recursive() {
            let told = node.accesskit_node();
            if told.role() != Role::Label || told.bounding_box().is_none() {
                continue;
            }
            let rect = node.rect();
            if !room.contains(rect.left_center())
                && whole.contains(rect.left_center())
                && rect.right() > whole.right() + 1.0
            {
                wrong.push(format!("{place}, help: {:?}", told.label().or(told.value())));
            }
        }
    }
    harness.hover_at(whole.right_bottom() - eframe::egui::vec2(4.0, 4.0));
}

#[test]
fn styles_turns_and_presets_hold_their_words_in_german_and_french() {
    let folder = tempfile::tempdir().expect("folder");
    let path = styled(folder.path());
    let size = [800.0, 3000.0];
    let whole = Rect::from_min_size(eframe::egui::Pos2::ZERO, size.into());
    let mut wrong = Vec::new();
    for (language, panels, picture, _) in TONGUES {
        let [style, turn] =
            if language == "de" { ["Stil von", "Biegung hinzufügen"] } else { ["Style de", "Ajouter un virage"] };
        let mut harness = window(language, size, opened(std::slice::from_ref(&path)));
        let seen = harness.get_by_label(picture).rect();
        let room = whole.with_min_y(seen.top()).with_max_x(seen.left() - 7.0);
        for layer in ["ways", "lakes", "huts", "towers", "town"] {
            press(&mut harness, &format!("{style} {layer}"));
            settle(&mut harness);
            // It opens by and by, and its properties are read.
            let by = if language == "de" { "gefärbt nach" } else { "coloré selon" };
            if ["ways", "lakes", "huts"].contains(&layer) {
                crate::wait_for(&mut harness, "the properties", |harness| {
                    harness.query_by_label(&format!("{layer} {by}")).is_some()
                });
            }
            (0..20).for_each(|_| harness.step());
        }
        look_at_all(&mut harness, &format!("{language} styles"), room, whole, &mut wrong);
        let tab = |harness: &mut Window, name: &str| {
            let tabs: Vec<_> = harness.get_all_by_label(name).collect();
            tabs.iter().find(|node| node.accesskit_node().role() == Role::Button).expect("a tab").click();
            harness.step();
        };
        tab(&mut harness, panels[2]);
        press(&mut harness, turn);
        settle(&mut harness);
        look_at_all(&mut harness, &format!("{language} turns"), room, whole, &mut wrong);
        tab(&mut harness, panels[4]);
        press(&mut harness, "progressive");
        settle(&mut harness);
        look_at_all(&mut harness, &format!("{language} presets"), room, whole, &mut wrong);
    }
    assert_none(&wrong);
}

#[test]
fn the_residues_of_a_molecule_hold_their_words_in_german_and_french() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("dna.toml");
    let text = "format = 1\n[camera]\neye = [0, -90, 20]\nlook_at = [0, 0, 20]\nimage = [160, 90]\n\
        [[layer]]\nkind = 'molecule'\nid = 'dna'\nsource = 'builtin:dna?pairs=6&seed=7'\n";
    std::fs::write(&path, text).expect("scene");
    let size = [800.0, 900.0];
    let whole = Rect::from_min_size(eframe::egui::Pos2::ZERO, size.into());
    let mut wrong = Vec::new();
    for (language, _, picture, _) in TONGUES {
        let mut harness = window(language, size, opened(std::slice::from_ref(&path)));
        let seen = harness.get_by_label(picture).rect();
        let room = whole.with_min_y(seen.top()).with_max_x(seen.left() - 7.0);
        look_at_all(&mut harness, &format!("{language} residues"), room, whole, &mut wrong);
    }
    assert_none(&wrong);
}
