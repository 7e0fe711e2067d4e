use super::*;
use crate::Opening;
use belvedere_studio::Editor;

#[test]
fn a_scene_comes_back_changed_and_waits_for_files_that_are_missing() {
    let dir = tempfile::tempdir().expect("folder");
    let path = dir.path().join("s.toml");
    let text = "format = 1\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[layer]]\nid = 'a'\nkind = 'mesh'\nsource = 'a.obj'\n";
    std::fs::write(&path, text).expect("scene");
    let mesh = dir.path().join("a.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("mesh");
    let mut editor = Editor::open(&path, Vec::new()).expect("scene");
    editor.edit(|document| document.title = "mine".into());
    let left = Recovered::text_of(&editor, serde_json::to_value(Extra::default()).expect("extra")).expect("text");
    let ctx = eframe::egui::Context::default();
    let open = || Viewer::new(&ctx, &Opening { left: Some(left.clone()), ..Opening::default() });
    let viewer = open();
    assert!(viewer.document().title == "mine" && viewer.is_changed());
    assert_eq!(viewer.needs(), [mesh.canonicalize().expect("file")]);
    std::fs::rename(&mesh, dir.path().join("b.obj")).expect("renamed");
    let mut viewer = open();
    assert!(viewer.document().title != "mine");
    assert!(!viewer.resumes(&ctx), "nothing has come");
    std::fs::rename(dir.path().join("b.obj"), &mesh).expect("renamed");
    assert!(viewer.resumes(&ctx) && viewer.document().title == "mine" && viewer.is_changed());
    assert!(!viewer.resumes(&ctx), "nothing waits any more");
}

#[test]
fn what_the_browser_does_not_keep_is_said_with_the_reason() {
    use egui_kittest::kittest::Queryable;
    type Tell = fn(&mut Viewer, bool);
    let new = |cc: &mut eframe::CreationContext<'_>| Viewer::new(&cc.egui_ctx, &Opening::default());
    let mut harness = egui_kittest::Harness::builder().with_max_steps(4).build_eframe(new);
    let tells: [(Tell, bool, &str); 4] = [
        (Viewer::tell_not_remembered, true, "The browser has no room to keep this scene"),
        (Viewer::tell_not_remembered, false, "The browser keeps no scenes here"),
        (Viewer::tell_not_kept, true, "The browser has no room to keep this file"),
        (Viewer::tell_not_kept, false, "The browser keeps no files here"),
    ];
    for (tell, is_full, words) in tells {
        assert!(harness.query_by_label_contains(words).is_none());
        tell(harness.state_mut(), is_full);
        (0..2).for_each(|_| harness.step());
        assert!(harness.query_by_label_contains(words).is_some(), "{words}");
    }
}
