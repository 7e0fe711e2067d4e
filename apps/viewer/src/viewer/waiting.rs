//! Scenes of an earlier load of the page that wait for files which the browser has lost. They wait until their files come, or until the user
//! gives them up; other scenes may be opened meanwhile.

use super::unsaved::Next;
use super::{Extra, Viewer};
use crate::language::{fill, tr};
use crate::menu::WaitingScene;
use belvedere_studio::{Editor, Recovered};
use eframe::egui::Context;
use std::path::{Path, PathBuf};

/// Names of missing files that a message lists.
const LISTED: usize = 12;

/// A scene that waits.
#[derive(Debug)]
pub(super) struct Waiting {
    /// Its state.
    pub(super) text: String,
    title: String,
    /// Names of the files that it still needs.
    missing: Vec<String>,
}

impl Waiting {
    /// Files of the scene that are there, canonical.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        if let Some(left) = Recovered::of_text(&self.text) {
            each_file(&left.editor, |_, file| files.extend(file));
        }
        files
    }
}

impl Viewer {
    /// Lets a state wait, and the states that waited beside it; those whose files are all there wait, too, until they are called.
    pub(super) fn wait_for_files(&mut self, text: &str) {
        let Some(mut left) = Recovered::of_text(text) else { return };
        let mut extra: Extra = serde_json::from_value(left.extra).unwrap_or_default();
        for other in std::mem::take(&mut extra.waiting) {
            self.wait_for_files(&other);
        }
        left.extra = serde_json::to_value(extra).unwrap_or_default();
        let Ok(text) = Recovered::text_of(&left.editor, left.extra) else { return };
        if self.resumed.waiting.iter().any(|other| other.text == text) {
            return;
        }
        let missing = missing(&left.editor);
        self.tell_missing(&missing);
        self.resumed.waiting.push(Waiting { text, title: left.editor.document().title.clone(), missing });
    }

    /// Whether files that have come belong to scenes that wait; the first that has all its files is shown.
    pub(super) fn resumes(&mut self, ctx: &Context) -> bool {
        let (mut came, mut ready, mut still) = (false, None, Vec::new());
        for waiting in &mut self.resumed.waiting {
            let Some(left) = Recovered::of_text(&waiting.text) else { continue };
            let missing = missing(&left.editor);
            if missing.len() >= waiting.missing.len() {
                continue;
            }
            came = true;
            waiting.missing = missing;
            if waiting.missing.is_empty() {
                ready = ready.or_else(|| Some(waiting.text.clone()));
            } else {
                still.push(waiting.missing.clone());
            }
        }
        still.iter().for_each(|missing| self.tell_missing(missing));
        if let Some(text) = ready {
            self.go_on_to(ctx, Next::Return(text));
        }
        came
    }

    /// Shows a scene that waited, without a question.
    pub(super) fn return_to_waiting(&mut self, text: &str) {
        self.resumed.waiting.retain(|waiting| waiting.text != text);
        self.resume(text);
    }

    /// Shows the `i`-th scene that waits, if its files are there.
    pub(super) fn call_waiting(&mut self, ctx: &Context, i: usize) {
        if let Some(waiting) = self.resumed.waiting.get(i) {
            let text = waiting.text.clone();
            self.go_on_to(ctx, Next::Return(text));
        }
    }

    /// Gives up the `i`-th scene that waits.
    pub(super) fn give_up(&mut self, i: usize) {
        if i < self.resumed.waiting.len() {
            self.resumed.waiting.remove(i);
            self.resumed.gave_up = true;
        }
    }

    /// The scenes that wait, for the menu.
    pub(super) fn waiting(&self) -> Vec<WaitingScene> {
        let title =
            |title: &str| if title.is_empty() { tr("the scene without a title").into() } else { title.to_owned() };
        let entry = |waiting: &Waiting| WaitingScene { title: title(&waiting.title), missing: list(&waiting.missing) };
        self.resumed.waiting.iter().map(entry).collect()
    }

    fn tell_missing(&mut self, missing: &[String]) {
        if missing.is_empty() {
            return;
        }
        let words = tr(
            "The scene that you had open needs files that the browser does not have any more: {0}. Drop them on the page, and it comes back. It waits in the menu File, where you can give it up.",
        );
        self.model.notices.error(fill(words, &[&list(missing)]));
    }
}

fn list(missing: &[String]) -> String {
    let list = missing.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    if missing.len() > LISTED { fill(tr("{0} and {1} more"), &[&list, &(missing.len() - LISTED)]) } else { list }
}

/// Calls `each` with every name of a file in the document, and the file that it leads to.
pub(super) fn each_file(editor: &Editor, mut each: impl FnMut(&str, Option<PathBuf>)) {
    let mut document = (**editor.document()).clone();
    document.for_each_path(&mut |name| {
        let file = editor.place.roots.resolve(name).ok();
        each(name, file.map(|file| belvedere::io::split_table(Path::new(&file)).0.to_owned()));
    });
}

/// Names of files in the document that lead to none.
pub(super) fn missing(editor: &Editor) -> Vec<String> {
    let mut names = Vec::new();
    each_file(editor, |name, file| {
        if file.is_none() && !names.iter().any(|other| other == name) {
            names.push(name.to_owned());
        }
    });
    names
}

#[cfg(test)]
mod tests {
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
        let [from, to] =
            [if ending == "obj" { "aside" } else { "obj" }, ending].map(|e| dir.join(format!("{name}.{e}")));
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
}
