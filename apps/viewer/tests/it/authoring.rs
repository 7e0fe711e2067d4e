//! A preset of one's own, from the template, by hand.

use crate::{app, find, opened, press, scene, settle};
use belvedere::picture::PictureOptions;
use belvedere::scene_file::{PresetsDoc, StageDoc};
use belvedere::{OpenOptions, Session};
use eframe::egui::{Key, Modifiers, vec2};

#[test]
fn a_progressive_preset_is_made_from_the_template_saved_and_drawn_elsewhere() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let mut harness = app(&opened(std::slice::from_ref(&path)));
    settle(&mut harness);
    let mut operations = 0;
    let mut done = || operations += 1;
    press(&mut harness, "Spline");
    done();
    press(&mut harness, "Presets");
    press(&mut harness, "progressive");
    done();
    settle(&mut harness);
    press(&mut harness, "Capture camera");
    done();
    settle(&mut harness);
    // The far end of the curve is raised by hand.
    let handle = find(&harness, "Control point 4").rect().center();
    harness.drag_at(handle);
    harness.step();
    for k in 1..=5 {
        harness.hover_at(handle + vec2(0.0, -4.0 * k as f32));
        harness.step();
    }
    harness.drop_at(handle + vec2(0.0, -20.0));
    done();
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    done();
    harness.step();
    harness.step();
    assert!(operations <= 15, "{operations} operations");

    let document = harness.state().document().clone();
    let [StageDoc::SplineBend(stage)] = document.stage.as_slice() else { panic!("no spline: {:?}", document.stage) };
    let PresetsDoc::Inline(presets) = &stage.presets else { panic!("the preset is not the user's own") };
    let template = belvedere::core::presets::PresetDocument::builtin("progressive").expect("built in");
    assert!(presets.presets[0].control[3][1] > template.presets[0].control[3][1], "nothing was raised");

    let drawn = |session: Session| session.render(&PictureOptions::default()).expect("drawn").frame.color;
    let file = Session::open(&path, &OpenOptions::default()).expect("saved scene");
    let source = belvedere::scene_file::SourceDocument::new((*document).clone());
    let here = Session::from_document(source, &OpenOptions::default()).expect("document");
    assert!(file.view().is_bent());
    assert!(drawn(file) == drawn(here), "the saved scene is drawn to another picture");
}
