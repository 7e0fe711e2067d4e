use super::*;

fn editor() -> Editor {
    let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n";
    let source = belvedere::scene_file::parse(Path::new("s.toml"), text).expect("scene");
    Editor::new(source.document, Place::default())
}

#[test]
fn a_gesture_is_one_step() {
    let mut editor = editor();
    editor.edit(|d| d.title = "a".into());
    for fov in [40.0, 35.0, 30.0] {
        editor.edit_within(1, |d| d.camera.fov_y_deg = fov);
    }
    editor.edit_within(2, |d| d.camera.fov_y_deg = 20.0);
    assert!(editor.undo() && editor.document().camera.fov_y_deg == 30.0);
    assert!(editor.undo() && editor.document().camera.fov_y_deg == 45.0 && editor.document().title == "a");
    assert!(editor.redo() && editor.document().camera.fov_y_deg == 30.0);
    editor.edit(|d| d.title = "b".into());
    assert!(!editor.redo(), "what was undone is gone after an edit");
}

#[test]
fn layers_that_are_added_together_are_one_step() {
    let (mut editor, text) = (editor(), "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n");
    let layer = |id: &str| format!("[[layer]]\nkind = 'line'\nid = '{id}'\nsource = 'way.gpx'\n");
    let text = format!("{text}{}{}", layer("a"), layer("b"));
    let layers = belvedere::scene_file::parse(Path::new("s.toml"), &text).expect("scene").document.layer;
    editor.add_layers(layers, vec!["folder".into()]);
    assert_eq!((editor.document().layer.len(), editor.place.roots.allowed.len()), (2, 1));
    assert!(editor.undo() && editor.document().layer.is_empty());
}

#[test]
fn an_edit_that_changes_nothing_is_no_step() {
    let mut editor = editor();
    editor.edit(|d| d.title = String::new());
    assert!(!editor.can_undo() && !editor.is_changed());
}

/// A small generator of numbers (Knuth's MMIX constants).
fn throw(dice: &mut u64, sides: u64) -> u64 {
    *dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*dice >> 33) % sides
}

#[test]
fn gestures_are_steps_and_undo_restores_the_document_before_each() {
    for seed in 0..200 {
        let (mut editor, mut dice) = (editor(), seed);
        // Documents before each step that is not undone.
        let mut before: Vec<Document> = Vec::new();
        let mut undone: Vec<Document> = Vec::new();
        for gesture in 0..40 {
            let present = (**editor.document()).clone();
            match throw(&mut dice, 6) {
                0 => {
                    assert_eq!(editor.undo(), !before.is_empty());
                    if let Some(last) = before.pop() {
                        assert_eq!(**editor.document(), last, "seed {seed}, gesture {gesture}");
                        undone.push(present);
                    }
                }
                1 => {
                    assert_eq!(editor.redo(), !undone.is_empty());
                    if let Some(next) = undone.pop() {
                        assert_eq!(**editor.document(), next);
                        before.push(present);
                    }
                }
                2 => editor.mark_saved(),
                what => {
                    let mut moved = false;
                    for _ in 0..=throw(&mut dice, 4) {
                        let value = 20.0 + throw(&mut dice, 60) as f64;
                        let change = |d: &mut Document| match what {
                            3 => d.camera.fov_y_deg = value,
                            4 => d.title = value.to_string(),
                            _ => d.camera.near = value,
                        };
                        editor.edit_within(gesture, change);
                        moved |= **editor.document() != present;
                    }
                    if moved {
                        undone.clear();
                    }
                    if **editor.document() != present {
                        before.push(present);
                    }
                }
            }
            let steps = before.len();
            assert!((steps..=steps + 1).contains(&editor.history().1), "seed {seed}: {steps} steps");
        }
        while let Some(last) = before.pop() {
            assert!(editor.undo() && **editor.document() == last, "seed {seed}");
        }
        assert!(!editor.undo());
    }
}
