//! Authoring of a preset from the template by pointer and keyboard.

use crate::{app, find, opened, press, scene, settle};
use belvedere::picture::PictureOptions;
use belvedere::scene_file::{PresetsDoc, SplineStageDoc, StageDoc};
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

#[test]
fn a_preset_is_copied_for_another_angle_and_taken_away_again() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Spline");
    press(&mut harness, "progressive");
    settle(&mut harness);
    let presets = |harness: &egui_kittest::Harness<'_, belvedere_viewer::Viewer>| {
        let Some(StageDoc::SplineBend(stage)) = harness.state().document().stage.first().cloned() else {
            panic!("no spline")
        };
        match stage.presets {
            PresetsDoc::Inline(presets) => presets.presets.len(),
            PresetsDoc::Named(name) => {
                belvedere::core::presets::PresetDocument::builtin(&name).expect("built in").presets.len()
            }
        }
    };
    let before = presets(&harness);
    press(&mut harness, "Copy for this camera");
    settle(&mut harness);
    assert_eq!(presets(&harness), before + 1);
    find(&harness, "preset 1");
    press(&mut harness, "Remove preset");
    settle(&mut harness);
    assert_eq!(presets(&harness), before);
}

#[test]
fn a_turn_gets_a_pivot_line_and_its_sharpness_by_hand() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    settle(&mut harness);
    let turn = |harness: &egui_kittest::Harness<'_, belvedere_viewer::Viewer>| {
        let Some(StageDoc::CurvedRays(stage)) = harness.state().document().stage.first().cloned() else {
            panic!("no turn")
        };
        stage.turn[0].clone()
    };
    assert!(turn(&harness).line.is_none());
    press(&mut harness, "pivot line of turn 1");
    settle(&mut harness);
    assert!(turn(&harness).line.is_some() && turn(&harness).normal.is_none());
    find(&harness, "Pivot line of turn 1");
    press(&mut harness, "pivot line of turn 1");
    settle(&mut harness);
    assert!(turn(&harness).line.is_none() && turn(&harness).normal.is_some());
    // The handles listen to the arrow keys, too.
    for (handle, key) in [("Sharpness of turn 1", Key::ArrowRight), ("Viewpoint of turn 1", Key::ArrowUp)] {
        let before = turn(&harness);
        find(&harness, handle).focus();
        harness.step();
        harness.key_press(key);
        settle(&mut harness);
        assert_ne!(turn(&harness), before, "{handle}");
    }
}

#[test]
fn turns_by_hand_make_way_for_a_preview_in_one_step_that_is_undone() {
    let folder = tempfile::tempdir().expect("folder");
    let mut harness = app(&opened(&[scene(folder.path())]));
    settle(&mut harness);
    press(&mut harness, "Curved rays");
    press(&mut harness, "Add a turn");
    settle(&mut harness);
    let by_hand = harness.state().document().clone();
    press(&mut harness, "Along a path");
    settle(&mut harness);
    let document = harness.state().document().clone();
    assert!(document.constructor.is_some() && document.stage.is_empty());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(*harness.state().document(), by_hand);
    // The other way round, too.
    press(&mut harness, "Along a path");
    settle(&mut harness);
    press(&mut harness, "Add a turn");
    settle(&mut harness);
    let document = harness.state().document().clone();
    assert!(document.constructor.is_none() && document.stage.len() == 1);
}

#[test]
fn of_several_presets_the_chosen_one_is_edited_and_those_without_a_name_have_a_number() {
    let folder = tempfile::tempdir().expect("folder");
    let path = scene(folder.path());
    let builtin = |name: &str| belvedere::core::presets::PresetDocument::builtin(name).expect("built in");
    let mut own = builtin("progressive");
    own.presets.extend(builtin("map").presets);
    own.presets.iter_mut().for_each(|preset| preset.name.clear());
    let mut editor = belvedere_studio::Editor::open(&path, Vec::new()).expect("scene");
    let stage = SplineStageDoc { presets: PresetsDoc::Inline(Box::new(own.clone())), pivot: None, plane: None };
    editor.edit(|document| document.stage.push(StageDoc::SplineBend(stage)));
    editor.save(&path).expect("saved");
    let mut harness = app(&opened(&[path]));
    settle(&mut harness);
    press(&mut harness, "Spline");
    settle(&mut harness);
    for (chosen, other, name) in [(1, 0, "Preset 2 at 80°"), (0, 1, "Preset 1 at 40°")] {
        find(&harness, name).scroll_to_me();
        (0..20).for_each(|_| harness.step());
        press(&mut harness, name);
        find(&harness, &format!("Preset {}", chosen + 1));
        press(&mut harness, "Mirror");
        settle(&mut harness);
        let Some(StageDoc::SplineBend(stage)) = harness.state().document().stage.first().cloned() else {
            panic!("no spline")
        };
        let PresetsDoc::Inline(now) = stage.presets else { panic!("the presets are not the user's own") };
        assert_ne!(now.presets[chosen], own.presets[chosen], "{name} was not edited");
        assert_eq!(now.presets[other], own.presets[other], "another one than {name} was edited");
        own = *now;
    }
}
