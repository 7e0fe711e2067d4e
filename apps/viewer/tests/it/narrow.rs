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
