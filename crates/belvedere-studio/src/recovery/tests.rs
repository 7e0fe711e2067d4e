use super::super::FileChange;
use super::super::place::tests::scene;
use super::*;

#[test]
fn what_a_killed_instance_was_doing_comes_back() {
    let dir = tempfile::tempdir().expect("folder");
    let state = dir.path().join("state");
    let mut editor = Editor::open(&scene(dir.path()), Vec::new()).expect("scene");
    editor.edit(|d| d.title = "changed".into());
    let (recovery, left) = Recovery::claim(&state).expect("place");
    assert!(left.is_none());
    recovery.write(&editor, serde_json::json!({ "tool": 3 })).expect("written");
    let (other, left) = Recovery::claim(&state).expect("a second instance");
    assert!(left.is_none(), "what a living instance does is its own");
    other.end();
    drop(recovery); // Dropped as the system does for a killed process.
    let (recovery, left) = Recovery::claim(&state).expect("place");
    let left = left.expect("left behind");
    assert!(left.editor.document().title == "changed" && left.editor.is_changed() && left.extra["tool"] == 3);
    assert_eq!(left.editor.place.scene, editor.place.scene);
    recovery.end();
    assert!(Recovery::claim(&state).expect("place").1.is_none(), "an instance that ended left something");
}

#[test]
fn a_scene_that_was_never_saved_comes_back_changed() {
    let dir = tempfile::tempdir().expect("folder");
    let path = scene(dir.path());
    let source = scene_file::read(&path).expect("scene");
    let mut editor = Editor::new(source.document, Place::default());
    editor.edit(|d| d.title = "changed".into());
    let (recovery, _) = Recovery::claim(&dir.path().join("state")).expect("place");
    recovery.write(&editor, serde_json::Value::Null).expect("written");
    drop(recovery);
    let mut left = Recovery::claim(&dir.path().join("state")).expect("place").1.expect("left behind").editor;
    assert!(left.is_changed() && left.document().title == "changed");
    left.save(&dir.path().join("t.toml")).expect("saved");
    assert!(left.is_saved() && !left.is_changed());
}

#[test]
fn the_state_comes_back_from_text_with_its_changes_and_without_its_file() {
    let dir = tempfile::tempdir().expect("folder");
    let mut editor = Editor::open(&scene(dir.path()), vec!["elsewhere".into()]).expect("scene");
    for changed in [false, true] {
        let text = Recovered::text_of(&editor, serde_json::json!({ "tool": 3 })).expect("text");
        let left = Recovered::of_text(&text).expect("state");
        assert_eq!(left.editor.document(), editor.document());
        assert_eq!((left.editor.is_changed(), &left.extra["tool"]), (changed, &3.into()));
        assert_eq!(left.editor.place.roots.allowed, editor.place.roots.allowed);
        editor.edit(|d| d.title = "changed".into());
    }
    editor.mark_saved();
    let text = Recovered::text_of(&editor, serde_json::Value::Null).expect("text");
    let left = Recovered::of_text(&text).expect("state").editor;
    assert!(left.document().title == "changed" && !left.is_changed(), "the file holds an older document");
    assert!(Recovered::of_text("no state").is_none());
}

#[test]
fn a_scene_that_was_undone_to_what_the_page_brings_after_a_save_is_changed() {
    let dir = tempfile::tempdir().expect("folder");
    let path = scene(dir.path());
    let packed = std::fs::read(&path).expect("scene");
    let mut editor = Editor::open(&path, Vec::new()).expect("scene");
    editor.edit(|d| d.title = "changed".into());
    editor.save(&path).expect("saved");
    assert!(editor.undo() && editor.is_changed());
    let text = Recovered::text_of(&editor, serde_json::Value::Null).expect("text");
    std::fs::write(&path, packed).expect("the page is loaded again");
    let left = Recovered::of_text(&text).expect("state").editor;
    assert!(left.is_changed() && left.document() == editor.document());
}

#[test]
fn what_another_program_wrote_after_a_crash_is_noticed() {
    let dir = tempfile::tempdir().expect("folder");
    let path = scene(dir.path());
    let before = std::fs::read_to_string(&path).expect("text");
    for (now, change) in [(before.clone(), None), (format!("title = 'x'\n{before}"), Some(FileChange::Edited))] {
        std::fs::write(&path, &before).expect("written");
        let mut editor = Editor::open(&path, Vec::new()).expect("scene");
        editor.edit(|d| d.camera.fov_y_deg = 30.0);
        let (recovery, _) = Recovery::claim(&dir.path().join("state")).expect("place");
        recovery.write(&editor, serde_json::Value::Null).expect("written");
        drop(recovery);
        std::fs::write(&path, now).expect("another program");
        let (recovery, left) = Recovery::claim(&dir.path().join("state")).expect("place");
        let mut left = left.expect("left behind").editor;
        assert_eq!(left.file_change(), change);
        assert_eq!(left.save(&path).is_ok(), change.is_none());
        recovery.end();
    }
}
