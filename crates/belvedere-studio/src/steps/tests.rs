use super::*;
use belvedere::placed::Place;
use belvedere::scene_file::{OverlayDoc, PointDoc};

fn editor() -> Editor {
    let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[layer]]\nkind = 'line'\nid = 'way'\nsource = 'way.gpx'\n\
            [[layer]]\nkind = 'point'\nid = 'huts'\nsource = 'huts.gpx'\n";
    let source = belvedere::scene_file::parse(std::path::Path::new("s.toml"), text).expect("scene");
    Editor::new(source.document, Place::default())
}

#[test]
fn steps_are_named_by_what_they_changed_and_gone_to() {
    let mut editor = editor();
    for k in 1..=3 {
        editor.edit_within(7, |d| d.camera.eye = PointDoc::Scene([f64::from(k), 0.0, 10.0]));
    }
    editor.edit(|d| d.camera.fov_y_deg = 30.0);
    editor.edit(|d| d.layer.swap(0, 1));
    editor.edit(|d| d.layer[1] = d.layer[1].with_must_see(true));
    editor.edit(|d| drop(d.layer.remove(0)));
    editor.edit(|d| d.overlay = Some(OverlayDoc { heatmap: true, ..OverlayDoc::default() }));
    let expected = [
        "moved the eye",
        "changed the field of view",
        "changed the order of the layers",
        "way must be seen",
        "removed huts",
        "changed the marks",
    ];
    let (names, done) = editor.history();
    assert_eq!((names, done), (expected.map(str::to_owned).to_vec(), 6));
    editor.go_to(1);
    assert_eq!((editor.document().layer.len(), editor.document().camera.fov_y_deg), (2, 45.0));
    assert_eq!(editor.history(), (expected.map(str::to_owned).to_vec(), 1), "the steps are still there");
    editor.go_to(99);
    assert!(editor.document().overlay.is_some());
}

#[test]
fn a_gesture_that_ends_where_it_began_is_no_step() {
    let mut editor = editor();
    editor.edit(|d| d.title = "a".into());
    for x in [1.0, 0.0] {
        editor.edit_within(3, |d| d.camera.eye = PointDoc::Scene([x, 0.0, 10.0]));
    }
    editor.edit(|d| d.title = "b".into());
    assert_eq!(editor.history().0, ["changed the title"; 2]);
    for x in [1.0, 0.0] {
        editor.edit_within(4, |d| d.camera.eye = PointDoc::Scene([x, 0.0, 10.0]));
    }
    assert!(editor.undo() && editor.document().title == "a", "a press of undo does something");
}
