//! What a page keeps for the time when it is loaded again: the scene as it was, and which files it needs.

use super::unsaved::Next;
use super::{Extra, Viewer};
use crate::language::{fill, tr};
use belvedere::editor::{Editor, Recovered};
use belvedere::io::fs;
use belvedere::scene_file::Document;
use eframe::egui::Context;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Names of missing files that a message lists.
const LISTED: usize = 12;

/// State of keeping.
#[derive(Debug, Default)]
pub(super) struct Resumed {
    /// The last state that was told, and whether it had changes.
    told: Option<(Arc<Document>, Extra, bool)>,
    /// Number of scenes that came in place of others.
    scenes: u32,
    /// The number that the first scene has.
    first: u32,
    /// State of a scene that waits for files, and their names.
    awaited: Option<(String, Vec<String>)>,
}

impl Resumed {
    /// * `opens`: whether files are opened at the start.
    pub(super) fn new(opens: bool) -> Self {
        Self { first: u32::from(opens), ..Self::default() }
    }

    /// Another scene comes in place of the current one.
    pub(super) fn another(&mut self) {
        self.scenes += 1;
        self.awaited = None;
    }
}

#[cfg_attr(not(target_family = "wasm"), allow(dead_code))]
impl Viewer {
    /// The state as text if it has changed since the last call; never that of an untouched first scene, and none while a scene waits for its
    /// files and nothing was changed.
    pub(crate) fn left(&mut self) -> Option<String> {
        let is_changed = self.is_changed();
        if self.model.is_opening() || self.model.shown.is_none() || (self.resumed.awaited.is_some() && !is_changed) {
            return None;
        }
        let extra = Extra { look: self.model.look.clone(), tab: self.panels.tab, bookmarks: self.bookmarks.clone() };
        let present = (self.model.document().clone(), extra, is_changed);
        let is_first = self.resumed.told.is_none();
        let is_told = self.resumed.told.as_ref().is_some_and(|(document, extra, changed)| {
            Arc::ptr_eq(document, &present.0) && (extra, *changed) == (&present.1, present.2)
        });
        if is_told {
            return None;
        }
        let beside = serde_json::to_value(&present.1).unwrap_or_default();
        self.resumed.told = Some(present);
        let is_untouched = is_first && self.resumed.scenes <= self.resumed.first && !is_changed;
        (!is_untouched).then(|| Recovered::text_of(&self.model.editor, beside).ok()).flatten()
    }

    /// Shows the scene of a state that [`Viewer::left`] wrote; if files of it are missing, says which and waits for them.
    ///
    /// Returns whether it is shown.
    pub(super) fn resume(&mut self, text: &str) -> bool {
        let Some(left) = Recovered::of_text(text) else { return false };
        let missing = missing(&left.editor);
        if !missing.is_empty() {
            self.tell_missing(&missing);
            self.resumed.awaited = Some((text.to_owned(), missing));
            return false;
        }
        self.replace(left.editor);
        self.model.stay();
        let extra: Extra = serde_json::from_value(left.extra).unwrap_or_default();
        (self.model.look, self.panels.tab) = (extra.look, extra.tab);
        self.bookmarks = extra.bookmarks;
        true
    }

    /// Whether files that have come belong to the scene that waits: it is shown once all are there.
    pub(super) fn resumes(&mut self, ctx: &Context) -> bool {
        let Some((text, before)) = self.resumed.awaited.take() else { return false };
        let Some(left) = Recovered::of_text(&text) else { return false };
        let missing = missing(&left.editor);
        if missing.len() == before.len() {
            self.resumed.awaited = Some((text, before));
            return false;
        }
        if !missing.is_empty() {
            self.tell_missing(&missing);
            self.resumed.awaited = Some((text, missing));
        } else if self.is_changed() {
            self.go_on_to(ctx, Next::Show(Box::new(left.editor)));
        } else {
            self.resume(&text);
        }
        true
    }

    fn tell_missing(&mut self, missing: &[String]) {
        let mut list = missing.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
        if missing.len() > LISTED {
            list = fill(tr("{0} and {1} more"), &[&list, &(missing.len() - LISTED)]);
        }
        let words = tr(
            "The scene that you had open needs files that the browser does not have any more: {0}. Drop them on the page, and it comes back.",
        );
        self.model.notices.error(fill(words, &[&list]));
    }

    /// Number of scenes that came in place of others; `None` while one is on its way.
    pub(crate) fn scene_number(&self) -> Option<u32> {
        (!self.is_opening() && self.model.shown.is_some() && self.resumed.awaited.is_none())
            .then_some(self.resumed.scenes)
    }

    /// Files that the scene reads, canonical.
    pub(crate) fn needs(&self) -> Vec<PathBuf> {
        let mut files: BTreeSet<PathBuf> = BTreeSet::new();
        each_file(&self.model.editor, |_, file| files.extend(file));
        let read = self.model.shown.iter().flat_map(|shown| shown.session.input_paths());
        files.extend(read.map(|file| fs::canonicalize(&file).unwrap_or(file)));
        files.into_iter().collect()
    }

    /// Lets the browser forget the files that it keeps.
    #[cfg(target_family = "wasm")]
    pub(super) fn forget_files(&mut self, ctx: &Context) {
        crate::browser::page::call("forget", &[]);
        let words = tr("The browser has forgotten your files; the scene keeps them until the page is closed.");
        self.model.notices.say(words, ctx.input(|input| input.time));
    }

    /// Says once that the browser keeps no more files.
    ///
    /// * `is_full`: whether there is no room for them; else the browser refuses.
    pub(crate) fn tell_not_kept(&mut self, is_full: bool) {
        let words = if is_full {
            tr(
                "The browser has no room to keep this file: open it again when the page has been loaded again. All else goes on.",
            )
        } else {
            tr(
                "The browser keeps no files here, as in a private window: open them again when the page has been loaded again. All else goes on.",
            )
        };
        self.model.notices.error(words);
    }
}

/// Calls `each` with every name of a file in the document, and the file that it leads to.
fn each_file(editor: &Editor, mut each: impl FnMut(&str, Option<PathBuf>)) {
    let mut document = (**editor.document()).clone();
    document.for_each_path(&mut |name| {
        let file = editor.place.roots.resolve(name).ok();
        each(name, file.map(|file| belvedere::io::split_table(Path::new(&file)).0.to_owned()));
    });
}

/// Names of files in the document that lead to none.
fn missing(editor: &Editor) -> Vec<String> {
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
        let ctx = Context::default();
        let open = || Viewer::new(&ctx, &Opening { left: Some(left.clone()), ..Opening::default() });
        let viewer = open();
        assert!(viewer.document().title == "mine" && viewer.is_changed());
        assert_eq!(viewer.needs(), [mesh.canonicalize().expect("file")]);
        std::fs::rename(&mesh, dir.path().join("b.obj")).expect("renamed");
        let mut viewer = open();
        assert!(viewer.document().title != "mine" && viewer.scene_number().is_none());
        assert!(!viewer.resumes(&ctx), "nothing has come");
        std::fs::rename(dir.path().join("b.obj"), &mesh).expect("renamed");
        assert!(viewer.resumes(&ctx) && viewer.document().title == "mine" && viewer.is_changed());
        assert!(!viewer.resumes(&ctx), "nothing waits any more");
    }
}
