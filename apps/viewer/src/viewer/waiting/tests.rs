use super::*;
use crate::Opening;
use crate::menu::Bookmark;

/// A scene with one model; `name` is its title and the name of the model's file.
fn scene(dir: &Path, name: &str) -> Editor {
    let path = dir.join(format!("{name}.toml"));
    let text = format!(
        "format = 1\ntitle = '{name}'\n[camera]\neye = [0, 0, 10]\nlook_at = [0, 1, 0]\n[[layer]]\nid = 'a'\nkind = 'mesh'\nsource = '{name}.obj'\n"
    );
    std::fs::write(&path, text).expect("scene");
    std::fs::write(dir.join(format!("{name}.obj")), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("mesh");
    Editor::open(&path, Vec::new()).expect("scene")
}

/// A changed scene with a bookmark as a page leaves it; its model is put aside.
fn lost(dir: &Path, name: &str) -> String {
    let mut editor = scene(dir, name);
    editor.edit(|document| document.camera.fov_y_deg = 30.0);
    let camera = editor.document().camera.clone();
    let extra = Extra { bookmarks: vec![Bookmark { name: "there".into(), camera }], ..Extra::default() };
    let text = Recovered::text_of(&editor, serde_json::to_value(extra).expect("extra")).expect("text");
    put(dir, name, "aside");
    text
}

fn put(dir: &Path, name: &str, ending: &str) {
    let [from, to] = [if ending == "obj" { "aside" } else { "obj" }, ending].map(|e| dir.join(format!("{name}.{e}")));
    std::fs::rename(from, to).expect("renamed");
}

fn loaded(text: &str) -> Viewer {
    Viewer::new(&Context::default(), &Opening { left: Some(text.to_owned()), ..Opening::default() })
}

#[test]
fn a_scene_waits_while_others_are_opened_and_over_new_loads_of_the_page() {
    let dir = tempfile::tempdir().expect("folder");
    let ctx = Context::default();
    let mut viewer = loaded(&lost(dir.path(), "mine"));
    viewer.replace(scene(dir.path(), "other"));
    let text = viewer.state_text().expect("a state");
    let mut viewer = loaded(&text);
    assert!(viewer.document().title == "other" && viewer.waiting()[0].missing == "mine.obj");
    assert!(!viewer.resumes(&ctx), "nothing has come");
    put(dir.path(), "mine", "obj");
    assert!(viewer.resumes(&ctx) && viewer.document().title == "mine" && viewer.is_changed());
    assert_eq!(viewer.bookmarks.first().map(|bookmark| bookmark.name.as_str()), Some("there"));
    assert!(viewer.waiting().is_empty());
}

#[test]
fn a_scene_whose_files_came_waits_for_the_answer_about_the_present_one() {
    let dir = tempfile::tempdir().expect("folder");
    let ctx = Context::default();
    let mut viewer = loaded(&lost(dir.path(), "mine"));
    viewer.replace(scene(dir.path(), "other"));
    viewer.model.edit(|document| document.camera.fov_y_deg = 20.0);
    put(dir.path(), "mine", "obj");
    assert!(viewer.resumes(&ctx) && viewer.asks() && viewer.document().title == "other");
    viewer.unsaved = None;
    assert!(viewer.waiting()[0].missing.is_empty(), "it waits on");
    viewer.call_waiting(&ctx, 0);
    let next = viewer.unsaved.take().expect("the question").into_next();
    viewer.go_on(&ctx, next);
    assert!(viewer.document().title == "mine" && viewer.bookmarks.len() == 1 && viewer.waiting().is_empty());
}

#[test]
fn two_scenes_wait_and_one_that_is_given_up_is_gone() {
    let dir = tempfile::tempdir().expect("folder");
    let first = lost(dir.path(), "first");
    let mut viewer = loaded(&first);
    assert!(viewer.state_text().is_none(), "an untouched page has nothing new to keep");
    viewer.replace(scene(dir.path(), "second"));
    viewer.model.edit(|document| document.camera.fov_y_deg = 20.0);
    let both = viewer.state_text().expect("a state");
    put(dir.path(), "second", "aside");
    let mut viewer = loaded(&both);
    let titles = |viewer: &Viewer| viewer.waiting().into_iter().map(|entry| entry.title).collect::<Vec<_>>();
    assert_eq!(titles(&viewer), ["first", "second"]);
    viewer.give_up(0);
    let text = viewer.state_text().expect("what is given up is not kept");
    assert_eq!(titles(&loaded(&text)), ["second"]);
}
